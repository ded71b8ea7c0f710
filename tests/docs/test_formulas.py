"""Formulas of the documentation fit on a phone, in a font of the pages' own."""

import re
import shutil
from pathlib import Path

import pytest

pytest.importorskip("ziamath", reason="part of the packages for the documentation")

import formulas
import pages
from browser import CHROMIUM, tab

HOUSE = Path(__file__).parents[2]

MACHINES = sorted((HOUSE / "docs" / "machines").glob("*.md"))
_HEAD = """<!doctype html><meta charset="utf-8"><link rel="stylesheet" href="pages.css">
<meta name="viewport" content="width=device-width">"""
WIDE = 360  # of what a phone shows of a page [px]
_BLOCK, _INLINE = re.compile(r"^\$\$(.+?)\$\$$", re.MULTILINE), re.compile(r"\$([^$\n]+)\$")


@pytest.fixture(scope="module")
def phone(tmp_path_factory):
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: formulas can only be seen in a browser")
    folder = tmp_path_factory.mktemp("phone")
    formulas.write_font(folder / "math.woff")
    shutil.copy(HOUSE / "docs" / "_static" / "pages.css", folder)
    with tab(tmp_path_factory.mktemp("browser")) as chromium:
        yield chromium, folder


@pytest.mark.slow
@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.stem)
def test_formulas_fit_on_a_phone_in_the_font_of_the_pages(phone, path):
    browser, folder = phone
    blocks = _BLOCK.findall(path.read_text(encoding="utf-8"))
    body = "".join(map(formulas.block, blocks))
    page = folder / "page.html"
    page.write_text(f"{_HEAD}<body style='margin: 0'>{body}", encoding="utf-8")
    browser.open(page, width=WIDE)
    browser.painted()
    right = (
        "[...document.querySelectorAll('.formula > *')].map(e => e.getBoundingClientRect().right)"
    )
    assert len(blocks) >= 3 and max(browser.value(right)) <= WIDE
    assert browser.value("[...document.fonts].map(font => font.status)") == ["loaded"]
    assert browser.complaints() == []
    assert {Path(address).name for address in browser.requests()} == {
        "page.html",
        "pages.css",
        "math.woff",
    }


@pytest.mark.slow
def test_the_font_has_every_letter_of_every_formula():
    covered_letters = {code for start, end in formulas.CHARACTERS for code in range(start, end)}
    for path in (HOUSE / "docs").rglob("*.md"):
        text = pages.expanded(path.read_text(encoding="utf-8"))
        for tex in _INLINE.findall(re.sub(r"`[^`\n]*`|^```.*?^```", "", text, flags=re.M | re.S)):
            written = re.sub("<.*?>", "", formulas.inline(tex))
            letters = {int(code, 16) for code in re.findall("&#x(.*?);", written)}
            letters |= set(map(ord, re.sub("&#x.*?;", "", written)))
            assert letters <= covered_letters, (
                path,
                tex,
                [chr(code) for code in letters - covered_letters],
            )
