"""The fast propagator beside the exact one, and its tangent flow through every event."""

import numpy as np
import pytest

from models.mole import MODEL, exact, lanes
from models.mole.lanes.block import MEASURED
from models.mole.lanes.rows import (
    CONTACTS,
    ELECTRIC,
    GROWTH,
    HALF,
    HIGH,
    IMPACT,
    IMPULSE,
    LOW,
    OUTCOME,
    PROGRESS,
    REACHED_END,
)
from models.mole.parameters import FORMULATIONS, Params, Settings
from models.mole.response.following import follow_repeating
from models.mole.response.machines import Machines
from models.mole.response.measured import Response
from models.mole.response.settling import settle
from models.mole.theory import equations
from models.mole.theory.system import mole

RNG = np.random.default_rng(11)
SIZES = np.array([1e-2, 1.0, 0.1, 1.0])  # of u, v, x, i


def machines(rows, tolerance, formulation="physical"):
    p = Params._make(np.array(rows, float).T)
    return Machines.started(p, Settings(formulation=formulation, tolerance=tolerance))


def scattered(n):
    """Return moles of all kinds within a tenth of the nominal one."""
    nominal = np.array(Params())
    rows = nominal * RNG.uniform(0.9, 1.1, (n, len(nominal)))
    rows[:, Params._fields.index("control_frequency")] = RNG.uniform(2.5, 13, n)
    rows[:, Params._fields.index("supply_phase")] = RNG.uniform(0, 6, n)
    return rows


def go(some, periods):
    """Propagate all rows so many control periods; return their records."""
    rows = np.arange(len(some.record))
    reached = some.run(rows, some.periods(rows) + periods)
    assert len(reached) == len(rows)
    assert np.all(some.record[:, OUTCOME] == REACHED_END)
    return some.record


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("frequency", [2.5, 5.0, 7.0, 8.0, 13.0, 47 / (2 * np.pi)])
def test_it_moves_as_the_exact_propagator(formulation, frequency):
    p = Params(control_frequency=frequency)
    q = mole(p, formulation)
    periods = int(2 * frequency)
    record = go(machines([p], 1e-11, formulation), periods)
    motion = exact.propagate(q, exact.start(p, q), periods * q.control_period, 1e-13)
    y = motion.state.y
    np.testing.assert_allclose(record[0, :4] / SIZES, y[:4] / SIZES, atol=1e-8)
    assert record[0, CONTACTS] == motion.contacts
    assert record[0, PROGRESS] == pytest.approx(y[5], abs=1e-8)
    assert record[0, IMPULSE] == pytest.approx(y[equations.IMPULSE], abs=1e-7)
    assert record[0, IMPACT] == pytest.approx(y[equations.IMPACT_WORK], abs=1e-6)
    assert record[0, ELECTRIC] == pytest.approx(y[equations.ELECTRICAL_WORK], abs=1e-5)
    assert record[0, LOW] == pytest.approx(motion.lowest, abs=1e-10)
    assert record[0, HIGH] == pytest.approx(motion.highest, abs=1e-10)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
@pytest.mark.parametrize(
    ("bar_friction", "mole_friction", "phase", "displacement"),
    [
        (9.0, 0.1, -1.67, -0.0410458),  # the bar stops before the mole would begin to slip
        (8.72, 0.02, 1.471, -0.0326306),  # the force on the mole reaches its limits on both sides
        (7.31, 0.02, 1.778, -0.0380499),  # or one, from zero and back
    ],
)
def test_slips_shorter_than_a_step_are_found(
    bar_friction, mole_friction, phase, displacement, tolerance
):
    """Slips of half a millisecond to one and a half, in steps of up to three."""
    p = Params(
        bar_friction=bar_friction,
        mole_friction=mole_friction,
        supply_phase=phase,
        initial_displacement=displacement,
        control_frequency=2.5,
    )
    q = mole(p, "physical")
    record = go(machines([p], tolerance), 2)
    motion = exact.propagate(q, exact.start(p, q), 2 * q.control_period, 1e-12)
    np.testing.assert_allclose(record[0, 0], motion.state.y[0], atol=2 * tolerance * SIZES[0])
    assert record[0, PROGRESS] == pytest.approx(motion.state.y[5], abs=2 * tolerance * SIZES[0])


def test_without_friction_on_the_ground_momentum_is_conserved():
    """Bars that stick or not, some thrown back by the stop; voltages up to thirty times nominal."""
    n = 256
    fields = {
        "bar_friction": RNG.choice([0.0, 1e-3, 0.1, 0.6, 9.0], n),
        "supply_voltage": RNG.choice([20.0, 82.02, 600.0, 2500.0], n),
        "supply_phase": RNG.uniform(-np.pi, np.pi, n),
        "initial_displacement": RNG.uniform(-0.05, 0.02, n),
        "mole_friction": np.zeros(n),
    }
    p = Params(**{k: np.broadcast_to(v, n) for k, v in (Params()._asdict() | fields).items()})
    record = go(machines(np.transpose(p), 1e-8), 30)
    share = p.bar_mass / (p.bar_mass + p.mole_mass)
    u, v, x = record[:, :3].T
    np.testing.assert_allclose(x, -share * v, rtol=0, atol=1e-11)
    moved = -share * (u - p.initial_displacement)
    np.testing.assert_allclose(record[:, PROGRESS], moved, rtol=0, atol=1e-9)


