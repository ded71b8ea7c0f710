"""Work-rates and lives under a random load, with honest errors."""

import numpy as np
import pytest
from nominal_beams import nominal
from random_load import LEVEL, PURE, prepared, started

from models.beam import MODEL, lanes
from models.beam.lanes import propagator
from models.beam.parameters import REGIMES, Params, Settings
from models.beam.response.averages import NINE_IN_TEN
from models.beam.response.settling import settle
from models.beam.wear.fitted_wear import FittedWear, fit
from models.beam.wear.lives import Lives
from models.beam.wear.random_lives import _note, _step
from uq.contract import Status


def rows(n=1, **values):
    x = np.tile(list(MODEL.nominal.values()), (n, 1))
    for name, value in values.items():
        x[:, Params._fields.index(name)] = value
    return x


def test_a_random_response_is_aperiodic_and_its_error_covers_what_other_seeds_give():
    n = 48
    p = nominal(n, mass_damping=20.0, **{**PURE, "random_force_level": 1e-2})
    _, system = prepared(lanes, p)
    state, gaps = started(lanes, system, p)
    response = settle(lanes, system, state, gaps)
    assert all(REGIMES[r] == "aperiodic" for r in response.regime)
    assert (response.period == 0).all() and (response.peak > 0).all()
    relative = response.error / response.work
    assert 0.05 < np.median(relative) < 0.115 and (relative < 0.25).all()
    off = np.abs(response.work - response.work.mean())
    assert 0.8 < (off < response.error).mean() < 0.98


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


@pytest.mark.slow
def test_a_seed_is_a_row_s_own_and_does_not_matter_without_random_load():
    x = np.vstack([rows(2, mass_damping=60.0, **PURE), rows(2, forcing_frequency=54.797)])
    seed = np.array([1, 2, 1, 2], np.uint64)
    settings = Settings(depths=(1e-5,), accuracy=0.3)
    outputs, _ = MODEL.batch(x, seed, settings)
    work = outputs["work_rate"]
    assert outputs["regime_changes"][:2].tolist() == [0, 0]
    assert (work[0] != work[1]).any() and (work[2] == work[3]).all()
    again, _ = MODEL.batch(x[1:2], seed[1:2], settings)
    for name in MODEL.given(settings).outputs:
        assert np.array_equal(again[name][0], outputs[name][1], equal_nan=True), name


@pytest.mark.parametrize("propagator", ["fast", "exact"])
def test_a_band_without_width_is_said_and_harms_no_other_row(propagator):
    x = rows(3, forcing_frequency=54.797, random_force_level=[1e-3, 0.0, 1e-3])
    x[:, Params._fields.index("random_force_low")] = [50.0, 50.0, 50.0]
    x[:, Params._fields.index("random_force_high")] = [40.0, 40.0, 50.0]
    x[:, Params._fields.index("force_amplitude")] = 0.05
    settings = Settings(depths=(1e-5,), accuracy=0.3, propagator=propagator)
    outputs, status, reasons = MODEL.batch(x, np.zeros(3, np.uint64), settings)
    assert status.tolist() == [Status.NON_FINITE, Status.OK, Status.NON_FINITE]
    words = "random_force_level > 0 needs random_force_high above random_force_low"
    assert reasons == {0: words, 2: words}
    constants = Params(random_force_level=1e-3, random_force_low=50.0, random_force_high=40.0)
    assert MODEL.refusal(settings, constants._asdict()) == words
    assert not MODEL.refusal(settings, constants._replace(random_force_level=0.0)._asdict())
    for name, output in MODEL.given(settings).outputs.items():
        if not output.is_category:
            assert np.isnan(outputs[name][[0, 2]]).all(), name
    assert np.isfinite(outputs["work_rate"][1]).all()


