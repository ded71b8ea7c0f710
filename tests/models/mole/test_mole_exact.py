"""The event-driven propagator: an independent driver, energy, the circuit, and hard cases."""

import filippov
import numpy as np
import pytest
from scipy.linalg import expm

from models.mole import exact
from models.mole.exact import propagator
from models.mole.parameters import FORMULATIONS, Params
from models.mole.theory import equations
from models.mole.theory.system import mole
from models.numerics.dop853 import OUT_OF_BUDGET, REACHED_END, STUCK

RNG = np.random.default_rng(2011)
SIZES = np.array([1e-2, 1.0, 0.1, 1.0, 80.0, 1e-2])


def begun(p, formulation="physical"):
    q = mole(p, formulation)
    return q, exact.start(p, q)


@pytest.mark.parametrize(
    ("formulation", "p"),
    [
        (formulation, Params(control_frequency=frequency, supply_phase=phase))
        for formulation in ("physical", "as-printed")
        for frequency, phase in ((5.0, 0.0), (7.0, 0.0), (8.0, 0.0), (8.0, 1.2))
    ]
    + [("paper", Params(control_frequency=7.0, supply_phase=1.2))],
)
def test_it_moves_as_by_scipy(formulation, p):
    end = 0.5
    switching = np.arange(1, 2 * end * p.control_frequency) / (2 * p.control_frequency)
    times = np.sort(RNG.uniform(0, end, size=400))
    times = times[abs(times[:, None] - switching).min(axis=1) > 1e-5]
    expected, contacts = filippov.follow(p, formulation, end, times)
    motion = exact.propagate(*begun(p, formulation), end, 1e-12, times)
    assert motion.status == REACHED_END
    assert motion.contacts == contacts > 2
    np.testing.assert_allclose(motion.samples[:, :6] / SIZES, expected / SIZES, rtol=0, atol=2e-9)
    still = (motion.samples[:, 1:3] == 0).mean(axis=0)
    assert 0 < still[0] < 0.1 < still[1] < 0.9  # what sticks is at rest to the bit


def test_a_bar_does_not_leap_over_a_narrow_coil():
    """A slow circuit asks for steps in which a fast bar passes through the coil."""
    p = Params(
        bar_mass=0.05,
        stop_gap=0.06,
        spring_stiffness=6e3,
        spring_rest=-0.2,
        coil_inductance=2.0,
        inductance_coefficient=0.02,
        inductance_width=2e-3,
        capacitance=9e-4,
        supply_frequency=2.0,
        initial_displacement=-0.6,
    )
    times = np.linspace(0, 0.02, 50)
    expected, _ = filippov.follow(p, "physical", 0.02, times, longest=5e-6)
    motion = exact.propagate(*begun(p), 0.02, 1e-13, times)
    assert motion.lowest < -0.1 < 0.06 < motion.highest
    np.testing.assert_allclose(motion.samples[:, :6] / SIZES, expected / SIZES, rtol=0, atol=2e-9)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("periods", [(7.0, 7), (8.0, 4)])
def test_on_a_periodic_orbit_the_magnet_pays_for_friction(formulation, periods):
    frequency, count = periods
    q, state = begun(Params(control_frequency=frequency), formulation)
    begin = round(60 * frequency) // count * count
    state = exact.propagate(q, state, begin * q.control_period, 1e-11).state
    motion = exact.propagate(q, state, (begin + count) * q.control_period, 1e-11)
    gain = motion.state.y - state.y
    np.testing.assert_allclose(gain[:5] / SIZES[:5], 0, atol=1e-8)
    mean = gain / (count * q.control_period)
    lost = mean[equations.FRICTION_LOSS] + mean[equations.VISCOUS_LOSS]
    balance = mean[equations.MAGNETIC_WORK] - lost
    if formulation == "as-printed":
        assert balance < -0.2
    else:
        assert abs(balance) < 1e-8
        assert lost > 0.5


