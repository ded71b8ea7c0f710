"""The points of a page, each a row: under the mouse, by the keyboard, and its card."""

import re

import numpy as np
import pytest
from computed import linear
from explored import open_by_keyboard, place_of_a_point, ranges

ASKED = {"thresholds": {"y": 6.0}}


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
    status_text = "document.querySelector('.card [role=status]').innerText"
    assert browser.value("window.clip") == command
    assert browser.value(status_text) == "Copied"
    browser.value("window.later()")
    assert browser.value(status_text) == ""


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
    browser.value("document.querySelector('.range:not([hidden]) input').focus()")
    browser.press("ArrowRight", "ArrowRight")
    browser.painted()
    (low, high), _ = ranges(browser)
    assert low > x4.min() and high == np.inf
    assert browser.value("document.activeElement.ariaValueText") != "open"


@pytest.mark.parametrize("samples", [2, 50, 400])
def test_points_are_whole_and_few_of_them_are_large(shown, samples):
    browser = shown(linear(samples=samples), width=900)
    squares = browser.value(
        "(() => { const c = document.querySelector('.scatter canvas');"
        " const p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data, seen = [];"
        " for (let i = 0; i < p.length; i += 4) if (p[i] === 160 && Math.abs(p[i + 2] - 173) < 2)"
        " seen.push([i / 4 % c.width, Math.floor(i / 4 / c.width)]);"
        " const ends = k => [Math.min(...seen.map(s => s[k])), Math.max(...seen.map(s => s[k]))];"
        " return [seen.length, ...ends(0), c.width, ...ends(1), c.height] })()"
    )
    area, left, right, width, top, bottom, height = squares
    assert area >= samples * (30 if samples < 60 else 1)
    assert left > 62 and right < width - 8 and top > 8 and bottom < height - 26  # off the axes
