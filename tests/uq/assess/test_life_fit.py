import numpy as np
import openturns as ot
import pytest
from computed import asking, linear, summarised, with_output
from scipy import stats

import uq
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.errors import InputError
from uq.result.result import Result
from uq.stats.location_scale import FAMILIES, anderson_darling, fit
from uq.stats.order_statistics import rows_for_bound

WEIBULL = stats.weibull_min(1.7, scale=3e5)
LOGNORMAL = stats.lognorm(0.6, scale=2e5)


def lives(values, censored=None, method="monte-carlo", **analysis):
    ds = with_output(linear(method, samples=len(values)), "life", values, "lifetime", censored)
    return asking(ds, outputs=["life"], **analysis)


def fitted(ds, law):
    return uq.life_fits(ds, "life", [law]).loc[("life", law)]


def sample(law, n=400, seed=1):
    return law.rvs(n, random_state=np.random.default_rng(seed))


@pytest.mark.parametrize("horizon", [np.inf, 2.5e5])
@pytest.mark.parametrize(("name", "law"), [("weibull", WEIBULL), ("lognormal", LOGNORMAL)])
def test_parameters_are_those_of_scipys_maximum_likelihood(name, law, horizon):
    life = sample(law)
    ended, life = life <= horizon, np.minimum(life, horizon)
    location, scale = fit(FAMILIES[name], np.log(life)[None], ended[None])
    data = stats.CensoredData(uncensored=life[ended], right=life[~ended])
    shape, _, median = law.dist.fit(data, floc=0)
    assert np.exp(location[0]) == pytest.approx(median, rel=1e-4)
    assert scale[0] == pytest.approx(1 / shape if name == "weibull" else shape, rel=1e-4)


def test_parameters_are_those_of_openturns():
    life = sample(WEIBULL)
    factory = ot.WeibullMinFactory()
    factory.setKnownParameter([0.0], [2])
    parameters = factory.build(ot.Sample(life[:, None])).getParameter()
    law = fitted(lives(life), "weibull")
    assert law["scale"] == pytest.approx(parameters[0], rel=1e-3)
    assert law["shape"] == pytest.approx(parameters[1], rel=1e-3)


def test_distance_is_that_of_anderson_and_darling():
    z = np.sort(np.random.default_rng(0).normal(size=60))
    z = (z - z.mean()) / z.std(ddof=1)
    distance = anderson_darling(stats.norm.cdf(z)[None], np.ones((1, 60), dtype=bool))[0]
    expected = stats.anderson(z, "norm", method="interpolate").statistic
    assert distance == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("law", "right", "wrong"),
    [(WEIBULL, "weibull", "lognormal"), (LOGNORMAL, "lognormal", "weibull")],
)
def test_the_right_law_fits_and_the_wrong_one_is_refused(law, right, wrong):
    fits = uq.life_fits(lives(sample(law)), "life", [right, wrong]).loc["life"]
    good, bad = fits.loc[right], fits.loc[wrong]
    assert good["p_value"] > 0.05 > bad["p_value"]
    assert "rejected" in bad["refused"] and bad[["B10", "shape", "median"]].isna().all()
    for name, p in B_LIVES.items():
        assert good[f"{name}_low"] < law.ppf(p) < good[f"{name}_high"]
        assert good[name] == pytest.approx(law.ppf(p), rel=0.25)
    for name in {"weibull": ("shape", "scale"), "lognormal": ("median", "sigma")}[right]:
        assert good[f"{name}_low"] < good[name] < good[f"{name}_high"]


def test_fits_are_a_table_and_in_json():
    life = lives(sample(LOGNORMAL, 100))
    table = uq.life_fits(life, "life")
    entries = summary_facts(summarise(Result(life), fits=True)).json["outputs"]["life"]["fits"]
    laws = ["weibull", "lognormal", "gamma", "exponential", "weibull-3", "weibull-mixture"]
    assert table.index.to_list() == [("life", law) for law in laws]
    good, bad = table.loc[("life", "lognormal")], table.loc[("life", "weibull")]
    assert good["refused"] == "" and bad["refused"] == entries["weibull"]["refused"]
    for name in ("B1", "B10", "B50"):
        values_of_row = [good[name], good[f"{name}_low"], good[f"{name}_high"]]
        assert values_of_row == [
            entries["lognormal"][name][end] for end in ("value", "low", "high")
        ]
        assert not good[f"{name}_extrapolated"]
    assert good["sigma_low"] < good["sigma"] < good["sigma_high"]
    assert np.isnan(bad["B10"]) and np.isnan(bad["scale"])


def test_few_rows_have_the_exact_interval_of_a_lognormal_median():
    life = sample(LOGNORMAL, 20, seed=2)
    law = fitted(lives(life), "lognormal")
    logarithms = np.log(life)
    exact = stats.ttest_1samp(logarithms, 0).confidence_interval()
    ends = np.log(law[["median_low", "median_high"]].to_numpy(float))
    # The normal law's interval would be shorter by 6 %.
    assert ends - logarithms.mean() == pytest.approx(exact - logarithms.mean(), rel=0.02)


