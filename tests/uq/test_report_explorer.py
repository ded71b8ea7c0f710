"""The page's answers about its rows, in a real browser, against those of Python."""

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from computed import asking, kinds, linear, with_output
from explored import cells

from uq.analysis.findings import Findings
from uq.analysis.life_quantiles import ended_by, life_quantiles, quantile_estimate
from uq.intervals import share_interval
from uq.report.embedded import MOST_ROWS, rows_inside
from uq.rows.elements import elements_of, replicates_of

ASKED = {"thresholds": {"y": 6.0}}


def ranges(browser):
    """Return the ends of each range."""
    ends = "one => [one.dataset.low, one.dataset.high]"
    found = browser.value(f"[...document.querySelectorAll('.range')].map({ends})")
    return [tuple(map(float, pair)) for pair in found]


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
        "(() => { const c = document.querySelector('.scatter canvas');"
        " c.scrollIntoView({behavior: 'instant'});"
        " const box = c.getBoundingClientRect();"
        " const p = c.getContext('2d').getImageData(100, 20, c.width - 140, c.height - 60);"
        " for (let i = 0; i < p.data.length; i += 4) if (p.data[i] === 160 && p.data[i + 1] === 166"
        " && p.data[i + 2] === 173) return [box.left + 100.5 + (i / 4) % p.width,"
        " box.top + 20.5 + Math.floor(i / 4 / p.width)] })()"
    )


DESIGNS = {
    "independent": {"samples": 400},
    "replicates": {"method": "sobol", "samples": 64, "replicates": 8},
    "one replicate": {"method": "sobol", "samples": 64},
    "units": {"samples": 130, "units": 3},
    "units and replicates": {"method": "sobol", "samples": 32, "replicates": 8, "repeats": 2},
}


@pytest.mark.parametrize("design", DESIGNS)
def test_a_brush_gives_what_python_finds_for_its_rows(shown, design):
    ds = linear(**DESIGNS[design], analysis=ASKED)
    browser = shown(ds)
    part = replicates_of(ds)
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
    assert np.isnan(among[1]) == (design == "one replicate")
    element = next(elements_of(ds, ["y"]))
    for rows, found in zip((chosen, hits | True), cells(browser)["quantile/0.1"], strict=True):
        some = replace(element, values=element.values[rows], censored=element.censored[rows])
        expected = quantile_estimate(some, 0.1, None if part is None else part[rows])
        assert found == pytest.approx(expected.numbers, rel=1e-9, nan_ok=True)
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


def test_a_success_is_no_life_that_ends(shown):
    ds = linear(samples=100)
    ds = with_output(ds, "locking", ds["y"].values, "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    said = shown(asking(ds, outputs=["locking"])).value(
        "[...document.querySelectorAll('#explore, #tolerances')].map(s => s.innerText).join()"
    )
    assert said.count("Share that has not yet succeeded") == 2 and "10\u00a0% quantile of" in said
    assert "outlives" not in said and "B10" not in said


@pytest.mark.parametrize("design", [("monte-carlo", 400, 1), ("sobol", 64, 8)], ids=str)
def test_censored_lives_have_the_numbers_of_python(shown, design):
    ds = kinds(*design, analysis={"thresholds": {"life": [1.4, 9.0]}})
    part = replicates_of(ds)
    found = cells(shown(ds))
    first = next(elements_of(ds, ["life"]))
    for time in (1.4, 9.0):
        assert first.unknown_sides(time).any()
        (here,) = found[f"{first.name}/{time:g}"]
        assert here == pytest.approx(ended_by(first, time, part)[1].numbers, nan_ok=True)
    for name, one in life_quantiles(first, {"0.1": 0.1, "0.5": 0.5}, part).items():
        (here,) = found[f"quantile/{name}"]
        assert here == pytest.approx(one.numbers, nan_ok=True)


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


def test_a_copied_command_is_said_to_be_for_two_seconds(shown):
    browser = shown(linear(samples=100))
    browser.value(
        "navigator.clipboard.writeText = async text => { window.clip = text };"
        " const wait = setTimeout; window.setTimeout = (work, time) => {"
        " if (time === 2000) window.later = work; else wait(work, time) }; 0"
    )
    open_by_keyboard(browser)
    browser.value("document.activeElement.click()")
    browser.painted()
    command = browser.value("document.querySelector('.card code').innerText")
    said = "document.querySelector('.card [role=status]').innerText"
    assert browser.value("window.clip") == command
    assert browser.value(said) == "Copied"
    browser.value("window.later()")
    assert browser.value(said) == ""


def open_by_keyboard(browser, key="Enter"):
    """Open the card of the row in the middle."""
    browser.value("document.querySelector('.scatter canvas').focus()")
    browser.press("ArrowRight", key)
    browser.painted()