def test_a_trajectory_shows_the_random_force_of_its_seed():
    p = Params(random_force_level=LEVEL, mass_damping=60.0)
    quantities, other = (MODEL.simulate(p, Settings(), seed).quantities for seed in (3, 4))
    (_, _, f), (_, _, g) = quantities["random_force"], other["random_force"]
    assert f.std() == pytest.approx(np.sqrt(LEVEL * 198), rel=0.3)
    assert (f != g).any()
    assert "random_force" not in MODEL.simulate(Params(), Settings(), 3).quantities


def lives_of_noisy_means(logarithm, noise, end):
    """Return the bias and the scatter of 400 lives over the true one, and the share in error.

    The 13 nodes are those of a path, finer at small growth; both functions are of the place in it.
    """
    rng = np.random.default_rng(5)
    place = np.linspace(0.0, 1.0, 13)
    x = np.expm1(place * np.log(9)) / 8
    fine = np.linspace(0.0, end, 2001)
    true = np.trapezoid(np.exp(-logarithm(np.log1p(8 * fine) / np.log(9))), fine)
    spread = noise(place)
    means = np.exp(logarithm(place)) * rng.gamma(spread**-2, spread**2, (400, 13))
    life, error = np.array([FittedWear(x, mean, spread * mean).life(end) for mean in means]).T
    within = np.abs(life - true) < NINE_IN_TEN * error
    return life.mean() / true - 1, life.std() / true, within.mean()


def test_a_noisy_rate_is_fitted_without_bias_and_with_its_error():
    rng = np.random.default_rng(4)
    t = np.linspace(0.0, 1.0, 13)
    true = 1.0 - 2.0 * t + 0.5 * t**3
    off, error = [], []
    for _ in range(400):
        level, covariance = fit(np.exp(true) * rng.gamma(5.0, 0.2, 13), np.ones(13))
        off.append(level - true)
        error.append(np.sqrt(np.diag(covariance)))
    assert np.abs(np.exp(off).mean(axis=0) - 1).max() < 0.05
    assert np.mean(error, axis=0) == pytest.approx(np.std(off, axis=0), rel=0.25)


@pytest.mark.parametrize("end", [0.25, 1.0])
def test_a_wear_rate_that_bends_twice_along_the_path_is_followed(end):
    """Twice as fast within a third of the path, as where a second kind of contact sets in."""
    bias, _, within = lives_of_noisy_means(
        lambda place: 0.3 * np.tanh((place - 0.5) / 0.1), lambda place: 0.06 + 0 * place, end
    )
    assert abs(bias) < 0.015
    assert 0.87 < within < 0.96


def test_a_life_has_the_noise_of_its_own_part_of_the_path():
    bias, _, within = lives_of_noisy_means(
        lambda place: 0.4 * place,
        lambda place: np.where(np.abs(place - 0.5) < 0.2, 0.15, 0.03),
        0.5,
    )
    assert abs(bias) < 0.01
    assert 0.86 < within < 0.94


def test_a_noisier_mean_makes_no_longer_life():
    bias, scatter, within = lives_of_noisy_means(
        lambda place: 0 * place, lambda place: 0.4 + 0 * place, 1.0
    )
    assert abs(bias) < 2 * scatter / 20
    assert 0.86 < within < 0.94


@pytest.mark.parametrize(("nodes", "noise"), [(7, 0.1), (14, 0.04)])
def test_nine_in_ten_lives_from_noisy_rates_are_within_their_errors(nodes, noise):
    rng = np.random.default_rng(5)
    x = np.linspace(0.0, 1.0, nodes)
    rate = np.exp(1 + 0.4 * x)
    true = (1 - np.exp(-0.4)) / 0.4 / np.e
    within = []
    for _ in range(400):
        mean = rate * rng.gamma(noise**-2, noise**2, nodes)
        life, error = FittedWear(x, mean, noise * mean).life(1.0)
        within.append(abs(life - true) < NINE_IN_TEN * error)
    assert 0.87 < np.mean(within) < 0.94


