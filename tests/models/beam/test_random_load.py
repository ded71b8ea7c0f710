"""The random load: the process it is, the same motion by three propagators, and honest errors."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.signal import welch
from scipy.stats import kstest

from models.beam import MODEL, exact, lanes
from models.beam.parameters import OUTPUTS, REGIMES, Params, Settings
from models.beam.response.settling import settle
from models.beam.structure.modal import beams, reach
from models.beam.structure.random_lines import COUNT, force
from models.beam.structure.random_response import tip_deviation
from models.beam.wear.fitted_wear import FittedWear, fit
from models.beam.wear.random_lives import _step
from models.numerics.blocks import LANES
from uq.contract import Status

LEVEL = 1e-3  # N2 Hz-1
PURE = {"force_amplitude": 0.0, "random_force_level": LEVEL}


def nominal(n=1, **values):
    fields = {**Params._field_defaults, **values}
    return Params(*(np.broadcast_to(np.asarray(v, float), (n,)).copy() for v in fields.values()))


def prepared(propagator, p, seeds=None, **settings):
    s = Settings(**settings)
    seeds = np.arange(len(p.length)) if seeds is None else seeds
    b = beams(p, s, np.asarray(seeds, np.uint64))
    ((_, system),) = propagator.groups(b, s)
    return b, system


def started(propagator, system, p, gap=1.0):
    x0 = p.initial_gap
    state = propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)
    return state, np.full((len(x0), 2), gap)


def rows(n=1, **values):
    x = np.tile(list(MODEL.nominal.values()), (n, 1))
    for name, value in values.items():
        x[:, Params._fields.index(name)] = value
    return x


# The force


def many_forces(n, seconds, rate, **values):
    p = nominal(n, **{**PURE, **values})
    b = beams(p, Settings(), np.arange(n, dtype=np.uint64))
    time = np.arange(0.0, seconds, 1 / rate)
    periods = time * p.forcing_frequency[0]
    return np.array([p.initial_gap[0] * force(load, periods) for load in b.load])


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
    f = many_forces(n, 9.0, 1 / 4.5)  # two instants, in two epochs, of many realisations
    f /= np.sqrt(LEVEL * 198.0)
    for instant in f.T:
        assert kstest(instant, "norm").pvalue > 0.01
        assert (instant**4).mean() == pytest.approx(3.0, abs=3 * np.sqrt(96 / n))
    for a, b in ((f[:-1, 0], f[1:, 0]), (f[:, 0], f[:, 1])):
        assert abs(np.corrcoef(a, b)[0, 1]) < 3 / np.sqrt(n)


def test_a_realisation_is_that_of_its_seed():
    p = nominal(3, **PURE)
    seeds = np.array([5, 2**64 - 1, 5], np.uint64)
    loads = beams(p, Settings(), seeds).load
    at = np.linspace(0.0, 1e6, 50)
    first, other, again = (force(load, at) for load in loads)
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


@pytest.mark.parametrize("low", [2.0, 20.0], ids=["all modes", "not the first mode"])
def test_without_contact_the_tip_varies_as_the_integral_of_the_spectrum_says(low):
    n = 64
    p = nominal(n, mass_damping=20.0, random_force_low=low, **PURE)
    known = analytic_deviation(p)
    b, system = prepared(lanes, p)
    sure = tip_deviation(b.load, b.forcing, b.frequency, b.decay, b.mobility)
    assert sure == pytest.approx(np.full(n, known), rel=2e-3)
    assert (reach(b) == 9 * sure).all()
    state, gaps = started(lanes, system, p, 1e6)
    lanes.advance(system, state, gaps, np.zeros((n, 2)), 100)
    x = lanes.advance(system, state, gaps, np.zeros((n, 2)), 2000).strobe[:, :, 0]
    squares = (x**2).mean(axis=1)
    error = squares.std(ddof=1) / np.sqrt(n)
    assert error < 0.02 * known**2
    assert squares.mean() == pytest.approx(known**2, abs=3 * error + 0.01 * known**2)


# The propagators


def test_without_contact_lanes_and_exact_agree_from_epoch_to_epoch():
    p = nominal(mass_damping=60.0, initial_displacement=5e-5, initial_velocity=2e-3, **PURE)
    traces = []
    for propagator in (lanes, exact):
        b, system = prepared(propagator, p, [7], steps_per_period=384)
        state, gaps = started(propagator, system, p, 1e6)
        periods = 2 * int(b.load["epoch"][0]) + 5
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
    b.load["epoch"] = 3  # so that one ends on the way
    system.beams.load["epoch"] = 3
    state, gaps = started(exact, system, p)
    record = exact.advance(system, state, gaps, np.zeros((1, 2)), periods)
    assert record.work.sum() > 1
    w, d, m = b.frequency[0], b.decay[0], b.mobility[0]
    forcing, load = b.forcing[0], b.load[0]

    def motion(t, y):
        z, v = np.split(y, 2)
        x = z.sum()
        contact = b.stiffness[0] * (max(x - 1, 0.0) - max(-x - 1, 0.0))
        inside = np.clip(t * forcing / (2 * np.pi), begin, np.nextafter(begin + 1, 0))
        tip = b.force[0] * np.cos(forcing * t) + force(load, np.array([inside]))[0] - contact
        return np.concatenate([v, m * tip - 2 * d * v - w**2 * z])

    y = np.zeros(2 * len(w))
    y[0] = p.initial_displacement[0] / p.initial_gap[0]
    for begin in range(periods):
        span = 2 * np.pi / forcing * np.array([begin, begin + 1])
        found = solve_ivp(
            motion, span, y, "DOP853", rtol=1e-10, atol=1e-10, max_step=span[0] + 1e-3
        )
        y = found.y[:, -1]
        z, v = np.split(y, 2)
        assert record.strobe[0, begin] == pytest.approx([z.sum(), v.sum() / forcing], abs=1e-7)


@pytest.mark.parametrize("propagator", [lanes, exact])
def test_a_random_run_in_parts_is_the_run_in_one_bit_for_bit(propagator):
    p = nominal(2, mass_damping=60.0, **PURE)
    b, system = prepared(propagator, p)
    epoch = int(b.load["epoch"][0])
    growth = np.full((2, 2), 1e-4)
    state, gaps = started(propagator, system, p)
    whole = propagator.advance(system, state, gaps, growth, epoch + 9)
    again, parts = started(propagator, system, p)
    pieces = [
        propagator.advance(system, again, parts, growth, k).work for k in (3, epoch - 3, 1, 8)
    ]
    assert whole.work.sum() > 0
    assert np.array_equal(whole.work, np.concatenate(pieces, axis=1))
    assert np.array_equal(state, again) and np.array_equal(gaps, parts)


def test_rows_with_and_without_random_load_do_not_see_each_other():
    n = LANES + 3
    level = np.where(np.arange(n) % 3 == 0, 0.0, LEVEL)
    p = nominal(n, random_force_level=level)
    _, system = prepared(lanes, p, steps_per_period=96)

    def works(some):
        state, gaps = started(lanes, system, p)
        part = system.take(some)
        return lanes.advance(part, state[some], gaps[some], np.zeros((len(some), 2)), 20).work

    together = works(np.arange(n))
    for some in ([0], [1], [4, 3, n - 1]):
        assert np.array_equal(works(np.array(some)), together[some])
    _, plain = prepared(lanes, nominal(), steps_per_period=96)
    state, gaps = started(lanes, plain, nominal())
    assert np.array_equal(
        lanes.advance(plain, state, gaps, np.zeros((1, 2)), 20).work[0], together[0]
    )


def test_a_load_too_fast_for_the_steps_is_refused_and_followed_with_more():
    p = nominal(random_force_high=3000.0, **PURE)
    assert not list(lanes.groups(beams(p, Settings()), Settings(steps_per_period=96)))
    _, system = prepared(lanes, p)
    assert system.steps >= 16 * 3000 / 57.1042


# Work-rates and lives


def test_a_random_response_is_aperiodic_and_its_error_covers_what_other_seeds_give():
    n = 48
    p = nominal(n, mass_damping=20.0, **{**PURE, "random_force_level": 1e-2})
    _, system = prepared(lanes, p)
    state, gaps = started(lanes, system, p)
    found = settle(lanes, system, state, gaps)
    assert all(REGIMES[r] == "aperiodic" for r in found.regime)
    assert (found.period == 0).all() and (found.peak > 0).all()
    relative = found.error / found.work
    assert 0.05 < np.median(relative) < 0.115 and (relative < 0.25).all()
    off = np.abs(found.work - found.work.mean())
    assert 0.8 < (off < found.error).mean() < 0.98


def test_a_random_load_too_weak_to_touch_does_no_work_and_wears_for_ever():
    x = rows(force_amplitude=0.0, random_force_level=1e-9)
    outputs, status = MODEL.batch(x, np.zeros(1, np.uint64), Settings())
    assert status[0] == Status.OK
    assert REGIMES[outputs["regime"][0]] == "no-impact"
    assert not outputs["work_rate"].any()
    assert np.isposinf(outputs["first_time_to_depth"]).all()
    assert outputs["regime_changes"][0] == 0


@pytest.mark.slow
def test_lives_cover_what_other_seeds_give():
    n = 32
    x = rows(n, mass_damping=20.0, force_amplitude=0.0, random_force_level=1e-2)
    settings = Settings(depths=(1.25e-4, 2.5e-4), accuracy=0.1)
    outputs, status = MODEL.batch(x, np.arange(n, dtype=np.uint64), settings)
    assert (status == Status.OK).all()
    life, error = outputs["time_to_depth"], outputs["time_to_depth_error"]
    off = np.abs(life - life.mean(axis=(0, 1)))
    assert (error > 0).all() and (error < 0.3 * life).all()
    assert (off < error).mean() > 0.8


def test_a_seed_is_a_row_s_own_and_does_not_matter_without_random_load():
    x = np.vstack([rows(2, mass_damping=60.0, **PURE), rows(2, forcing_frequency=54.797)])
    seed = np.array([1, 2, 1, 2], np.uint64)
    settings = Settings(depths=(1e-5,), accuracy=0.3)
    outputs, _ = MODEL.batch(x, seed, settings)
    work = outputs["work_rate"]
    assert outputs["regime_changes"][:2].tolist() == [0, 0]
    assert (work[0] != work[1]).any() and (work[2] == work[3]).all()
    again, _ = MODEL.batch(x[1:2], seed[1:2], settings)
    for name in OUTPUTS:
        assert np.array_equal(again[name][0], outputs[name][1], equal_nan=True), name


@pytest.mark.parametrize("propagator", ["fast", "exact"])
def test_a_band_without_width_is_said_and_harms_no_other_row(propagator):
    x = rows(3, forcing_frequency=54.797, random_force_level=[1e-3, 0.0, 1e-3])
    x[:, Params._fields.index("random_force_low")] = [50.0, 50.0, 50.0]
    x[:, Params._fields.index("random_force_high")] = [40.0, 40.0, 50.0]
    x[:, Params._fields.index("force_amplitude")] = 0.05
    settings = Settings(depths=(1e-5,), accuracy=0.3, propagator=propagator)
    outputs, status = MODEL.batch(x, np.zeros(3, np.uint64), settings)
    assert status.tolist() == [Status.NON_FINITE, Status.OK, Status.NON_FINITE]
    for name, output in OUTPUTS.items():
        if not output.is_category:
            assert np.isnan(outputs[name][[0, 2]]).all(), name
    assert np.isfinite(outputs["work_rate"][1]).all()


def test_a_trajectory_shows_the_random_force_of_its_seed():
    p = Params(random_force_level=LEVEL, mass_damping=60.0)
    one, other = (MODEL.simulate(p, Settings(), seed).quantities for seed in (3, 4))
    (_, _, f), (_, _, g) = one["random_force"], other["random_force"]
    assert f.std() == pytest.approx(np.sqrt(LEVEL * 198), rel=0.3)
    assert (f != g).any()
    assert "random_force" not in MODEL.simulate(Params(), Settings(), 3).quantities


def test_a_noisy_rate_is_fitted_without_bias_and_with_its_error():
    rng = np.random.default_rng(4)
    t = np.linspace(0.0, 1.0, 13)
    true = 1.0 - 2.0 * t + 0.5 * t**3
    found = []
    for _ in range(400):
        coefficient, covariance = fit(t, np.exp(true) * rng.gamma(5.0, 0.2, 13))
        found.append((coefficient.sum() - true[-1], np.sqrt(covariance.sum())))
    off, error = np.array(found).T
    assert abs(np.exp(off).mean() - 1) < 0.15
    assert error.mean() == pytest.approx(off.std(), rel=0.25)


def test_a_fit_of_next_to_nothing_is_no_overflow():
    """A site that wears by fits and starts, over thirty powers of ten."""
    rate = np.array([1e-300, 1e-3, 1e-250, 1.0, 1e-200, 1e3, 1e-300, 1e-300, 1e-280, 1e-300])
    wear = FittedWear(np.linspace(0.0, 1.0, 10), rate, rate)
    assert np.isposinf(wear.life(1.0)[0]) or wear.life(1.0)[0] > 0


@pytest.mark.slow
def test_contacts_that_are_rare_are_waited_for():
    """One in some hundred periods: a thousand periods without one are no zero."""
    x = rows(4, force_amplitude=0.0, random_force_level=9e-7)
    outputs, status = MODEL.batch(x, np.arange(4, dtype=np.uint64), Settings(depths=(1e-5,)))
    assert (status == Status.OK).sum() >= 3
    done = status == Status.OK
    assert (outputs["work_rate_heavy"][done] > 0).all()


@pytest.mark.slow
def test_what_is_averaged_has_forgotten_its_start():
    """At 1600 Hz the first mode remembers for longer than the budget lasts."""
    x = rows(2, forcing_frequency=[57.0, 1600.0], mass_damping=0.5, force_amplitude=0.0)
    x[:, Params._fields.index("random_force_level")] = 1e-2
    _, status = MODEL.batch(x, np.zeros(2, np.uint64), Settings(depths=(1e-5,), accuracy=0.3))
    assert status.tolist() == [Status.OK, Status.OUT_OF_BUDGET]


def test_a_load_that_takes_too_many_steps_is_out_of_budget():
    x = rows(forcing_frequency=1.0, random_force_level=1e-3, random_force_high=1000.0)
    outputs, status = MODEL.batch(x, np.zeros(1, np.uint64), Settings())
    assert status[0] == Status.OUT_OF_BUDGET
    assert np.isnan(outputs["work_rate"]).all()


def test_lines_are_many_where_the_beam_is_sharp():
    p = nominal(**PURE)
    b = beams(p, Settings(), np.zeros(1, np.uint64))
    edges = b.load["edges"][0] * p.forcing_frequency[0]
    assert len(edges) == COUNT + 1 and (np.diff(edges) >= 0).all()
    for f in b.frequency[0, :2] / (2 * np.pi):
        assert np.sum(np.abs(edges - f) < 0.5) >= 5


def test_no_work_is_done_at_a_stop_out_of_reach():
    """The tip turns within a contact, and hardly beyond it: neither is the other site's."""
    p = nominal(16, random_force_level=2.0)
    _, system = prepared(lanes, p)
    state, gaps = started(lanes, system, p)
    gaps[:, 1] = 1e6
    work = lanes.advance(system, state, gaps, np.zeros((16, 2)), 512).work
    assert (work[:, :, 1] == 0).all()
    assert (work[:, :, 0].sum(axis=1) > 0).all()


def test_a_site_much_faster_than_the_other_keeps_a_gap_of_known_size():
    grown = _step(np.array([[2.0, 0.1]]), np.array([[1e12, 1.0]]), np.array([[0.5, 1.0]]))
    assert grown[0, 0] == pytest.approx(2 * 2.0 + 1.0)
    assert grown[0, 1] == pytest.approx(0.1 + 3e-12)


def test_a_beam_that_its_steps_throw_out_of_all_bounds_is_out_of_budget():
    """A stiff contact that hardly ends feeds on what the steps make of it."""
    x = rows(2)
    x[0] = [
        *(18.4133, 165.819, 0.282995, 5194780.0, 6814.32, 4845627.0, 21.7748, 99.4254, 4.06674e-3),
        *(-0.317745, 10.0677, 5.43682e-5, 6.8e-11, 5.92539, 3.47426e-3, -0.0801288, -2.51198),
        *(535.794, 890.099, 2202.53),
    ]
    outputs, status = MODEL.batch(x, np.array([744, 0], np.uint64), Settings(depths=(1e-5,)))
    assert status.tolist() == [Status.OUT_OF_BUDGET, Status.OK]
    assert np.isnan(outputs["work_rate"][0]).all()