def test_moles_anywhere_within_the_bounds_move_as_the_exact_propagator():
    """Bars flung far and fast, every other one through a narrow coil."""
    bounds = [MODEL.parameter(name).bounds for name in MODEL.parameter_names]
    low, high = np.transpose(bounds)
    fast = Params._fields.index("friction_gradient")  # the others are of slow time
    rows = np.tile(np.array(Params()), (120, 1))
    rows[:, :fast] = np.random.default_rng(5).uniform(low[:fast], high[:fast], (120, fast))
    rows[::2, Params._fields.index("inductance_width")] *= 0.01
    rows[:, Params._fields.index("control_frequency")] += 5.0
    some = machines(rows, 1e-10)
    periods = np.ceil(0.2 * rows[:, Params._fields.index("control_frequency")]).astype(int)
    record = go(some, periods)
    far = []
    for row, count, got in zip(rows, periods, record, strict=True):
        p = Params._make(row)
        q = mole(p, "physical")
        motion = exact.propagate(q, exact.start(p, q), count * q.control_period, 1e-12)
        length = motion.highest - motion.lowest + 0.01
        sizes = np.array([length, length * 10, length * 10, p.supply_voltage / p.resistance])
        np.testing.assert_allclose(got[:4] / sizes, motion.state.y[:4] / sizes, rtol=0, atol=1e-7)
        assert got[CONTACTS] == motion.contacts
        far.append(length)
    assert np.median(far) > 1


def test_an_interruption_changes_little():
    rows = scattered(16)
    through = go(machines(rows, 1e-10), 30)
    some = machines(rows, 1e-10)
    first = go(some, 13).copy()
    second = go(some, 17)
    close = abs(second[:, :3] - through[:, :3]) / SIZES[:3] < 1e-6
    assert close.all(axis=1).sum() >= 14  # one or two may be chaotic
    still = close.all(axis=1)
    np.testing.assert_allclose(
        (first + second)[still, PROGRESS], through[still, PROGRESS], atol=1e-8
    )


def test_tangents_go_through_events_as_neighbouring_motions_do():
    """Central differences of the exact propagator, over four control periods at 8 Hz."""
    p = Params()
    q = mole(p, "physical")
    some = machines([p], 1e-12)
    begin = go(some, 40)[0].copy()
    flow = lanes.monodromy(some.system, some.record, np.array([44]))[0]
    state = exact.propagate(q, exact.start(p, q), 40 * q.control_period, 1e-13).state
    np.testing.assert_allclose(state.y[:4] / SIZES, begin[:4] / SIZES, atol=1e-7)
    sizes = np.array([1e-2, 1.0, 0.1, 1.0, 80.0])
    expected = np.empty((MEASURED, MEASURED))
    for j in range(MEASURED):
        ends = []
        for side in (1, -1):
            y = state.y.copy()
            y[j] += side * 1e-6 * sizes[j]
            moved = state._replace(y=y)
            ends.append(exact.propagate(q, moved, 44 * q.control_period, 1e-13).state.y[:5])
        expected[:, j] = (ends[0] - ends[1]) / (2e-6 * sizes[j])
    # At the strobe bar and mole stick or slip as they do: what sticks has no freedom to start with.
    free = [j for j in range(MEASURED) if not (j in (1, 2) and state.y[j] == 0)]
    scaled = flow * sizes / sizes[:, None]
    np.testing.assert_allclose(
        scaled[:, free], (expected * sizes / sizes[:, None])[:, free], atol=2e-5
    )
    assert abs(scaled[:, free]).max() > 0.1


def test_the_exponent_is_how_fast_neighbours_part():
    """At 9 Hz, with the distance brought back after every control period."""
    parted, tangent = np.zeros(400), np.zeros(400)
    some = machines([Params(control_frequency=9.0)] * 2, 1e-12)
    go(some, 100)
    sizes = np.array([1e-2, 1.0, 0.1, 1.0, 80.0])
    apart = np.array([1e-9, 0.0, 0.0, 0.0, 0.0])
    flow = np.ones((2, MEASURED))
    for period in range(400):
        some.record[1] = some.record[0]
        some.record[1, :5] += apart
        limit = some.periods(np.arange(2)) + 1
        some.run(np.arange(2), limit, flow)
        assert np.abs(flow[0]).max() == 1
        flow[1] = flow[0]
        tangent[period] = some.record[0, GROWTH]
        apart = some.record[1, :5] - some.record[0, :5]
        size = np.linalg.norm(apart / sizes)
        parted[period] = np.log(size / 1e-7)
        apart *= 1e-7 / size
        # What sticks has nothing to be apart in.
        apart[1:3] *= some.record[0, 1:3] != 0
    exponents = np.array([parted[1:].mean(), tangent[1:].mean()]) * 9.0
    assert exponents[0] > 2.5
    assert exponents[0] == pytest.approx(exponents[1], abs=0.05)


def test_a_row_that_cannot_end_is_stopped(monkeypatch):
    monkeypatch.setattr("models.mole.lanes.propagator.BUDGET", 1000)
    some = machines([Params()], 1e-8)
    reached = some.run(np.array([0]), np.array([100]))
    assert len(reached) == 0
    assert some.record[0, HALF] < 200


def test_motion_that_repeats_is_averaged_over_whole_periods_of_it():
    """Ten control periods at 7 Hz, where it takes seven to repeat, are rounded up."""
    some, out = machines([Params(control_frequency=7.0)], 1e-8), Response.nothing(1)
    repeating, _ = settle(some, 0)
    follow_repeating(some, repeating, 10, out)
    np.testing.assert_allclose(out.time, [14 / 7.0])
    assert out.contacts.sum() == 14
