"""What the tests of pages need: a browser."""

import pytest
from browser import CHROMIUM, tab


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """Return a tab of a browser."""
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: the report can only be tested in a browser")
    with tab(tmp_path_factory.mktemp("browser")) as one:
        yield one
