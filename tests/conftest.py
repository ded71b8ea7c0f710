"""What many tests need: a folder, study files, the command line, a browser, machine files."""

import itertools
import os
import re
import signal
import sys
from typing import NamedTuple
from unittest.mock import patch

import dask  # noqa: F401  (before a verb that only reads calls it absent)
import pytest
from browser import CHROMIUM, tab
from hypothesis import HealthCheck, settings
from own_machines import PAD, PAD_PROGRAM, WEAR_STUDY
from own_study import own_study
from shared_compilation import compile_once_for_all_processes

import models.numerics.jit  # noqa: F401  (before numba: all tests compile as the command does)
from uq.cli import main
from uq.machines import server

_numbers = itertools.count()

# How long an example takes says how busy the machine is.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")

compile_once_for_all_processes()


def pytest_collection_modifyitems(items):
    """Let a process compile the machines in one file, while others do what needs no machine."""
    last = ("tests/docs", "tests/models")

    def place(item):
        path = item.nodeid
        return not path.startswith("tests/test_contract.py"), path.startswith(last)

    items.sort(key=place)


class Ended(NamedTuple):
    """How a command ended."""

    code: int
    out: str
    err: str


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return an empty folder that the test works in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def uq(folder, monkeypatch, capsys):
    """Return a function that runs ``uq ARGUMENTS`` in this process."""
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    environment = dict(os.environ)

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["uq", *map(str, arguments)])
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main()
        return Ended(ended.value.code, *capsys.readouterr())

    yield call
    os.environ.clear()
    os.environ.update(environment)
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture
def write_study(folder):
    """Return a function that writes a small study file and returns its path."""

    def write(
        model="ishigami",
        method="monte-carlo",
        samples=64,
        replicates=1,
        second_order=False,
        seed=5,
        uncertain=("x1", "x2", "x3"),
        law='distribution = "uniform", lower = 0.1, upper = 0.9',
        more="",
        name="small",
    ):
        lines = [
            "[study]",
            f'name = "{name}"',
            f'model = "{model}"',
            "[design]",
            f'method = "{method}"',
            f"samples = {samples}",
            f"replicates = {replicates}",
            f"second_order = {str(second_order).lower()}",
            f"seed = {seed}",
            "[uncertain]",
            *(f"{parameter} = {{{law}}}" for parameter in uncertain),
            more,
        ]
        path = folder / f"{name}.toml"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write


@pytest.fixture
def no_other_figures():
    """Draw no figure but those that the test adds: that would take most of its time."""
    from uq import plots

    with patch.dict(plots.FIGURES, clear=True):  # puts them back in their order
        yield


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """Return a tab of a browser."""
    if CHROMIUM is None:
        pytest.skip("chromium is not installed: the report can only be tested in a browser")
    with tab(tmp_path_factory.mktemp("browser")) as chromium:
        yield chromium


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
    server._remote_model.cache_clear()
