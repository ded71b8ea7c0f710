"""Periodic orbits: they close, their multipliers are true, and what cannot be found is said."""

import numpy as np
import pytest
from machines import SYMMETRIC, plausible

from models.numerics.dop853 import GUARDED
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import systems
from models.vibrator.exact import propagator
from models.vibrator.lanes import orbit, tangents
from models.vibrator.lanes.following import follow
from models.vibrator.lanes.packed import HALF, STATE, WHOLE, pack
from models.vibrator.parameters import Params
from models.vibrator.theory.averaged import disphasing, steady_motion

RIGID = {"mount_stiffness": np.inf, "mount_rotational_stiffness": np.inf, "feed_mass": 0.0}
MACHINES = plausible(10, seed=1, **RIGID)
HEAVY = MACHINES._replace(gravity=np.full(10, 9.81))
TURN = np.where(np.isin(np.arange(STATE), (3, 4)), 2 * np.pi, 0.0)


def guess(p, off=0.0):
    """Return the state of the averaged theory at psi_1 = 0, with an angle added, and its period."""
    at = disphasing(p)
    w, angle = at.speed, at.angle + off
    motion = steady_motion(p, w, angle)
    state = np.zeros((len(w), STATE))
    for i, amplitude in enumerate(motion[:3]):
        state[:, i], state[:, 5 + i] = amplitude.real, (1j * w * amplitude).real
    state[:, 4], state[:, 8], state[:, 9] = -angle, w, w
    return state, 2 * np.pi / w


def find(p, steps, off=0.0):
    return orbit.find_orbits(pack(systems(p).rigid), *guess(p, off), steps)


def mean_angle(p, orbits, steps):
    trace = follow(pack(systems(p).rigid), orbits.state, orbits.period, steps)
    return (trace[:, :, 3] - trace[:, :, 4]).mean(axis=1)


def gap(m, state, period):
    """Return by how much one machine misses its start after a turn of vibrator 1, scaled."""
    motion = propagator.propagate(m, state, 2 * period, 1e-13, turns=1)
    assert motion.status == GUARDED
    miss = (motion.state - state - TURN) / propagator.scales_of(m, rigid_motion.DEGREES)
    return max(abs(miss).max(), abs(motion.time / period - 1))


def passage(m, start, period):
    """Return the derivative of the map from one passage of psi_1 = 0 to the next."""
    scales = 1e-5 * propagator.scales_of(m, rigid_motion.DEGREES)
    columns = []
    for i in tangents.FREE:
        change = scales * (np.arange(STATE) == i)
        above, below = (
            propagator.propagate(m, start + s * change, 2 * period, 1e-13, turns=1).state
            for s in (1, -1)
        )
        columns.append((above - below)[tangents.FREE] / (2 * scales[i]))
    return np.array(columns).T


@pytest.mark.parametrize("p", [MACHINES, HEAVY])
def test_orbits_close_on_themselves(p):
    orbits = find(p, 192)
    assert orbits.converged.all()
    assert np.all(orbits.state[:, 3] == 0)
    for i in range(10):
        assert gap(systems(p).row(i), orbits.state[i], orbits.period[i]) < 1e-9


@pytest.mark.parametrize(("p", "off"), [(MACHINES, 0.0), (MACHINES, np.pi), (HEAVY, 0.0)])
def test_the_multiplier_is_that_of_the_passages(p, off):
    """Of stable orbits, and of the unstable ones with the vibrators the other way round."""
    orbits = find(p, 96, off)
    assert orbits.converged.sum() > 3
    assert np.all((orbits.multiplier[orbits.converged] > 1) == bool(off))
    for i in np.flatnonzero(orbits.converged)[:5]:
        m = systems(p).row(i)
        values = np.linalg.eigvals(passage(m, orbits.state[i], orbits.period[i]))
        np.testing.assert_allclose(orbits.multiplier[i], abs(values).max(), rtol=1e-5)


def test_the_disphasing_angle_converges_with_order_5():
    coarse, middle, fine, exact_angle = (
        mean_angle(MACHINES, find(MACHINES, steps), steps) for steps in (12, 24, 48, 192)
    )
    errors = abs(np.array([coarse, middle, fine]) - exact_angle).max(axis=1)
    assert errors[1] < 1e-7
    assert np.all(np.log2(errors[:-1] / errors[1:]) > 4.8)


