"""The tables of a report: each number with its unit and interval, no row of the study left out."""

import numpy as np
import pytest
from computed import (
    UNIFORM,
    asking,
    computed,
    kinds,
    linear,
    study_of,
    summarised,
    with_output,
    with_status,
)
from wordings import sentence

from uq import plots
from uq.assess.answer.answer import answer
from uq.assess.answer.wording import unit_for
from uq.assess.findings import Findings
from uq.assess.statistic import Statistic
from uq.assess.summary import summarise
from uq.contract import Status
from uq.render.html.cells import Cell, HtmlTable, cell, without_empty_columns
from uq.render.html.convergence import convergence_of
from uq.render.html.embedded_rows import rows_inside
from uq.render.html.indices import sensitivity_of
from uq.render.html.inputs import _quantiles, fixed_inputs, input_tables
from uq.render.html.outcomes import category_table, outcomes, result_tables, status_table
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.text.units import typical

DAY = 86400.0


def lines(table):
    """Return the rows of a table by their first cell, each as header -> text."""
    return {
        row[0].text: {name: cell.text for name, cell in zip(table.header, row, strict=True)}
        for row in table.rows
    }


def lives(censored=0, **analysis):
    """Return a result with lives of 5 to 15 days, of which the last are censored or never end."""
    values = np.r_[np.linspace(5, 15, 54) * DAY, np.full(10, np.inf)]
    flags = np.arange(64) < 54
    flags[: 54 - censored] = False
    ds = with_output(linear(samples=64), "life", values, "lifetime", flags)
    return asking(ds, outputs=["life", "y"], **analysis)


def results_of(ds, caption):
    """Return the one table whose caption begins so."""
    tables = result_tables(outcomes(Result(ds), summarise(Result(ds))))
    (table,) = (results for results in tables if results.caption.startswith(caption))
    return table


def test_statistics_are_in_the_unit_of_their_line():
    ds = lives()
    table = results_of(ds, "Statistics")
    life, y = lines(table).values()
    median = summarised(ds)["outputs"]["life"]["quantiles"]["0.5"]
    assert life["unit"] == "days" and life["50 % quantile"] == f"{median['value'] / DAY:.5g}"
    assert (life["mean"], life["never"]) == ("-", "10")
    assert y["unit"] == "" and y["mean"] == f"{float(ds['y'].mean()):.5g}"
    cell = table.rows[0][table.header.index("50 % quantile")]
    assert cell.more == f"{median['low'] / DAY:.5g} to\u00a0{median['high'] / DAY:.5g}"
    assert cell.key == median["value"]  # lines of other units sort among each other


def test_tolerance_bounds_say_what_is_covered_and_how_surely():
    bounds = {"coverage": 0.8, "confidence": 0.95}
    table = results_of(lives(tolerance=bounds), "Tolerance bounds")
    assert table.caption == (
        "Tolerance bounds: with 95 % confidence each, 80 % of all are above the lower, and 80 %"
        " below the upper"
    )
    assert lines(table)["life"]["upper"] == "never"
    assert 5 < float(lines(table)["life"]["lower"]) < 7


def test_probabilities_stand_on_their_side_of_the_threshold():
    table = results_of(lives(thresholds={"life": [7 * DAY]}), "Probabilities")
    ((_, threshold, above, below),) = table.rows
    assert (threshold.text, threshold.key) == ("7 days", 7 * DAY)
    assert float(above.text) == pytest.approx(53 / 64, abs=1e-4)
    assert float(below.text) == pytest.approx(11 / 64, abs=1e-4)


def test_undefined_rows_have_a_column_beside_both_probabilities():
    ds = kinds(samples=100, analysis={"outputs": ["angle"], "thresholds": {"angle": "30 degrees"}})
    table = results_of(ds, "Probabilities")
    line = lines(table)["angle"]
    share = float(np.isnan(ds["angle"].values).mean())
    assert line["undefined"] == f"{100 * share:.1f} %" and line["threshold"] == "magnitude 30°"
    assert float(line["P(above)"]) + float(line["P(below)"]) + share == pytest.approx(1, abs=1e-3)
    whole = results_of(lives(thresholds={"life": [7 * DAY]}), "Probabilities")
    assert "undefined" not in whole.header


def test_a_probability_that_assumes_something_says_so():
    ds = lives(censored=30, thresholds={"life": [14 * DAY]})
    entry = summarised(ds)["outputs"]["life"]["thresholds"][f"{14 * DAY!r}"]
    table = results_of(ds, "Probabilities")
    line = lines(table)["life"]
    assert line["note"].startswith(entry["reason"]) and "Kaplan-Meier" in line["note"]
    assert line["P(below)"] == f"{entry['kaplan_meier']['below']['value']:.5g}"


def test_b_lives_are_beside_the_rows_that_did_not_end():
    ds = lives(censored=3)
    line = lines(results_of(ds, "B-lives"))["life"]
    assert line["unit"] == "days" and 5 < float(line["B10"]) < 7
    assert (line["rows never ending"], line["rows censored"]) == ("10", "3")


