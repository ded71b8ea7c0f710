"""Tolerance bounds that hold for several outputs at once."""

import re

import numpy as np
import pytest
from computed import UNIFORM, as_text, computed, kinds, study_of, summarised
from scipy import stats

import uq
from uq.assess.answer.answer import conclude, verdict
from uq.assess.answer.quantities import quantities
from uq.assess.findings import Findings
from uq.assess.joint_bounds import Needed, rows_needed
from uq.errors import InputError
from uq.result.result import Result
from uq.result.result_file import failed
from uq.stats.order_statistics import joint_bounds, rows_for_bound, tolerance_bounds
from uq.study.definition import study_from_text

DEPENDENCE = {
    "independent": lambda u, v: (u, v),
    "equal": lambda u, v: (u, u),
    "opposite": lambda u, v: (u, 1 - u),
}


def share_within(how, first, second):
    """Return P(both lie below their bounds)."""
    if how == "independent":
        return first * second
    return min(first, second) if how == "equal" else max(first + second - 1, 0.0)


def test_rows_needed_are_those_of_guba_makai_and_pal():
    assert [rows_for_bound(0.95, 0.95, bounds=p) for p in (1, 2, 3, 4)] == [59, 93, 124, 153]


def test_one_bound_is_the_tolerance_bound():
    values = np.random.default_rng(0).standard_normal(500)
    for lost in (0, 3):
        low, high = tolerance_bounds(values, lost, 0.95, 0.95)
        assert joint_bounds([values], lost, 0.95, 0.95) == [high]
        assert joint_bounds([-values], lost, 0.95, 0.95) == [-low]


@pytest.mark.parametrize("lost", [0, 2])
def test_too_few_rows_give_no_bound(lost):
    needed = rows_for_bound(0.95, 0.95, lost, bounds=2)
    values = np.random.default_rng(0).random((2, needed - lost))
    assert np.isfinite(joint_bounds(values, lost, 0.95, 0.95)).all()
    assert np.isnan(joint_bounds(values[:, 1:], lost, 0.95, 0.95)).all()


@pytest.mark.slow
@pytest.mark.parametrize("how", DEPENDENCE)
@pytest.mark.parametrize("rows", [93, 500])
def test_bounds_hold_at_once_in_95_percent(how, rows):
    rng = np.random.default_rng(rows)
    shares = []
    for _ in range(1000):
        bounds = joint_bounds(DEPENDENCE[how](*rng.random((2, rows))), 0, 0.95, 0.95)
        shares.append(share_within(how, *bounds))
    held = np.mean(np.array(shares) >= 0.95)
    print(f"\n{how}, {rows} rows: {held:.1%}")
    assert 0.93 <= held <= 0.97
    # The share within the bounds has the same law whatever the dependence.
    outside = stats.binom.ppf(0.05, rows, 0.05)
    law = stats.beta(rows + 1 - outside, outside)
    assert stats.kstest(shares, law.cdf).pvalue > 1e-3


def test_a_summary_has_them_beside_each_output():
    ds = kinds(samples=300, analysis={"joint_bounds": {"work": "upper", "angle": "both"}})
    outputs = summarised(ds)["outputs"]
    assert outputs["work[side=left]"]["joint_bounds"].keys() == {"upper", "rows_needed"}
    assert outputs["angle"]["joint_bounds"].keys() == {"lower", "upper", "rows_needed"}
    assert "joint_bounds" not in outputs["life[side=left,depth=0.5]"]
    # Two sides, two bounds of the angle; rows without an angle say nothing of it.
    defined = ~np.isnan(ds["angle"].values)
    values = [ds["work"].values[defined, 0], ds["work"].values[defined, 1]]
    angle = ds["angle"].values[defined]
    expected = joint_bounds([*values, -angle, angle], 0, 0.95, 0.95)
    got = [outputs[f"work[side={side}]"]["joint_bounds"]["upper"] for side in ("left", "right")]
    got += [-outputs["angle"]["joint_bounds"]["lower"], outputs["angle"]["joint_bounds"]["upper"]]
    assert got == expected
    assert rows_needed(Result(ds), Result(ds).analysis) == {"joint_bounds": Needed(153, 4)}


def test_lives_are_never_or_beyond_the_horizon():
    ds = kinds(samples=400, analysis={"joint_bounds": {"life": "both"}})
    bounds = summarised(ds)["outputs"]["life[side=left,depth=0.5]"]["joint_bounds"]
    assert bounds["upper"] is None and bounds["upper_never"] is True
    assert bounds["lower"] >= 0.5


def test_failed_rows_lie_outside():
    tables = {
        "study": {"name": "joint", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 120},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
        "analysis": {"joint_bounds": {"y": "both"}},
    }
    sound = summarised(computed(study_of(tables)))["outputs"]["y"]["joint_bounds"]
    failing = tables | {"settings": {"fail_above": 0.98}}
    statistics = summarised(computed(study_of(failing)))["outputs"]["y"]["joint_bounds"]
    assert sound["rows_needed"] == 93 < statistics["rows_needed"]
    assert sound["upper"] is not None and statistics["upper"] is None


