"""Lives in service: ageing bearings, hardening rubber, springs that break one by one."""

import math
from dataclasses import replace

import numpy as np
import pytest
import vibrator_papers as closed
from scipy.stats import kstest, weibull_min

from models.vibrator import MODEL
from models.vibrator.parameters import CAUSES, Params, Settings
from models.vibrator.service import course as one_machine
from models.vibrator.service.course import ANGLE, LATE, LOST, SPRING, Answer, Task, course
from models.vibrator.service.slow_states import in_service, spring_breaks
from models.vibrator.service.steady import in_theory
from models.vibrator.theory import averaged

SOFT = Params(stiffness_x=2.07e5, stiffness_y=2.07e5, support_offset=0.0)
"""Isotropic, centred and soft: the closed forms hold."""

SETTINGS = Settings(run_up=15.0)
SIDES = np.ones((2, 1))


def compute(p, seed=(0,), settings=SETTINGS):
    """Return outputs of one machine for each seed, or of many machines."""
    columns = np.broadcast_arrays(*np.atleast_1d(*p), np.zeros(len(seed)))[:-1]
    return MODEL.batch(np.stack(columns, axis=1), np.array(seed, np.uint64), settings)[0]


NAMES = dict(enumerate(CAUSES)) | {-1: "none"}


def limited(limit):
    return replace(SETTINGS, angle_limit=limit)


def life(p, seed=(0,), settings=SETTINGS):
    """Return time, error and cause of the first machine."""
    out = compute(p, seed, settings)
    cause = NAMES[out["time_to_disphasing_cause"][0]]
    return out["time_to_disphasing"][0], out["time_to_disphasing_error"][0], cause


@pytest.mark.parametrize("degrees", [3.0, 12.0, 30.0])
@pytest.mark.parametrize("exponent", [1.0, 2.5])
def test_a_bearing_that_ages_has_the_life_of_the_closed_form(degrees, exponent):
    """By (5), (6) of equal motors, sin(angle) = d_rho/(m e B), d_rho = rho_0 (t/t_j)^nu."""
    p = SOFT._replace(ageing_time_1=3.6e7, ageing_exponent=exponent)
    limit = math.radians(degrees)
    time, error, cause = life(p, settings=limited(limit))
    at = closed.combined_centre(
        p.body_mass, p.body_inertia, p.unbalanced_mass, p.shaft_distance, p.shaft_half_angle
    )
    w = averaged.disphasing(p).speed[0]
    reduced = closed.reduced_mass(at.mass, p.stiffness_x, w)
    inertia = closed.reduced_inertia(at.inertia, p.stiffness_y, p.support_half_spacing, w)
    b = closed.synchronising_coefficient(at.distance, inertia, reduced, reduced)
    growth = p.unbalance_1 * b * math.sin(limit) / p.bearing_constant_1
    assert cause == "angle"
    assert error < 1e-6 * time
    assert time == pytest.approx(p.ageing_time_1 * growth ** (1 / exponent), rel=1e-2)


@pytest.mark.parametrize("kinematics", ["small", "exact"])
@pytest.mark.parametrize("propagator", ["fast", "exact"])
def test_the_machine_of_that_age_runs_at_the_limit(kinematics, propagator):
    p = Params(ageing_time_1=3e7, ageing_time_2=9e7, support_hardening=0.1, support_imbalance=0.1)
    settings = replace(limited(0.15), kinematics=kinematics, propagator=propagator)
    time, error, cause = life(p, settings=settings)
    assert cause == "angle" and 0 < error < 1e-4 * time
    here = Params._make(np.array([value]) for value in p)
    aged = in_service(here, np.array([time]), *SIDES)
    angle = compute(aged, settings=settings)["disphasing_angle"][0]
    assert abs(angle) == pytest.approx(0.15, abs=1e-6)


def test_the_stated_error_covers_the_difference_from_finer_steps():
    rng = np.random.default_rng(1)
    n = 8
    p = Params(
        synchronous_speed_1=rng.normal(157, 0.05, n),
        synchronous_speed_2=rng.normal(157, 0.05, n),
        ageing_time_1=rng.uniform(2e7, 2e8, n),
        ageing_exponent=rng.uniform(1, 3, n),
        stiffness_x=rng.uniform(6e5, 2e6, n),
    )
    rough, fine = (
        compute(p, range(n), replace(limited(0.3), steps_per_turn=steps)) for steps in (24, 384)
    )
    off = abs(rough["time_to_disphasing"] - fine["time_to_disphasing"])
    stated = rough["time_to_disphasing_error"]
    assert (rough["time_to_disphasing_cause"] == ANGLE).all()
    assert (off <= 2 * stated + 1e-9 * fine["time_to_disphasing"]).all()


