"""Soil ahead of the mole: a second integrator, closed forms, energy, and its absence."""

import numpy as np
import pytest
import slider

from models.mole import exact, lanes
from models.mole.batch import batch
from models.mole.lanes.rows import CONTACTS, DENT, FRONT, IMPACT, PROGRESS, SOIL_MODE
from models.mole.parameters import Params, Settings
from models.mole.response.machines import Machines
from models.mole.response.settled import respond
from models.mole.theory import equations
from models.mole.theory.soil import APART, ELASTIC, SLIDING, decide_in_soil
from models.mole.theory.system import mole
from uq.contract import Status

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


def thrust(speed, stiffness, damping=0.0, friction=0.0, limit=30.0):
    """Return how far the base is driven, and the state, of a mole and its bar thrown as one."""
    p = Params(
        bar_friction=9.0,
        supply_voltage=2.7,
        spring_rest=-0.022,
        mole_friction=friction,
        soil_limit=limit,
        soil_stiffness=stiffness,
        soil_damping=damping,
    )
    q = mole(p, "physical")
    y = np.zeros(equations.SIZE_IN_SOIL)
    y[0], y[2] = p.initial_displacement, speed
    soil = SLIDING if damping * speed >= limit else ELASTIC
    state = exact.State(0.0, y, False, 0, 1, 0, soil)
    end = exact.propagate(q, state, 0.3, 1e-12).state
    return end.y[equations.SOIL_BASE], 0.5 * (p.bar_mass + p.mole_mass) * speed**2, q, end


@pytest.mark.parametrize("friction", [0.1, 0.4])
def test_in_stiff_soil_a_blow_drives_the_mole_by_its_energy_over_the_forces(friction):
    base, energy, q, end = thrust(0.3, 1e7, friction=friction)
    forces = 30.0 + q.mole_limit
    np.testing.assert_allclose(base, energy / forces, rtol=2e-3)
    loading = 30.0**2 / (2 * 1e7) + q.mole_limit * 30.0 / 1e7
    np.testing.assert_allclose(base, (energy - loading) / forces, rtol=1e-6)
    assert end.y[2] == 0 or friction < 0.4


@pytest.mark.parametrize("stiffness", [1e4, 1e5])
def test_without_friction_a_blow_first_loads_the_soil_then_drives_it(stiffness):
    """E = F_y^2/(2 k) + F_y db; below the first term there is no advance."""
    loaded = 30.0**2 / (2 * stiffness)
    base, energy, _, _ = thrust(0.3, stiffness)
    np.testing.assert_allclose(base, (energy - loaded) / 30.0, rtol=1e-8)
    mass = energy / (0.5 * 0.3**2)
    for share in (0.5, 0.999):
        base, _, _, end = thrust(np.sqrt(2 * share * loaded / mass), stiffness)
        assert base == 0
        np.testing.assert_allclose(end.y[2], -np.sqrt(2 * share * loaded / mass), rtol=1e-6)
    assert thrust(np.sqrt(2 * 1.001 * loaded / mass), stiffness)[0] > 0


@pytest.mark.parametrize("p", list(drawn(6)))
def test_energy_is_conserved_in_soil(p):
    q = mole(p, "physical")
    start = exact.start(p, q)
    y = exact.propagate(q, start, 0.5, 1e-12).state.y

    def stored(y):
        dent = y[equations.SOIL_FRONT] - y[equations.SOIL_BASE]
        return 0.5 * (
            q.bar_mass * (y[1] + y[2]) ** 2
            + q.mole_mass * y[2] ** 2
            + q.spring_stiffness * (y[0] - q.spring_rest) ** 2
            + q.contact_stiffness * max(y[0] - q.stop_gap, 0.0) ** 2
            + q.soil_stiffness * dent**2
        )

    lost = y[equations.FRICTION_LOSS] + y[equations.VISCOUS_LOSS] + y[equations.SOIL_LOSS]
    balance = y[equations.MAGNETIC_WORK] - lost - stored(y) + stored(start.y)
    assert abs(balance) < 1e-8 and y[equations.SOIL_LOSS] >= 0


def test_soil_that_bears_nothing_is_as_no_soil():
    rows = [Params(control_frequency=7.0, soil_limit=limit) for limit in (0.0, 1e-7)]
    for p in rows:
        assert exact.start(p, mole(p, "physical")).y.size == (15 if p.soil_limit else 12)
    o, status = batch(np.array(rows), np.zeros(2, np.uint64), Settings(tolerance=1e-10))
    assert np.all(status == Status.OK)
    np.testing.assert_allclose(o["progression_rate"][1], o["progression_rate"][0], rtol=1e-5)
    assert o["progression_rate"][0] != o["progression_rate"][1]


def test_rows_without_soil_keep_their_bits_beside_rows_with_it():
    rows = [Params(control_frequency=7.0, soil_limit=limit) for limit in (0.0, 20.0, 0.0)]
    rows[2] = rows[2]._replace(bar_friction=0.3)
    seed = np.zeros(3, np.uint64)
    together, _ = batch(np.array(rows), seed, Settings())
    for i in range(3):
        alone, _ = batch(np.array(rows[i : i + 1]), seed[:1], Settings())
        for name, values in alone.items():
            np.testing.assert_array_equal(values[0], together[name][i], err_msg=name)


@pytest.mark.slow
def test_soil_that_grows_denser_refuses_the_mole_on_the_way():
    p = Params(control_frequency=7.0, soil_limit=5.0, soil_limit_gradient=60.0)
    seed = np.zeros(1, np.uint64)
    o, _ = batch(np.array([p]), seed, Settings(distance=(1.0, 10.0)))
    time = o["time_to_distance"][0]
    # Held fast by the soil, the bar moves irregularly: whether the mole creeps may stay open.
    assert np.isfinite(time[0])
    assert time[1] == np.inf or o["time_to_distance_censored"][0, 1]
    _, status, reasons = batch(np.array([p]), seed, Settings(formulation="as-printed"))
    assert status == [Status.NON_FINITE] and "creates energy" in reasons[0]


def test_the_mode_in_soil_is_the_only_one_that_contradicts_nothing():
    """Every combination of frictions is tried by the reference, which asserts that one fits."""
    rng = np.random.default_rng(9)
    seen = set()
    for p in drawn(20):
        m, q = slider.Pushing(p), mole(p, "physical")
        for _ in range(60):
            y = np.zeros(8)
            y[0] = rng.uniform(-0.05, 0.01)
            y[1], y[2] = rng.choice([-0.1, 0.0, 0.1], 2)
            y[3] = rng.uniform(0, 3)
            y[5] = y[6] = rng.uniform(0, 2) * p.soil_limit / p.soil_stiffness
            soil = slider.ELASTIC
            pushed = m.reaction(y, soil)
            if pushed < 0:
                continue
            fits = m.judged(y, False, soil)
            got = decide_in_soil(q, y[1], y[2], m.force(y[:6], False), pushed)
            assert got == (fits.bar, fits.mole)
            seen.add((y[1] == 0, y[2] == 0, *got))
    assert len(seen) >= 20