def test_the_status_table_is_of_all_rows():
    ds = with_status(linear("saltelli", 8, 2), [0, 1], Status.OUT_OF_BUDGET)
    ds["status"].attrs["example_out_of_budget"] = "row 0: too long"
    line = lines(status_table(Result(ds), summarise(Result(ds))))["out-of-budget"]
    assert (line["rows"], line["share"]) == ("2", "2.1 %")  # of 96, of which 32 are independent
    assert line["first message"] == "row 0: too long"


def test_shares_of_regimes_have_their_interval():
    ds = kinds(samples=50)
    summary = summarise(Result(ds))
    label, rows, share = category_table("regime", summary.regimes).rows[0]
    low, high = (100 * getattr(summary.regimes["slow"].estimate, end) for end in ("low", "high"))
    assert (label.text, rows.text) == ("slow", "25")
    assert (share.text, share.more) == ("50.0 %", f"{low:.1f} to {high:.1f} %")


def test_inputs_are_given_as_stated_and_as_the_rows_have_them():
    uncertain = {
        "x1": UNIFORM | {"source": "a book: fitted"},
        "x2": {"equals": "x1"},
        "x4": {"distribution": "uniform", "lower": 0.4, "upper": 0.6, "times": "x1"},
    }
    ds = computed(
        study_of(
            {
                "study": {"name": "inputs", "model": "linear"},
                "design": {"method": "sobol", "samples": 1024},
                "uncertain": uncertain,
            }
        )
    )
    (table,) = input_tables(Result(ds))
    rows = lines(table)
    assert (rows["x1"]["known"], rows["x1"]["source"]) == ("fitted", "a book: fitted")
    assert float(rows["x1"]["95 %"]) == pytest.approx(0.95, abs=2e-3)
    assert rows["x2"]["law"] == "equals x1" and rows["x2"]["50 %"] == ""
    assert rows["x4"]["law"] == "x1 times uniform: lower 0.4, upper 0.6"
    assert float(rows["x4"]["50 %"]) == pytest.approx(0.5, abs=2e-3)  # of the factor


@pytest.mark.parametrize(
    ("units", "quantiles", "texts"),
    [
        ("rad s-1", [156.742, 157.0, 157.258], ["156.74 rad s⁻¹", "157.00 rad s⁻¹"]),
        ("m", [2.09e-4, 2.5e-4, 2.91e-4], ["209 µm", "250 µm"]),
        ("1", [0.2467, 0.295, 0.3435], ["0.247", "0.295"]),
        ("N", [5.0, 5.0, 5.0], ["5 N", "5 N"]),
        ("m s-1", [-1.8, -0.07, 1.79], ["-1.8 m s⁻¹", "-0.1 m s⁻¹"]),
    ],
)
def test_quantiles_of_an_input_can_be_told_apart(units, quantiles, texts):
    cells = _quantiles("x", unit_for(units, typical(quantiles)), np.array(quantiles))
    assert [cell.text.replace("\u00a0", " ") for cell in cells][:2] == texts


def test_an_input_has_one_prefix_in_sentences_tables_figures_and_controls():
    rate = {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}
    ds = computed(
        study_of(
            {
                "study": {"name": "skewed", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 400},
                "uncertain": {"rate": rate},
                "analysis": {"thresholds": {"life": "9 days"}},
            }
        )
    )
    assert ds["rate"].max() > 1e-9  # which would be read in nm s⁻¹
    assert (
        lines(next(input_tables(Result(ds))))["rate"]["law"]
        == "lognormal: median 250 pm s⁻¹, sigma 0.5"
    )
    (event,) = answer(ds).events
    for figure in (
        plots.scatter(ds, "life"),
        plots.inputs(ds),
        plots.event_probability(ds, event.name),
    ):
        assert figure.axes[0].get_xlabel().endswith("[pm s⁻¹]")
    assert rows_inside(Findings(Result(ds)), "a.nc")["columns"][0]["after"] == " pm\u00a0s⁻¹"
    assert event.over_unit.name == "pm s⁻¹"


