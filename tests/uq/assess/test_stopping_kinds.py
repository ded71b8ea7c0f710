"""Runs that stop when a B-life, an index, or the difference between two indices is known."""

import numpy as np
import pytest
from computed import UNIFORM, computed, kinds, study_of, summarised
from until_studies import PAIR, WEAR, study, tables, wear

from benchmarks.coverage import whole
from uq.assess import stopping
from uq.assess.sensitivities import sensitivities
from uq.assess.sensitivity_table import sensitivity_facts
from uq.errors import InputError
from uq.execution import runner
from uq.result.result import Result


def seen_with_confidence(monkeypatch, confidence, of, ds):
    monkeypatch.setattr(stopping, "confidence", lambda design: confidence)
    return stopping.interim_estimate(of.design, Result(ds))


@pytest.mark.parametrize(
    "laws", [WEAR, WEAR | {"depth": {"distribution": "uniform", "lower": 1e-4, "upper": 1e-3}}]
)
@pytest.mark.parametrize(("name", "p"), [("B10", 0.1), ("B2.5", 0.025)])
def test_a_b_life_is_that_of_the_summary(monkeypatch, laws, name, p):
    of = wear({"b_life": name, "half_width": 1.0}, laws, samples=256)
    ds = computed(of)
    seen = seen_with_confidence(monkeypatch, 0.95, of, ds)
    assert seen.what == f"{name} of life" and seen.units == "s"
    shown = summarised(ds)["outputs"]["life"]["b_lives"].get(name)
    asked = study_of(
        tables({"output": "life", "quantile": p, "half_width": 1.0}) | {"uncertain": laws},
        "exponential-wear",
    )
    same = seen_with_confidence(monkeypatch, 0.95, asked, ds)
    assert same.estimate == seen.estimate
    if shown is not None:
        assert seen.estimate.numbers == (shown["value"], shown["low"], shown["high"])


def test_a_b_life_may_rest_on_censored_rows():
    ds = kinds(samples=256)  # lives of 0.5 to 1.5, censored from 1.3 on, a fifth never ends
    name = "life[side=left,depth=0.5]"

    def look(b_life):
        until = {"output": name, "b_life": b_life, "half_width": 0.2}
        given = tables(until, samples=256) | {"uncertain": PAIR}
        return stopping.interim_estimate(study_of(given, "sample_models:KINDS").design, Result(ds))

    assert look("B50").half_width < 0.2
    assert look("B90").half_width == np.inf


def test_the_shapley_effect_of_a_single_input_is_refused_before_the_run():
    given = tables({"output": "y", "index": "shapley", "half_width": 0.1}, 512, "shapley")
    with pytest.raises(InputError, match="is 1 in every study of one input, x1: no interval"):
        study_of(given | {"uncertain": {"x1": UNIFORM}})


@pytest.mark.parametrize(
    ("more", "widest"),
    [
        ({}, None),
        ({"input": "x2"}, "S1 x2 of y"),
        ({"difference": ["x3", "x4"]}, "S1 x3 - x4 of y"),
    ],
)
def test_an_index_is_that_of_the_sensitivity(monkeypatch, more, widest):
    of = study(1.0, samples=64, method="saltelli", replicates=8, index="S1", **more)
    ds = computed(of)
    seen = seen_with_confidence(monkeypatch, 0.95, of, ds)
    index_values = sensitivity_facts(sensitivities(Result(ds))).json["outputs"]["y"]["S1"]
    halves = {
        name: (estimate["high"] - estimate["low"]) / 2 for name, estimate in index_values.items()
    }
    if "difference" in more:
        assert seen.what == widest
        assert seen.estimate.value == pytest.approx(
            index_values["x3"]["value"] - index_values["x4"]["value"]
        )
        assert seen.half_width < halves["x3"] + halves["x4"]
        return
    name = more.get("input") or max(halves, key=halves.get)
    assert seen.what == f"S1 {name} of y"
    assert seen.half_width == pytest.approx(halves[name], rel=1e-12)


def test_an_input_without_effect_does_not_keep_a_run_going(tmp_path):
    until = {"output": "y", "index": "ST", "half_width": 0.1}
    given = tables(until, samples=256, method="saltelli", replicates=8)
    of = study_of(given | {"uncertain": PAIR}, "sample_models:PLAIN")
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    assert ds.attrs["samples"] < 256
    assert "ST x1 of y is" in summarised(ds)["notes"][0]


def test_shapley_effects_need_no_replicates(tmp_path):
    of = study(0.05, samples=4096, method="shapley", index="shapley", difference=["x4", "x1"])
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    assert ds.attrs["samples"] < 4096
    seen = stopping.interim_estimate(of.design, Result(ds))
    assert seen.what == "shapley x4 - x1 of y"
    assert seen.estimate.low < 15 / 30 < seen.estimate.high


