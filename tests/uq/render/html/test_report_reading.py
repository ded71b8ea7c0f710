"""A report can be read: its contrast, names, heads and contents, and what it saves."""

import csv
import io
from urllib.parse import unquote

import pytest
from computed import computed, kinds, study_of

from uq.render.figures.figure import BARS, COLOURS
from uq.render.html.page import page
from uq.result.result import Result

UNFOLD = "document.querySelectorAll('details').forEach(fold => { fold.open = true })"
RATE = {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}
ASKED = {"thresholds": {"life": 1.0}, "tolerance": {"coverage": 0.9, "confidence": 0.9}}
FAINT = """(() => {
  const numbers = text => text.match(/[\\d.]+/g).map(Number);
  const over = (top, below) => {
    const [r, g, b, a = 1] = numbers(top);
    return [r, g, b].map((part, i) => a * part + (1 - a) * below[i]);
  };
  const groundOf = element => {
    const chain = [];
    for (let at = element; at; at = at.parentElement) chain.unshift(at);
    return chain.map(at => getComputedStyle(at).backgroundColor)
      .reduce((below, top) => over(top, below), [255, 255, 255]);
  };
  const light = rgb => rgb.map(part => part / 255)
    .map(part => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4)
    .reduce((sum, part, i) => sum + [0.2126, 0.7152, 0.0722][i] * part, 0);
  const faint = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement, text = walker.currentNode.data.trim();
    if (!text || !element.checkVisibility()) continue;
    if (element.closest("svg, :disabled, script, [aria-hidden]")) continue;
    const ground = groundOf(element), ink = over(getComputedStyle(element).color, ground);
    const [dark, bright] = [light(ink), light(ground)].sort((a, b) => a - b);
    if ((bright + 0.05) / (dark + 0.05) < 4.5) faint.push(text.slice(0, 60));
  }
  return faint })()"""


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """Return the path of a page on a result of every kind."""
    path = tmp_path_factory.mktemp("reading") / "report.html"
    path.write_text(page(Result(kinds(samples=200, analysis=ASKED)), "out.nc"), encoding="utf-8")
    return path


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
def test_all_text_stands_out_from_its_ground(browser, report, width, dark):
    browser.open(report, width=width, dark=dark)
    browser.value(UNFOLD)
    assert browser.value(FAINT) == []


def test_controls_are_named_and_tables_have_heads(browser, report):
    browser.open(report)
    browser.value(UNFOLD)
    empty = "[...document.querySelectorAll('{}')].filter(one => !one.textContent.trim()).length"
    assert browser.value(empty.replace("{}", "button, summary, nav a, th")) == 0
    tables = "[...document.querySelectorAll('table')].filter(table => table.rows.length)"
    bare = f"{tables}.filter(table => !table.querySelector('th[scope=col]'))"
    assert browser.value(f"{bare}.length") == 0
    # The order of the focus is that of the page.
    assert (
        browser.value("document.querySelectorAll('[tabindex]:not([tabindex=\"0\"])').length") == 0
    )
    assert browser.value("document.querySelectorAll('h1').length") == 1


def test_a_page_has_the_colours_of_its_figures(report):
    text = report.read_text().lower()
    assert f"--accent: {COLOURS[0]}".lower() in text and f"--warn: {COLOURS[1]}".lower() in text
    assert f".bar-fill {{ background: {BARS[0]}".lower() in text


def test_what_can_be_sorted_or_moved_looks_so(browser, report):
    browser.open(report, width=390)
    browser.value(UNFOLD)
    signs = browser.value(
        "[...document.querySelectorAll('th button')]"
        ".map(button => getComputedStyle(button, '::after').content)"
    )
    assert signs and all("\N{UP DOWN ARROW}" in content for content in signs)
    wide = "[...document.querySelectorAll('.wide')].filter(w => w.scrollWidth > w.clientWidth + 1)"
    grounds = browser.value(f"{wide}.map(w => getComputedStyle(w).backgroundImage)")
    assert grounds and all("gradient" in ground for ground in grounds)
    titles = browser.value(
        "[...document.querySelectorAll('.explorer figure')]"
        ".flatMap(figure => [...figure.querySelectorAll('.axis-title, figcaption')])"
        ".map(title => title.textContent)"
    )
    assert len(titles) == 4 and all(titles)


def test_a_folded_report_is_short_and_its_contents_open_it(browser, report):
    browser.open(report, width=1400, height=900)
    assert browser.value("document.documentElement.scrollHeight") <= 8 * 900
    fold = "document.querySelector('#convergence details')"
    assert browser.value(f"{fold}.open") is False
    link = "document.querySelector('nav a[href=\"#convergence\"]')"
    browser.value(f"{link}.click()")
    browser.painted()
    assert browser.value(f"{fold}.open") is True
    browser.value("window.scrollTo(0, 0)")
    browser.painted()
    marked = "[...document.querySelectorAll('nav [aria-current=true]')].map(a => a.textContent)"
    assert browser.value(marked) == ["Answer"]


def test_a_table_is_saved_as_it_is_shown(browser, report):
    browser.open(report)
    table = (
        "[...document.querySelectorAll('table')]"
        ".find(t => t.caption?.textContent.startsWith('Tolerance bounds'))"
    )
    texts = browser.value(
        f"[...{table}.tBodies[0].rows]"
        ".map(row => [...row.cells].map(cell => cell.firstChild?.textContent))"
    )
    address = browser.value(
        f"(() => {{ const link = {table}.querySelector('caption a');"
        " link.addEventListener('click', event => event.preventDefault()); link.click();"
        " return [link.href, link.download] })()"
    )
    assert address[1].startswith("Tolerance-bounds") and address[1].endswith(".csv")
    kind, _, content = address[0].partition(",")
    assert kind == "data:text/csv;charset=utf-8"
    head, *lines = csv.reader(io.StringIO(unquote(content)))
    assert {"lower", "upper", "unit"} < set(head) and len(lines) == len(texts) > 1
    assert all(len(line) == len(head) for line in lines)
    bounds = [line[head.index("lower")] for line in lines]
    assert [float(bound) for bound in bounds if bound not in ("-", "none", "")]


def test_the_warning_is_seen_beside_the_main_number(browser, tmp_path, no_other_figures):
    study = study_of(
        {
            "study": {"name": "wear", "model": "exponential-wear"},
            "design": {"method": "monte-carlo", "samples": 200},
            "uncertain": {"rate": RATE, "depth": RATE | {"median": 2.5e-4, "source": "assumed"}},
            "analysis": {"tolerance": {"coverage": 0.9, "confidence": 0.9}},
        }
    )
    path = tmp_path / "wear.html"
    path.write_text(page(Result(computed(study)), "wear.nc"), encoding="utf-8")
    browser.open(path)
    warning, number = (
        f"document.querySelector('.main-tile .{name}')" for name in ("warning", "tile-value")
    )
    boxes = browser.value(
        f"[{warning}, {number}].map(one => (b => [b.left, b.top, b.right, b.bottom])"
        "(one.getBoundingClientRect()))"
    )
    (left, top, _, bottom), (_, number_top, number_right, number_bottom) = boxes
    assert 0 < left - number_right < 300 and top < number_bottom and bottom > number_top
    ink = f"[{warning}, document.body].map(one => getComputedStyle(one).color)"
    assert len(set(browser.value(ink))) == 1
    assert "depth" in browser.value(f"{warning}.innerText")