def test_bounds_that_lack_rows_are_not_settled():
    tables = {
        "study": {"name": "joint", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 80},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
        "analysis": {"joint_bounds": {"y": "both"}, "max_failed": 0.2},
    }
    few = Findings(Result(computed(study_of(tables))))
    sentence = "the requested joint bounds require 93 rows"
    assert f"More rows needed: {sentence}; about 93 rows in total would settle it." in verdict(few)
    failing = computed(study_of(tables | {"settings": {"fail_above": 0.9}}))
    assert failed(failing).mean() > 0.05  # as many rows as may lie outside
    joint = summarised(failing)["outputs"]["y"]["joint_bounds"]
    assert joint == {"lower": None, "upper": None, "rows_needed": None}
    assert np.isnan(uq.summary(failing)["joint_rows_needed"].item())
    findings = Findings(Result(failing))
    sentence = "oo many rows are invalid for the requested joint bounds"
    assert f"T{sentence}. More rows would not help." in verdict(findings)
    advice = {remedy.rule: remedy.text for remedy in conclude(findings).advice}
    assert f"t{sentence}" in advice["failed"] and "joint" not in advice.get("rows", "")
    why = quantities(findings)[0].tolerance_bound.basis
    assert "of the rows are invalid and count as beyond it" in why


@pytest.mark.parametrize(
    ("asked", "method", "words"),
    [
        (
            {"z": "upper"},
            "monte-carlo",
            r"joint_bounds.z = .upper.: no such output of model 'linear'",
        ),
        ({"y": "up"}, "monte-carlo", r"joint_bounds.y = .up.: must be 'lower', 'upper' or 'both'"),
        ({"y": "upper"}, "halton", r"joint_bounds.*assumes independent rows, .*'monte-carlo'"),
    ],
)
def test_mistakes_are_one_line(asked, method, words):
    tables = {
        "study": {"name": "joint", "model": "linear"},
        "design": {"method": method, "samples": 100},
        "uncertain": {"x1": UNIFORM},
        "analysis": {"joint_bounds": asked},
    }
    with pytest.raises(InputError, match=words) as refused:
        study_from_text(as_text(tables))
    assert len(refused.value.lines) == 1


def test_the_answer_promises_the_joint_bounds_that_a_study_asks_for():
    ds = kinds(samples=300, analysis={"joint_bounds": {"work": "upper", "angle": "both"}})
    tolerance_bounds = {
        quantity.name: quantity.tolerance_bound for quantity in quantities(Findings(Result(ds)))
    }
    bounds = summarised(ds)["outputs"]
    work, angle = tolerance_bounds["work[side=left]"], tolerance_bounds["angle"]
    assert work.upper == bounds["work[side=left]"]["joint_bounds"]["upper"] and np.isnan(work.lower)
    assert work.upper > bounds["work[side=left]"]["quantiles"]["0.95"]["value"]
    words = r"With 95 % confidence, at least 95 % of values are below .*, within the joint bounds"
    assert re.fullmatch(words + " of work, angle.", work.sentence)
    assert angle.lower == bounds["angle"]["joint_bounds"]["lower"] < angle.upper
    assert "% of defined values are above " in angle.sentence
    assert " and are below " in angle.sentence
    # An output that the study does not name keeps a bound of its own.
    assert not tolerance_bounds["life[side=left,depth=0.5]"].joint
    tolerance_bound = conclude(Findings(Result(ds))).fact.json["quantities"]["work[side=left]"][
        "promise"
    ]
    assert tolerance_bound["joint"] == ["work", "angle"] and tolerance_bound["upper"] == work.upper


def test_joint_bounds_that_lack_rows_are_not_replaced_by_single_ones():
    ds = kinds(samples=80, analysis={"joint_bounds": {"work": "upper"}})
    tolerance_bound = next(
        quantity for quantity in quantities(Findings(Result(ds))) if quantity.output == "work"
    ).tolerance_bound
    assert (
        np.isnan(tolerance_bound.upper) and "With 95 % confidence" not in tolerance_bound.sentence
    )
    assert tolerance_bound.basis.startswith("No joint tolerance bound: 93 rows are required.")


def test_both_joint_bounds_of_one_output_are_one_sentence():
    tables = {
        "study": {"name": "joint", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 120},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
        "analysis": {"joint_bounds": {"y": "both"}},
    }
    (quantity,) = quantities(Findings(Result(computed(study_of(tables)))))
    words = r"With 95 % confidence, at least 95 % of values are above \S+ and are below \S+\."
    assert re.fullmatch(words, quantity.tolerance_bound.sentence), quantity.tolerance_bound.sentence