def test_without_a_slow_process_a_life_is_none_or_all():
    p = Params(
        synchronous_speed_2=np.array([157.0, 157.0, 140.0]),
        bearing_constant_1=np.array([1e-4, 1e-3, 1e-4]),
        ageing_time_1=np.array([math.inf] * 3),
    )
    out = compute(p, (0, 1, 2), replace(SETTINGS, angle_limit=0.2))
    np.testing.assert_array_equal(out["time_to_disphasing"], [math.inf, 0, 0])
    causes = [NAMES[i] for i in out["time_to_disphasing_cause"]]
    assert causes == ["none", "angle", "lost-synchronisation"]
    assert not out["time_to_disphasing_censored"].any()
    frictionless = Params(bearing_constant_1=0.0, ageing_time_1=1e3)
    assert life(frictionless) == pytest.approx((math.inf, math.nan, "none"), nan_ok=True)


def test_equal_ageing_stops_the_motors_without_disphasing():
    p = SOFT._replace(
        ageing_time_1=1e7, ageing_time_2=1e7, ageing_exponent=2.0, damping_ratio=0.0707
    )
    time, error, cause = life(p)
    assert cause == "lost-synchronisation"
    assert error < 1e-5 * time
    here = Params._make(np.array([value]) for value in p)

    def runs(factor):
        aged = in_service(here, np.array([factor * time]), *SIDES)
        return bool(np.isfinite(in_theory(aged)[0][0]))

    assert runs(0.99) and not runs(1.01)


def test_lives_beyond_the_horizon_are_censored():
    p = SOFT._replace(ageing_time_1=1e12)
    out = compute(p, settings=replace(SETTINGS, horizon=1e9))
    assert out["time_to_disphasing"][0] == 1e9 and out["time_to_disphasing_censored"][0]
    assert out["time_to_disphasing_cause"][0] == -1


def test_springs_break_at_weibull_times_and_leave_the_others():
    n, count = 400, 3
    p = Params(spring_life=np.full(n, 2e8), spring_shape=np.full(n, 1.7))
    springs = spring_breaks(p, np.arange(n, dtype=np.uint64), count)
    assert (np.diff(springs.time, axis=1) > 0).all()
    assert kstest(springs.time.ravel(), weibull_min(1.7, scale=2e8).cdf).pvalue > 0.01
    both = springs.left + springs.right
    whole = np.broadcast_to(2 - np.arange(2 * count + 1) / count, both.shape)
    np.testing.assert_allclose(both, whole, rtol=1e-14, atol=1e-15)
    assert (springs.left[:, -1] == 0).all() and (springs.right[:, -1] == 0).all()
    assert abs((springs.left[:, 1] < 1).mean() - 0.5) < 0.1


def test_a_machine_of_broken_springs_has_the_stiffness_of_each_side():
    p = Params._make(np.array([v]) for v in Params(support_imbalance=0.2, stiffness_x=1e6))
    aged = in_service(p, np.array([3.6e6 * 9]), np.array([0.5]), np.array([0.75]))
    k_right, k_left = 0.75 * 0.6, 0.5 * 0.4
    assert aged.stiffness_x[0] == pytest.approx(1e6 * (k_right + k_left), rel=1e-14)
    imbalance = (k_right - k_left) / (k_right + k_left)
    assert aged.support_imbalance[0] == pytest.approx(imbalance, rel=1e-14)
    hard = in_service(p._replace(support_hardening=np.array([0.1])), np.array([3.6e6 * 9]), *SIDES)
    assert hard.stiffness_y[0] == pytest.approx(1.1 * p.stiffness_y[0], rel=1e-14)


def test_springs_end_lives_when_they_break_or_leave_none():
    seeds = range(12)
    p = Params(spring_life=3e8)
    out = compute(p, seeds, replace(SETTINGS, angle_limit=0.06, springs=3))
    here = Params._make(np.full(12, value) for value in p)
    springs = spring_breaks(here, np.arange(12, dtype=np.uint64), 3)
    times, causes = out["time_to_disphasing"], out["time_to_disphasing_cause"]
    assert (causes == SPRING).all() and (out["time_to_disphasing_error"] == 0).all()
    for i in seeds:
        (j,) = np.flatnonzero(springs.time[i] == times[i])
        left, right = springs.left[i], springs.right[i]
        for k in range(1, j + 1):  # all machines before it are within the limit
            aged = in_service(
                Params._make(field[:1] for field in here),
                springs.time[i, k - 1 : k],
                left[k : k + 1],
                right[k : k + 1],
            )
            assert abs(compute(aged)["disphasing_angle"][0]) <= 0.06


