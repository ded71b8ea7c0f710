"""Other tolerances: what the sliders of a page show, against what Python finds on the same rows."""

import base64
import re
import shlex

import numpy as np
import pytest
from computed import computed, study_of, with_status
from explored import cells
from scipy_counterparts import of_scipy

import uq as api
from uq.assess.answer.answer import conclude
from uq.assess.findings import Findings
from uq.assess.weighted_mixture import WeightedMixture
from uq.assess.what_if import read_changes, reweighted_summary, what_if_facts
from uq.contract import Status
from uq.errors import RunError
from uq.render.html.embedded_columns import IMPOSSIBLE, log_bytes
from uq.render.html.embedded_rows import rows_inside
from uq.render.html.moved_laws import can_move, shifts, widths
from uq.render.html.tolerances import FEWEST
from uq.result.result import Result
from uq.sampling.laws import LAWS, law_of
from uq.stats.importance_weights import effective_rows

NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
SIGMA = {"distribution": "lognormal", "median": 1.0, "sigma": 0.4}
GAMMA = {"distribution": "gamma", "shape": 4.0, "scale": 0.25}
COUNTS = {"distribution": "histogram", "edges": [-2.0, 0.0, 1.0, 3.0], "counts": [3.0, 5.0, 2.0]}
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
    laws = {"a": SIGMA, "z": NORMAL} | uncertain
    tables = {
        "study": {"name": "scaled", "model": "scaled"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 3} | design,
        "uncertain": laws,
        "analysis": {"outputs": ["life", "y"], "thresholds": {"life": [0.8], "y": [0.5]}},
    } | ({"dependence": dependence} if dependence else {})
    return computed(study_of(tables, "sample_models:SCALED"))


def test_a_law_with_a_text_among_its_arguments_has_a_slider():
    tables = {
        "study": {"name": "rods", "model": "gap-wear"},
        "design": {"method": "monte-carlo", "samples": 200, "seed": 3},
        "uncertain": {
            "wear_coefficient": {
                "distribution": "wear-coefficient",
                "pair": "inconel-600/inconel-600",
            }
        },
    }
    inside = rows_inside(Findings(Result(computed(study_of(tables)))), "rods.nc")
    (slider,) = inside["tolerances"]["sliders"]
    words = [stop["words"] for track in slider["tracks"] for stop in track["stops"]]
    assert all("pair inconel-600/inconel-600" in text for text in words)


def move(browser, name, track, place):
    """Move a slider of an input to a stop, counted from the lower end."""
    browser.value(
        f"(() => {{ const input = document.querySelector('.tolerance[data-name={name}]');"
        f" const slider = [...input.querySelectorAll('label')]"
        f".find(label => label.innerText === '{track}').querySelector('input');"
        f" slider.value = {place}; slider.dispatchEvent(new Event('input')) }})()"
    )
    browser.painted()


def asked_of_python(browser, ds):
    """Return the changes of the command that the page shows, and what it finds in Python."""
    command = browser.value("document.querySelector('#tolerances .command code').innerText")
    words = shlex.split(command)
    assert words[:3] == ["uq", "what-if", "a result.nc"]
    changes = read_changes([word for word in words[3:] if word != "--set"])
    return changes, reweighted_summary(Result(ds), changes)


def status(browser):
    return browser.value("document.querySelector('#tolerances .status').innerText")


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, marks=[pytest.mark.slow] * (case in ("product", "replicates")))
        for case in CASES
    ],
)
def test_a_slider_shows_what_python_finds(shown, case):
    name, laws, design, ranks = CASES[case]
    ds = scaled(laws, ranks, **design)
    browser = shown(ds)
    for track, place in (("width", 2), ("shift", 1)):
        move(browser, name, track, place)
        changes, reweighted = asked_of_python(browser, ds)
        assert changes
        outputs = what_if_facts(reweighted).json["outputs"]
        displayed = cells(browser, "#tolerances")
        for output, at, side in (("life", "0.8", "below"), ("y", "0.5", "above")):
            estimate = outputs[output]["thresholds"][at][side]
            expected = [estimate[end] for end in ("value", "low", "high")]
            assert displayed[f"{output}/{at}"][0] == pytest.approx(expected, rel=1e-12)
        assert displayed["life/0.8"][0] != pytest.approx(displayed["life/0.8"][1])
        assert f"worth {reweighted.effective_rows:.3g} of " in status(browser)


