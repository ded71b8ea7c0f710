"""A lifetime whose end is a success is not spoken of as a life."""

import numpy as np
import pytest
from computed import asking, linear, summarised, with_output
from drawn import words

from models import vibrator
from uq import plots
from uq.assess.answer.answer import answer
from uq.assess.summary import summarise
from uq.render.html.outcomes import outcomes, result_tables
from uq.result.result import Result
from uq.result.variables import outputs_of


@pytest.fixture
def locking():
    """Return a result with times of synchronisation."""
    ds = with_output(linear(samples=200), "locking", np.linspace(1.0, 3.0, 200), "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    study = {"thresholds": {"locking": 2.0}, "outputs": ["locking"]}
    return asking(ds, **study, tolerance={"coverage": 0.9, "confidence": 0.9})


def test_the_axes_say_what_has_happened(locking):
    figure = plots.lifetime(locking, "locking")
    assert "Probability that the motors have locked" in words(figure)
    (other,) = figure.axes[0].child_axes
    assert other.get_ylabel() == "Probability that it has\nnot happened yet"
    assert "1, 10, 50 % quantiles" in words(figure) and "B10" not in words(figure)


def test_the_latest_time_is_promised(locking):
    parts = summarise(Result(locking)).outputs["locking"].parts
    labels = [statistic.label for statistic in parts["b_lives"]]
    assert "10 % by" in labels and "B10" not in labels
    assert "B10" in summarised(locking)["outputs"]["locking"]["b_lives"]  # a key is kept
    lead = answer(locking).lead
    assert np.isnan(lead.tolerance_bound.lower) and np.isfinite(lead.tolerance_bound.upper)
    assert any("succeed within 2 s" in str(event) for event in lead.events)


def test_the_vibrator_declares_its_success(locking):
    assert outputs_of(locking)["locking"].success == "the motors have locked"
    assert vibrator.MODEL.outputs["synchronisation_time"].success


def test_a_report_speaks_of_success(locking):
    table = next(
        found_table
        for found_table in result_tables(outcomes(Result(locking), summarise(Result(locking))))
        if found_table.caption.startswith("Times by which")
    )
    assert table.header[2:5] == ("1 % by", "10 % by", "50 % by")
    never = locking.copy(deep=True)
    never["locking"][:100] = np.inf
    tolerance_bound = answer(asking(never, outputs=["locking"])).lead.tolerance_bound
    assert tolerance_bound.reason == "" or tolerance_bound.reason == "more than 5 % may not succeed"
    tables = list(result_tables(outcomes(Result(never), summarise(Result(never)))))
    assert any("rows never succeeding" in shown.header for shown in tables)
