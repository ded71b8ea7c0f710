"""The random force: the process it is, and the same motion by three propagators."""

import numpy as np
import pytest
from nominal_beams import nominal
from random_load import LEVEL, PURE, prepared, started
from scipy.integrate import quad, solve_ivp
from scipy.signal import welch
from scipy.stats import kstest

from models.beam import exact, lanes
from models.beam.parameters import Params, Settings
from models.beam.structure.modal import beams, free_reach
from models.beam.structure.random_response import RIGID, filtered, tip_deviation
from models.numerics.blocks import LANES


def many_forces(n, seconds, rate, **values):
    p = nominal(n, **{**PURE, **values})
    b = beams(p, Settings(), np.arange(n, dtype=np.uint64))
    time = np.arange(0.0, seconds, 1 / rate)
    periods = time * p.forcing_frequency[0]
    forcing = b.forcing[0]
    return np.array([p.initial_gap[0] * filtered(x, forcing, RIGID, periods) for x in b.load])


@pytest.mark.slow
def test_the_force_has_the_level_asked_for_within_the_band_and_little_outside():
    low, high = 5.0, 120.0
    band = {"random_force_low": low, "random_force_high": high, "mass_damping": 60.0}
    f = many_forces(24, 60.0, 500.0, **band)
    variance = f.var(axis=1)
    error = variance.std(ddof=1) / np.sqrt(len(f))
    assert error < 0.02 * LEVEL * (high - low)
    assert variance.mean() == pytest.approx(LEVEL * (high - low), abs=3 * error)
    frequency, level = welch(f, fs=500.0, nperseg=1024)
    level = level.mean(axis=0) / LEVEL
    inside = (frequency > low + 2) & (frequency < high - 2)
    fifths = [part.mean() for part in np.array_split(level[inside], 5)]
    assert fifths == pytest.approx(np.ones(5), rel=0.05)
    outside = (frequency < low - 5) | (frequency > high + 5)
    assert level[outside].max() < 0.02


@pytest.mark.slow
def test_the_force_is_gaussian_at_any_instant_and_rows_are_independent():
    n = 4000
    f = many_forces(n, 9.0, 1 / 4.5)  # two instants of many realisations
    f /= np.sqrt(LEVEL * 198.0)
    for instant in f.T:
        assert kstest(instant, "norm").pvalue > 0.01
        assert (instant**4).mean() == pytest.approx(3.0, abs=3 * np.sqrt(96 / n))
    for a, b in ((f[:-1, 0], f[1:, 0]), (f[:, 0], f[:, 1])):
        assert abs(np.corrcoef(a, b)[0, 1]) < 3 / np.sqrt(n)


def test_a_realisation_is_that_of_its_seed():
    p = nominal(3, **PURE)
    seeds = np.array([5, 2**64 - 1, 5], np.uint64)
    b = beams(p, Settings(), seeds)
    at = np.linspace(0.0, 1e4, 50)
    first, other, again = (filtered(x, b.forcing[0], RIGID, at) for x in b.load)
    assert np.array_equal(first, again)
    assert np.abs(np.corrcoef(first, other)[0, 1]) < 0.6


def response(p, f):
    """Return the tip's displacement per unit force, from the modes."""
    b = beams(p, Settings())
    w, d, m = b.frequency[0], b.decay[0], b.mobility[0]
    omega = 2 * np.pi * f
    return abs((m / (w**2 - omega**2 + 2j * d * omega)).sum()) ** 2


def analytic_deviation(p):
    """Return the root of the integral of S |H|^2, in initial gaps."""
    low, high = p.random_force_low[0], p.random_force_high[0]
    natural = beams(p, Settings()).frequency[0] / (2 * np.pi)
    peaks = [f for f in natural if low < f < high]
    whole, _ = quad(lambda f: response(p, f), low, high, points=peaks, limit=500, epsrel=1e-8)
    return np.sqrt(p.random_force_level[0] * whole) / p.initial_gap[0]


@pytest.mark.parametrize(
    "low",
    [
        pytest.param(2.0, id="all modes"),
        pytest.param(20.0, id="not the first mode", marks=pytest.mark.slow),
    ],
)
def test_without_contact_the_tip_varies_as_the_integral_of_the_spectrum_says(low):
    n = 64
    p = nominal(n, mass_damping=20.0, random_force_low=low, **PURE)
    expected = analytic_deviation(p)
    b, system = prepared(lanes, p)
    sure = tip_deviation(b.load, b.forcing, b.oscillators)
    assert sure == pytest.approx(np.full(n, expected), rel=2e-3)
    assert (free_reach(b) == 9 * sure).all()
    state, gaps = started(lanes, system, p, 1e6)
    lanes.advance(system, state, gaps, np.zeros((n, 2)), 100)
    x = lanes.advance(system, state, gaps, np.zeros((n, 2)), 2000).strobe[:, :, 0]
    squares = (x**2).mean(axis=1)
    error = squares.std(ddof=1) / np.sqrt(n)
    assert error < 0.02 * expected**2
    assert squares.mean() == pytest.approx(expected**2, abs=3 * error + 0.01 * expected**2)


# The propagators