def weights_of(plain):
    """Return the weights that a page holds as bytes."""
    codes = np.frombuffer(base64.b64decode(plain["bytes"]), "u1")
    return np.where(codes == IMPOSSIBLE, 0.0, np.exp(plain["top"] - plain["step"] * codes))


def stop_of(inside, name, track, place):
    """Return a stop of a slider of the rows inside a page."""
    slider = next(
        candidate for candidate in inside["tolerances"]["sliders"] if candidate["name"] == name
    )
    return next(candidate for candidate in slider["tracks"] if candidate["name"] == track)["stops"][
        place
    ]


@pytest.mark.parametrize("design", [{"samples": 1000}, NESTED], ids=["rows", "units"])
def test_several_changes_are_counted_by_the_product_of_their_weights(shown, design):
    ds = scaled({"c": GAMMA}, **design)
    browser, moves = shown(ds), [("z", "width", 2), ("c", "shift", 1), ("a", "width", 1)]
    for chosen in moves:
        move(browser, *chosen)
    inside = rows_inside(Findings(Result(ds)), "a result.nc")
    weights = np.prod([weights_of(stop_of(inside, *change)["weights"]) for change in moves], axis=0)
    displayed = cells(browser, "#tolerances")
    rows = Result(ds).independent.dataset
    hits = {"life/0.8": rows["life"].values < 0.8, "y/0.5": rows["y"].values > 0.5}
    outputs = what_if_facts(asked_of_python(browser, ds)[1]).json["outputs"]
    for key, side in (("life/0.8", "below"), ("y/0.5", "above")):
        (share, *ends), (studied, *_) = displayed[key]
        assert share == pytest.approx(np.average(hits[key], weights=weights), rel=1e-12)
        assert studied == hits[key].mean() and np.isnan(ends).all()
        output, at = key.split("/")
        estimate = outputs[output]["thresholds"][at][side]
        assert estimate["low"] < share < estimate["high"]
    parts = design["samples"]
    worth = effective_rows(weights) * parts / len(weights)
    assert f"worth {worth:.3g} of " in status(browser) and worth > FEWEST
    assert "counted" in browser.value("document.querySelector('#tolerances thead').innerText")


def test_a_byte_a_row_moves_no_share_by_a_tenth_of_its_standard_error():
    inside = rows_inside(Findings(Result(ds := scaled({}, samples=2000))), "a.nc")
    hits = ds["y"].values > 0.5
    for track, place in (("width", 0), ("width", 2), ("shift", 0), ("shift", 3)):
        stop = stop_of(inside, "z", track, place)
        weights = weights_of(stop["weights"])
        estimate = stop["events"]["y/0.5"]
        error = (estimate["high"] - estimate["low"]) / 3.92
        assert abs(np.average(hits, weights=weights) - estimate["value"]) < 0.1 * error


def test_weights_survive_their_bytes():
    weights = np.array([0.0, 1e-9, 0.2, 1.0, 3.7])
    restored = weights_of(log_bytes(weights))
    assert restored[0] == 0 and restored[-1] == pytest.approx(3.7) and 0 < restored[1] < 1e-6
    assert restored[2:] == pytest.approx(weights[2:], rel=0.04)
    assert weights_of(log_bytes(np.full(5, 2.0))) == pytest.approx(2.0)


