"""What the tests of pages need: a browser."""

import re

import pytest
from browser import CHROMIUM, tab


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """Return a tab of a browser."""
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: the report can only be tested in a browser")
    with tab(tmp_path_factory.mktemp("browser")) as one:
        yield one


@pytest.fixture
def shown(browser, tmp_path):
    """Return a function that opens the part of a report on its rows."""
    from explored import explorer

    def show(ds, **how):
        path = tmp_path / "page.html"
        path.write_text(explorer(ds), encoding="utf-8")
        browser.open(path, **how)
        browser.painted()
        return browser

    yield show
    assert browser.complaints() == []
    assert all(re.match("file:|data:", address) for address in browser.requests())
