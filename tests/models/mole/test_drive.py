"""Times to distances and temperatures: closed forms, slow time resolved, and the coil's energy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from models.mole import MODEL, exact
from models.mole.batch import batch
from models.mole.drive import NODES, Rates, Task, drive
from models.mole.lanes.rows import CURRENT, SQUARED
from models.mole.parameters import CAUSES, Params, Settings
from models.mole.response.machines import Machines
from models.mole.theory import equations
from models.mole.theory.system import mole
from models.numerics.course import NEVER, OPEN, REACHED
from uq.contract import Status
from uq.sampling.named_values import read_settings

COLD = Task((1.0, 5.0), (), 0.0, 0.0, 400.0)
ALPHA = 0.0039


def follow(task, rates):
    """Return how a mole with rates in closed form drives, and how many rates it needed."""
    going, count = drive(task), 1
    place = next(going)
    try:
        while True:
            place = going.send(Rates(*rates(*place)))
            count += 1
    except StopIteration as ended:
        return ended.value, count


def test_on_ground_that_does_not_change_the_time_is_the_distance_over_the_velocity():
    done, count = follow(COLD, lambda z, theta: (0.04, 0.0, 20.0, 0.0))
    assert done.distance.times == [1.0 / 0.04, 5.0 / 0.04] and count == 1
    assert done.distance.errors == [0.0, 0.0]


def test_a_velocity_linear_in_the_place_takes_a_logarithm():
    task = COLD._replace(changing=5.0)
    done, count = follow(task, lambda z, theta: (0.04 - 0.006 * z, 0.0, 20.0, 0.0))
    first, last = 0.04, 0.01
    expected = 5.0 * np.log(first / last) / (first - last)
    np.testing.assert_allclose(done.distance.times[1], expected, rtol=1e-12)
    expected = 1.0 * np.log(first / 0.034) / (first - 0.034)
    np.testing.assert_allclose(done.distance.times[0], expected, rtol=1e-12)
    assert NODES < count <= 2 * NODES and done.distance.errors[1] < 1e-9


def test_a_mole_that_is_refused_on_the_way_drives_to_that_place_alone():
    task = COLD._replace(changing=5.0)
    done, _ = follow(task, lambda z, theta: (0.04 - 0.012 * z, 0.0, 20.0, 0.0))
    expected = np.log(0.04 / 0.028) / 0.012
    np.testing.assert_allclose(done.distance.times[0], expected, rtol=1e-12)
    assert done.distance.fates == [REACHED, NEVER] and done.distance.times[1] == np.inf
    done, _ = follow(COLD, lambda z, theta: (-0.01, 0.0, 20.0, 0.0))
    assert done.distance.fates == [NEVER, NEVER]


def test_whether_a_mole_creeps_may_stay_open():
    done, _ = follow(COLD, lambda z, theta: (1e-4, 1e-3, 20.0, 0.0))
    assert done.distance.fates == [OPEN, OPEN] and done.distance.times == [0.0, 0.0]


def test_a_jump_of_the_velocity_is_within_the_error():
    rng = np.random.default_rng(1)
    for place in rng.uniform(0.5, 4.5, 20):

        def rates(z, theta, place=place):
            return (0.04 if z < place else 0.01), 0.0, 20.0, 0.0

        done, _ = follow(COLD._replace(changing=5.0), rates)
        expected = place / 0.04 + (5.0 - place) / 0.01
        assert abs(done.distance.times[1] - expected) <= done.distance.errors[1]


def test_errors_of_velocities_are_carried_into_the_time():
    """Nine in ten of the errors are within the one stated, of 400 drives with noisy rates."""
    rng = np.random.default_rng(2)
    expected = 5.0 * np.log(0.04 / 0.01) / 0.03
    inside = 0
    for _ in range(400):

        def rates(z, theta):
            return 0.04 - 0.006 * z + 0.0005 * rng.standard_normal(), 0.0005, 20.0, 0.0

        done, _ = follow(COLD._replace(changing=5.0), rates)
        inside += abs(done.distance.times[1] - expected) <= done.distance.errors[1]
    assert inside > 360


@pytest.mark.parametrize("power", [10.0, 25.0])
def test_a_constant_power_warms_exponentially(power):
    task = Task((), (20.0, 40.0), 0.0, 3.0, 400.0)
    done, _ = follow(task, lambda z, theta: (0.04, 0.0, power, 0.0))
    for i, theta in enumerate(task.temperatures):
        if theta < 3.0 * power:
            expected = -1200.0 * np.log(1 - theta / (3.0 * power))
            np.testing.assert_allclose(done.temperature.times[i], expected, rtol=1e-12)
            assert done.warmths[i] == theta
        else:
            assert done.temperature.fates[i] == NEVER
            np.testing.assert_allclose(done.warmths[i], 3.0 * power)


@pytest.mark.parametrize("limit", [10.0, 500.0])
def test_a_constant_current_warms_to_the_closed_form(limit):
    """R = R_20/(1 - alpha I^2 R_20 R_th): the resistance feeds back on the power."""
    cold, gain = 20.0, 3.0 * ALPHA * 20.0
    task = Task((), (limit,), 0.0, 3.0, 400.0)
    done, _ = follow(task, lambda z, theta: (0.04, 0.0, cold * (1 + ALPHA * theta), 0.0))
    settled = (1 / (1 - gain) - 1) / ALPHA
    if limit < settled:
        expected = -1200.0 / (1 - gain) * np.log(1 - limit / settled)
        np.testing.assert_allclose(done.temperature.times[0], expected, rtol=1e-9)
    else:
        assert done.temperature.times[0] == np.inf
        np.testing.assert_allclose(done.warmths[0], settled, rtol=1e-9)


@pytest.mark.parametrize("power", [14.0, 19.3, 25.0])
def test_a_warm_mole_is_within_its_error(power):
    """Rates that bend with the temperature, targets reached and not, with noise and without."""
    rng = np.random.default_rng(8)
    task = Task((), (5.0, 17.0, 31.0, 200.0), 0.0, 2.0, 400.0)

    def speed(theta):
        return 0.03 + 0.02 * np.sin(theta / 15)

    def heat(theta):
        return power * (1 - 2e-5 * theta**2)

    settled = brentq(lambda theta: heat(theta) - theta / 2.0, 0, 100)
    for noise in (0.0, 1e-4):
        inside, most = [], 0.0
        for _ in range(100 if noise else 1):

            def rates(z, theta, noise=noise):
                draw = noise * rng.standard_normal(2)
                return speed(theta) + draw[0], noise, heat(theta) + 100 * draw[1], 100 * noise

            done, _ = follow(task, rates)
            expected = np.minimum(task.temperatures, settled)
            inside.extend(abs(done.warmths - expected) <= np.add(done.warmth_errors, 1e-9))
            inside.extend(abs(done.speeds - speed(expected)) <= np.add(done.speed_errors, 1e-12))
            most = max(most, *done.speed_errors)
        assert np.mean(inside) >= 0.9
        assert most < 0.002


@pytest.mark.parametrize("capacity", [4.0, 40.0, 400.0])
def test_a_mole_warms_as_it_drives_through_ground_that_changes(capacity):
    """Against an integrator of ordinary differential equations, within the errors stated."""
    task = Task((1.0, 2.5, 5.0), (10.0, 20.0, 30.0), 5.0, 2.0, capacity)

    def rates(z, theta):
        z = min(z, task.changing)
        speed = 0.04 * np.exp(-0.1 * z) * (1 + 0.004 * theta)
        return speed, 0.0, 22.0 * (1 - 0.001 * theta) * (1 + 0.02 * z), 0.0

    def slope(t, y):
        speed, _, power, _ = rates(*y)
        return speed, (power - y[1] / 2.0) / capacity

    def reach(i, target):
        return lambda t, y: y[i] - target

    events = [reach(0, d) for d in task.distances] + [reach(1, t) for t in task.temperatures]
    solved = solve_ivp(slope, (0, 2e4), [0, 0], "LSODA", events=events, rtol=1e-10, atol=1e-10)
    done, count = follow(task, rates)
    courses = done.distance, done.temperature
    times = np.concatenate([course.times for course in courses])
    errors = np.concatenate([course.errors for course in courses])
    expected = np.array([t[0] for t in solved.t_events])
    np.testing.assert_allclose(times, expected, rtol=0.02)
    assert count < 4 * NODES
    assert (np.abs(times - expected) <= errors + 1e-3 * expected).all()


def test_a_coil_may_cool_down_again():
    task = Task((5.0,), (15.0, 39.0), 5.0, 2.0, 40.0)

    def rates(z, theta):
        return 0.04, 0.0, 20.0 - 4.0 * abs(min(z, 5.0) - 2.5), 0.0

    done, _ = follow(task, rates)
    np.testing.assert_allclose(done.distance.times, 125.0, rtol=1e-12)
    solved = solve_ivp(
        lambda t, y: [(rates(0.04 * t, 0)[2] - y[0] / 2) / 40],
        (0, 125),
        [0.0],
        rtol=1e-9,
        max_step=1,
    )
    expected = np.interp(
        15.0, solved.y[0][: solved.y[0].argmax()], solved.t[: solved.y[0].argmax()]
    )
    np.testing.assert_allclose(done.temperature.times[0], expected, rtol=0.02)
    assert done.temperature.fates[1] == NEVER  # it falls to 20 K in the end
    np.testing.assert_allclose(done.warmths[1], 20.0)


# The real mole.


def compute(settings, *changes):
    x = np.array([Params(**{"control_frequency": 7.0} | change) for change in changes])
    outputs, status, *_ = batch(x, np.zeros(len(x), np.uint64), settings)
    assert np.all(status == Status.OK)
    return outputs


def test_by_default_the_time_follows_from_the_rate():
    o = compute(Settings(distance=(1.0, 10.0)), {}, {"control_frequency": 13.0})
    np.testing.assert_allclose(
        o["time_to_distance"][0], np.array([1, 10]) / o["progression_rate"][0]
    )
    assert np.isposinf(o["time_to_distance"][1]).all() and abs(o["progression_rate"][1]) < 1e-7
    assert not o["time_to_distance_censored"].any()


def test_friction_that_grows_slows_the_mole_as_rates_along_the_way_say():
    growing = {"friction_gradient": 0.01}
    o = compute(Settings(distance=(4.0,)), growing)
    places = np.linspace(0, 4.0, 41)
    along = compute(Settings(), *({"mole_friction": 0.235 + 0.01 * z} for z in places))
    expected = np.trapezoid(1 / along["progression_rate"], places)
    error = o["time_to_distance_error"][0, 0]
    assert abs(o["time_to_distance"][0, 0] - expected) < max(error, 1e-3 * expected)
    assert error < 0.02 * expected


def test_ground_too_rough_refuses_the_mole_and_a_horizon_censors():
    rough = {"friction_gradient": 1.0}
    o = compute(Settings(distance=(0.1, 10.0)), rough)
    assert np.isfinite(o["time_to_distance"][0, 0]) and o["time_to_distance"][0, 1] == np.inf
    assert not o["time_to_distance_censored"].any()
    cut = compute(Settings(distance=(0.1, 10.0), horizon=100.0), rough, {})
    assert cut["time_to_distance"][:, 1].tolist() == [np.inf, 100.0]
    assert cut["time_to_distance_censored"][:, 1].tolist() == [False, True]


def test_the_heat_of_the_coil_closes_the_balance_of_energy():
    """R i^2 is the work of the supply less what coil and capacitor store and what moves the bar."""
    p = Params(control_frequency=7.0)
    q = mole(p, "physical")
    machines = Machines.started(
        Params._make(np.array([p]).T), Settings(tolerance=1e-11, distance=(1.0,))
    )
    machines.run(np.arange(1), np.array([20]))
    y = exact.propagate(q, exact.start(p, q), 20 * q.control_period, 1e-12).state.y
    heat = y[equations.ELECTRICAL_WORK] - y[equations.MAGNETIC_WORK]
    np.testing.assert_allclose(q.resistance * machines.record[0, SQUARED], heat, rtol=1e-8)
    assert heat > 10 * abs(y[equations.MAGNETIC_WORK]) and machines.record[0, CURRENT] != 0


def test_a_warm_mole_moves_as_with_the_resistance_of_its_coil():
    o = compute(Settings(temperature=(20.0, 500.0)), {"coil_thermal_resistance": 2.0})
    assert np.isfinite(o["time_to_temperature"][0, 0]) and o["time_to_temperature"][0, 1] == np.inf
    theta = o["warm_temperature"][0]
    assert theta[0] == 20.0 and 40 < theta[1] < 55
    warm = compute(Settings(), *({"resistance": 27.5 * (1 + ALPHA * t)} for t in theta))
    np.testing.assert_allclose(o["warm_progression_rate"][0], warm["progression_rate"], rtol=2e-3)
    # All heat leaves: that of the supply, less the work on bar and mole.
    assert 0.9 < theta[1] / 2.0 / warm["electrical_power"][1] < 1.0


def test_what_cannot_be_is_refused_in_a_line():
    falling = Params(control_frequency=7.0, friction_gradient=-0.1)
    _, status, reasons = batch(
        np.array([falling]), np.zeros(1, np.uint64), Settings(distance=(10.0,))
    )
    assert status == [Status.NON_FINITE] and "friction would be negative" in reasons[0]
    assert read_settings(MODEL, {"distance": 10})[0].distance == (10.0,)
    assert read_settings(MODEL, {"distance": 0})[0].distance == ()
    for value in [2.0, 1.0], [0.0, 1.0]:
        problem = read_settings(MODEL, {"distance": value})[1]
        assert problem == {"": "distance must be a list of increasing positive numbers"}
    assert "within 0.0 to" in read_settings(MODEL, {"distance": -1.0})[1]["distance"]
    assert "must be a list" in read_settings(MODEL, {"temperature": "hot"})[1]["temperature"]


def cold_speed(task, rates):
    """Return the velocity with a cold coil where a mole is held."""
    return follow(task, rates)[0].cold_speed


def test_a_mole_held_by_heat_would_drive_on_with_a_cold_coil():
    warm = Task((1.0, 5.0), (), 0.0, 2.0, 4.0)
    assert cold_speed(warm, lambda z, theta: (0.04 - 0.002 * theta, 0.0, 20.0, 0.0)) == 0.04
    assert cold_speed(warm, lambda z, theta: (-0.01, 0.0, 20.0, 0.0)) == -0.01
    assert np.isnan(cold_speed(warm, lambda z, theta: (0.04, 0.0, 20.0, 0.0)))  # it arrives
    # Ground and coil together hold it where the ground alone would not, or would as well.
    changing = warm._replace(changing=5.0)
    assert cold_speed(changing, lambda z, t: (0.04 - 0.004 * z - 0.001 * t, 0.0, 20.0, 0.0)) > 0
    assert cold_speed(changing, lambda z, t: (0.04 - 0.02 * z - 1e-9 * t, 0.0, 20.0, 0.0)) < 1e-6


def test_the_cause_of_a_drive_is_its_distance_or_what_holds_the_mole():
    o = compute(
        Settings(distance=(0.1, 10.0)), {"friction_gradient": 1.0}, {}, {"control_frequency": 13.0}
    )
    names = [[*CAUSES, "none"][code] for code in o["time_to_distance_cause"].ravel()]
    assert names == ["distance", "refusal", "distance", "distance", "refusal", "refusal"]
    cut = compute(Settings(distance=(10.0,), horizon=100.0), {})
    assert cut["time_to_distance_cause"].tolist() == [[-1]]