@pytest.mark.parametrize(
    ("until", "more", "words"),
    [
        ({"b_life": "B10"}, {}, r"until.b_life = .B10.: 'y' is not a lifetime \(lifetimes: none\)"),
        ({"b_life": "10"}, {}, r'must be "B" and a percentage, such as "B10"'),
        ({"b_life": "B0"}, {}, r'must be "B" and a percentage, such as "B10"'),
        (
            {"index": "S1"},
            {},
            "'monte-carlo' design gives no index with an interval; .* 'saltelli'",
        ),
        (
            {"index": "s1"},
            {"method": "saltelli", "replicates": 8},
            r"no such index .*'S1'\?.*allowed: S1, ST",
        ),
        ({"index": "S1"}, {"method": "saltelli"}, r"\[design\] until: a .*set replicates = 8"),
        (
            {"index": "S1", "input": "x9"},
            {"method": "saltelli", "replicates": 8},
            "no such input .*allowed: x1",
        ),
        (
            {"index": "S1", "difference": ["x1"]},
            {"method": "saltelli", "replicates": 8},
            "difference",
        ),
        (
            {"index": "S1", "difference": ["x1", "x1"]},
            {"method": "saltelli", "replicates": 8},
            "twice",
        ),
        (
            {"index": "S1", "difference": ["x1", "x2", "x3"]},
            {"method": "saltelli", "replicates": 8},
            "must have at most 2 entries",
        ),
        (
            {"index": "S1", "input": "x1", "difference": ["x1", "x2"]},
            {"method": "saltelli", "replicates": 8},
            "at most one of input",
        ),
        ({"input": "x1"}, {}, "need index"),
        (
            {"index": "S1", "quantile": 0.5},
            {"method": "saltelli", "replicates": 8},
            "at most one of above",
        ),
        ({"above": 3.0, "half_width": "2 days"}, {}, "the unit 'days' does not fit 'above'"),
        ({"half_width": "2 days"}, {}, "the unit 'days' does not fit 'y'"),
        ({"half_width": "-2 %"}, {}, "greater than 0"),
        ({"indx": "S1"}, {"method": "saltelli", "replicates": 8}, r"did you mean 'index'.*b_life"),
    ],
)
def test_mistakes_are_one_line(until, more, words):
    with pytest.raises(InputError, match=words) as refused:
        study_of(tables({"output": "y", "half_width": 1.0} | until, **more))
    assert len(refused.value.lines) == 1


def test_an_unknown_element_is_refused_before_any_row():
    until = {"output": "life[side=left,depth=0.6]", "half_width": 0.1}
    given = tables(until) | {"uncertain": PAIR}
    with pytest.raises(InputError, match=r"until.output = .*no such element; did you mean .*0.5"):
        study_of(given, "sample_models:KINDS")


def test_the_editor_knows_the_keys():
    from uq.study.schema import json_schema

    keys = json_schema()["definitions"]["Until"]["properties"]
    assert set(keys) >= {"b_life", "index", "input", "difference"}


@pytest.mark.parametrize(("design", "index"), [("saltelli", "ST"), ("shapley", "shapley")])
def test_a_run_may_stop_at_the_index_of_all_elements_together(monkeypatch, design, index):
    replicates = 4 if design == "saltelli" else 1
    until = {"output": "front[:]", "index": index, "half_width": 0.1}
    given = tables(until, samples=64, method=design, replicates=replicates)
    of = study_of(given | {"uncertain": whole.LAWS}, whole.NAME)
    ds = computed(of)
    seen = seen_with_confidence(monkeypatch, 0.95, of, ds)
    every = sensitivity_facts(sensitivities(Result(ds), output="front[:]")).json["outputs"][
        "front[:]"
    ][index]
    settled = {name: estimate for name, estimate in every.items() if estimate["low"] is not None}
    halves = {name: (estimate["high"] - estimate["low"]) / 2 for name, estimate in settled.items()}
    widest = max(halves, key=halves.get)
    assert seen.what == f"{index} {widest} of front[:]"
    assert seen.half_width == pytest.approx(halves[widest], rel=1e-12)


@pytest.mark.parametrize(
    ("until", "line"),
    [
        ({}, r"all elements together have only an index; 'front' is each of them"),
        ({"above": 1.0}, r"all elements together have only an index"),
        ({"output": "fronts[:]", "index": "ST"}, r"no such output"),
    ],
)
def test_what_all_elements_together_do_not_have_is_refused(until, line):
    given = tables({"output": "front[:]", "half_width": 0.1} | until, 64, "saltelli", 4)
    with pytest.raises(InputError, match=line):
        study_of(given | {"uncertain": whole.LAWS}, whole.NAME)


class Interrupted(Exception):
    """What ends a run in these tests."""


SHAPLEY = {"method": "shapley", "samples": 2048}

SALTELLI = {"method": "saltelli", "samples": 256, "replicates": 8}

KINDS = {
    "mean": ({"half_width": 0.1}, {}),
    "probability": ({"above": 5.0, "half_width": 0.04}, {}),
    "quantile": ({"quantile": 0.9, "half_width": 0.2}, {}),
    "shapley": ({"index": "shapley", "half_width": 1e-6}, SHAPLEY),
    "difference": ({"index": "ST", "difference": ["x4", "x1"], "half_width": 0.1}, SALTELLI),
}


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind == "shapley")) for kind in KINDS]
)
def test_a_run_killed_between_looks_ends_as_one_that_was_not(tmp_path, kind):
    until, more = KINDS[kind]
    of = study_of(tables({"output": "y", **until}, **more))
    whole_run = runner.run(of, tmp_path / "whole.nc", workers=0)
    size = stopping.interim_sizes(of.design)[0] * (7 if more is SHAPLEY else 1)

    def kill(progress):
        if progress.done > size:
            raise Interrupted

    with pytest.raises(Interrupted):
        runner.run(of, tmp_path / "out.nc", workers=0, chunk_rows=64, progress=kill)
    resumed = runner.run(of, tmp_path / "out.nc", workers=0)
    assert resumed.equals(whole_run) and resumed.attrs["samples"] == whole_run.attrs["samples"]
    assert summarised(resumed) == summarised(whole_run)
