"""The answer where regimes intermingle, inputs are tied, or the rows follow no law."""

import re

import numpy as np
import pytest
from computed import UNIFORM, asking, computed, linear, study_of, with_output

import uq
from uq.assess.answer.answer import answer
from uq.assess.answer.contributions import Contribution
from uq.assess.answer.leading_level import intermingled
from uq.assess.answer.rankings import Ranking
from uq.assess.answer.wording import assumptions, mark_of, source_of
from uq.render.html.answer import fragment
from uq.result.result import Result
from uq.stats.estimate import Estimate


def test_intermingled_regimes_say_how_little_better_known_inputs_tell():
    assert intermingled(Estimate(0.5, 0.4, 0.6)).sentence == (
        "The regimes are intermingled: with half the uncertainty of all inputs, 70.7 % (66.0 to"
        " 75.8 %) of the uncertain outcomes would remain uncertain, against 50 % at smooth"
        " boundaries (uncertainty exponent 0.5)."
    )


@pytest.mark.parametrize("exponent", [Estimate(0.9, 0.8, 1.0), Estimate(0.5), Estimate(reason="")])
def test_a_boundary_that_may_be_smooth_is_not_called_intermingled(exponent):
    assert intermingled(exponent).members == {}


def tied():
    tables = {
        "study": {"name": "tied", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 200, "seed": 1},
        "uncertain": {"x1": UNIFORM, "x3": UNIFORM, "x4": {"equals": "x3"}},
        "analysis": {"outputs": ["y"]},
    }
    return computed(study_of(tables))


def test_an_input_that_leads_names_those_that_equal_it():
    conclusions = answer(tied())
    assert conclusions.lead.ranking.leader.inputs == ("x3",)
    assert conclusions.ties == "x4 equals x3 in every row."
    assert conclusions.ties in repr(conclusions) and conclusions.ties in fragment(conclusions)
    assert answer(linear(samples=200)).ties == ""


def test_screening_ranks_in_the_unit_of_the_output_and_says_what_it_cannot_promise():
    ds = linear("morris", samples=10, replicates=4)
    ds = with_output(ds, "depth", 0.003 * ds["x4"].values ** 2 * (1 + ds["x1"].values))
    ds = asking(ds, outputs=["depth"])
    conclusions = answer(ds)
    assert conclusions.lead.tolerance_bound is None and conclusions.lead.range is None
    assert re.fullmatch(
        r"x4 contributes most: [\d.]+ µm \([\d.]+ to [\d.]+\)\.", conclusions.lead.ranking.sentence
    )
    (rows,) = [advice.text for advice in conclusions.advice if advice.rule == "rows"]
    assert rows == (
        "To obtain a bound: the rows of a 'morris' design do not follow the laws of the"
        " inputs; use 'monte-carlo'."
    )


def piled(at):
    """A depth that three in ten rows reach, as far as it is followed."""
    ds = linear(samples=400)
    depth = np.minimum(ds["x4"].values, at)
    return asking(with_output(ds, "depth", depth), outputs=["depth"], wanted={"depth": "below"})


def test_no_bound_is_promised_that_no_row_can_exceed():
    tolerance_bound = answer(piled(0.7)).lead.tolerance_bound
    share = 100 * (linear(samples=400)["x4"].values >= 0.7).mean()
    text = f"{share:.1f} % of the rows have the largest value, 0.7 m"
    assert tolerance_bound.sentence == f"{text}: values may be truncated there."
    assert tolerance_bound.basis == ""
    traced = uq.trace(piled(0.7), "answer/quantities/depth/promise/share_at_largest")
    assert traced["value"] == pytest.approx(share / 100)
    assert [estimator["code"].rpartition(".")[2] for estimator in traced["estimators"]] == ["piles"]
    assert "do not exceed" not in repr(answer(piled(0.7)))
    assert "at least 95 % of values are below" in answer(piled(1.0)).lead.tolerance_bound.sentence


def test_inputs_that_may_have_no_effect_are_alternatives():
    both = (Estimate(0.4), Estimate(0.3))
    contribution = Contribution(("x_1", "x_2"), both, True, doubtful=("x_2",))
    assert contribution.words == "x 1 or x 2" and contribution.sure == ("x_1",)
    ranking = Ranking("y", "rbd-fast", contributions=(contribution,))
    assert ranking.sentence == "x 1 or x 2 may contribute most: 40 % and 30 %."
    assert Contribution(("x_1", "x_2"), both, True).words == "both xes"


def test_assumed_laws_and_values_are_listed():
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 20, "seed": 1},
        "uncertain": {
            "rate": {"distribution": "lognormal", "median": 2e-10, "sigma": 0.5}
            | {"source": "assumed: a guess"},
            "depth": {"distribution": "lognormal", "median": 2.5e-4, "sigma": 0.1}
            | {"source": "of a drawing"},
        },
    }
    conclusions = answer(computed(study_of(tables)))
    assert conclusions.assumptions[0] == "1 of 2 laws is assumed: rate."
    assert conclusions.assumptions[-1] == (
        "Laws whose source does not say given, measured, inferred, fitted, assumed or chosen:"
        " depth."
    )
    assert "Assumptions</summary><ul><li>1 of 2 laws" in fragment(conclusions)


def test_a_law_without_a_source_is_known_no_better_than_an_assumed_nominal_value():
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 20, "seed": 1},
        "uncertain": {
            "rate": {"distribution": "lognormal", "median": 2e-10, "sigma": 0.5},
            "depth": {"distribution": "lognormal", "median": 2.5e-4, "sigma": 0.1},
        },
    }
    result = Result.of(computed(study_of(tables)))
    result.dataset["rate"].attrs["source"] = "given: the supplier"
    result.dataset["depth"].attrs["source"] = "assumed: the default of the function"
    assert [mark_of(result, name) for name in ("rate", "depth")] == ["", "assumed"]
    assert source_of(result, "rate") == "none; its nominal value: given: the supplier"
    assert assumptions(result)["laws_without_source"].members["inputs"] == ["rate"]
