"""A row of a page by its number: opened as by a click, refused, or only named."""

import base64

import numpy as np
import pytest
from computed import linear

from uq.result.result import Result
from uq.assess.findings import Findings
from uq.render.html.embedded_rows import rows_inside
from uq.result.elements import independent_rows

BOX = "document.querySelector('#explorer form input')"
HINT = "document.querySelector('#explorer form [role=status]').innerText"
CARD = "document.querySelector('.card')?.innerText ?? ''"


def ask(browser, number):
    """Type a number over what is there, and Enter."""
    browser.value(f"{BOX}.focus(); {BOX}.select()")
    browser.do("Input.insertText", text=number)
    browser.press("Enter")
    browser.painted()


@pytest.mark.parametrize("size", [{}, {"width": 400, "height": 700}], ids=["wide", "phone"])
def test_a_number_opens_its_row(shown, size):
    ds = linear(samples=100)
    browser = shown(ds, **size)
    assert browser.value(f"{BOX}.labels[0].innerText.trim()") == "Row"
    for number in (0, 57, 99):
        ask(browser, str(number))
        card = browser.value(CARD)
        assert f"uq row 'a result.nc' {number}" in card and browser.value(HINT) == ""
        assert all(f"{ds[one].values[number]:.6g}" in card for one in ("x1", "x2", "x3", "x4", "y"))
    box = "document.querySelector('.card').getBoundingClientRect()"
    assert browser.value(f"{box}.top < innerHeight")
    browser.press("Escape")
    assert browser.value(CARD) == ""


@pytest.mark.parametrize("number", ["100", "-1", "1.5", ""])
def test_a_wrong_number_says_what_is_allowed(shown, number):
    browser = shown(linear(samples=100))
    ask(browser, number)
    assert browser.value(CARD) == ""
    assert browser.value(HINT) == "Rows have the numbers 0 to 99."
    assert browser.value(f"{BOX}.ariaInvalid") == "true"
    ask(browser, "99")
    assert browser.value(HINT) == "" and browser.value(f"{BOX}.ariaInvalid") == "false"
    assert "Row 99" in browser.value(CARD)


def test_a_row_that_the_page_does_not_hold_has_its_command(shown):
    ds = linear(samples=30_000)
    inside = rows_inside(Findings(Result(ds)), "many.nc")
    numbers = np.frombuffer(base64.b64decode(inside["numbers"]), "<i4").tolist()
    browser = shown(ds)
    absent = min(set(range(30_000)) - set(numbers))
    ask(browser, str(absent))
    card = browser.value(CARD).replace("\xa0", " ")
    assert "Not among the 20 000 rows in this page, a random part of 30 000" in card
    assert f"uq row 'a result.nc' {absent}" in card and "Inputs" not in card
    ask(browser, str(numbers[7]))
    assert "Inputs" in browser.value(CARD)


def test_a_row_beside_those_of_statistics_has_its_command(shown):
    ds = linear("saltelli", samples=64)
    browser = shown(ds)
    beside = set(ds["sample"].values.tolist()) - set(independent_rows(ds)["sample"].values.tolist())
    ask(browser, str(max(beside)))
    card = browser.value(CARD)
    assert "those that count in its statistics" in card and "Inputs" not in card
