"""Other tolerances: what the sliders of a page find, against what Python finds on the same rows."""

import json
import shlex

import numpy as np
import pytest
from computed import computed, study_of, with_status
from explored import cells
from report_scripts import scripts

import uq as api
from uq.result.result import Result
from uq.assess.findings import Findings
from uq.assess.population import Population
from uq.assess.reweighting import Weighting
from uq.assess.row_inputs import inputs_of
from uq.assess.scaling import population
from uq.assess.what_if import _changed, answer, read_changes, what_if_json
from uq.contract import Status
from uq.errors import RunError
from uq.render.html.embedded_rows import rows_inside
from uq.result.elements import independent_rows, replicates_of
from uq.stats.intervals import share_interval

NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
SIGMA = {"distribution": "lognormal", "median": 1.0, "sigma": 0.4}
GAMMA = {"distribution": "gamma", "shape": 4.0, "scale": 0.25}
COUNTS = {"distribution": "histogram", "edges": [-2.0, 0.0, 1.0, 3.0], "counts": [3.0, 5.0, 2.0]}
TIMES = SIGMA | {"sigma": 0.3, "times": "a"}
NESTED = {"samples": 200, "units": 3}
RANKS = {"parameters": ["a", "z"], "rank_correlation": [[1.0, 0.4], [0.4, 1.0]]}
CASES = {
    "weighted": ("z", {"z": NORMAL}, {}, None),
    "truncated": ("z", {"z": NORMAL | {"truncate": [-2.0, 1.5]}}, {}, None),
    "counts": ("z", {"z": COUNTS}, {}, None),
    "integrated": ("a", {"a": GAMMA}, {}, None),
    "product": ("b", {"a": SIGMA, "b": SIGMA}, {}, None),
    "factor": ("b", {"b": SIGMA | {"sigma": 0.3, "times": "a"}}, {}, None),
    "scaled by a factor": ("a", {"b": SIGMA | {"sigma": 0.3, "times": "a"}}, {}, None),
    "correlated": ("z", {}, {}, RANKS),
    "scaled by what is correlated": ("a", {}, {}, RANKS),
    "replicates": ("z", {}, {"method": "sobol", "samples": 128, "replicates": 8}, None),
    "units": ("z", {}, NESTED, None),
}
"""Name -> the input that is moved, laws that differ, design, and rank correlations."""


def scaled(uncertain, dependence=None, **design):
    """Return a result of lives that input a only scales, beside an output of both inputs."""
    some = {"a": SIGMA, "z": NORMAL} | uncertain
    tables = {
        "study": {"name": "scaled", "model": "scaled"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 3} | design,
        "uncertain": some,
        "analysis": {"outputs": ["life", "y"], "thresholds": {"life": [0.8], "y": [0.5]}},
    } | ({"dependence": dependence} if dependence else {})
    return computed(study_of(tables, "sample_models:SCALED"))


def move(browser, name, width, shift):
    """Move the sliders of an input."""
    for i, value in enumerate((width, shift)):
        browser.value(
            f"(() => {{ const own = document.querySelector('.tolerance[data-name={name}]');"
            f" const slider = own.querySelectorAll('input')[{i}];"
            f" slider.value = {value}; slider.dispatchEvent(new Event('input')) }})()"
        )


def asked_of_python(browser, ds):
    """Return what the command that the page shows finds in Python."""
    browser.painted()
    command = browser.value("document.querySelector('#tolerances .command code').innerText")
    words = shlex.split(command)
    assert words[:3] == ["uq", "what-if", "a result.nc"]
    changes = read_changes([word for word in words[3:] if word != "--set"])
    return changes, answer(Result(ds), changes)


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, marks=[pytest.mark.slow] * (case in ("product", "replicates")))
        for case in CASES
    ],
)
def test_a_slider_finds_what_python_finds(shown, case):
    name, laws, design, ranks = CASES[case]
    ds = scaled(laws, ranks, **design)
    browser = shown(ds)
    move(browser, name, 0.8, 0.3)
    changes, found = asked_of_python(browser, ds)
    assert changes
    outputs = what_if_json(found)["outputs"]
    here = cells(browser, "#tolerances")
    for output, at, side in (("life", "0.8", "below"), ("y", "0.5", "above")):
        one = outputs[output]["thresholds"][at][side]
        expected = [one[end] for end in ("value", "low", "high")]
        assert here[f"{output}/{at}"][0] == pytest.approx(expected, rel=1e-7)
    assert here["life/0.8"][0] != pytest.approx(here["life/0.8"][1])
    worth = browser.value("document.querySelector('#tolerances .said data').value")
    assert float(worth) == pytest.approx(found.effective_rows, rel=1e-7)


