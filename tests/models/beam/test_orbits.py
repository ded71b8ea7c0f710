"""Periodic orbits: known ones, unwanted ones recognised, and the return map beside the strobe."""

import numpy as np
import pytest
from exact_beams import at_omega, set_up
from return_map import first_crossing, return_map

from models.beam.branches.orbits import find_orbit, settled_orbit
from models.beam.exact.passage import passage
from models.beam.exact.tuning import Tuning

KNOWN = {5.61: (3.919359, 3.394367), 9.9: (82.55679, 29.56878), 9.5: (32.36390, 32.36390)}


def settled(omega, periods=300, gap=1.0):
    """Return a beam, its state and gaps after some periods."""
    setup = set_up(at_omega(omega), gap=gap)
    setup.advance(periods)
    tuning = Tuning(setup.modal)
    return tuning.at(tuning.forcing), setup.state[0, : tuning.size], setup.gaps[0]


@pytest.mark.parametrize("omega", KNOWN)
def test_known_orbits_are_found_to_rounding(omega):
    beam, state, gaps = settled(omega)
    orbit = find_orbit(beam, state, gaps, stable_only=True, farthest=0.05)
    assert orbit.outcome == "converged"
    assert orbit.residual < 1e-10 and orbit.iterations <= 5
    rates = np.sort(orbit.work)[::-1] * omega / (2 * np.pi)
    np.testing.assert_allclose(rates, KNOWN[omega], rtol=3e-7)
    again = passage(beam, orbit.state, gaps, periods=5)
    np.testing.assert_allclose(again.state, orbit.state, rtol=0, atol=1e-9)
    assert orbit.is_stable and orbit.is_symmetric == (omega == 9.5)
    assert orbit.contacts.tolist() == [1, 1]
    assert orbit.impact_velocities.shape == (1,)


def test_multiplier_of_the_symmetric_orbit():
    orbit = find_orbit(*settled(9.5))
    assert abs(orbit.multipliers[0]) == pytest.approx(0.98859, abs=1e-5)


@pytest.mark.parametrize("omega", KNOWN)
def test_a_motion_comes_near_its_orbit_as_fast_as_the_multipliers_say(omega):
    beam, state, gaps = settled(omega)
    orbit = find_orbit(beam, state, gaps)
    periods = 600
    setup = set_up(at_omega(omega))
    distances = []
    for _ in range(2):
        setup.advance(periods)
        distances.append(np.abs(setup.state[0, : len(state)] - orbit.state).max())
    contraction = (distances[1] / distances[0]) ** (1 / periods)
    assert contraction == pytest.approx(abs(orbit.multipliers[0]), abs=2e-3)


def test_an_unstable_orbit_is_reported():
    """Beyond its Neimark-Sacker point the symmetric orbit is still there."""
    beam, state, gaps = settled(9.1)
    near = find_orbit(beam, state, gaps)
    beyond = settled(9.03)[0]
    orbit = find_orbit(beyond, near.state, gaps, stable_only=True)
    assert near.is_stable
    assert orbit.outcome == "unstable"
    assert abs(orbit.multipliers[0]) > 1 and orbit.residual < 1e-10
    assert find_orbit(beyond, near.state, gaps).outcome == "converged"


def test_a_far_orbit_is_reported():
    """Of two mirror images the guess is near the other one's mirror plane."""
    beam, state, gaps = settled(9.9)
    orbit = find_orbit(beam, state, gaps)
    rng = np.random.default_rng(5)
    away = orbit.state * (1 + 0.02 * rng.normal(size=len(state)))
    rejected = find_orbit(beam, away, gaps, farthest=1e-3)
    assert rejected.outcome in ("far", "stalled")
    near = find_orbit(beam, away, gaps, farthest=0.2)
    assert near.outcome == "converged"
    assert 1e-3 < near.distance < 0.2
    np.testing.assert_allclose(near.work, orbit.work, rtol=1e-9)


def test_the_absence_of_an_orbit_is_reported():
    beam, state, gaps = settled(7.5, periods=50)
    assert find_orbit(beam, state, gaps, stable_only=True, farthest=0.1).outcome != "converged"
    with pytest.raises(ValueError, match="does not settle on an orbit of period 1"):
        settled_orbit(beam, state, gaps)