def test_without_contact_lanes_and_exact_agree_from_stretch_to_stretch():
    p = nominal(mass_damping=60.0, initial_displacement=5e-5, initial_velocity=2e-3, **PURE)
    traces = []
    for propagator in (lanes, exact):
        b, system = prepared(propagator, p, [7], steps_per_period=768)  # no mode is static
        state, gaps = started(propagator, system, p, 1e6)
        periods = 2 * int(b.load["stretch"][0]) + 5
        traces.append(
            propagator.advance(system, state, gaps, np.zeros((1, 2)), periods, trace=True).trace
        )
        assert state[0, -1 if propagator is lanes else -3] == periods
    assert np.abs(traces[1]).max() > 1
    assert np.abs(traces[0] - traces[1]).max() < 1e-8 * np.abs(traces[1]).max()


def test_through_contacts_lanes_converge_to_exact():
    p = nominal(random_force_level=LEVEL, random_force_low=20.0)
    errors = []
    for steps in (200, 800):
        pair = []
        for propagator in (lanes, exact):
            _, system = prepared(propagator, p, [3], steps_per_period=steps)
            state, gaps = started(propagator, system, p)
            pair.append(propagator.advance(system, state, gaps, np.zeros((1, 2)), 5, trace=True))
        assert pair[1].work.sum() > 1
        errors.append(np.abs(pair[0].trace - pair[1].trace).max() / np.abs(pair[1].trace).max())
    assert errors[1] < 2e-4
    assert errors[1] < errors[0] / 12


@pytest.mark.slow
def test_exact_is_an_independent_integration_of_the_beam_under_the_same_force():
    p = nominal(
        random_force_level=LEVEL,
        mass_damping=60.0,
        random_force_low=10.0,
        initial_displacement=4e-4,
    )
    elements, periods = 2, 4
    b, system = prepared(exact, p, [11], elements=elements)
    state, gaps = started(exact, system, p)
    record = exact.advance(system, state, gaps, np.zeros((1, 2)), periods)
    assert record.work.sum() > 1
    w, d, m = b.frequency[0], b.decay[0], b.mobility[0]
    forcing = b.forcing[0]
    at = np.linspace(0.0, periods, 40_001)
    force = filtered(b.load[0], forcing, RIGID, at)

    def motion(t, y):
        z, v = np.split(y, 2)
        x = z.sum()
        contact = b.stiffness[0] * (max(x - 1, 0.0) - max(-x - 1, 0.0))
        random = np.interp(t * forcing / (2 * np.pi), at, force)
        tip = b.force[0] * np.cos(forcing * t) + random - contact
        return np.concatenate([v, m * tip - 2 * d * v - w**2 * z])

    y = np.zeros(2 * len(w))
    y[0] = p.initial_displacement[0] / p.initial_gap[0]
    for begin in range(periods):
        span = 2 * np.pi / forcing * np.array([begin, begin + 1])
        solution = solve_ivp(
            motion, span, y, "DOP853", rtol=1e-10, atol=1e-10, max_step=span[0] + 1e-3
        )
        y = solution.y[:, -1]
        z, v = np.split(y, 2)
        # Force and motion are each interpolated, to 4e-6 at most (`interpolation`).
        assert record.strobe[0, begin] == pytest.approx([z.sum(), v.sum() / forcing], abs=4e-6)


@pytest.mark.parametrize("propagator", [lanes, exact])
def test_a_random_run_in_parts_is_the_run_in_one_bit_for_bit(propagator):
    p = nominal(2, mass_damping=60.0, **PURE)
    b, system = prepared(propagator, p)
    stretch = int(b.load["stretch"][0])
    growth = np.full((2, 2), 1e-4)
    state, gaps = started(propagator, system, p)
    whole = propagator.advance(system, state, gaps, growth, stretch + 9)
    again, parts = started(propagator, system, p)
    pieces = [
        propagator.advance(system, again, parts, growth, k).work for k in (3, stretch - 3, 1, 8)
    ]
    assert whole.work.sum() > 0
    assert np.array_equal(whole.work, np.concatenate(pieces, axis=1))
    assert np.array_equal(state, again) and np.array_equal(gaps, parts)


def test_rows_with_and_without_random_load_do_not_see_each_other():
    n = LANES + 3
    level = np.where(np.arange(n) % 3 == 0, 0.0, LEVEL)
    settings = Settings(steps_per_period=96)

    def works(rows):
        p = nominal(len(rows), random_force_level=level[rows])
        work = np.full((len(rows), 20, 2), np.nan)
        for part, system in lanes.groups(beams(p, settings, rows.astype(np.uint64)), settings):
            q = Params._make(field[part] for field in p)
            state, gaps = started(lanes, system, q)
            work[part] = lanes.advance(system, state, gaps, np.zeros((len(part), 2)), 20).work
        return work

    together = works(np.arange(n))
    assert np.isfinite(together).all() and together.any()
    for some in ([0], [1], [4, 3, n - 1]):
        assert np.array_equal(works(np.array(some)), together[some])


def test_a_load_too_fast_for_the_steps_is_refused_and_followed_with_more():
    p = nominal(random_force_high=3000.0, **PURE)
    assert not list(lanes.groups(beams(p, Settings()), Settings(steps_per_period=96)))
    _, system = prepared(lanes, p)
    assert system.steps >= 16 * 3000 / 57.1042


@pytest.mark.slow
def test_steps_finer_than_the_ladder_under_a_random_load_give_the_same_work_rate():
    work = []
    for steps in (200, 2000):
        p = nominal(random_force_level=LEVEL, random_force_low=20.0)
        _, system = prepared(lanes, p, [3], steps_per_period=steps)
        state, gaps = started(lanes, system, p)
        work.append(lanes.advance(system, state, gaps, np.zeros((1, 2)), 5).work.sum())
    assert work[1] > 1
    assert work[0] == pytest.approx(work[1], rel=0.01)
