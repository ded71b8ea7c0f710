"""What several tests need: a browser, and machines from outside."""

import itertools
import re

import pytest
from browser import CHROMIUM, tab
from own_machines import PAD, PAD_PROGRAM, WEAR_STUDY
from own_study import own_study

from uq.machines import server

_numbers = itertools.count()


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


@pytest.fixture
def write_function(folder):
    """Return a function that writes a module of its own, and returns the name of its file."""

    def write(text, study=WEAR_STUDY):
        name = f"own_machine_{next(_numbers)}.py"
        (folder / name).write_text(text)
        (folder / "own.toml").write_text(study)
        return name

    return write


@pytest.fixture
def write_program(folder):
    """Return a function that writes machine file, template, program and study."""

    def write(program=PAD_PROGRAM, text=PAD):
        (folder / "machine.toml").write_text(text)
        (folder / "deck").write_text("load={load}\nseed={seed}\nother={braces}\n")
        (folder / "own.toml").write_text(own_study("pad", "load", upper=2.0))
        (folder / "program").write_text(program)
        (folder / "program").chmod(0o755)

    return write


@pytest.fixture
def forgetful(monkeypatch):
    """Let a test ask servers anew, for a short time only."""
    monkeypatch.setattr(server, "_SOON", 20.0)
    server._known.cache_clear()
