"""Pictures of the machines on a phone: whole, and their letters are legible."""

import shutil
from pathlib import Path

import generated
import pytest
from browser import CHROMIUM, tab
from sketches import sheet

HOUSE = Path(__file__).parents[2]

PHONE = 375  # px
SMALLEST = 12.0  # letters are drawn with 11 points


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize("machine", generated.machines())
def test_a_machine_fits_on_a_phone_with_letters_that_can_be_read(machine, tmp_path):
    for path in (HOUSE / "docs" / "_static").iterdir():
        shutil.copy(path, tmp_path)
    shutil.copy(HOUSE / "docs" / "pictures" / f"{machine}.svg", tmp_path)
    page = tmp_path / "page.html"
    page.write_text(
        '<!doctype html><meta name="viewport" content="width=device-width">'
        '<link rel="stylesheet" href="pages.css"><body style="margin: 0">'
        f'<article style="padding: 0 1rem"><p><img src="./{machine}.svg"></p></article>'
    )
    (tmp_path / "browser").mkdir()
    with tab(tmp_path / "browser") as browser:
        browser.open(page, width=PHONE)
        browser.painted()
        shown = "document.querySelector('img').getBoundingClientRect()"
        assert browser.value(f"{shown}.right") <= PHONE
        assert browser.value("document.querySelector('p').scrollWidth") <= PHONE
        narrow = page.with_name(f"{machine}-narrow.svg").as_uri()
        assert narrow in browser.requests()
        assert 11 * browser.value(f"{shown}.width") / sheet.NARROW >= SMALLEST