def test_too_few_rows_are_refused_as_in_python(shown):
    ds = scaled({}, samples=60)
    browser = shown(ds)
    move(browser, "z", 1.5, 1.5)
    browser.painted()
    with pytest.raises(RunError) as refused:
        asked_of_python(browser, ds)
    said = browser.value("document.querySelector('#tolerances .said').innerText")
    why = str(refused.value)
    assert said == f"{why[0].upper()}{why[1:]}." and "Pareto k" in said
    assert browser.value("document.querySelector('#tolerances').innerText").count("Pareto k") == 1
    assert np.isnan(cells(browser, "#tolerances")["life/0.8"][0][0])


def test_inputs_without_a_slider_are_named(shown):
    listed = {"distribution": "discrete-choice", "values": [0.5, 1.0], "weights": [1.0, 1.0]}
    browser = shown(scaled({"a": listed}))
    assert browser.value("document.querySelectorAll('.tolerance').length") == 1
    notes = browser.value("document.querySelector('#tolerances .note').innerText")
    assert "its values are listed" in notes


QUANTILES = """(() => { const all = new Reweighting(rows); MOVES
  const changes = all.changed.flatMap(name => all.laws.get(name).changes(all.old.get(name))
    .map(([key, value]) => [`uncertain.${name}.${key}`, value]));
  const found = (name, p) => {
    const steps = new WeightedQuantile(all, all.columns.get(name)).of(p);
    for (let one = steps.next(); ; one = steps.next()) if (one.done) return one.value;
  };
  return [changes, ...["life", "y"].map(name => [0.05, 0.5, 0.95].map(p => found(name, p)))];
})()"""


@pytest.mark.parametrize(
    ("laws", "design"),
    [({"c": GAMMA}, {"samples": 300}), ({"c": GAMMA}, NESTED), ({"b": TIMES}, {"samples": 80})],
    ids=["rows", "units", "few"],
)
def test_quantiles_and_their_intervals_are_those_of_python(browser, tmp_path, laws, design):
    ds = independent_rows(scaled(laws, **design))
    inside = json.dumps(rows_inside(Findings(Result(ds)), "a.nc"))
    path = tmp_path / "quantiles.html"
    script = f"{scripts()}; const rows = new Rows({inside})"
    path.write_text(f"<meta charset=utf-8><script>{script}</script>", encoding="utf-8")
    browser.open(path)
    for moves in ({"z": (0.8, 0.1)}, {"a": (0.7, 0.2), "z": (0.9, 0.0)}):
        moved = "".join(f"all.move({json.dumps(n)}, {a}, {b});" for n, (a, b) in moves.items())
        changes, *columns = browser.value(QUANTILES.replace("MOVES", moved))
        outputs = what_if_json(answer(Result(ds), dict(changes)))["outputs"]
        for name, found in zip(("life", "y"), columns, strict=True):
            for p, one in zip(("0.05", "0.5", "0.95"), found, strict=True):
                expected = outputs[name]["quantiles"][p]
                for end in ("value", "low", "high"):
                    known = np.nan if expected[end] is None else expected[end]
                    here = np.nan if one[end] is None else one[end]
                    assert here == pytest.approx(known, rel=1e-7, nan_ok=True), (name, p, end)
    assert browser.complaints() == []