def test_chance_decides_only_where_springs_can_break():
    aged = Params(ageing_time_1=3e7)
    few, more = (compute(aged, seeds)["time_to_disphasing"] for seeds in ((1, 2), (3, 4)))
    np.testing.assert_array_equal(few, more)
    brittle = aged._replace(spring_life=3e7)
    first, other = compute(brittle, (1, 2))["time_to_disphasing"]
    assert first != other
    np.testing.assert_array_equal(compute(brittle, (2, 1))["time_to_disphasing"], [other, first])


def test_a_machine_with_feed_and_on_mounts_ages_too():
    p = Params(ageing_time_1=3.6e7, feed_mass=100.0, throw_coefficient=0.8)
    time, error, cause = life(p)
    assert cause == "angle" and error < 1e-3 * time
    here = Params._make(np.array([value]) for value in p)
    angle = compute(in_service(here, np.array([time]), *SIDES))["disphasing_angle"][0]
    assert abs(angle) == pytest.approx(SETTINGS.angle_limit, abs=1e-6)


# One machine, its angles given.


def follow(angle, end=1e9, breaks=(), limit=0.2, cause=LATE, theory=None):
    """Return a life and the number of orbits wanted, from angle(t, broken)."""
    way = course(Task(limit, angle(0.0, 0), 0.0, 0.0, breaks, end, cause))
    exact = 0
    try:
        query = next(way)
        while True:
            exact += query.is_exact
            source = angle if query.is_exact or theory is None else theory
            query = way.send(Answer(source(query.time, query.broken), 1e-9))
    except StopIteration as ended:
        return ended.value, exact


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("size", [1.0001, 3.0, 1e3, 1e6])
def test_the_time_at_which_the_limit_is_passed_is_located(power, size):
    (time, error, cause), exact = follow(lambda t, _: -0.2 * size * (t / 1e9) ** power)
    assert cause == ANGLE and exact < 25
    assert abs(time - 1e9 * size ** (-1 / power)) <= max(error, 1e-11 * time)


def test_a_theory_that_is_late_or_early_does_not_decide():
    def angle(t, _):
        return 0.02 + 0.3 * t / 1e9

    for off in (-0.05, 0.05):
        (time, _, cause), _ = follow(angle, theory=lambda t, k, off=off: angle(t, k) + off)
        assert cause == ANGLE and time == pytest.approx(6e8, rel=1e-7)


def test_a_lost_orbit_and_one_lost_before_its_angle_passes():
    def lost(t, _):
        return 0.1 if t < 3e8 else math.nan

    (time, error, cause), _ = follow(lost)
    assert cause == LOST and abs(time - 3e8) <= error <= 1e-5 * time

    def passes(t, _):
        return 0.8 * t / 1e9 if t < 3e8 else math.nan

    (time, _, cause), _ = follow(passes)
    assert cause == ANGLE and time == pytest.approx(2.5e8, rel=1e-7)


def test_a_break_between_looks_is_seen_even_where_theory_is_late():
    def angle(t, broken):
        return 0.1 + 0.15 * (broken > 0) - 0.2 * t / 1e9

    breaks = (1e8, 7e8)
    (time, error, cause), _ = follow(angle, breaks=breaks)
    assert (time, error, cause) == (1e8, 0.0, SPRING)
    (time, _, cause), _ = follow(angle, breaks=breaks, theory=lambda t, k: angle(t, k) - 0.04)
    assert cause == LATE  # within its error of the limit, and back before the next look


def test_what_ends_a_life_when_nothing_passes():
    (time, error, cause), exact = follow(lambda t, _: 0.1, end=5e8, cause=SPRING)
    assert (time, error, cause) == (5e8, 0.0, SPRING) and not exact
    assert one_machine.LOOKS == 20


@pytest.mark.slow
def test_more_looks_find_no_earlier_time(monkeypatch):
    rng = np.random.default_rng(8)
    n = 300
    p = Params(
        unbalance_1=rng.normal(5, 0.025, n),
        axis_offset=rng.normal(0, 0.0025, n),
        ageing_time_1=10 ** rng.uniform(7.25, 8.25, n),
        ageing_time_2=10 ** rng.uniform(7.25, 8.25, n),
        ageing_exponent=rng.uniform(1, 3, n),
        support_imbalance=rng.normal(0, 0.02, n),
        support_hardening=rng.uniform(0, 0.15, n),
        spring_life=10 ** rng.uniform(7.85, 8.85, n),
    )
    few = compute(p, range(n), limited(0.1))
    monkeypatch.setattr(one_machine, "LOOKS", 160)
    many = compute(p, range(n), limited(0.1))
    np.testing.assert_allclose(few["time_to_disphasing"], many["time_to_disphasing"], rtol=2e-6)
    name = "time_to_disphasing_cause"
    np.testing.assert_array_equal(few[name], many[name])


