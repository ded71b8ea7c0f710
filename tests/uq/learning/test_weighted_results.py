"""Readers of results take rows that inspections have weighted, or refuse them with one sentence."""

import numpy as np
import pytest
from computed import asking, computed, study_of, summarised
from learnt_studies import exactly, measured, wear
from scipy.stats import lognorm

import uq as api
from uq import plots
from uq.errors import InputError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.posterior_result import as_unit
from uq.render.html.page import page
from uq.result.elements import elements_of
from uq.result.result import Result


@pytest.fixture(scope="module")
def posterior():
    """Return rows of which what is shared has been learnt, so that their weights differ."""
    return update(wear(rate="shared", samples=600, units=2), measured(6e5, 7e5))


@pytest.fixture(scope="module")
def unit():
    asked = {"thresholds": {"life": [5.2e5]}}
    return as_unit(update(wear(samples=2000, analysis=asked), measured(5e5)), "A")


def of_weights(ds, numbers):
    return np.average(numbers, weights=ds["weight"])


def test_every_statistic_counts_rows_by_their_weight(unit):
    life = unit["life"].values
    statistics = summarised(unit, plain=True)
    assert statistics["effective_rows"] < 1500 and statistics["pareto_k"] < 0.7
    statistics_of_life = statistics["outputs"]["life"]
    assert statistics_of_life["effective_rows"] == pytest.approx(statistics["effective_rows"])
    assert statistics_of_life["mean"] == pytest.approx(of_weights(unit, life))
    assert statistics_of_life["sd"] == pytest.approx(
        of_weights(unit, (life - statistics_of_life["mean"]) ** 2) ** 0.5
    )
    below = statistics_of_life["thresholds"]["520000.0"]["below"]
    assert below["value"] == pytest.approx(of_weights(unit, life < 5.2e5))
    assert below["low"] < below["value"] < below["high"]
    for name, p in (("B10", 0.1), ("B50", 0.5)):
        at = statistics_of_life["b_lives"][name]
        assert of_weights(unit, life < at["value"]) < p <= of_weights(unit, life <= at["value"])
        assert at["low"] < at["value"] < at["high"]
    assert statistics_of_life["tolerance"] is None


def test_lives_of_an_inspected_unit_are_integrated(unit):
    """Against the closed form, with intervals several times narrower than those of lives drawn."""
    mean, cov = exactly([5e5])
    sd = (cov[0, 0] + cov[1, 1] - 2 * cov[0, 1]) ** 0.5
    law = lognorm(sd, scale=np.exp(mean[1] - mean[0]))
    life, drawn = (summarised(unit, plain=plain)["outputs"]["life"] for plain in (False, True))
    assert life["integrated"]["inputs"] == ["depth"]
    below, counted = (statistics["thresholds"]["520000.0"]["below"] for statistics in (life, drawn))
    assert below["low"] < law.cdf(5.2e5) < below["high"]
    assert below["high"] - below["low"] < (counted["high"] - counted["low"]) / 4
    for name, p in (("B10", 0.1), ("B50", 0.5)):
        assert life["b_lives"][name]["low"] < law.ppf(p) < life["b_lives"][name]["high"]


def test_the_survival_curve_counts_rows_by_their_weight(unit):
    curve = api.survival(unit, "life")
    at = 5.2e5
    seen = float(curve["survival"].sel(time=at, method="ffill"))
    assert seen == pytest.approx(of_weights(unit, unit["life"].values > at), abs=0.01)
    assert np.isnan(curve["band_low"]).all() and "equal weight" in curve.attrs["band"]
    curve = curve.dropna("time", subset=["survival"])
    assert (curve["low"] <= curve["survival"]).all()


def test_censored_lives_leave_no_number_after_them(unit):
    late = unit["life"].values > 5.5e5
    cut = unit.assign(life=unit["life"].clip(max=5.5e5))
    cut["life_censored"] = ("row", late.astype(np.int8), {"role": "censored", "long_name": "x"})
    curve = api.survival(cut, "life")
    assert float(curve["survival"].sel(time=5.4e5, method="ffill")) == pytest.approx(
        of_weights(unit, unit["life"].values > 5.4e5), abs=0.01
    )
    assert summarised(cut)["outputs"]["life"]["b_lives"]["B50"]["value"] == pytest.approx(
        summarised(unit, plain=True)["outputs"]["life"]["b_lives"]["B50"]["value"]
    )
    late = summarised(asking(cut, outputs=["life"], thresholds={"life": [6e5]}))
    assert late["outputs"]["life"]["thresholds"]["600000.0"]["below"]["value"] is None


def test_regimes_are_weighted():
    tables = {
        "study": {"name": "kinds", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 400},
        "uncertain": {"x1": {"distribution": "uniform", "lower": 0.01, "upper": 0.99}},
    }
    ds = computed(study_of(tables, "sample_models:KINDS"))
    work = next(elements_of(ds, ["work"]))
    told = {"unit": "A", "output": work.name, "kind": "below", "value": np.median(work.values)}
    unit = as_unit(update(ds, [told]), "A")
    shares = summarised(unit)["regime"]
    for code, label in enumerate(unit["regime"].attrs["flag_meanings"].split()[1:]):
        assert shares[label]["share"] == pytest.approx(of_weights(unit, unit["regime"] == code))


def test_before_and_after_are_compared_with_cautious_intervals(posterior):
    table = api.compare(wear(rate="shared", samples=600, units=2), posterior)
    line = table.loc[("life", "B50")]
    assert line["second"] < line["first"] and line["low"] < line["difference"] < line["high"]
    shares = table.loc[("life", "P(<1000000.0)")]
    assert shares["low"] < shares["difference"] < shares["high"]


def test_figures_and_report_show_weighted_rows(posterior, tmp_path):
    names = {path.stem for path in plots.save_all(Result(posterior), tmp_path, every=True)}
    assert {"lifetime-life", "quantiles-life", "inputs"} <= names
    assert not any(name.startswith(("scatter", "sobol", "convergence")) for name in names)
    text = page(Result(posterior), "posterior.nc")
    assert "given 2 inspections of 2 units" in text and "effective rows" in text
    assert "not with rows that inspections have weighted" in text


@pytest.mark.parametrize(
    "verb",
    [
        "sensitivity posterior.nc",
        "convergence posterior.nc",
        "summary posterior.nc --fits",
        "what-if posterior.nc --set uncertain.rate.sigma=0.4",
        "twin posterior.nc",
        "row posterior.nc 3",
        "extend posterior.nc --samples 700",
        "rerun posterior.nc --failed",
        "verify posterior.nc",
    ],
)
def test_what_makes_no_sense_with_weights_is_refused(uq, folder, posterior, verb):
    write_result(posterior, folder / "posterior.nc")
    ended = uq(*verb.split())
    assert ended.code == 2 and ended.err.count("\n") == 1, ended
    assert "not with rows that inspections have weighted" in ended.err


def test_a_posterior_is_not_taken_for_the_result_of_its_study(posterior, folder):
    write_result(posterior, folder / "posterior.nc")
    (folder / "wear.toml").write_text(posterior.attrs["study"])
    with pytest.raises(InputError, match="has rows that inspections have weighted"):
        api.run("wear.toml", "posterior.nc")


@pytest.mark.parametrize("weight", [-1.0, np.nan, 0.0])
def test_unsound_weights_are_refused(posterior, folder, weight):
    bad = posterior.copy(deep=True)
    bad["weight"][:] = weight
    write_result(bad, folder / "bad.nc")
    with pytest.raises(InputError, match="'weight' is negative, infinite or zero throughout"):
        api.open_result("bad.nc")
