"""The page's answers about its rows, in a real browser, against those of Python."""

import base64
import json
import re
import shlex

import numpy as np
import pytest
from computed import computed, kinds, linear, study_of, with_output

from uq.analysis.findings import Findings
from uq.analysis.what_if import answer, read_changes, what_if_json
from uq.errors import RunError
from uq.intervals import share_interval
from uq.report.embedded import MOST_ROWS, rows_inside
from uq.report.page import templates

ASKED = {"thresholds": {"y": 6.0}}
CELLS = """[...document.querySelectorAll("PLACE table.found tr[data-key]")].map(line => [
  line.dataset.key,
  ...[...line.cells].slice(1).map(cell => [cell.querySelector("data")?.value ?? "NaN",
  cell.dataset.low ?? "NaN", cell.dataset.high ?? "NaN"])])"""
PAGE = """<!DOCTYPE html><html lang=en><meta charset=utf-8>
<meta name=viewport content="width=device-width">
<style>:root { --faint: gray; --line: silver; --accent: navy; color-scheme: light dark }</style>"""


@pytest.fixture
def shown(browser, tmp_path):
    """Return a function that opens the page of a result."""

    def show(ds, **how):
        path = tmp_path / "page.html"
        rows = rows_inside(Findings(ds), "a result.nc")
        explorer = templates().get_template("explorer.html")
        text = PAGE + explorer.render(rows_inside=rows)
        path.write_text(text, encoding="utf-8")
        browser.open(path, **how)
        browser.painted()
        return browser

    yield show
    assert browser.complaints() == []
    assert all(re.match("file:|data:", address) for address in browser.requests())


def ranges(browser):
    """Return the ends of each range."""
    ends = "one => [one.dataset.low, one.dataset.high]"
    found = browser.value(f"[...document.querySelectorAll('.range')].map({ends})")
    return [tuple(map(float, pair)) for pair in found]


def cells(browser, place="#explorer"):
    """Return the numbers of the table: key -> one (value, low, high) for each column."""
    browser.painted()
    numbers = browser.value(CELLS.replace("PLACE", place))
    return {key: [np.array(one, dtype=float) for one in found] for key, *found in numbers}


def drag_handle(browser, name, end, steps):
    """Move a handle as its element does when it is dragged."""
    selector = f".range[data-name={json.dumps(name)}]"
    browser.value(
        f"(() => {{ const range = document.querySelector({json.dumps(selector)});"
        f" const handle = range.querySelectorAll('input')[{end}];"
        f" handle.value = {steps}; handle.dispatchEvent(new Event('input')) }})()"
    )
    browser.painted()


def place_of_a_point(browser):
    """Return a place of the page where a point is drawn, in the colour of rows."""
    return browser.value(
        "(() => { const c = document.querySelector('.scatter canvas'); c.scrollIntoView();"
        " const box = c.getBoundingClientRect();"
        " const p = c.getContext('2d').getImageData(100, 20, c.width - 140, c.height - 60);"
        " for (let i = 0; i < p.data.length; i += 4) if (p.data[i] === 160 && p.data[i + 1] === 166"
        " && p.data[i + 2] === 173) return [box.left + 100.5 + (i / 4) % p.width,"
        " box.top + 20.5 + Math.floor(i / 4 / p.width)] })()"
    )


@pytest.mark.parametrize("design", [("monte-carlo", 400, 1), ("sobol", 64, 8), ("sobol", 64, 1)])
def test_a_brush_gives_what_python_finds_for_its_rows(shown, design):
    method, samples, replicates = design
    ds = linear(method, samples, replicates, analysis=ASKED)
    browser = shown(ds)
    part = ds["replicate"].values if method == "sobol" else None
    hits, x4 = ds["y"].values > 6.0, ds["x4"].values
    drag_handle(browser, "x4", 0, 200)
    drag_handle(browser, "x4", 1, 430)
    (low, high), *_ = ranges(browser)
    chosen = (x4 >= low) & (x4 <= high)
    assert 0 < chosen.sum() < len(x4)
    among, everywhere = cells(browser)["y/6"]
    within = None if part is None else part[chosen]
    expected = hits[chosen].mean(), *share_interval(hits[chosen], within)
    assert among == pytest.approx(expected, rel=1e-9, nan_ok=True)
    assert everywhere == pytest.approx((hits.mean(), *share_interval(hits, part)), nan_ok=True)
    assert np.isnan(among[1]) == (replicates == 1 and method == "sobol")
    said = browser.value("document.querySelector('.said').textContent")
    assert said.startswith(f"{chosen.sum()} of {len(x4)} rows, chosen after the fact")


