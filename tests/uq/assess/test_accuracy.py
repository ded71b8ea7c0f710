"""Rows whose stated error exceeds the accuracy that the study asked for."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import pytest
import sample_models
from computed import asking, computed, linear, study_of, summarised, with_output

import uq
from uq.assess.statistic import Context
from uq.assess.statistics.counts import accuracy
from uq.assess.summary import summarise
from uq.cli.summary_tables import show_summary
from uq.contract import Output, Setting
from uq.render.html.outcomes import outcomes, result_tables
from uq.result.elements import elements_of
from uq.result.result import Result


@dataclass(frozen=True)
class Asking:
    """An accuracy of each value."""

    accuracy: Annotated[float, Setting("relative", bounds=(0.0, 1.0))] = 0.05


def _rough(x, seed, settings):
    return {"y": 1 + x[:, :1], "y_error": 0.1 * x[:, :1]}, np.zeros(len(x), np.int8)


ROUGH = replace(
    sample_models.KINDS,
    name="rough",
    settings=Asking,
    outputs={
        "y": Output("m", "some length", dims=("side",), accuracy="accuracy"),
        "y_error": Output("m", "error of it", dims=("side",)),
    },
    batch=_rough,
    coordinates=lambda settings: {"side": ("left",)},
    simulate=None,
)


def accuracy_of(ds, name):
    """Return what is said of the accuracy of an output without dimensions."""
    (element,) = elements_of(ds, [name])
    (statistic,) = accuracy(element, Context(Result(ds), Result(ds).analysis))
    return statistic.facts["accuracy"]


def rough(accuracy=0.04):
    """Return a result whose rows are off by 0.1 x1 in 1 + x1: more than 0.04 of it from 2/3 on."""
    uniform = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    tables = {
        "study": {"name": "rough", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 60},
        "uncertain": {"x1": uniform, "x2": uniform},
        "settings": {"accuracy": accuracy},
    }
    return computed(study_of(tables, "test_accuracy:ROUGH"))


def with_errors(values, errors, asked=0.1, **more):
    ds = with_output(linear(samples=len(values)), "life", values, **more)
    ds["life"].attrs["accuracy"] = asked
    return with_output(ds, "life_error", errors)


def test_a_result_carries_the_accuracy_asked_for():
    ds = rough(0.03)
    assert ds["y"].attrs["accuracy"] == 0.03
    assert "accuracy" not in ds["y_error"].attrs


def test_rows_beyond_the_accuracy_are_counted_and_reported(capsys):
    ds = rough()
    expected = int((ds["x1"] > 2 / 3).sum())
    assert 0 < expected < 60
    summary = summarise(Result(ds))
    assert summarised(ds)["outputs"]["y[side=left]"]["accuracy"] == {
        "asked": 0.04,
        "rows": 60,
        "missed": expected,
        "share": expected / 60,
    }
    show_summary(Result(ds), summary)
    share = f"{100 * expected / 60:.1f} %"
    assert f"accuracy 0.04 not reached in {expected} rows ({share})" in capsys.readouterr().out
    assert uq.summary(ds).loc["y[side=left]", "accuracy_missed"] == expected
    table = next(result_tables(outcomes(Result(ds), summary)))
    column = table.header.index("rows short of the accuracy")
    assert (table.rows[0][column].text, table.rows[0][column].more) == (str(expected), share)


def test_nothing_is_reported_where_every_row_reaches_its_accuracy(capsys):
    ds = rough(0.05)
    assert summarised(ds)["outputs"]["y[side=left]"]["accuracy"]["missed"] == 0
    show_summary(Result(ds), summarise(Result(ds)))
    assert "not reached" not in capsys.readouterr().out


def test_rows_that_never_end_or_are_censored_or_failed_have_no_accuracy():
    values = [1.0, 1.0, np.inf, 1.0, np.nan, 1.0]
    errors = [0.2, np.nan, np.nan, np.nan, np.nan, 0.05]
    ds = with_errors(values, errors, kind="lifetime", censored=[0, 0, 0, 1, 0, 0])
    accuracy = accuracy_of(ds, "life")
    assert (accuracy["rows"], accuracy["missed"]) == (3, 2)


@pytest.mark.parametrize("values", [[np.inf, np.inf]])
def test_without_a_finite_life_there_is_no_share(values):
    ds = with_errors(values, [np.nan, np.nan], kind="lifetime", censored=[0, 0])
    assert accuracy_of(ds, "life")["share"] is None


def test_outputs_of_which_no_accuracy_is_asked_say_nothing_of_one():
    ds = asking(with_output(linear(), "y_error", np.ones(64)), outputs=["y"])
    assert "accuracy" not in summarised(ds)["outputs"]["y"]
