"""The report in a real browser: on a desk, on a phone, on paper, and without script."""

import io
import re

import numpy as np
import pytest
from computed import kinds, linear, with_output, with_status
from explored import PAGE
from matplotlib.image import imread

from uq.contract import Status
from uq.render.html.page import page
from uq.result.result import Result

HOSTILE = '<script>alert("x")</script><img src=x onerror=alert(1)>&amp;'
UNFOLD = "document.querySelectorAll('details').forEach(fold => { fold.open = true })"
ASKED = {"thresholds": {"life": 1.0}, "sensitivity": ["rbd-fast"]}


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    ds = with_output(kinds(samples=200, analysis=ASKED), "odd", np.arange(200.0))
    ds["odd"].attrs["long_name"] = HOSTILE
    ds["x1"].attrs |= {"long_name": HOSTILE, "source": HOSTILE, "symbol": HOSTILE}
    ds = with_status(ds, [0], Status.RAISED).assign_attrs(title=HOSTILE, cpu=HOSTILE)
    ds["status"].attrs["example_raised"] = HOSTILE
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(page(Result(ds), f"{HOSTILE}.nc"), encoding="utf-8")
    return path


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("width", [400, 1400])
def test_a_report_is_shown_without_complaint_or_request(browser, report, width, dark):
    browser.open(report, width=width, dark=dark)
    picture = imread(io.BytesIO(browser.picture()))
    assert browser.complaints() == []
    assert {re.match(r"(data:image|file:).*", address)[1] for address in browser.requests()} == {
        "data:image",
        "file:",
    }
    assert picture.shape[0] > 2000 and width - 20 < picture.shape[1] <= width  # a scroll bar
    assert browser.value("document.documentElement.scrollWidth") <= width  # nothing sticks out
    controls = ":is(#explore, #tolerances) :is(button, input, select, canvas)"
    is_named = "one => one.ariaLabel || one.innerText || one.labels.length"
    assert browser.value(f"[...document.querySelectorAll('{controls}')].every({is_named})")
    ground = picture[5, 5, :3].mean()
    assert (ground < 0.2) == dark
    assert abs(picture[..., :3].mean(axis=2) - ground).max() > 0.7  # the text stands out


def test_names_with_markup_are_text(browser, report):
    browser.open(report)
    shown = browser.value("document.body.innerText")
    assert shown.count(HOSTILE) >= 5
    assert browser.value("document.title") != "" and browser.complaints() == []
    assert browser.value("document.querySelectorAll('img[src=x], [onerror]').length") == 0
    assert not any(name == "Page.javascriptDialogOpening" for name, _ in browser.events)


def test_tables_sort_by_a_click_and_back(browser, report):
    browser.open(report)
    column = (
        "(() => { const t = [...document.querySelectorAll('table')].find(t =>"
        " t.caption?.textContent.startsWith('Statistics'));"
        " const i = [...t.tHead.rows[0].cells].findIndex("
        "c => c.textContent === '50\u00a0% quantile');"
        " {}; return [...t.tBodies[0].rows].map(r => Number(r.cells[i].dataset.key)) })()"
    )
    click = "t.tHead.rows[0].cells[i].querySelector('button').click()"
    before = browser.value(column.replace("{}", ""))
    up = browser.value(column.replace("{}", click))
    down = browser.value(column.replace("{}", click))
    assert sorted(before) == up == down[::-1] != before


def test_the_table_of_contents_leads_to_every_section(browser, report):
    browser.open(report)
    links = "[...document.querySelectorAll('nav a')].map(a => a.getAttribute('href'))"
    there = "[...document.querySelectorAll('main > section')].map(s => '#' + s.id)"
    assert browser.value(links) == browser.value(there)


def test_all_is_there_without_script(browser, report):
    browser.open(report)
    there = "main > section:not(#explore, #tolerances)"
    words = (
        f"['table', 'svg', 'p'].map(n => document.querySelectorAll('{there} ' + n).length).join()"
    )
    buttons = "document.querySelectorAll('button').length"
    with_script = browser.value(words)
    assert browser.value(buttons) > 0
    browser.open(report, script=False)
    assert browser.value(words) == with_script and browser.value(buttons) == 0


def test_a_report_prints_on_a4(browser, report):
    browser.open(report, dark=True)
    pdf = browser.pdf()
    assert pdf.startswith(b"%PDF-")
    sizes = set(re.findall(rb"/MediaBox ?\[([^\]]+)\]", pdf))
    assert {tuple(round(float(n)) for n in size.split()) for size in sizes} == {(0, 0, 595, 842)}


def test_heads_of_tables_are_printed_on_every_page(browser, report):
    browser.open(report)
    browser.do("Emulation.setEmulatedMedia", media="print")
    shown = browser.value(
        "[...document.querySelectorAll('th button')].map(b => getComputedStyle(b).display)"
    )
    browser.do("Emulation.setEmulatedMedia", media="")
    assert shown and set(shown) == {"contents"}  # Chromium repeats no box of a button