def test_what_cannot_be_fitted_is_refused():
    good = sample(WEIBULL)
    never = np.where(np.arange(400) < 7, np.inf, good)
    zero = np.where(np.arange(400) < 3, 0.0, good)
    for values, censored, sentence in (
        (never, None, "of 400 rows 7 never end"),
        (zero, None, "3 rows have no positive life"),
        (good, np.arange(400) >= 19, "only 19 rows ended"),
        (np.full(400, 5.0), None, "share fewer than 20 values"),
    ):
        fits = uq.life_fits(lives(values, censored), "life")
        # An exponential life may be 0: its density is finite there.
        kept = fits.drop(("life", "exponential")) if values is zero else fits
        assert kept["refused"].str.contains(sentence).all()
    fits = uq.life_fits(lives(good, method="halton"), "life")
    assert fits["refused"].str.contains("independent rows").all()
    with pytest.raises(InputError, match="not a lifetime"):
        uq.life_fits(linear(), "y")
    with pytest.raises(InputError, match="no such law 'weibul'; did you mean 'weibull'?"):
        uq.life_fits(lives(good), "life", ["weibul"])


def test_b_lives_are_plain_quantiles_while_censoring_does_not_matter():
    life = sample(LOGNORMAL)
    whole = summarised(lives(life, quantiles=[0.01, 0.1, 0.5]))["outputs"]["life"]
    assert list(whole["b_lives"].values()) == list(whole["quantiles"].values())
    late = np.minimum(life, 2.5e5)
    cut = summarised(lives(late, life > 2.5e5))["outputs"]["life"]
    assert cut["b_lives"] == whole["b_lives"]
    never = np.where(life > 2.5e5, np.inf, life)
    assert summarised(lives(never))["outputs"]["life"]["b_lives"] == whole["b_lives"]
    most = summarised(lives(np.where(life > 1e5, np.inf, life)))["outputs"]["life"]
    assert most["b_lives"]["B50"]["value"] is None and most["b_lives"]["B50"]["never"]


def test_b_lives_of_censored_rows_are_those_of_kaplan_and_meier():
    # Klein, Moeschberger, "Survival analysis", 2nd ed. (2003), section 4.5: the median remission
    # of the 6-MP group is 23 months, from 13 on; nothing bounds it from above.
    ended = [6, 6, 6, 7, 10, 13, 16, 22, 23]
    left = [6, 9, 10, 11, 17, 19, 20, 25, 32, 32, 34, 35]
    censored = np.r_[np.zeros(9), np.ones(12)]
    statistics = summarised(lives(np.r_[ended, left].astype(float), censored))["outputs"]["life"]
    b50 = statistics["b_lives"]["B50"]
    assert (b50["value"], b50["low"], b50["high"]) == (23.0, 13.0, None)
    assert "censoring" in b50["assumes"]


def test_share_that_ended_by_a_time_with_rows_censored_before():
    life, leaving = sample(WEIBULL, 1000), sample(stats.expon(scale=4e5), 1000, seed=2)
    ds = lives(np.minimum(life, leaving), leaving < life, thresholds={"life": 2e5})
    entry = summarised(ds)["outputs"]["life"]["thresholds"]["200000.0"]
    assert entry["below"]["value"] is None and "censored before" in entry["reason"]
    guess = entry["kaplan_meier"]
    assert guess["below"]["low"] < guess["below"]["value"] < guess["below"]["high"]
    assert guess["below"]["value"] == pytest.approx(WEIBULL.cdf(2e5), abs=0.06)
    assert guess["above"]["value"] == pytest.approx(1 - guess["below"]["value"])
    at = uq.survival(ds, "life").sel(time=2e5, method="ffill")
    assert guess["above"]["value"] == float(at["survival"])


@pytest.mark.parametrize(("coverage", "confidence"), [(0.95, 0.95), (0.99, 0.9), (0.9, 0.99)])
def test_rows_that_a_bound_needs_are_those_of_openturns(coverage, confidence):
    for failed in (0, 2):
        expected = ot.Wilks.ComputeSampleSize(coverage, confidence, failed)
        assert rows_for_bound(coverage, confidence, failed) == expected


def test_beside_quantiles_of_censored_rows_stand_those_of_kaplan_and_meier_as_b_lives_are():
    # Rows are lost from sight all along: B10 has a value, and so must the quantile 0.1 have.
    life, leaving = sample(WEIBULL, 1000), sample(stats.expon(scale=4e5), 1000, seed=2)
    ds = lives(np.minimum(life, leaving), leaving < life, quantiles=[0.05, 0.1, 0.5])
    entry = summarised(ds)["outputs"]["life"]
    assert entry["quantiles"]["0.1"]["kaplan_meier"] == entry["b_lives"]["B10"]
    assert entry["quantiles"]["0.5"]["kaplan_meier"] == entry["b_lives"]["B50"]
    plain = entry["quantiles"]["0.05"]
    assert plain["value"] is None and plain["censored"]
    assert summarise(Result(ds)).outputs["life"].find("quantiles", "0.05").words() == "-"
    low = plain["kaplan_meier"]
    assert low["low"] < WEIBULL.ppf(0.05) < low["high"] and "censoring" in low["assumes"]


@pytest.mark.parametrize(
    ("values", "time", "value", "reason"),
    [
        ([1.0, 2.0, 3.0, 4.0], 2.5, 0.0, "no row ended before it"),
        ([1.0, 2.0, 3.0, 4.0], 9.0, None, "it is after the last observation"),
    ],
)
def test_a_share_after_kaplan_and_meier_without_interval_has_a_reason(values, time, value, reason):
    ds = lives(np.array(values), np.ones(4), thresholds={"life": time})
    entry = summarised(ds)["outputs"]["life"]["thresholds"][repr(time)]["kaplan_meier"]
    below = {"value": value, "low": None, "high": None, "reason": reason}
    assert entry["below"] == below