def test_many_rows_that_weights_are_worth_are_no_power_of_ten():
    inside = rows_inside(Findings(Result(scaled({}, samples=3000))), "a.nc")
    quality = stop_of(inside, "z", "width", 2)["quality"].replace("\N{NO-BREAK SPACE}", " ")
    assert re.match(r"These weights are worth [12] \d\d0 of 3 000 rows", quality), quality


def test_inputs_that_depend_on_each_other_are_left_to_the_command(shown):
    browser = shown(scaled({}, RANKS))
    move(browser, "a", "width", 2)
    move(browser, "z", "width", 2)
    assert "depend on each other" in status(browser)
    assert np.isnan(cells(browser, "#tolerances")["life/0.8"][0][0])


def test_too_few_rows_for_several_changes_are_left_to_the_command(shown):
    browser = shown(scaled({}, samples=120))
    move(browser, "z", "width", 0)
    assert np.isfinite(cells(browser, "#tolerances")["life/0.8"][0][0])
    move(browser, "a", "width", 0)
    assert status(browser).startswith("Too few rows support all these changes")
    assert np.isnan(cells(browser, "#tolerances")["life/0.8"][0][0])
    browser.value("document.querySelector('.as-studied').click()")
    assert status(browser) == "The laws of the study."


def test_a_change_of_the_shift_takes_back_that_of_the_width(shown):
    ds = scaled({})
    browser = shown(ds)
    move(browser, "z", "width", 1)
    move(browser, "z", "shift", 3)
    assert list(asked_of_python(browser, ds)[0]) == ["uncertain.z.mean"]
    words = browser.value("document.querySelector('.tolerance[data-name=z] output').innerText")
    assert words == "mean 0.5, sd 1"


def test_too_few_rows_are_refused_as_in_python(shown):
    ds = scaled({}, samples=60)
    browser = shown(ds)
    move(browser, "z", "width", 5)
    with pytest.raises(RunError) as refused:
        asked_of_python(browser, ds)
    why = str(refused.value)
    assert status(browser) == f"{why[0].upper()}{why[1:]}." and "Pareto k" in why
    assert np.isnan(cells(browser, "#tolerances")["life/0.8"][0][0])


def test_inputs_without_a_slider_are_named(shown):
    listed = {"distribution": "discrete-choice", "values": [0.5, 1.0], "weights": [1.0, 1.0]}
    browser = shown(scaled({"a": listed}))
    assert browser.value("document.querySelectorAll('.tolerance').length") == 1
    notes = browser.value("document.querySelector('#tolerances .note').innerText")
    assert "its values are listed" in notes


def test_a_stop_estimates_no_quantile_that_the_page_does_not_show(monkeypatch):
    findings = Findings(Result(scaled({}, samples=200)))
    answered, searched, search = conclude(findings).quantities, [], WeightedMixture.quantile
    monkeypatch.setattr(
        WeightedMixture,
        "quantile",
        lambda rows, p: searched.append(rows.element.name) or search(rows, p),
    )
    sliders = rows_inside(findings, "a.nc", answered)["tolerances"]["sliders"]
    stops = sum(len(track["stops"]) - 1 for slider in sliders for track in slider["tracks"])
    assert stops >= 10 and set(searched) == {answered[0].name}
    assert len(searched) <= stops + 1


def bound_sentence(browser):
    return browser.value("document.querySelector('.promised').innerText").replace("\xa0", " ")


def test_the_page_says_what_could_then_be_promised(shown):
    ds = scaled({})
    browser = shown(ds)
    now = api.answer(ds).lead.tolerance_bound
    assert bound_sentence(browser) == now.sentence
    move(browser, "z", "width", 2)
    _, reweighted = asked_of_python(browser, ds)
    low = what_if_facts(reweighted).json["outputs"]["life"]["quantiles"]["0.05"]["low"]
    text = bound_sentence(browser)
    assert text.startswith("The lower end of the 95 % interval of the 5 % quantile would be ")
    displayed = float(text.split("would be ")[1].split()[0])
    assert displayed <= low < displayed * 1.01
    studied = now.unit.text(now.quantiles[0].low, -np.inf)
    assert text.endswith(f" from {studied} by the same method.")


