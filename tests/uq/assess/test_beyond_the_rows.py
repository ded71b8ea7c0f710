"""A quantile that the rows do not reach has no value, and a fitted one is called extrapolated."""

from pathlib import Path

import numpy as np
import pytest
from computed import asking, compared, kinds, linear, summarised, with_output
from scipy import stats

import uq as api
from uq.assess.expected_widths import expected_widths
from uq.assess.summary import summarise
from uq.assess.summary_table import summary
from uq.files.whole_files import write
from uq.render.html.outcomes import outcomes, result_tables
from uq.result.result import Result
from uq.stats import order_statistics


def lives(rows, **design):
    ds = linear(samples=rows // design.get("replicates", 1), **design)
    values = stats.gamma(2.0, scale=1e5).rvs(rows, random_state=1)
    return asking(with_output(ds, "life", values, "lifetime"), outputs=["life"], quantiles=[0.001])


@pytest.mark.parametrize("rows", [1, 16, 99, 999])
def test_ranks_reach_from_one_in_n_plus_one_to_n(rows):
    values = np.arange(rows, dtype=float)
    least = 1 / (rows + 1)
    for p in (least, 1 - least):
        assert np.isfinite(order_statistics.quantile(values, p))
    for p in (0.99 * least, 1 - 0.99 * least):
        assert np.isnan(order_statistics.quantile(values, p))


@pytest.mark.parametrize(
    "design", [{}, {"method": "latin-hypercube"}, {"method": "sobol", "replicates": 8}]
)
def test_a_quantile_beyond_the_rows_has_a_reason_and_no_value(design):
    output = summarised(lives(64, **design))["outputs"]["life"]
    for entry in (output["quantiles"]["0.001"], output["b_lives"]["B1"]):
        assert entry["value"] is None and entry["low"] is None
        assert "64 rows" in entry["reason"]
    assert output["quantiles"]["0.001"]["rows_needed"] == 999
    assert output["b_lives"]["B1"]["rows_needed"] == 99
    assert output["b_lives"]["B10"]["value"] is not None


def test_the_rows_needed_are_enough():
    output = summarised(lives(999))["outputs"]["life"]
    assert output["quantiles"]["0.001"]["value"] is not None
    assert "reason" not in output["quantiles"]["0.001"]


def test_independent_rows_still_bound_it_from_one_side():
    entry = summarised(lives(64))["outputs"]["life"]["quantiles"]["0.001"]
    assert entry["high"] is not None


def test_every_reader_says_how_many_rows_it_takes(uq, folder):
    ds = lives(64)
    write(ds, Path("life.nc").absolute())
    out = uq("summary", "life.nc", "--explain", "--full").out
    assert "needs 999 rows" in out and "needs 99 rows" in out
    assert np.isnan(summary(ds).loc["life", "B1"])
    cells = dict(
        zip(
            *(lambda t: (t.header, t.rows[0]))(list(result_tables(outcomes_of(ds)))[1]),
            strict=True,
        )
    )
    assert cells["B1"].text == "needs 99 rows"
    assert compared(ds, ds)["outputs"]["life"]["b_lives"]["B1"]["difference"]["value"] is None
    assert expected_widths(Result(ds))["life"].quantiles[0.001] is None


def outcomes_of(ds):
    return outcomes(Result(ds), summarise(Result(ds)))


def test_a_fitted_life_beyond_the_rows_is_called_extrapolated():
    fits = api.life_fits(lives(60), "life", ["weibull", "lognormal"])
    assert (fits["refused"] == "").all() and fits["assumes"].str.contains(
        "no proof|not tested"
    ).all()
    assert fits["B1_extrapolated"].all() and not fits["B10_extrapolated"].any()
    (extrapolated,) = api.life_fits(lives(120), "life", ["weibull"])["B1_extrapolated"]
    assert not extrapolated


def test_laws_stand_side_by_side(uq, folder):
    write(lives(60), Path("life.nc").absolute())
    lines = uq("summary", "life.nc", "--fits").out.splitlines()
    head = next(line for line in lines if "weibull" in line)
    assert "lognormal" in head
    b1 = next(line for line in lines if "B1, extrapolated" in line)
    assert b1.count(" to ") == 2
    assert "no proof" in " ".join(" ".join(lines).split())


def test_inputs_of_a_regime_of_few_rows_have_no_outer_quantiles():
    ds = kinds(samples=8, analysis={"outputs": ["regime"]})
    input_quantiles = api.regimes(ds)["input_quantile"].isel(regime=0, parameter=0)
    assert np.isnan(input_quantiles.sel(probability=[0.05, 0.95])).all()
    assert np.isfinite(input_quantiles.sel(probability=0.5))


def test_the_expected_width_counts_a_life_censored_at_the_threshold_as_above_it():
    """As every statistic does: it has not ended there."""
    values = np.repeat([1.0, 3.0], 32)
    widths = []
    for at in (2.0, 3.0):
        ds = with_output(linear(samples=64), "life", values, "lifetime", censored=values == 3.0)
        asked = asking(ds, outputs=["life"], thresholds={"life": [at]})
        widths.append(expected_widths(Result(asked))["life"].thresholds[at])
    assert widths[0] == widths[1]
