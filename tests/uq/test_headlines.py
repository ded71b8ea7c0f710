"""The sentences at the top of a report: each true, in the unit of its table, and no bolder."""

import re

import numpy as np
import pytest
from computed import asking, kinds, linear, summarised, with_output

from uq.analysis.findings import Findings
from uq.analysis.summary import summarise
from uq.report.headlines import headlines
from uq.report.indices import sensitivity_of
from uq.report.outcomes import outcomes

DAY = 86400.0


def sentences(ds, methods=(), failed=0):
    summary = summarise(ds)
    return headlines(summary, failed, outcomes(ds, summary), methods)


def subjects(ds, method, outputs):
    (found,) = sensitivity_of(Findings(asking(ds, outputs=outputs, sensitivity=[method])))
    return found.subjects


def test_failed_rows_come_first():
    assert sentences(linear(samples=20))[0] == "All rows were computed."
    assert sentences(linear(samples=20), failed=3)[0] == "3 of 20 rows failed."


def test_the_most_frequent_regime_is_named_first():
    ds = kinds(samples=50)
    ds["regime"][:] = np.repeat([0, 1], [10, 40])
    assert sentences(ds)[1] == "Regimes: fast 80.0 %, slow 20.0 %."


def test_a_median_is_given_in_the_unit_of_its_table_with_its_interval():
    lives = np.r_[np.linspace(5, 15, 54) * DAY, np.full(10, np.inf)]
    ds = with_output(linear(samples=64), "life", lives, "lifetime")
    ds = with_output(ds, "never", np.full(64, np.inf), "lifetime")
    quantile = summarised(ds)["outputs"]["life"]["quantiles"]["0.5"]
    _, y, life, never = sentences(ds)
    numbers = re.fullmatch(
        r"Meaning of life: median (\S+) days \(95 % interval (\S+) to (\S+)\)\.", life
    ).groups()
    known = [quantile[key] / DAY for key in ("value", "low", "high")]
    assert list(map(float, numbers)) == pytest.approx(known, abs=0.5)
    assert re.fullmatch(r"Value of the function: median \S+ \(95 % interval \S+ to \S+\)\.", y)
    assert never == "Meaning of never: median never."
    alone = sentences(linear("sobol", samples=64))[1]  # no replicates, no interval
    assert re.fullmatch(r"Value of the function: median \d\S*\.", alone)


def test_what_the_study_asks_of_an_output_follows_its_median():
    ds = with_output(linear(samples=200), "life", np.linspace(1, 10, 200) * DAY, "lifetime")
    ds = with_output(ds, "turn", np.linspace(-0.5, 0.5, 200), "angle")
    ds = asking(
        ds,
        outputs=["life", "turn", "y"],
        tolerance={"coverage": 0.9, "confidence": 0.95},
        thresholds={"life": 2 * DAY, "turn": 0.4, "y": 5.0},
    )
    life, turn, y = (one.partition("). ")[2] for one in sentences(ds)[1:])
    found = summarised(ds)["outputs"]
    bound = f"{found['life']['tolerance']['lower'] / DAY:.5g}"
    assert life == (
        f"90/95 lower bound: {bound} days. 11.5 % (95 % interval 7.8 to 16.7 %) end within 2 days."
    )
    assert turn == "20.0 % (95 % interval 15.0 to 26.1 %) exceed 0.4 m in magnitude."
    share = found["y"]["thresholds"]["5.0"]["above"]["value"]
    assert y.startswith(f"{100 * share:.1f} % (") and y.endswith(" exceed 5.")
    _, alone = sentences(
        asking(ds, outputs=["life"], quantiles=[0.9], thresholds={"life": 2 * DAY})
    )
    assert alone == "Meaning of life: 11.5 % (95 % interval 7.8 to 16.7 %) end within 2 days."


def test_an_input_matters_most_only_where_the_others_are_known_to_matter_less():
    ds = linear("saltelli", samples=64, replicates=4)
    ds = with_output(ds, "even", ds["x1"].values + ds["x2"].values)
    settled, open_ = (one.leading for one in subjects(ds, "sobol", ["y", "even"]))
    assert re.fullmatch(
        r"Independent input \(x_4\) explains \d+\.\d % of the variance of the .*ST\)\.", settled
    )
    assert re.fullmatch(
        r"The leading input for the meaning of even is not settled"
        r" \(sobol: ST of x[12] is 0\.\d+ to 0\.\d+\)\.",
        open_,
    )


def test_an_input_that_does_little_does_not_lead():
    rng = np.random.default_rng(3)
    ds = linear(samples=2000)
    hardly = with_output(ds, "hardly", 0.6 * ds["x1"].values + rng.normal(size=2000))
    (subject,) = subjects(hardly, "rbd-fast", ["hardly"])
    assert subject.leading.startswith(
        "No single input explains much of the variance of the meaning of hardly (rbd-fast: S1 = 0.0"
    )


def test_an_input_below_those_without_effect_does_not_lead():
    few = with_output(linear(samples=64), "noise", np.random.default_rng(0).random(64))
    (subject,) = subjects(few, "rbd-fast", ["noise"])
    (table,) = subject.tables
    largest, idle = table.rows[0][1].key, table.rows[-1][1].key
    assert 0.05 < largest < idle  # it is a share to speak of, and yet says nothing
    assert subject.leading == ""