@pytest.mark.parametrize("part", [WHOLE, HALF])
def test_derivatives_of_a_part_are_those_of_nearby_ones(part):
    (state, period), constants = guess(HEAVY), pack(systems(HEAVY).rigid)
    end = tangents.revolve(constants, state, period, 24, part)
    turn = TURN / part.parts
    plain = part.mirror * follow(constants, state, period, 24)[:, -1] - turn
    np.testing.assert_array_equal(end[:, :, 0], plain)
    sizes = np.repeat([1e-6, 1e-4], 5)
    for column, i in enumerate(tangents.FREE):
        change = sizes * (np.arange(STATE) == i)
        above, below = (follow(constants, state + s * change, period, 24)[:, -1] for s in (1, -1))
        expected = part.mirror * (above - below) / (2 * sizes[i])
        scale = np.abs(expected).max(axis=0)
        assert np.all(np.abs(end[:, :, 1 + column] - expected) < 1e-5 * scale)
    later, sooner = (follow(constants, state, period + s, 24)[:, -1] for s in (1e-7, -1e-7))
    rates = part.mirror * (later - sooner) / 2e-7
    scale = np.abs(rates).max(axis=0)
    assert np.all(np.abs(end[:, :, -1] - rates) < 1e-4 * scale)


def by_newton(p, steps, off):
    """Return the state and period of the orbits by a plain Newton's method for whole turns."""
    (state, period), constants = guess(p, off), pack(systems(p).rigid)
    for _ in range(8):
        end = tangents.revolve(constants, state, period, steps, WHOLE)
        matrix = end[:, :, 1:].copy()
        matrix[:, tangents.FREE, np.arange(9)] -= 1
        step = np.linalg.solve(matrix, state[:, :, None] - end[:, :, :1])[:, :, 0]
        state[:, tangents.FREE] += step[:, :-1]
        period = period + step[:, -1]
    return state, period


@pytest.mark.parametrize("off", [0.0, 1e-3, 0.3])
def test_the_orbits_are_those_of_a_plain_newtons_method(off):
    """From guesses near enough for derivatives that are kept, and from others."""
    quick = find(MACHINES, 24, off)
    state, period = by_newton(MACHINES, 24, off)
    assert quick.converged.all()
    np.testing.assert_allclose(quick.state, state, rtol=0, atol=1e-9)
    np.testing.assert_allclose(quick.period, period, rtol=1e-11)


@pytest.mark.parametrize("p", [MACHINES, HEAVY])
def test_the_estimated_error_is_a_bound_of_the_true_one(p):
    coarse, fine = find(p, 24), find(p, 192)
    error = abs(coarse.angle - fine.angle)
    assert np.all((error < 2 * coarse.error) & (coarse.error < 1e-7))
    assert np.all(fine.error < 1e-4 * coarse.error)


def test_following_ends_where_the_orbit_does():
    orbits = find(MACHINES, 48)
    trace = follow(pack(systems(MACHINES).rigid), orbits.state, orbits.period, 48)
    np.testing.assert_allclose(trace[:, -1] - TURN, orbits.state, rtol=0, atol=1e-9)
    for i in (0, 7):
        m, times = systems(MACHINES).row(i), orbits.period[i] * np.arange(1, 49) / 48
        motion = propagator.propagate(m, orbits.state[i], times[-1], 1e-13, times=times)
        errors = (trace[i] - motion.samples) / propagator.scales_of(m, rigid_motion.DEGREES)
        assert abs(errors).max() < 1e-8


def test_half_a_turn_later_the_body_is_at_the_opposite_displacement():
    orbits = find(MACHINES, 192)
    mirror = np.where(np.isin(np.arange(STATE), (0, 1, 2, 5, 6, 7)), -1.0, 1.0)
    for i in range(10):
        m = systems(MACHINES).row(i)
        motion = propagator.propagate(m, orbits.state[i], orbits.period[i] / 2, 1e-13)
        errors = motion.state - TURN / 2 - mirror * orbits.state[i]
        assert abs(errors / propagator.scales_of(m, rigid_motion.DEGREES)).max() < 1e-9