def test_angles_in_service_pass_the_limit_when_lives_end():
    n = 24
    rng = np.random.default_rng(8)
    p = Params(
        ageing_time_1=10 ** rng.uniform(7.25, 8.25, n),
        spring_life=10 ** rng.uniform(7.85, 8.85, n),
    )
    times = (0.0, 2.88e7, 5.8e7, 1.5e8)
    out = compute(p, range(n), replace(limited(0.1), service_times=times))
    angle, life_of = out["service_angle"], out["time_to_disphasing"]
    np.testing.assert_array_equal(angle[:, 0], out["disphasing_angle"])
    for j, time in enumerate(times):
        over = np.isnan(angle[:, j]) | (np.abs(angle[:, j]) > 0.1)
        np.testing.assert_array_equal(over, life_of <= time)
    assert 0 < (life_of <= times[1]).sum() < n


def test_an_angle_in_service_is_undefined_where_motors_never_lock():
    p = Params(
        synchronous_speed_2=np.array([157.0, 140.0]), ageing_time_1=np.array([math.inf, 1e8])
    )
    out = compute(p, (0, 1), replace(SETTINGS, service_times=(1e7,)))
    np.testing.assert_array_equal(np.isnan(out["service_angle"][:, 0]), [False, True])
    assert out["service_angle"][0, 0] == out["disphasing_angle"][0]


def states(*tables):
    return replace(limited(0.2), duty=tuple(tuple(table.items()) for table in tables))


AGEING = Params(
    ageing_time_1=3e7, feed_mass=40.0, feed_position=0.5, damping_ratio=0.07, throw_coefficient=0.5
)
"""A feed that rides on the deck, away from the mass centre."""


def test_in_duty_a_machine_ages_while_it_runs_and_ends_in_the_state_that_ends_it_first():
    empty, full = (
        life(AGEING._replace(feed_mass=mass), settings=limited(0.2)) for mass in (0.0, 80.0)
    )
    assert empty[2] == full[2] == "angle" and empty[0] != pytest.approx(full[0], rel=1e-3)
    off = {"name": "off", "share": 0.3, "wear": 0.0, "feed_mass": 50.0}
    half = life(AGEING, settings=states({"share": 0.5, "feed_mass": 0.0}, off))
    assert half[2] == "angle" and half[0] == pytest.approx(2 * empty[0], rel=1e-7)
    assert 0 < half[1] < 1e-5 * half[0]
    for pace, wear in ((0.75, 1.0), (1.75, 3.0)):
        thin = {"name": "thin", "share": 0.5, "feed_mass": 0.0, "wear": wear}
        mixed = life(AGEING, settings=states(thin, {"share": 0.25, "feed_mass": 2.0}))
        assert mixed[0] == pytest.approx(min(empty[0], full[0]) / pace, rel=1e-7)
    nominal = life(AGEING, settings=limited(0.2))
    assert life(AGEING, settings=states({"share": 1.0})) == nominal


def test_in_duty_times_in_service_are_those_of_the_calendar():
    p = SOFT._replace(ageing_time_1=3e7)
    times = replace(SETTINGS, service_times=(1e7, 2e7))
    duty = replace(states({"share": 0.5}), service_times=(2e7, 4e7))
    angles, again = (compute(p, settings=settings)["service_angle"] for settings in (times, duty))
    np.testing.assert_array_equal(angles, again)
    censored = compute(p, settings=replace(duty, horizon=1e7))
    assert censored["time_to_disphasing_censored"].all()
    assert censored["time_to_disphasing"] == 1e7


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        (({"share": 0.7}, {"share": 0.4}), "sum to 1.1, more than 1"),
        (({"share": 0.7, "gap_offset": 1e-5},), "has no 'gap_offset'"),
        (({"share": 0.7, "feed_mas": 2.0},), "did you mean 'feed_mass'"),
        (({"share": 0.7, "wear": 0.0}, {"share": 0.0}), "must have a positive share and wear"),
    ],
)
def test_a_duty_that_makes_no_sense_is_refused_in_one_line(tables, words):
    with pytest.raises(ValueError) as caught:
        states(*tables)
    assert words in str(caught.value) and "\n" not in str(caught.value)
