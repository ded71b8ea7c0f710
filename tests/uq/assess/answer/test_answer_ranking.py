"""What inputs contribute: each sentence of the answer against its numbers."""

import re

import answered
import numpy as np
import pytest
from answered import numbers
from computed import (
    asking,
    computed,
    linear,
    study_of,
    with_output,
)

from uq.assess.answer.answer import answer
from uq.assess.answer.contributions import AverageEffect
from uq.assess.sensitivities import sensitivities
from uq.indices.given_data import HSIC
from uq.result.nesting import first_samples
from uq.result.result import Result
from uq.stats.estimate import Estimate


@pytest.fixture(scope="module")
def lifetime():
    return answered.lifetime()


def test_a_contribution_has_size_and_direction(lifetime):
    _, conclusions = lifetime
    first = conclusions.lead.ranking.contributions[0]
    assert first.inputs == ("rate",) and first.indices[0].low < 25 / 26 < first.indices[0].high
    (by,) = numbers("10 % more shortens it by # %", first.effect)  # exactly: depth over rate
    assert by == pytest.approx(100 - 100 / 1.1, abs=0.01)
    assert conclusions.lead.ranking.sentence.startswith("Rate contributes most: 9")


def test_inputs_that_indices_do_not_tell_apart_are_named_together():
    ds = linear("saltelli", samples=64, replicates=4)
    ds = with_output(ds, "even", ds["x1"].values + ds["x2"].values)
    ranking = answer(asking(ds, outputs=["even"])).lead.ranking
    assert set(ranking.contributions[0].inputs) == {"x1", "x2"}
    assert ranking.sentence.startswith(("x1 and x2 contribute most", "x2 and x1 contribute most"))


def test_an_effect_without_a_direction_has_no_size():
    assert AverageEffect(0, "10 %", Estimate(1.0, -1.0, 3.0)).sentence() == "no clear direction"
    assert AverageEffect(1).sentence("rate") == "more rate raises it"


def test_a_large_design_ranks_inputs_by_its_first_rows(monkeypatch):
    ds = linear(samples=400)
    monkeypatch.setattr("uq.result.nesting.RANKED", 300)
    few = answer(ds).lead.ranking
    alone = answer(first_samples(ds, 300)).lead.ranking
    assert few.contributions == alone.contributions
    assert few.index_meaning == f"{alone.index_meaning}, by the first 300 rows"


def test_an_index_that_is_not_settled_ranks_nothing_and_says_what_would_settle_it():
    rng = np.random.default_rng(0)
    ds = linear("saltelli", samples=8, replicates=4)
    ds = with_output(ds, "wild", rng.standard_cauchy(ds.sizes["row"]).clip(-50, 50))
    conclusions = answer(asking(ds, outputs=["wild"]))
    assert conclusions.lead.ranking.leader is None and conclusions.lead.ranking.rows_factor > 1
    assert "not settled" in conclusions.lead.ranking.sentence
    (rows,) = [advice for advice in conclusions.advice if advice.rule == "rows"]
    match = re.match(
        r"Compute (?:about|more than) ([\d ]+) rows \([\d ]+ samples\) instead of (\d+): ",
        rows.text,
    )
    assert int(match[1].replace(" ", "")) >= rows.rows - 1 > int(match[2])


def test_what_decides_that_an_angle_is_too_large_is_that_of_its_magnitude():
    ds = linear(samples=600)
    sign = np.where(ds["x1"].values > 0.5, 1.0, -1.0)
    ds = with_output(ds, "turn", sign * (0.2 + 0.3 * ds["x4"].values), "angle")
    ds["turn"].attrs["units"] = "rad"
    lead = answer(asking(ds, outputs=["turn"], thresholds={"turn": 0.4})).lead
    assert lead.ranking.leader.inputs == ("x1",)  # of the signed value, as it says
    assert lead.ranking.index_meaning.endswith("of the angle with its sign")
    assert "raises its signed value" in lead.ranking.leader.effect
    (event,) = lead.events
    assert event.decided_by.startswith(
        "Main driver: x4. Over x4, the share ranges from 0 % below 0."
    )


def test_an_angle_beyond_a_limit_on_either_side_is_not_ranked_by_what_single_inputs_explain():
    """Each of four inputs raises it on one side and lowers it on the other: S1 sees neither."""
    ds = linear(samples=1000)
    signed = sum(ds[f"x{i}"].values - 0.5 for i in range(1, 5))
    ds = with_output(ds, "turn", 0.3 * signed, "angle")
    ds["turn"].attrs["units"] = "rad"
    ds = asking(ds, outputs=["turn"], thresholds={"turn": 0.3})
    (event,) = answer(ds).lead.events
    assert event.ranking.leader is None and np.isnan(event.ranking.rows_factor)
    _, left, low, high = numbers(
        "No single input explains much alone: S1 is at most #, and single inputs leave"
        r" # % \(# to # %\) unexplained; method hsic-target shows which inputs matter.",
        event.decided_by,
    )
    assert 50 < low < left < high
    by_kernel = sensitivities(Result(ds), "hsic-target", event.name).targets[event.name]
    hsic = by_kernel.indices.values[HSIC]
    assert min(index.value for index in hsic.values()) > by_kernel.indices.nulls[HSIC].limit


@pytest.mark.parametrize(("cv", "step"), [(0.2, "10 %"), (0.03, "1 %"), (0.004, "0.1 %")])
def test_an_input_is_changed_within_its_scatter(cv, step):
    tables = {
        "study": {"name": "pads", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 200},
        "uncertain": {"rate": {"distribution": "lognormal", "mean": 1e-9, "cv": cv}},
    }
    (change,) = answer(computed(study_of(tables))).lead.ranking.leader.changes
    assert change.step == step