def test_the_page_says_what_could_then_be_promised(shown):
    ds = scaled({})
    browser = shown(ds)
    now = api.answer(ds).lead.promise

    def promised(words):
        at_once = (  # the page may change between two questions
            "(() => { const cell = document.querySelector('#tolerances .promised');"
            " const numbers = [...cell.querySelectorAll('data')].map(data => Number(data.value));"
            " return [numbers, cell.innerText] })()"
        )
        for _ in range(100):
            browser.painted()
            values, text = browser.value(at_once)
            if words in text:
                return values, text.replace("\N{NO-BREAK SPACE}", " ")
        raise AssertionError("nothing is promised")

    values, text = promised("last longer than")
    assert values == [now.lower] and text == now.sentence
    move(browser, "z", 0.8, 0.0)
    (then, before), text = promised("would then")
    _, found = asked_of_python(browser, ds)
    known = what_if_json(found)["outputs"]["life"]["quantiles"]["0.05"]
    assert before == pytest.approx(now.quantiles[0].low, rel=1e-7)
    assert then == pytest.approx(known["low"], rel=1e-7)
    shown_then = float(text.split("would then be ")[1].split()[0])
    assert shown_then <= then < shown_then * 1.01
    assert text.startswith("The lower end of the interval of the 5 % quantile would then be")


@pytest.mark.parametrize("case", ["weighted", "integrated"])
def test_failed_rows_lie_beyond_what_could_then_be_promised(shown, case):
    name, laws, *_ = CASES[case]
    ds = scaled(laws)
    far = ds[name] > ds[name].quantile(0.98)
    ds = with_status(ds, np.flatnonzero(far), Status.RAISED)
    ds = ds.assign({one: ds[one].where(~far) for one in ("life", "y")})
    browser = shown(ds)
    move(browser, name, 0.8, 0.0)
    _, found = asked_of_python(browser, ds)
    known = what_if_json(found)["outputs"]["life"]["quantiles"]["0.05"]
    assert known["failed_low"] < known["low"]
    cells = "[...document.querySelectorAll('#tolerances .promised data')]"
    for _ in range(100):
        browser.painted()
        then = browser.value(f"{cells}.map(one => Number(one.value))")
        if len(then) == 2:
            break
    assert then[0] == pytest.approx(known["failed_low"], rel=1e-7)


CURVES = """(() => { const all = new Reweighting(rows); MOVES
  const changes = all.changed.flatMap(name => all.laws.get(name).changes(all.old.get(name))
    .map(([key, value]) => [`uncertain.${name}.${key}`, value]));
  return [changes, ...["life", "y"].map(name => {
    const one = new WeightedCurve(all, all.columns.get(name));
    return [one.curve, [...one.band()].at(-1)];
  })] })()"""


@pytest.mark.parametrize("design", [{"samples": 300}, NESTED], ids=["rows", "units"])
def test_curves_and_their_intervals_are_those_of_python(browser, tmp_path, design):
    ds = independent_rows(scaled({"c": GAMMA}, **design))
    inside = json.dumps(rows_inside(Findings(Result(ds)), "a.nc"))
    path = tmp_path / "curves.html"
    script = f"{scripts()}; const rows = new Rows({inside})"
    path.write_text(f"<meta charset=utf-8><script>{script}</script>", encoding="utf-8")
    browser.open(path)
    part = replicates_of(ds)
    for moves in ({}, {"z": (0.8, 0.3)}, {"c": (0.7, 0.2)}):
        moved = "".join(f"all.move({json.dumps(n)}, {a}, {b});" for n, (a, b) in moves.items())
        changes, *curves = browser.value(CURVES.replace("MOVES", moved))
        elements = population(Result(ds), ["life", "y"])
        if moves:
            new = _changed(Result(ds), dict(changes))
            elements = Weighting(Result(ds), inputs_of(Result(ds)), new, part).elements(["life", "y"])
        for element, (curve, band) in zip(elements, curves, strict=True):
            rows = Population(element, part)
            ends = zip(band["low"], band["high"], strict=True)  # a step has those before it, too
            for at, (low, high) in dict(zip(band["at"], ends, strict=True)).items():
                if element.is_plain:
                    expected = share_interval(element.values > at, part)
                else:
                    expected = rows.outliving(at).numbers[1:]
                found = np.array([low, high], dtype=float)  # null stands for NaN
                assert found == pytest.approx(expected, rel=1e-6, abs=1e-9, nan_ok=True)
            middle = len(curve["at"]) // 2
            share = rows.outliving(curve["at"][middle]).value
            assert curve["share"][middle] == pytest.approx(share, abs=2e-3)
    assert browser.complaints() == []