def test_the_shortest_period_is_found():
    once = find_orbit(*settled(9.9))
    orbit = find_orbit(*settled(9.9), period=6)
    assert orbit.period == 1
    np.testing.assert_allclose(orbit.work, once.work, rtol=1e-9)
    np.testing.assert_allclose(abs(orbit.multipliers[:4]), abs(once.multipliers[:4]), rtol=1e-9)
    twice = find_orbit(*settled(7.1), period=4)
    assert (twice.period, twice.is_stable) == (2, True)


def test_without_a_contact_multipliers_are_those_of_damping():
    setup = set_up(at_omega(9.9), gap=1e3)
    tuning = Tuning(setup.modal)
    orbit = settled_orbit(tuning.at(tuning.forcing), setup.state[0, : tuning.size], setup.gaps[0])
    assert not orbit.work.any() and orbit.impact_velocities.shape == (0,)
    slowest = np.exp(-2 * np.pi * setup.modal.decay[0].min() / setup.modal.forcing[0])
    assert abs(orbit.multipliers[0]) == pytest.approx(slowest, rel=1e-9)


# The section x_c = +x_1, v > 0


@pytest.mark.parametrize("omega", KNOWN)
def test_multipliers_of_the_return_map_are_those_of_the_strobe(omega):
    beam, state, gaps = settled(omega)
    orbit = find_orbit(beam, state, gaps)
    on_section, phase = first_crossing(beam, orbit.state, gaps)
    back = return_map(beam, on_section, phase, gaps)
    np.testing.assert_allclose(back.state, on_section, rtol=0, atol=1e-10)
    assert back.phase - phase == pytest.approx(2 * np.pi, abs=1e-10)
    multipliers = np.linalg.eigvals(back.jacobian)
    multipliers = multipliers[np.argsort(-abs(multipliers))][:8]
    np.testing.assert_allclose(abs(multipliers), abs(orbit.multipliers[:8]), rtol=1e-8)
    velocity = on_section[len(state) // 2 :].sum()
    assert velocity == pytest.approx(orbit.impact_velocities[0], rel=1e-10)


def test_an_orbit_of_two_periods_meets_the_section_twice():
    """Eq 4: m returns take n periods of the force, here 2 and 2."""
    beam, state, gaps = settled(7.1)
    orbit = find_orbit(beam, state, gaps, period=2)
    point, phase = first, begun = first_crossing(beam, orbit.state, gaps)
    jacobian = np.eye(len(state))
    for _ in orbit.impact_velocities:
        back = return_map(beam, point, phase, gaps)
        point, phase, jacobian = back.state, back.phase, back.jacobian @ jacobian
    np.testing.assert_allclose(point, first, rtol=0, atol=1e-9)
    assert phase - begun == pytest.approx(4 * np.pi, abs=1e-9)
    largest = abs(np.linalg.eigvals(jacobian)).max()
    assert largest == pytest.approx(abs(orbit.multipliers[0]), rel=1e-7)


def test_jacobian_of_the_return_map_is_its_derivative():
    beam, state, gaps = settled(5.61, periods=20)
    point, phase = first_crossing(beam, state, gaps)
    m, h = len(state) // 2, 1e-6

    def mapped(u):
        y = np.append(gaps[0] - u[1:m].sum(), u[1:])
        back = return_map(beam, y, u[0], gaps)
        return np.append(back.phase, back.state[1:])

    u = np.append(phase, point[1:])
    expected = np.stack([(mapped(u + e) - mapped(u - e)) / (2 * h) for e in h * np.eye(2 * m)], 1)
    jacobian = return_map(beam, point, phase, gaps).jacobian
    np.testing.assert_allclose(jacobian, expected, rtol=0, atol=1e-7 * np.abs(expected).max())


def test_off_the_section_there_is_no_return():
    beam, state, gaps = settled(9.9)
    with pytest.raises(ValueError, match="must have x = x_1"):
        return_map(beam, state, 0.0, gaps)
    far = np.array([50.0, 50.0])
    point = np.zeros(44)
    point[0], point[22] = 50.0, 1e-3
    assert np.isnan(return_map(beam, point, 0.0, far).state).all()
    assert np.isnan(first_crossing(beam, state, far)[1])