def test_a_fit_of_next_to_nothing_is_no_overflow():
    """A site that wears by fits and starts, over thirty powers of ten."""
    rate = np.array([1e-300, 1e-3, 1e-250, 1.0, 1e-200, 1e3, 1e-300, 1e-300, 1e-280, 1e-300])
    wear = FittedWear(np.linspace(0.0, 1.0, 10), rate, rate)
    assert np.isposinf(wear.life(1.0)[0]) or wear.life(1.0)[0] > 0


@pytest.mark.parametrize("noise", [0.01, 0.2])
def test_a_life_begins_and_ends_with_the_path(noise):
    wear = FittedWear(np.arange(5.0), np.full(5, 2.0), np.full(5, 2.0 * noise))
    assert wear.life(0.0) == (0.0, 0.0)
    assert wear.life(4.0 + 1e-9) == wear.life(4.0)
    assert wear.life(4.0)[0] == pytest.approx(2.0)
    assert wear.grown(1.0) == pytest.approx(2.0)


def test_a_life_beyond_means_of_nothing_is_not_told():
    rate = np.array([1.0, 2.0, 0.5, 1.0, 1.0, 0.1, *np.zeros(4), 1e-100, *np.zeros(3)])
    wear = FittedWear(np.linspace(0.0, 1.0, 14), rate, rate)
    life, error = wear.life(0.2)
    assert 0 < error < life < 1.0
    assert np.isposinf(wear.life(1.0)[0])


@pytest.mark.slow
def test_contacts_that_are_rare_are_waited_for():
    """One in some hundred periods: a thousand periods without one are no zero."""
    x = rows(4, force_amplitude=0.0, random_force_level=9e-7)
    outputs, status = MODEL.batch(x, np.arange(4, dtype=np.uint64), Settings(depths=(1e-5,)))
    assert (outputs["work_rate_heavy"] > 0).all()
    assert not outputs["first_time_to_depth_censored"].any()
    assert np.isfinite(outputs["first_time_to_depth"]).all()
    # A site without a contact at several growths in a row has no life, and its row says so.
    whole = ~outputs["time_to_depth_censored"].any(axis=(1, 2))
    assert whole.any()
    np.testing.assert_array_equal(status == Status.OK, whole)


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


@pytest.mark.slow
def test_a_stiff_contact_that_hardly_ends_does_not_feed_on_its_steps():
    stiff = [
        *(18.4133, 165.819, 0.282995, 5194780.0, 6814.32, 4845627.0, 21.7748, 99.4254, 4.06674e-3),
        *(-0.317745, 10.0677, 5.43682e-5, 6.8e-11, 5.92539, 3.47426e-3, -0.0801288, -2.51198),
        *(535.794, 890.099, 2202.53),
    ]
    p = nominal(**dict(zip(Params._fields, stiff, strict=True)))
    _, system = prepared(lanes, p, [744])
    state, gaps = started(lanes, system, p)
    peaks = [lanes.advance(system, state, gaps, np.zeros((1, 2)), 256).peak.max() for _ in range(4)]
    assert 0 < peaks[-1] < peaks[0] < -p.initial_displacement[0] / p.initial_gap[0]


def test_a_beam_slower_to_forget_than_the_budget_lasts_is_out_of_budget():
    x = rows(1, length=18.0, mass_damping=10.0, random_force_level=1e-3, random_force_low=50.0)
    outputs, status = MODEL.batch(x, np.zeros(1, np.uint64), Settings(depths=(1e-5,)))
    assert status.tolist() == [Status.OUT_OF_BUDGET]
    assert np.isnan(outputs["work_rate"]).all()


def test_a_beam_that_its_steps_throw_out_of_all_bounds_is_out_of_budget(monkeypatch):
    monkeypatch.setattr(propagator, "_LOST", 0.0)  # any motion at all
    x = rows(2, random_force_level=[1e-3, 0.0], force_amplitude=[6.0, 0.0])
    outputs, status = MODEL.batch(x, np.array([744, 0], np.uint64), Settings(depths=(1e-5,)))
    assert status.tolist() == [Status.OUT_OF_BUDGET, Status.OK]
    assert np.isnan(outputs["work_rate"][0]).all()