def test_published_check_values_at_8_hz():
    q, state = begun(Params())
    state = exact.propagate(q, state, 480 * q.control_period, 1e-10).state
    times = np.linspace(state.time, 484 * q.control_period, 50_001)
    motion = exact.propagate(q, state, times[-1], 1e-10, times)
    contact = q.contact_stiffness * np.maximum(motion.samples[:, 0] - q.stop_gap, 0)
    gain = (motion.state.y - state.y) / 4
    peak = q.contact_stiffness * (motion.highest - q.stop_gap)
    np.testing.assert_allclose(peak, 252.8, atol=0.05)
    np.testing.assert_allclose(np.trapezoid(contact, times) / 4, 0.609, atol=5e-4)
    np.testing.assert_allclose(gain[equations.IMPACT_WORK], 57.8e-3, atol=5e-5)
    np.testing.assert_allclose(gain[equations.ELECTRICAL_WORK] * 8, 28.0, atol=0.05)
    np.testing.assert_allclose(gain[5] * 8, 42.2e-3, atol=5e-5)
    assert motion.contacts == 4
    # Extremes are found exactly, so samples only come near.
    assert 0 < peak - contact.max() < 1e-2
    assert 0 <= motion.samples[:, 0].min() - motion.lowest < 1e-8


@pytest.mark.parametrize("formulation", ["physical", "paper"])
def test_with_the_bar_held_the_circuit_is_linear(formulation):
    p = Params(control_frequency=7.3, supply_phase=0.7)
    q = mole(p, formulation)._replace(bar_limit=1e9)
    times = np.sort(RNG.uniform(0, 0.6, size=200))
    motion = exact.propagate(q, exact.start(p, q), 0.6, 1e-12, times)
    inductance = equations.coil(q, p.initial_displacement).inductance
    omega, drive = q.supply_speed, q.supply_speed * q.voltage
    # The state i, p, sin and cos of the supply's phase obeys a linear equation.
    on = np.zeros((4, 4))
    on[0, :2] = -q.resistance / inductance, 1 / inductance
    on[1, [0, 3]] = -q.elastance, drive
    on[2, 3], on[3, 2] = omega, -omega
    off = on.copy()
    off[1, 3] = 0.0
    state, half = np.array([0, 0, np.sin(0.7), np.cos(0.7)]), 0.5 / 7.3
    expected = np.zeros((200, 2))
    for k in range(9):
        if formulation == "physical":
            state[1] += (-1) ** k * q.voltage * state[2]
        matrix = off if k % 2 else on
        for j in np.nonzero(np.floor(times / half) == k)[0]:
            expected[j] = (expm(matrix * (times[j] - k * half)) @ state)[:2]
        state = expm(matrix * half) @ state
    got = motion.samples[:, 3:5]
    np.testing.assert_allclose(got / SIZES[3:5], expected / SIZES[3:5], rtol=0, atol=1e-10)
    np.testing.assert_array_equal(motion.samples[:, 1:3], 0)
    assert motion.lowest == motion.highest == p.initial_displacement


def test_the_slope_of_the_inductance_is_its_derivative():
    q = mole(Params(), "physical")
    for u in RNG.uniform(-0.06, 0.06, size=20):
        h = 1e-5
        low, mid, high = (equations.coil(q, u + s) for s in (-h, 0, h))
        slope = (high.inductance - low.inductance) / (2 * h)
        np.testing.assert_allclose(mid.slope, slope, atol=1e-6)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("frequency", [5.0, 7.0, 8.0])
def test_tolerances_agree_over_a_minute(formulation, frequency):
    q, state = begun(Params(control_frequency=frequency), formulation)
    means = [
        exact.propagate(q, state, 60.0, tolerance).state.y[5:] / 60 for tolerance in (1e-9, 1e-12)
    ]
    np.testing.assert_allclose(means[0], means[1], rtol=1e-6)


@pytest.mark.parametrize("tolerance", [1e-6, 1.1e-6, 1.5e-6])
def test_short_slips_are_seen_in_long_steps(tolerance):
    """At 13 Hz, without impact, every third control period has a slip of 0.6 ms."""
    q, state = begun(Params(control_frequency=13.0))
    coarse, fine = (exact.propagate(q, state, 10.0, limit) for limit in (tolerance, 1e-12))
    assert coarse.steps < 0.3 * fine.steps
    assert coarse.events == fine.events


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_it_goes_on_from_any_state(formulation):
    """Stopped at sticks, slips, contacts, just begun ones too, and at switchings."""
    p = Params(control_frequency=7.0)
    q, state = begun(p, formulation)
    whole = exact.propagate(q, state, 1.0, 1e-12)
    stops = [*RNG.uniform(0, 1, size=300), *(np.arange(1, 15) * 0.5 * q.control_period)]
    contacts = 0
    for stop in sorted(stops):
        motion = exact.propagate(q, state, stop, 1e-12)
        state, contacts = motion.state, contacts + motion.contacts
    motion = exact.propagate(q, state, 1.0, 1e-12)
    assert contacts + motion.contacts == whole.contacts
    np.testing.assert_allclose(motion.state.y[:6] / SIZES, whole.state.y[:6] / SIZES, atol=1e-8)
    assert motion.state._replace(y=None) == whole.state._replace(y=None)