@pytest.mark.parametrize(
    ("copula", "caption"),
    [
        ({}, "Rank correlations: a guess"),
        (
            {"copula": "clayton", "survival": True},
            "Rank correlations, survival Clayton copula: a guess",
        ),
        (
            {"copula": "student", "degrees_of_freedom": 4.0},
            "Rank correlations, Student's copula with 4 degrees of freedom: a guess",
        ),
    ],
)
def test_fixed_inputs_have_units_and_correlations_a_source(copula, caption):
    dependence = copula | {
        "parameters": ["rate", "threshold"],
        "rank_correlation": [[1.0, 0.5], [0.5, 1.0]],
        "source": "a guess",
    }
    uncertain = {
        "rate": {"distribution": "lognormal", "median": 1e-9, "sigma": 0.1},
        "threshold": {"distribution": "uniform", "lower": 0.1, "upper": 0.2},
    }
    ds = computed(
        study_of(
            {
                "study": {"name": "inputs", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 16},
                "uncertain": uncertain,
                "dependence": dependence,
            }
        )
    )
    laws, ranks = input_tables(Result(ds))
    fixed = fixed_inputs(Result(ds))
    assert lines(laws)["threshold"]["law"] == "uniform: lower 0.1 m s⁻¹, upper 0.2 m s⁻¹"
    assert ranks.caption == caption
    assert [[cell.text for cell in row] for row in ranks.rows] == [["threshold, rate", "0.5"]]
    assert lines(fixed)["depth"]["value"] == "250\u00a0µm"


def test_indices_are_ranked_beside_an_input_without_effect():
    ds = asking(linear(samples=200, settings={"fail_above": 0.95}), sensitivity=["rbd-fast"])
    ((used, subjects),) = sensitivity_of(Findings(Result(ds))).values()
    lost = int(ds["y"].isnull().sum())
    assert lost > 0
    assert used.startswith(f"from {200 - lost} rows; {lost} groups with missing")
    (table,) = subjects[0].tables
    names = [row[0].text for row in table.rows]
    nulls = ["(an input without effect)", "(largest of 4 such inputs)"]
    assert names == ["x4", "x3", "x2", "x1", *nulls]
    smaller, largest = (float(row[1].text) for row in table.rows[-2:])
    assert largest >= smaller


def test_indices_have_their_intervals_and_no_dropped_groups_without_need():
    result = Result(linear("saltelli", samples=32, replicates=4))
    ((used, subjects),) = sensitivity_of(Findings(result)).values()
    assert used == "from 768 rows"
    first, *_ = subjects[0].tables[0].rows
    low, high = map(float, first[1].more.split(" to "))
    assert low < float(first[1].text) < high


def test_errors_of_the_rows_stand_beside_that_of_sampling_in_one_unit():
    ds = with_output(lives(), "life_error", np.full(64, 0.5 * DAY), "lifetime")
    section = convergence_of(Findings(Result(ds)), outcomes(Result(ds), summarise(Result(ds))))
    line = lines(section["table"])["life"]
    assert (line["unit"], line["error of the rows"]) == ("days", "0.5")
    assert float(line["half-width of the interval"]) == pytest.approx(1.6, abs=0.1)
    assert section["warnings"] == [] and section["refused"] == ""


def test_rows_less_exact_than_their_number_are_warned_of():
    ds = with_output(linear("latin-hypercube", 16, 4), "y_error", np.ones(64))
    section = convergence_of(Findings(Result(ds)), outcomes(Result(ds), summarise(Result(ds))))
    (warning,) = section["warnings"]
    assert warning.startswith("y: numerical error (1 1) exceeds")
    assert sentence("no fewer samples") in section["refused"] and section["pictures"] == []


def test_numbers_of_a_kind_have_bars_on_one_scale():
    cells = [
        Cell("2", key=2.0, scale="m", ends=(1.0, 4.0)),
        Cell("1", key=-1.0, scale="m"),
        Cell("0.5", key=0.5, scale="share"),
        Cell("7", key=7.0),
        Cell("never", key=np.inf, scale="m"),
    ]
    table = HtmlTable("", ("",) * 5, [tuple(cells)])
    assert table.scales == {"share": (0.0, 1.0), "m": (-1.0, 4.0)}
    of_two, of_less, of_share, none, never = (
        cell_of_row.bar(table.scales) for cell_of_row in cells
    )
    assert "left:20.0%;width:40.0%" in of_two and "left:40.0%;width:60.0%" in of_two  # with ends
    assert "left:0.0%;width:20.0%" in of_less and "bar-ends" not in of_less
    assert "left:0.0%;width:50.0%" in of_share and none == never == ""


def test_probabilities_and_quantiles_have_bars():
    ds = lives(thresholds={"life": [7 * DAY]})
    scales = {
        cell_of_row.scale
        for cell_of_row in results_of(ds, "Probabilities").rows[0]
        if cell_of_row.scale
    }
    assert scales == {"share"}
    table = results_of(ds, "Statistics")
    marked = {
        h
        for h, cell_of_row in zip(table.header, table.rows[0], strict=True)
        if cell_of_row.scale == "s"
    }
    assert marked >= {"5 % quantile", "50 % quantile"} and "never" not in marked


def test_what_never_ends_sorts_last_and_what_says_nothing_is_left_out():
    never = cell(Statistic(("life",), "life", Estimate(np.inf, 1.0, np.inf)))
    assert (never.text, never.more, never.key) == ("never", "1 to\u00a0never", np.inf)
    table = HtmlTable("", ("name", "empty", "full"), [(Cell("a"), Cell("-"), Cell("1"))])
    assert without_empty_columns(table).header == ("name", "full")