@pytest.mark.parametrize("case", ["weighted", "integrated"])
def test_failed_rows_lie_beyond_what_could_then_be_promised(shown, case):
    name, laws, *_ = CASES[case]
    ds = scaled(laws)
    far = ds[name] > ds[name].quantile(0.98)
    ds = with_status(ds, np.flatnonzero(far), Status.RAISED)
    ds = ds.assign({output: ds[output].where(~far) for output in ("life", "y")})
    browser = shown(ds)
    move(browser, name, "width", 2)
    _, reweighted = asked_of_python(browser, ds)
    quantile = what_if_facts(reweighted).json["outputs"]["life"]["quantiles"]["0.05"]
    assert quantile["failed_low"] < quantile["low"]
    displayed = float(bound_sentence(browser).split("would be ")[1].split()[0])
    assert displayed <= quantile["failed_low"] < displayed * 1.01


ARGUMENTS = {
    "normal": {"mean": 3.0, "sd": 0.4},
    "truncated-normal": {"mean": 3.0, "sd": 0.9, "lower": 1.0, "upper": 4.0},
    "lognormal": {"mean": 3.0, "cv": 0.3},
    "wear-coefficient": {"pair": "inconel-690/steel-405", "sigma": 0.4},
    "uniform": {"lower": 1.0, "upper": 4.0},
    "loguniform": {"lower": 0.5, "upper": 4.0},
    "triangular": {"lower": 1.0, "mode": 1.5, "upper": 4.0},
    "pert": {"lower": 1.0, "mode": 3.5, "upper": 4.0},
    "beta": {"alpha": 0.7, "beta": 2.5, "lower": 1.0, "upper": 4.0},
    "weibull": {"shape": 1.7, "scale": 2.0},
    "gamma": {"shape": 4.5, "scale": 0.5},
    "gumbel": {"mode": 3.0, "scale": 0.3},
    "exponential": {"mean": 1.5},
    "histogram": {"edges": [1.0, 1.5, 3.0, 4.0], "counts": [5.0, 20.0, 10.0]},
    "integer-range": {"lower": 1, "upper": 9},
}


def test_each_law_has_a_slider_or_a_reason():
    laws = {name: law_of({"distribution": name} | given) for name, given in ARGUMENTS.items()}
    assert all(can_move(law) for law in laws.values())
    assert all(name in ARGUMENTS or law.discrete for name, law in LAWS.items())


@pytest.mark.parametrize("name", ARGUMENTS)
def test_stops_scatter_less_or_more_and_lie_higher_or_lower(name):
    law = law_of({"distribution": name} | ARGUMENTS[name])
    studied = of_scipy(law)
    for moves, moment in ((widths(law), "std"), (shifts(law), "mean")):
        stops = []
        for at, changed in moves:
            moved = of_scipy(law_of({"distribution": name} | ARGUMENTS[name] | dict(changed)))
            stops.append((at, getattr(moved, moment)() / getattr(studied, moment)()))
            assert moved.support()[0] >= studied.support()[0]
            assert moved.support()[1] <= studied.support()[1]
        values = [value for _, value in sorted(stops)]
        assert values == sorted(values) and len(set(values)) >= len(values) - 1
        assert not stops or values[0] < 1


def test_arguments_of_laws_keep_the_digits_of_their_change():
    law = law_of({"distribution": "uniform", "lower": 1e6, "upper": 1e6 + 1e-3})
    (_, changed), *_ = widths(law)
    assert changed["lower"] == pytest.approx(1e6 + 2.5e-4, abs=1e-8)
    assert changed["upper"] == pytest.approx(1e6 + 7.5e-4, abs=1e-8)