def test_few_hits_have_the_exact_interval(shown):
    ds = linear(samples=400, analysis={"thresholds": {"y": 9.0}})
    hits = ds["y"].values > 9.0
    assert 0 < hits.sum() < 20
    (everywhere,) = cells(shown(ds))["y/9"]
    assert everywhere == pytest.approx((hits.mean(), *share_interval(hits)), rel=1e-9)


def test_a_brush_by_the_mouse_chooses_a_rectangle(shown):
    browser = shown(linear(samples=400, analysis=ASKED))
    x, y = place_of_a_point(browser)
    browser.drag((x + 20, y - 5), (x - 120, y + 90))
    browser.painted()
    (x_low, x_high), (y_low, y_high) = ranges(browser)
    ds = linear(samples=400, analysis=ASKED)
    x4, values = ds["x4"].values, ds["y"].values
    chosen = (x4 >= x_low) & (x4 <= x_high) & (values >= y_low) & (values <= y_high)
    assert chosen.sum() == browser.value("Number(document.querySelector('.said data').value)") > 0


def test_lives_that_never_end_or_are_censored_lie_beyond_the_brush(shown):
    ds = kinds(samples=400, analysis={"thresholds": {"life": 1.0}})
    browser = shown(ds)
    life, censored = ds["life"].values[:, 0, 0], ds["life_censored"].values[:, 0, 0] == 1
    known = ~np.isnan(life)
    drag_handle(browser, "life[side=left,depth=0.5]", 0, 1)
    (low, high) = ranges(browser)[1]
    count = "Number(document.querySelector('.said data').value)"
    assert (life[known] >= low).sum() == browser.value(count) and high == np.inf
    drag_handle(browser, "life[side=left,depth=0.5]", 1, 499)
    (low, high) = ranges(browser)[1]
    ended = known & ~censored & (life >= low) & (life <= high)
    assert ended.sum() == browser.value(count)


def test_chips_leave_out_a_regime(shown):
    ds = kinds(samples=100)
    browser = shown(ds)
    browser.value(
        "[...document.querySelectorAll('.chip')].find(c => c.innerText.startsWith('fast')).click()"
    )
    found = cells(browser)
    assert found["regime/fast"][0][0] == 0 and found["regime/slow"][0][0] == 1
    slow = (ds["regime"].values == 0).sum()
    assert browser.value("Number(document.querySelector('.said data').value)") == slow
    browser.value("document.querySelector('.clear').click()")
    assert len(cells(browser)["regime/fast"]) == 1


def test_a_point_is_named_under_the_mouse_and_opened_by_a_click(shown):
    ds = linear(samples=100)
    browser = shown(ds)
    place = place_of_a_point(browser)
    browser.mouse("Moved", *place)
    browser.painted()
    tip = browser.value("document.querySelector('.tip').innerText")
    row = int(re.match(r"Row (\d+)", tip)[1])
    browser.click(*place)
    assert browser.value("Number(document.querySelector('.card').dataset.row)") == row
    card = browser.value("document.querySelector('.card').innerText")
    assert f"uq row 'a result.nc' {row}" in card
    assert all(f"{ds[name].values[row]:.6g}" in card for name in ("x1", "x2", "x3", "x4", "y"))
    browser.value("document.querySelector('.card button').click()")
    browser.painted()
    assert browser.value("document.querySelector('.card [role=status]').innerText")


def test_the_keyboard_moves_between_rows_and_handles(shown):
    ds = linear(samples=100, analysis=ASKED)
    browser = shown(ds)
    browser.value("document.querySelector('.scatter canvas').focus()")
    browser.press("ArrowRight")
    first = browser.value("document.querySelector('.tip').innerText")
    browser.press("ArrowRight", "Enter")
    row = browser.value("Number(document.querySelector('.card').dataset.row)")
    before = int(re.match(r"Row (\d+)", first)[1])
    x4 = ds["x4"].values
    assert np.sort(x4).searchsorted(x4[row]) == np.sort(x4).searchsorted(x4[before]) + 1
    browser.value("document.querySelector('.range input').focus()")
    browser.press("ArrowRight", "ArrowRight")
    browser.painted()
    (low, high), _ = ranges(browser)
    assert low > x4.min() and high == np.inf
    assert browser.value("document.activeElement.ariaValueText") != "open"