def test_gravity_averages_out_to_first_order_over_a_turn():
    """Reversed gravity is half a turn later: an orbit changes with the square of gravity."""
    none, full, twice = (
        find(MACHINES._replace(gravity=np.full(10, g)), 96) for g in (0.0, 9.81, 19.62)
    )
    small = abs(full.angle - none.angle)
    assert np.all((small > 1e-6) & (small < 1e-3))
    np.testing.assert_allclose(twice.angle - none.angle, 4 * (full.angle - none.angle), rtol=1e-2)
    np.testing.assert_allclose(full.period, none.period, rtol=1e-5)


def test_half_a_turn_leads_to_the_same_orbits_as_a_whole_one(monkeypatch):
    half = find(MACHINES, 24)
    monkeypatch.setattr(orbit, "_QUIET", 0.0)
    whole = find(MACHINES, 24)
    for got, expected in zip(half, whole, strict=True):
        np.testing.assert_allclose(got, expected, rtol=1e-9, atol=1e-9)
    assert not np.array_equal(half.state, whole.state)


def assert_found_or_said(p, state, period):
    """Try guesses; what is found must be an orbit."""
    m = systems(p)
    orbits = orbit.find_orbits(pack(m.rigid), state, period, 48)
    for i in np.flatnonzero(orbits.converged):
        assert gap(m.row(i), orbits.state[i], orbits.period[i]) < 1e-6
    return orbits


def test_from_a_guess_far_away_an_orbit_is_found_or_none():
    rng = np.random.default_rng(8)
    p = plausible(60, seed=9, **RIGID)
    state = rng.normal(size=(60, STATE)) * np.repeat([1e-2, 1.0], 5)
    state[:, 3], state[:, 4] = 0.0, rng.uniform(-np.pi, np.pi, 60)
    state[:, 8:] = rng.uniform(-20, 400, size=(60, 2))
    orbits = assert_found_or_said(p, state, 10 ** rng.uniform(-3, 0, 60))
    assert 0 < orbits.converged.sum() < 60
    assert np.all(orbits.period[orbits.converged] > 0)


def test_guesses_that_are_no_numbers_harm_nobody():
    constants = pack(systems(MACHINES).rigid)
    expected = find(MACHINES, 24)
    state, period = guess(MACHINES)
    state[2], state[4, 8], period[6] = np.nan, np.inf, np.nan
    period[8] = 1e300
    orbits = orbit.find_orbits(constants, state, period, 24)
    spoilt = np.isin(np.arange(10), (2, 4, 6, 8))
    np.testing.assert_array_equal(orbits.converged, ~spoilt)
    for got, alone in zip(orbits, expected, strict=True):
        np.testing.assert_array_equal(got[~spoilt], alone[~spoilt])


def test_motors_that_cannot_synchronise_have_no_orbit():
    p = plausible(10, seed=1, **RIGID, synchronous_speed_2=110.0, breakdown_speed_2=100.0)
    state, _ = guess(MACHINES)
    state[:, 9] = 110.0
    assert not assert_found_or_said(p, state, np.full(10, 2 * np.pi / 156)).converged.any()


def test_a_machine_has_the_same_bits_in_any_company():
    p = plausible(37, seed=3, **RIGID)._replace(gravity=np.arange(37) % 3 * 5.0)
    constants, (state, period) = pack(systems(p).rigid), guess(p)
    is_finite = np.isfinite(period)
    together = orbit.find_orbits(constants, state, period, 24)
    assert together.converged[is_finite].sum() > 30
    order = np.random.default_rng(4).permutation(37)
    shuffled = orbit.find_orbits(constants[order], state[order], period[order], 24)
    for got, expected in zip(shuffled, together, strict=True):
        np.testing.assert_array_equal(got, expected[order])
    for i in range(0, 37, 4):
        alone = orbit.find_orbits(constants[[i]], state[[i]], period[[i]], 24)
        for got, expected in zip(alone, together, strict=True):
            np.testing.assert_array_equal(got, expected[[i]])


def test_a_symmetric_machine_runs_in_phase():
    p = Params._make(np.array([value]) for value in SYMMETRIC)
    orbits = find(p, 24, off=0.3)
    assert orbits.converged.all() and orbits.multiplier[0] < 1
    assert abs(mean_angle(p, orbits, 24)[0]) < 1e-12
