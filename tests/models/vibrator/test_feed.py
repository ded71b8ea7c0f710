"""The bouncing feed: published phases, balances of momentum and energy, what it does to dphi."""

import numpy as np
import pytest
from machines import UNDAMPED
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar

from models.vibrator.theory.averaged import disphasing
from models.vibrator.theory.feed import LARGEST_THROW, apparent_mass, contact_coefficient, flight

THROWS = [1.0001, 1.02, 1.146, 1.5, 1.705, 2.3, 2.975, 3.2, 3.296]
DECK = UNDAMPED._replace(stiffness_x=2.07e5, stiffness_y=2.07e5)


def impulse(throw):
    start, end = flight(throw)
    return throw * (np.cos(end) - np.cos(start)) + end - start


def impact_coefficient(throw):
    """Return the first Fourier coefficient of the impact alone, as the paper has it."""
    _, end = flight(throw)
    return impulse(throw) * np.exp(-1j * end) / np.pi


@pytest.mark.parametrize(
    ("throw", "phase"), [(1.146, np.pi), (1.705, 1.5 * np.pi), (2.975, 2 * np.pi)]
)
def test_published_impact_phases(throw, phase):
    _, landing = flight(throw)
    assert landing == pytest.approx(phase, abs=2e-3)


@pytest.mark.parametrize("throw", THROWS)
def test_the_flight_is_the_first_return_to_the_deck(throw):
    start, end = flight(throw)
    assert throw * np.sin(start) == pytest.approx(1.0)

    def height(tau):  # over the deck
        t = tau - start
        return np.sin(start) + t * np.cos(start) - t**2 / (2 * throw) - np.sin(tau)

    assert abs(height(end)) < 1e-14
    inside = start + (end - start) * np.linspace(0, 1, 1001)[20:-1]
    assert np.all(height(inside) > 0)
    assert height(end + 1e-3) < 0


@pytest.mark.parametrize("throw", THROWS)
def test_the_mean_contact_force_is_the_weight(throw):
    start, end = flight(throw)
    riding, _ = quad(lambda tau: 1 - throw * np.sin(tau), end - 2 * np.pi, start)
    assert riding + impulse(throw) == pytest.approx(2 * np.pi, rel=1e-12)


@pytest.mark.parametrize("throw", THROWS)
def test_the_coefficient_is_the_fourier_integral(throw):
    start, end = flight(throw)

    def part(of):
        def integrand(tau):
            return of((1 - throw * np.sin(tau)) * np.exp(-1j * tau))

        return quad(integrand, end - 2 * np.pi, start, epsabs=1e-13)[0]

    whole = impact_coefficient(throw) + (part(np.real) + 1j * part(np.imag)) / np.pi
    assert contact_coefficient(throw) == pytest.approx(whole, rel=1e-10)


@pytest.mark.parametrize("throw", THROWS)
def test_the_deck_loses_what_the_impact_dissipates(throw):
    # Work of one turn and loss of a plastic impact, both over m_n (A_y w)^2.
    work = -np.pi * apparent_mass(throw).imag
    assert work == pytest.approx(0.5 * (impulse(throw) / throw) ** 2, rel=1e-9, abs=1e-15)


def test_feed_that_never_leaves_is_a_mass():
    assert np.array_equal(apparent_mass([0.1, 0.9, 1.0]), [1, 1, 1])
    assert np.isnan(flight([0.5, 1.0])).all()
    assert apparent_mass(1.0 + 1e-9) == pytest.approx(1.0, abs=1e-6)


def test_single_stroke_motion_ends_where_the_flight_lasts_a_turn():
    start, end = flight(LARGEST_THROW)
    assert end - start == pytest.approx(2 * np.pi, rel=1e-12)
    assert np.isnan(apparent_mass(LARGEST_THROW * (1 + 1e-12)))
    loaded = DECK._replace(feed_mass=10.0, throw_coefficient=[3.2, 3.4])
    assert np.array_equal(disphasing(loaded).exists, [True, False])


def angle(throw, feed_mass=5.0):
    p = DECK._replace(feed_mass=feed_mass, throw_coefficient=throw)
    return disphasing(p).angle[0]


def test_throws_that_leave_the_vibrators_in_phase():
    for coefficient, throw in ((impact_coefficient, 2.975), (contact_coefficient, 2.972)):
        zero = brentq(lambda k, c=coefficient: c(k).imag, 2.5, 3.2)
        assert zero == pytest.approx(throw, abs=5e-4)
    assert brentq(angle, 2.5, 3.2) == pytest.approx(2.97, abs=0.01)
    # 1.146 is neutral as far as the impact goes, but not for the feed that rides.
    hit = brentq(lambda k: impact_coefficient(k).imag, 1.05, 1.5)
    assert hit == pytest.approx(1.146, abs=5e-4)
    assert contact_coefficient(1.146).imag > 1.0
    assert angle(1.146) > angle(2.0) > 2 * angle(2.7) > 0


def largest(function):
    return minimize_scalar(lambda k: -function(k), bounds=(1.05, 3.2), method="bounded").x


def test_throws_that_disturb_most():
    # Near 1.7 for feed of constant weight; of constant mass, earlier: gravity falls as 1/k_p.
    assert largest(lambda k: contact_coefficient(k).imag) == pytest.approx(1.710, abs=1e-3)
    assert largest(lambda k: angle(k, feed_mass=3.0 * k)) == pytest.approx(1.71, abs=0.01)
    assert largest(angle) == pytest.approx(1.336, abs=0.01)