def test_a_card_takes_the_focus_from_the_keyboard_and_gives_it_back(shown):
    browser = shown(linear(samples=100))
    at = "document.activeElement.textContent || document.activeElement.localName"
    tip = "document.querySelector('.tip').innerText"
    cards = "document.querySelectorAll('.card').length"
    open_by_keyboard(browser)
    row = browser.value("document.querySelector('.card').dataset.row")
    assert browser.value(at) == "Copy"
    browser.press("Escape")
    browser.painted()
    assert browser.value(cards) == 0 and browser.value(at) == "canvas"
    assert browser.value(tip).startswith(f"Row {row}\n")  # the arrows go on from there
    browser.click(*place_of_a_point(browser))
    browser.painted()
    assert browser.value(cards) == 1 and browser.value(at) == "canvas"


@pytest.mark.parametrize("size", [{}, {"width": 400, "height": 700}], ids=["wide", "phone"])
def test_a_click_leaves_the_plot_in_sight_and_escape_returns_to_it(shown, size):
    browser = shown(linear(samples=100), **size)
    plot = (
        "(() => { const b = document.querySelector('.scatter canvas').getBoundingClientRect();"
        " return b.top > -1 && b.bottom < window.innerHeight + 1 })()"
    )
    browser.click(*place_of_a_point(browser))
    browser.painted()
    command = "document.querySelector('.card code').getBoundingClientRect().bottom"
    assert browser.value(plot) and browser.value(f"{command} < window.innerHeight")
    browser.value("document.activeElement.blur()")  # as a click on the text of the card does
    browser.value("window.scrollTo(0, document.body.scrollHeight)")
    browser.press("Escape")
    browser.painted()
    assert browser.value("document.querySelectorAll('.card').length") == 0
    assert browser.value("document.activeElement.localName") == "canvas" and browser.value(plot)


def test_a_threshold_is_drawn_where_it_is_or_not_at_all(shown):
    for at, drawn in ((6.0, 1), (-1e3, 0), (1e3, 0)):
        browser = shown(linear(samples=100, analysis={"thresholds": {"y": at}}))
        for part in ("#explore", "#tolerances"):
            lines = f"document.querySelectorAll('{part} svg .threshold').length"
            assert browser.value(lines) == drawn


def test_inputs_are_called_as_in_the_answer(shown):
    ds = linear(samples=100)
    ds["x4"].attrs |= {"long_name": "a long explanation", "symbol": "xi_4"}
    browser = shown(ds)
    for place in (".range span", ".tolerance[data-name=x4] span"):
        found = browser.value(
            f"(one => [one.textContent, one.title])(document.querySelector('{place}'))"
        )
        assert found == ["x4 (ξ₄)", "a long explanation (ξ₄)"]
    options = browser.value("[...document.querySelectorAll('option')].map(o => o.textContent)")
    assert any(option.startswith("x4 (ξ₄)") for option in options)
    open_by_keyboard(browser)
    assert "x4 (ξ₄)" in browser.value("document.querySelector('.card').innerText")


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


EVERYTHING = """(async () => {
  const found = [], frame = requestAnimationFrame, sliders = ".tolerance input";
  const painted = () => new Promise(f => frame(() => frame(f)));
  const set = async (element, value, event) => {
    element.value = value;
    element.dispatchEvent(new Event(event));
    await painted();
    const words = document.body.innerText.match(/NaN|Infinity|undefined/);
    if (words) found.push(words[0]);
    if (document.querySelector('svg [d*=NaN], svg [x*=NaN], svg [x1*=NaN]')) found.push("path");
    if (document.documentElement.scrollWidth > innerWidth) found.push("too wide");
  };
  for (const select of document.querySelectorAll("select"))
    for (const option of select.options) await set(select, option.value, "change");
  for (const handle of document.querySelectorAll(".range input")) await set(handle, 250, "input");
  for (const chip of document.querySelectorAll(".chip")) chip.click();
  for (const value of [0.2, 1.5, 0.9])
    for (const slider of document.querySelectorAll(sliders)) await set(slider, value, "input");
  await new Promise(f => setTimeout(f, 300));
  return found })()"""


def odd_results():
    """Yield results that leave little to show, or too much."""
    asked = {"thresholds": {"y": 6.0}}
    yield linear(samples=1, analysis=asked)
    yield linear(samples=2, units=2, analysis=asked)
    yield kinds(samples=7, analysis={"thresholds": {"life": 1.0}})
    ds = linear(samples=50)
    for values in (np.full(50, 3.0), np.full(50, np.nan), 10.0 ** np.linspace(-200, 200, 50)):
        ds = with_output(ds, f"y{len(ds)}", values)
    ds["y"].attrs["long_name"] = "</script> " + 60 * "long" + " \u202e \U0001f600 \"'&"
    yield ds


def test_odd_results_are_shown_without_a_fault(shown):
    for ds in odd_results():
        browser = shown(ds, width=400)
        answer = browser.do(
            "Runtime.evaluate", expression=EVERYTHING, awaitPromise=True, returnByValue=True
        )
        assert answer["result"].get("value") == [], answer
        assert browser.complaints() == []