def test_steps_are_fine_enough_for_a_fast_random_force():
    """The same realisations in four times as many steps."""
    n, loud = 16, {"random_force_level": 2.0, "random_force_low": 110.0, "random_force_high": 180.0}
    p = nominal(n, force_amplitude=0.0, **loud)
    work = []
    for steps in (0, 768):
        _, system = prepared(lanes, p, steps_per_period=steps)
        state, gaps = started(lanes, system, p)
        work.append(lanes.advance(system, state, gaps, np.zeros((n, 2)), 512).work.mean(axis=1))
    assert work[0].mean() == pytest.approx(work[1].mean(), rel=3e-3)


@pytest.mark.slow
def test_a_band_above_the_first_mode_gives_every_seed_the_same_work_rate():
    x = rows(8, force_amplitude=0.0, random_force_level=0.2, random_force_low=50.0)
    settings = Settings(depths=(1e-9,), accuracy=1.0, modes=6)
    outputs, _ = MODEL.batch(x, np.arange(8, dtype=np.uint64), settings)
    work = outputs["work_rate"].mean(axis=1)
    assert work.std(ddof=1) < 0.15 * work.mean()


def test_a_worn_gap_followed_to_where_it_hardly_wears_keeps_its_life():
    """The slow site's path must not bend the fit of the fast one's wear."""
    x = np.concatenate([np.linspace(0.0, 1.0, 13), 1.5 ** np.arange(1, 9)])
    rate = np.stack([np.where(x <= 1.0, 1.0, 1e-6), np.full(len(x), 1e-12)], axis=1)
    grown = np.stack([x, 1e-9 * x], axis=1)
    out = Lives.nothing(1, 1, 0)
    _note(0, out, np.ones(2), grown, rate, 0.1 * rate, np.ones(1), np.zeros(0), False)
    assert out.reached[0].tolist() == [[True], [False], [True]]
    assert out.time[0, 0, 0] == pytest.approx(1.0, rel=0.01)
    assert out.error[0, 0, 0] < 0.02


def test_a_stop_that_is_met_late_has_waited_while_the_other_gap_grew():
    grown = np.array([[x, max(0.0, x - 3.0)] for x in np.arange(0.0, 5.0, 0.5)])
    rate = np.stack([np.ones(10), np.where(grown[:, 0] < 3.0, 0.0, 1.0)], axis=1)
    instants = np.array([1.0, 3.25])
    out = Lives.nothing(1, 1, 2)
    _note(0, out, np.ones(2), grown, rate, 0.1 * rate, np.ones(1), instants, False)
    assert out.time[0, :, 0] == pytest.approx([1.0, 3.75, 1.0], rel=1e-6)
    # From a node to the next, half a unit of time later.
    assert 0.14 < out.error[0, 1, 0] < 0.3
    assert out.depth[0, 1] == pytest.approx([0.0, 0.5], abs=1e-6)


@pytest.mark.slow
def test_the_life_of_one_stop_under_a_random_load_is_finite_and_the_other_s_is_not():
    """The far stop is 12 standard deviations of the free tip away."""
    x = rows(4, force_amplitude=0.0, random_force_level=1e-4, initial_gap=5e-3, gap_asymmetry=1.9)
    settings = Settings(depths=(1.25e-4,), accuracy=0.1)
    outputs, status = MODEL.batch(x, np.arange(4, dtype=np.uint64), settings)
    assert (status == Status.OK).all()
    life, error = outputs["time_to_depth"][:, :, 0], outputs["time_to_depth_error"][:, :, 0]
    assert np.isposinf(life[:, 0]).all()
    assert (error[:, 1] < 0.2 * life[:, 1]).all()