def test_no_printed_figure_leaves_half_a_page_empty(browser, report):
    browser.open(report, width=690)  # pixels between the margins of A4
    browser.do("Emulation.setEmulatedMedia", media="print")
    heights = browser.value(
        "[...document.querySelectorAll('.pictures figure')].map(f => f.offsetHeight)"
    )
    browser.do("Emulation.setEmulatedMedia", media="")
    assert 100 < min(heights) and max(heights) < 480  # of 1000 pixels, with its caption


def test_a_wide_figure_is_printed_where_it_has_room(browser, tmp_path):
    wide, narrow = ('<svg viewBox="0 0 174 50"></svg>', '<svg viewBox="0 0 84 60"></svg>')
    path = tmp_path / "print.html"
    path.write_text(
        f"{PAGE}<body><div style='height: 16cm'></div><div class=pictures>"
        f"<figure class=full>{wide}</figure><figure>{narrow}</figure></div>"
        "<div style='height: 17cm; break-inside: avoid'></div>"
    )
    browser.open(path)
    assert len(re.findall(rb"/Type\s*/Page\b", browser.pdf())) == 2  # a hole would need a third


def test_letters_of_printed_figures_are_not_too_small(browser, report):
    browser.open(report, width=690)
    browser.do("Emulation.setEmulatedMedia", media="print")
    points = browser.value(
        "[...document.querySelectorAll('figure svg')].filter(one => one.checkVisibility())"
        ".flatMap(svg => { const {width, height} = svg.viewBox.baseVal;"
        " const box = svg.getBoundingClientRect();"
        " const scale = 0.75 * Math.min(box.width / width, box.height / height);"
        " return [...svg.querySelectorAll('text')].map(one => parseFloat("
        "getComputedStyle(one).fontSize)).filter(size => size > 6).map(size => scale * size) })"
    )  # indices of symbols are smaller
    browser.do("Emulation.setEmulatedMedia", media="")
    assert len(points) > 5 and min(points) >= 7


def test_a_printed_report_has_figures_instead_of_controls(browser, report):
    browser.open(report)
    shown = "[...document.querySelectorAll('#explore, #tolerances')].map(s => s.offsetHeight)"
    assert min(browser.value(shown)) > 0
    browser.do("Emulation.setEmulatedMedia", media="print")
    hidden = browser.value(shown)
    browser.do("Emulation.setEmulatedMedia", media="")
    assert hidden == [0, 0]


@pytest.mark.slow
def test_a_report_of_one_row_is_shown_too(browser, tmp_path):
    path = tmp_path / "one.html"
    path.write_text(page(Result(linear(samples=1)), "one.nc"), encoding="utf-8")
    browser.open(path, width=400)
    assert browser.complaints() == []


@pytest.mark.parametrize(("width", "height", "screens"), [(1400, 900, 1), (400, 800, 2)])
def test_the_answer_fits_the_first_screen_or_two_of_a_phone(
    browser, report, width, height, screens
):
    browser.open(report, width=width, height=height)
    screen = "document.querySelector('.first-screen')"
    bottom = browser.value(f"{screen}.getBoundingClientRect().bottom + scrollY")
    assert bottom <= screens * height
    for part in (".main-tile", "svg", ".bar", ".checks", ".checks ~ ul"):
        assert browser.value(f"{screen}.querySelector('{part}') !== null"), part


def test_bars_of_indices_start_and_end_alike_whatever_the_sign_of_the_number(browser, tmp_path):
    path = tmp_path / "crossed.html"
    path.write_text(
        page(Result(linear("saltelli", samples=16, replicates=4)), "crossed.nc"), "utf-8"
    )
    browser.open(path)
    tables = "[...document.querySelectorAll('.subject table')]"
    bars = "[...t.querySelectorAll('td:nth-child(2) .bar')]"
    place = "b => [b.getBoundingClientRect().left, b.getBoundingClientRect().width].join()"
    places = browser.value(f"{tables}.map(t => {bars}.map({place}))")
    signs = browser.value(f"{tables}.map(t => t.textContent).join(' ')").count("\u2212")
    assert signs and all(len(set(start)) == 1 for start in places if start)


def test_captions_of_wide_tables_stay_in_sight_on_a_phone(browser, report):
    browser.open(report, width=400)
    browser.value(UNFOLD)
    wide = (
        "[...document.querySelectorAll('main section .wide')].filter(w => !w.closest('.subject'))"
    )
    browser.value(f"{wide}.forEach(one => one.scrollLeft = 1e4)")
    ends = "(b => [b.left, b.right])(one.querySelector('caption').getBoundingClientRect())"
    scrolled = f"{wide}.filter(one => one.scrollLeft > 50).map(one => {ends})"
    caption_ends = browser.value(scrolled)
    assert caption_ends and all(0 <= left and right <= 400 for left, right in caption_ends), (
        caption_ends
    )


def test_a_printed_answer_fills_its_columns(browser, report):
    browser.open(report, width=690)
    browser.do("Emulation.setEmulatedMedia", media="print")
    used = browser.value(
        "(() => { const a = document.querySelector('.answer'), box = a.getBoundingClientRect();"
        " const parts = [...a.children].flatMap(one => [...one.getClientRects()]);"
        " return parts.reduce((sum, b) => sum + b.width * b.height, 0) / box.width / box.height"
        " })()"
    )
    browser.do("Emulation.setEmulatedMedia", media="")
    assert used > 0.78  # the gap between the columns is no part of any