def test_a_page_of_many_rows_is_small_and_says_which_part_it_holds(shown):
    ds = linear(samples=100_000)
    for i in range(7):
        ds = with_output(ds, f"more{i}", ds["y"].values ** (i + 1))
    inside = rows_inside(Findings(ds), "many.nc")
    numbers = np.frombuffer(base64.b64decode(inside["numbers"]), "<i4")
    assert len(inside["columns"]) == 12 and inside["total"] == 100_000
    assert len(numbers) == MOST_ROWS and 45_000 < numbers.mean() < 55_000
    assert len(json.dumps(inside)) < 4e6


NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
LAWS = {
    "normal": (NORMAL, "z"),
    "truncated-normal": (
        NORMAL | {"distribution": "truncated-normal", "lower": -1.0, "upper": 2.0},
        "z",
    ),
    "truncate": (NORMAL | {"truncate": [-2.0, 1.5]}, "z"),
    "uniform": ({"distribution": "uniform", "lower": -1.0, "upper": 2.0}, "z"),
    "triangular": ({"distribution": "triangular", "lower": -1.0, "mode": 0.0, "upper": 2.0}, "z"),
    "triangular scale": (
        {"distribution": "triangular", "lower": 0.5, "mode": 1.0, "upper": 2.0},
        "a",
    ),
    "cv": ({"distribution": "lognormal", "mean": 1.0, "cv": 0.4}, "a"),
    "sigma": ({"distribution": "lognormal", "median": 1.0, "sigma": 0.4}, "a"),
    "loguniform": ({"distribution": "loguniform", "lower": 0.3, "upper": 2.0}, "a"),
}


def scaled(uncertain, **design):
    """Return a result of lives that input a only scales, beside an output of both inputs."""
    some = {"a": LAWS["sigma"][0], "z": NORMAL} | uncertain
    tables = {
        "study": {"name": "scaled", "model": "scaled"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 3} | design,
        "uncertain": some,
        "analysis": {"outputs": ["life", "y"], "thresholds": {"life": [0.8], "y": [0.5]}},
    }
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
    return changes, answer(ds, changes)


@pytest.mark.parametrize(
    ("law", "design"),
    [
        *((law, {}) for law in LAWS),
        ("sigma", {"method": "sobol", "samples": 128, "replicates": 8}),
        ("normal", {"samples": 200, "units": 3}),
    ],
)
def test_a_slider_finds_what_python_finds(shown, law, design):
    stated, name = LAWS[law]
    ds = scaled({name: stated}, **design)
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
        assert here[f"{output}/{at}"][0] != pytest.approx(here[f"{output}/{at}"][1])
    worth = browser.value("document.querySelector('#tolerances .said data').value")
    assert float(worth) == pytest.approx(found.effective_rows, rel=1e-7)


def test_lives_that_two_inputs_scale_keep_the_law_of_their_product(shown):
    ds = scaled({"b": {"distribution": "loguniform", "lower": 0.8, "upper": 1.2}})
    browser = shown(ds)
    move(browser, "z", 0.8, 0.3)
    _, found = asked_of_python(browser, ds)
    one = what_if_json(found)["outputs"]["life"]["thresholds"]["0.8"]["below"]
    expected = [one[end] for end in ("value", "low", "high")]
    assert cells(browser, "#tolerances")["life/0.8"][0] == pytest.approx(expected, rel=1e-7)
    notes = browser.value("document.querySelector('#tolerances .note').innerText")
    assert notes.count("it scales lives together with other inputs") == 2


def test_too_few_rows_are_refused_as_in_python(shown):
    ds = scaled({}, samples=60)
    browser = shown(ds)
    move(browser, "z", 1.5, 1.5)
    browser.painted()
    with pytest.raises(RunError) as refused:
        asked_of_python(browser, ds)
    said = browser.value("document.querySelector('#tolerances .said').innerText")
    assert said.split(":")[0] == str(refused.value).split(":")[0] and "Pareto k" in said
    assert np.isnan(cells(browser, "#tolerances")["life/0.8"][0][0])


def test_inputs_without_a_slider_are_named(shown):
    listed = {"distribution": "discrete-choice", "values": [0.5, 1.0], "weights": [1.0, 1.0]}
    browser = shown(scaled({"a": listed}))
    assert browser.value("document.querySelectorAll('.tolerance').length") == 1
    notes = browser.value("document.querySelector('#tolerances .note').innerText")
    assert "its law is discrete-choice" in notes
