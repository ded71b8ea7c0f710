"""What a page shows of its rows: names, thresholds, which part, and odd results; or why none."""

import base64
import json
import re
from html import unescape

import numpy as np
import pytest
from computed import asking, kinds, linear, with_output, with_status
from explored import open_by_keyboard

from uq.assess.answer.answer import conclude
from uq.assess.findings import Findings
from uq.contract import Status
from uq.learning.inspections import read_inspections, read_tables
from uq.render.html.embedded_rows import MOST_ROWS, rows_inside
from uq.render.html.page import page
from uq.result.result import Result


def test_a_success_is_no_life_that_ends(shown):
    ds = linear(samples=100)
    ds = with_output(ds, "locking", ds["y"].values, "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    sentence = shown(asking(ds, outputs=["locking"])).value(
        "[...document.querySelectorAll('#explore, #tolerances')].map(s => s.innerText).join()"
    )
    assert sentence.count("Share that has not yet succeeded") == 2
    assert "outlives" not in sentence and "B10" not in sentence


def test_a_threshold_is_drawn_where_it_is_or_not_at_all(shown):
    for at, drawn in ((6.0, 1), (-1e3, 0), (1e3, 0)):
        browser = shown(linear(samples=100, analysis={"thresholds": {"y": at}}))
        for part in ("#explore", "#tolerances"):
            lines = f"document.querySelectorAll('{part} svg .threshold').length"
            assert browser.value(lines) == drawn


@pytest.mark.parametrize(
    ("symbol", "html", "plain"),
    [("xi_4", "x4 (ξ₄)", "x4 (ξ₄)"), ("k_tra", "x4 (k<sub>tra</sub>)", "x4")],
)
def test_inputs_are_called_as_in_the_answer(shown, symbol, html, plain):
    ds = linear(samples=100)
    ds["x4"].attrs |= {"long_name": "a long explanation", "symbol": symbol}
    browser = shown(ds)
    for place in (".range:not([hidden]) span", ".tolerance[data-name=x4] span"):
        label = browser.value(
            f"(one => [one.innerHTML, one.title])(document.querySelector('{place}'))"
        )
        assert label == [html, "a long explanation"]
    options = browser.value("[...document.querySelectorAll('option')].map(o => o.textContent)")
    assert plain in options
    open_by_keyboard(browser)
    called = re.sub("<.*?>", "", html)
    assert called in browser.value("document.querySelector('.card').innerText")


def test_a_page_of_many_rows_is_small_and_says_which_part_it_holds(shown):
    ds = linear(samples=100_000)
    for i in range(7):
        ds = with_output(ds, f"more{i}", ds["y"].values ** (i + 1))
    inside = rows_inside(Findings(Result(ds)), "many.nc")
    numbers = np.frombuffer(base64.b64decode(inside["numbers"]), "<i4")
    assert len(inside["columns"]) == 12 and inside["extent"].endswith("of 100\u00a0000.")
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
  for (const value of [0, 1, 4])
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


def failed_rows():
    """Return a result without any value."""
    ds = with_status(linear(samples=4), range(4), Status.RAISED)
    return with_output(ds, "y", np.full(4, np.nan))


def weighted_rows():
    """Return a result as inspections leave it."""
    ds = linear(samples=4)
    return ds.assign(weight=("row", np.ones(4), {"role": "weight"}))


@pytest.mark.parametrize(
    ("ds", "why"),
    [
        (failed_rows, "No row has a value of any output."),
        (lambda: asking(kinds(samples=8), outputs=["regime"]), "The outputs are categories"),
        (weighted_rows, "Inspections have weighted the rows"),
        (lambda: linear("morris", samples=4), "No row of design 'morris' follows the laws"),
    ],
    ids=["failed", "categories", "weighted", "morris"],
)
def test_a_page_that_cannot_compute_with_its_rows_says_why(ds, why, no_other_figures):
    text = unescape(page(Result(ds()), "a.nc"))
    section = text.partition('<section id="explore">')[2].partition("</section>")[0]
    assert why in section and "<script" not in section and 'id="rows"' not in text


def test_a_page_on_a_posterior_says_how_to_learn_it_again(tmp_path, no_other_figures):
    inspections = [
        {"unit": "A", "output": "y", "kind": "measured", "time": 2.0, "value": 0.1, "sd": 1e-3},
        {"unit": "B", "output": "y", "kind": "above", "time": 2.0, "value": 7.0},
    ]
    ds = weighted_rows().assign_attrs(
        inspections=json.dumps(inspections), model_error=0.2, new_rows=800
    )
    text = unescape(page(Result(ds), "after.nc"))
    update = "uq update results/linear.nc inspections.csv -o after.nc --rows 800 --model-error 0.2"
    assert update in text.partition("uq run linear.toml")[2]
    given = text.partition("<h3>The inspections</h3>\n<pre>")[2].partition("</pre>")[0]
    (tmp_path / "inspections.csv").write_text(given)
    assert read_inspections(tmp_path / "inspections.csv") == read_tables(inspections)
    assert "inspections.csv" not in page(Result(linear(samples=4)), "a.nc")


def test_the_first_plot_is_over_what_the_answer_names(shown):
    ds = linear(samples=2000, analysis={"thresholds": {"y": 100.5}})
    rare = 100.0 * (ds["x2"].values > 0.9)
    ds["y"].values[:] = ds["x1"].values + rare  # ranks vary most over x1, values over x2
    assert "ontributes most" in repr(conclude(Findings(Result(ds))))
    names = "[...document.querySelectorAll('.range:not([hidden])')].map(one => one.dataset.name)"
    assert shown(ds).value(names) == ["x2", "y"]
