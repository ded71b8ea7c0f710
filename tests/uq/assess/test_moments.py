"""Means, standard deviations and their intervals, as far as they exist."""

from pathlib import Path

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import asking, compared, linear, summarised, with_output
from scipy import stats

from uq.assess.convergence import enough
from uq.assess.expected_widths import expected_widths
from uq.assess.statistics.moments import between_share
from uq.assess.summary import summarise
from uq.assess.summary_table import summary
from uq.cli.summary_tables import show_summary
from uq.files.whole_files import write
from uq.render.html.outcomes import outcomes, result_tables
from uq.result.result import Result
from uq.stats.dependent_rows import Dependence
from uq.stats.intervals import ONE_ROW
from uq.stats.moments import moments, sd_interval, standard_deviation

NOTHING = {"low": None, "high": None}


def heavy(index, rows=1000, **of_design):
    """Return a result whose output z follows Pareto's law."""
    ds = linear(samples=rows // of_design.get("replicates", 1), **of_design)
    values = stats.pareto(index).rvs(rows, random_state=3)
    return asking(with_output(ds, "z", values), outputs=["z"])


def test_a_mean_without_variance_has_no_interval_and_no_sd():
    entry = summarised(heavy(1.5))["outputs"]["z"]
    assert entry["mean"] is not None and entry["mean_interval"] == NOTHING
    assert entry["sd"] is None and entry["sd_interval"] == NOTHING
    assert entry["tail"]["side"] == "upper" and entry["tail"]["values"] == 400
    assert entry["tail"]["low"] < 1 / 1.5 < entry["tail"]["high"]
    assert "no variance" in entry["reasons"]["mean_interval"] == entry["reasons"]["sd"]
    assert "logarithm" in entry["reasons"]["sd"]


def test_a_mean_of_which_few_rows_decide_is_covered():
    """A tenth of 100 rows is exponential, the others are 0: Student's interval covers 87 %."""
    rng = np.random.default_rng(1)
    rows = [np.where(rng.random(100) < 0.9, 0.0, rng.exponential(size=100)) for _ in range(400)]
    means = [moments(values).mean for values in rows]
    assert sum(mean.low <= 0.1 <= mean.high for mean in means) >= 0.92 * 400


def test_a_mean_whose_variance_is_open_comes_with_a_caution(capsys):
    """Of 200 such samples the interval misses in a quarter, mostly beside a caution."""
    rng, law = np.random.default_rng(8), stats.pareto(1.5)
    estimates = [moments(law.rvs(200, random_state=rng)) for _ in range(200)]
    plain = [estimate for estimate in estimates if not estimate.mean.reason]
    missed = [estimate for estimate in plain if not estimate.mean.low <= 3.0 <= estimate.mean.high]
    assert (
        len(missed) > 30 and sum(estimate.caution is None for estimate in missed) <= len(missed) / 3
    )
    assert not any(estimate.caution for estimate in estimates if estimate.mean.reason)
    assert moments(stats.expon().rvs(1000, random_state=rng)).caution is None

    ds = heavy(2.2)
    summary = summarise(Result(ds))
    entry = summarised(ds)["outputs"]["z"]
    assert entry["mean_interval"]["low"] and "too narrow" in entry["caution"]
    (table,) = result_tables(outcomes(Result(ds), summary))
    assert any(entry["caution"] in cell.more for cell in table.rows[0])
    show_summary(Result(ds), summary)
    assert "may be too narrow" in " ".join(capsys.readouterr().out.split())


def test_a_mean_that_does_not_exist_is_refused():
    entry = summarised(heavy(0.8))["outputs"]["z"]
    assert entry["mean"] is None and entry["mean_interval"] == NOTHING
    assert "no mean" in entry["reasons"]["mean"]
    assert entry["quantiles"]["0.5"]["low"] is not None


def test_replicates_do_not_make_a_heavy_tail_light():
    entry = summarised(heavy(1.5, method="latin-hypercube", replicates=8))["outputs"]["z"]
    assert entry["sd"] is None and entry["mean_interval"] == NOTHING


def test_a_light_tail_has_everything():
    entry = summarised(asking(linear(samples=400), outputs=["y"]))["outputs"]["y"]
    assert entry["reasons"] == {}
    assert entry["sd_interval"]["low"] < np.sqrt(30 / 12) < entry["sd_interval"]["high"]
    assert entry["tail"]["k"] < 0


def test_every_reader_reports_it():
    ds, light = heavy(0.8), asking(with_output(linear(samples=1000), "z", np.arange(1000.0)))
    line = summary(ds).loc["z"]
    assert (
        line["tail_k"] > 1 and np.isnan(line[["mean", "mean_low", "sd", "sd_low"]].tolist()).all()
    )
    assert enough(ds, "z").loc["z", "estimate"] == "median"
    assert expected_widths(Result(ds))["z"].mean is None
    z = compared(ds, asking(light, outputs=["z"]))["outputs"]["z"]
    for estimate in (z["mean"]["difference"], z["sd"]["difference"], z["sd"]["ratio"]):
        assert estimate["low"] is None and estimate["high"] is None
    value = between_share(ds["z"].values, np.arange(1000) % 2).value
    assert np.isnan(value)


@pytest.mark.parametrize(
    ("design", "method"),
    [
        ("saltelli", "sobol"),
        ("monte-carlo", "rbd-fast"),
        pytest.param("monte-carlo", "hdmr", marks=pytest.mark.slow),
    ],
)
def test_a_variance_that_does_not_exist_is_not_apportioned(design, method):
    ds = linear(method=design, samples=1024)
    share = stats.rankdata(ds["y"].values) / (ds.sizes["row"] + 1)
    ds = asking(with_output(ds, "z", stats.pareto(1.5).ppf(share)), outputs=["z"])
    entry = sensitivities(ds, method, "z")["outputs"]["z"]
    assert "log(z)" in entry["refused"] and "rank(z)" in entry["refused"]
    for name in ("log(z)", "rank(z)"):
        assert "refused" not in sensitivities(ds, method, name)["outputs"][name]


def test_the_terminal_and_the_report_give_the_reason(uq, folder):
    ds = heavy(0.8)
    write(ds, Path("z.nc").absolute())
    out = " ".join(uq("summary", "z.nc", "--explain", "--full").out.split())
    assert "with k above 1 there is no mean; use quantiles" in out
    table = next(result_tables(outcomes(Result(ds), summarise(Result(ds)))))
    cells = dict(zip(table.header, table.rows[0], strict=True))
    assert cells["mean"].text == "none" and "no mean" in cells["mean"].more
    assert "no mean" not in cells["sd"].more and "no variance" in cells["sd"].more


@pytest.mark.parametrize("law", [stats.uniform(), stats.norm(), stats.expon()])
def test_the_sd_of_replicates_holds_the_truth(law):
    rng, held = np.random.default_rng(0), 0
    for _ in range(200):  # Latin hypercubes of one input
        slices = rng.permuted(np.tile(np.arange(50), (8, 1)), axis=1)
        values = law.ppf((slices + rng.random((8, 50))) / 50).ravel()
        low, high = sd_interval(values, Dependence(np.repeat(np.arange(8), 50)))
        held += low < law.std() < high
    assert held >= 0.91 * 200


def test_replicates_that_agree_have_no_interval_of_sd():
    values, replicates = np.append(np.zeros(50), np.ones(50)), Dependence(np.repeat([0, 1], 50))
    assert np.isnan(sd_interval(values, replicates)).all()


def test_the_sd_of_an_even_design_has_no_bias():
    even = (np.arange(125) + np.random.default_rng(0).random((400, 125))) / 125
    replicates = Dependence(np.repeat(np.arange(8), 125))
    deviations = [standard_deviation(y, replicates) for y in even.reshape(50, 1000)]
    assert np.mean(deviations) == pytest.approx(12**-0.5, rel=1e-4)
    assert standard_deviation(even[0]) == even[0].std(ddof=1)


@pytest.mark.parametrize(("law", "rows"), [(stats.lognorm(1.0), 200), (stats.pareto(6), 200)])
def test_an_interval_of_sd_does_not_depend_on_whether_a_sample_looks_light(law, rows):
    """Of 200 lognormal rows, the few samples that look light hold the truth in a fifth."""
    rng = np.random.default_rng(3)
    deviations = [moments(law.rvs(rows, random_state=rng)).sd for _ in range(200)]
    given = [sd for sd in deviations if not sd.reason]
    assert len(given) >= 0.98 * 200
    assert sum(estimate.low < law.std() < estimate.high for estimate in given) >= 0.91 * len(given)


def test_an_sd_whose_squares_are_equal_has_an_interval_of_the_error_of_its_mean():
    values = np.repeat([0.0, 1.0], 100)
    low, high = sd_interval(values)
    assert 0.5 * (1 - 0.02) < low < 0.5 < high < 0.5 * (1 + 0.02)


def test_one_row_says_why_it_has_no_scatter_and_equal_rows_need_not():
    single, constant = moments(np.array([1.0])), moments(np.ones(80))
    assert single.mean.reason == single.sd.reason == ONE_ROW
    assert constant.mean.reason == constant.sd.reason == ""
    assert constant.sd.value == 0


@pytest.mark.parametrize("size", [1e-200, 1e-160, 1e150, 1e200])
def test_the_size_of_values_changes_no_digit_of_their_scatter(size):
    values = np.random.default_rng(7).normal(size=200)
    small, usual = moments(values * size), moments(values)
    for name in ("mean", "sd"):
        numbers, expected = (getattr(estimates, name).numbers for estimates in (small, usual))
        assert np.array(numbers) / size == pytest.approx(np.array(expected), rel=1e-9)


def test_too_few_independent_rows_give_no_interval_of_the_standard_deviation():
    """Of 50 lognormal rows with sigma 1, the interval would cover 87 %."""
    values = np.random.default_rng(1).normal(size=200)
    assert moments(values).sd.has_interval
    few = moments(values[:199]).sd
    assert not few.has_interval and few.reason.startswith("200 rows are required")
