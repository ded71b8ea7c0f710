"""Soil ahead of the mole: a second integrator, closed forms, energy, and its absence."""

import numpy as np
import pytest
import slider

from models.mole import exact, lanes
from models.mole.lanes.rows import CONTACTS, DENT, FRONT, IMPACT, PROGRESS, SOIL_MODE
from models.mole.parameters import Params, Settings
from models.mole.response.machines import Machines
from models.mole.response.settled import respond
from models.mole.theory import equations
from models.mole.theory.soil import APART
from models.mole.theory.system import mole

SIZES = np.array([1e-2, 1.0, 0.1, 1.0, 80.0, 1e-2, 1e-2, 1e-2])
STATE = [0, 1, 2, 3, 4, 5, equations.SOIL_FRONT, equations.SOIL_BASE]


def drawn(count, seed=5):
    """Return moles in soils of all kinds: soft and stiff, elastic and damped, some ever denser."""
    rng = np.random.default_rng(seed)
    for i in range(count):
        damping = [0.0, 10 ** rng.uniform(1, 3.3)][i % 2]
        yield Params(
            control_frequency=rng.uniform(5, 12),
            supply_phase=rng.uniform(0, 6),
            bar_friction=0.295 * rng.uniform(0.5, 1.5),
            mole_friction=0.235 * rng.choice([0.1, 1.0, 3.0]) * rng.uniform(0.5, 1.5),
            stop_gap=rng.uniform(-4e-3, 0.0),
            soil_limit=10 ** rng.uniform(0, 2),
            soil_limit_gradient=rng.choice([0.0, 100.0]),
            soil_stiffness=10 ** rng.uniform(3.3, 6),
            soil_damping=damping,
        )


def compare(p, end=0.2, longest=1e-4):
    times = np.sort(np.random.default_rng(3).uniform(0, end, 150))
    switching = np.arange(0, 2 * end * p.control_frequency) / (2 * p.control_frequency)
    times = times[abs(times[:, None] - switching).min(axis=1) > 1e-5]
    expected, events = slider.follow(p, end, times, longest)
    q = mole(p, "physical")
    motion = exact.propagate(q, exact.start(p, q), end, 1e-12, times)
    return (motion.samples[:, STATE] - expected) / SIZES, events


def test_it_moves_as_by_scipy_in_soil():
    for p in drawn(3):
        difference, _ = compare(p)
        assert abs(difference).max() < 1e-8


@pytest.mark.slow
def test_forty_moles_move_as_by_scipy_in_soil():
    total = 0
    for p in drawn(40):
        difference, events = compare(p)
        assert abs(difference).max() < 1e-8
        total += events
    assert total > 100


def lanes_of(rows, tolerance):
    return Machines.started(Params._make(np.array(rows, float).T), Settings(tolerance=tolerance))


def test_lanes_move_in_soil_as_the_exact_propagator():
    rows = [p._replace(soil_limit_gradient=0.0) for p in drawn(40)]
    some = lanes_of(rows, 1e-11)
    every = np.arange(len(rows))
    assert len(some.run(every, np.full(40, 12))) == 40
    modes = set()
    for p, got in zip(rows, some.record, strict=True):
        q = mole(p, "physical")
        motion = exact.propagate(q, exact.start(p, q), 12 * q.control_period, 1e-13)
        y = motion.state.y
        np.testing.assert_allclose(got[:4] / SIZES[:4], y[:4] / SIZES[:4], rtol=0, atol=1e-7)
        base = y[equations.SOIL_BASE]
        assert got[DENT] == pytest.approx(y[equations.MOLE_DISPLACEMENT] - base, abs=1e-10)
        if motion.state.soil == APART:
            assert got[FRONT] == pytest.approx(y[equations.SOIL_FRONT] - base, abs=1e-10)
        assert got[PROGRESS] == pytest.approx(y[equations.MOLE_DISPLACEMENT], abs=1e-9)
        assert got[IMPACT] == pytest.approx(y[equations.IMPACT_WORK], abs=1e-7)
        assert got[SOIL_MODE] == motion.state.soil and got[CONTACTS] == motion.contacts
        modes.add(motion.state.soil)
    assert len(modes) > 1


@pytest.mark.parametrize("damping", [0.0, 100.0])
def test_tangents_go_through_events_in_soil_as_neighbouring_motions_do(damping):
    """Central differences of the exact propagator, over three control periods at 7 Hz."""
    p = Params(control_frequency=7.0, soil_limit=20.0, soil_damping=damping, soil_stiffness=2e4)
    q = mole(p, "physical")
    some = lanes_of([p], 1e-12)
    some.run(np.arange(1), np.array([20]))
    flow = lanes.monodromy(some.system, some.record, np.array([23]))[0]
    state = exact.propagate(q, exact.start(p, q), 20 * q.control_period, 1e-13).state
    w, front, base = equations.MOLE_DISPLACEMENT, equations.SOIL_FRONT, equations.SOIL_BASE
    sizes = np.array([1e-2, 1.0, 0.1, 1.0, 80.0, 1e-3, 1e-3])
    places = [0, 1, 2, 3, 4, w, front]
    free = [j for j in range(6) if not (j in (1, 2) and state.y[j] == 0)]
    free += [6] if state.soil == APART and damping else []
    expected = np.zeros((7, 7))
    for j in free:
        ends = []
        for side in (1, -1):
            y = state.y.copy()
            y[places[j]] += side * 1e-6 * sizes[j]
            if j == 5 and state.soil != APART:
                y[front] = y[w]
            end = exact.propagate(q, state._replace(y=y), 23 * q.control_period, 1e-13).state
            y = end.y[places]
            y[5:] -= end.y[base]
            ends.append(y)
        expected[:, j] = (ends[0] - ends[1]) / (2e-6 * sizes[j])
    scale = sizes / sizes[:, None]
    np.testing.assert_allclose((flow * scale)[:6, free], (expected * scale)[:6, free], atol=5e-5)
    assert abs(flow * scale)[:6, free].max() > 0.01
    settled = respond(some, Settings())
    assert settled.period[0] > 0 and settled.growth[0, 0] < 0