def test_a_mole_too_weak_to_slip_rests_and_a_state_is_left_as_it_is():
    p = Params(control_frequency=0.08, supply_voltage=2.7, initial_displacement=-0.02)
    q, state = begun(p)
    before = state.y.copy()
    motion = exact.propagate(q, state, 10.0, 1e-8)
    np.testing.assert_array_equal(state.y, before)
    np.testing.assert_array_equal(motion.state.y[[1, 2, 5]], 0)
    assert motion.state.y[0] == -0.02
    assert (motion.state.bar, motion.state.mole, motion.contacts) == (0, 0, 0)
    assert exact.propagate(q, motion.state, 5.0, 1e-8).state.time == 10.0


@pytest.mark.parametrize(
    "changed",
    [
        {"bar_friction": 0.0},
        {"mole_friction": 0.0},
        {"bar_friction": 0.0, "mole_friction": 0.0},
        {"bar_friction": 9.0, "spring_stiffness": 6e3},
        {"spring_stiffness": 0.0, "initial_velocity": 3.0},
        {"stop_gap": -0.022, "contact_stiffness": 3.8e6},
        {"stop_gap": -0.022, "initial_displacement": 0.1},
        {"bar_mass": 8.91, "mole_mass": 0.098},
        {"bar_mass": 0.0099, "contact_stiffness": 3.8e6, "resistance": 825.0},
        {"control_frequency": 400.0},
        {"supply_voltage": 2500.0, "resistance": 0.9},
    ],
)
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_hard_cases_end_and_keep_the_books(formulation, changed):
    p = Params()._replace(**changed)
    q, state = begun(p, formulation)
    motion = exact.propagate(q, state, 2.0, 1e-10)
    assert motion.status == REACHED_END

    def stored(y):
        u, v, x = y[:3]
        stop = max(u - q.stop_gap, 0.0)
        kinetic = q.bar_mass * (v + x) ** 2 + q.mole_mass * x**2
        spring = q.spring_stiffness * (u - q.spring_rest) ** 2
        return (kinetic + spring + q.contact_stiffness * stop**2) / 2

    y = motion.state.y
    gain = stored(y) - stored(state.y)
    put_in, lost = (
        y[equations.MAGNETIC_WORK],
        y[equations.FRICTION_LOSS] + y[equations.VISCOUS_LOSS],
    )
    turned_over = stored(state.y) + abs(put_in) + lost
    if formulation != "as-printed":
        assert abs(gain - put_in + lost) <= 1e-7 * turned_over
    assert y[equations.FRICTION_LOSS] >= 0


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_random_moles_end_soon(formulation):
    nominal = np.array(Params())
    for _ in range(60):
        p = Params(*(nominal * np.exp(RNG.uniform(-0.7, 0.7, size=len(nominal)))))
        motion = exact.propagate(*begun(p, formulation), 1.0, 1e-8)
        assert motion.status == REACHED_END
        assert motion.events < 500
        assert motion.steps < 20_000


def test_a_budget_ends_and_what_is_not_finite_is_found_out(monkeypatch):
    q, state = begun(Params())
    broken = state._replace(y=np.full(equations.SIZE, np.nan))
    assert exact.propagate(q, broken, 1.0, 1e-8).status == STUCK
    monkeypatch.setattr(propagator, "STEPS_PER_RADIAN", 0)
    monkeypatch.setattr(propagator, "_SPARE_STEPS", 50)
    motion = exact.propagate(q, state, 1.0, 1e-8, times=[0.0, 1.0])
    assert (motion.status, motion.steps) == (OUT_OF_BUDGET, 50)
    assert 0 < motion.state.time < 1
    assert np.isnan(motion.samples[1]).all() and np.isfinite(motion.samples[0]).all()
