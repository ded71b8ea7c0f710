"""Outputs of a program: keys of JSON, columns of CSV, netCDF variables, or a pattern."""

import csv
import json
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from uq.errors import one_line
from uq.files.netcdf_files import refuse_tricks
from uq.machines.machine_file import STDOUT, OutputTable
from uq.machines.returned import RowError
from uq.text.literals import read_number

LONGEST = 100_000_000
"""Bytes of a text that is searched for a result."""

_SEARCH_SECONDS = 10.0  # some patterns need exponential time

_SHOWN = 60  # characters of a text that is no number

STDOUT_FILE, STDERR_FILE = "stdout.txt", "stderr.txt"
"""Names of the files in the folder of a row with the output of its program."""


def value_in(folder: Path, name: str, output: OutputTable) -> Any:
    """Return an output from the folder of a row: a number, or nested lists of them.

    Raises
    ------
    RowError
        When it is not there, with the reason.
    """
    file = STDOUT_FILE if output.file == STDOUT else output.file
    where = "its output" if output.file == STDOUT else f"'{output.file}'"
    path = folder / file
    if not path.is_file():
        raise RowError(f"wrote no file '{output.file}', where '{name}' is expected")
    try:
        if output.netcdf:
            return _in_netcdf(path, output.netcdf)
        if path.stat().st_size > LONGEST:
            raise RowError(f"wrote {path.stat().st_size} bytes to {where}; too many to read")
        text = path.read_text(encoding="utf-8-sig", errors="replace")
        if output.json_path:
            return _in_json(text, output.json_path)
        if output.csv:
            return _in_csv(text, output.csv)
        return _matched(text, output.pattern)
    except (LookupError, ValueError, TypeError, OverflowError, OSError, RecursionError) as error:
        raise RowError(f"has no '{name}' in {where}: {one_line(error)}") from None


def _in_json(text: str, path: str) -> Any:
    value = json.loads(text, parse_float=read_number)
    for part in path.split("."):
        if isinstance(value, dict):
            if part not in value:
                raise ValueError(f"no key '{part}' of '{path}'")
            value = value[part]
        elif isinstance(value, list):
            value = value[int(part)]
        else:
            raise ValueError(f"nothing at '{part}' of '{path}'")
    return _number(value)


def _number(value: Any) -> Any:
    """Convert numbers written as text, such as ``"inf"``, since JSON has no infinity."""
    if isinstance(value, list):
        return [_number(element) for element in value]
    if not isinstance(value, str | int | float):
        raise ValueError(f"no number: {json.dumps(value)[:_SHOWN]}")
    return _real(value) if isinstance(value, str) else float(value)


def _real(text: str) -> float:
    """Parse a number, also in the format of Fortran: ``1.5D+03``."""
    if "_" in text:  # in numbers only Python reads it
        raise ValueError(f"no number: '{text[:_SHOWN]}'")
    if re.fullmatch(r"\s*[-+.\d]+[dD][-+]?\d+\s*", text):
        text = re.sub("[dD]", "e", text)
    try:
        return read_number(text)
    except ValueError:
        raise ValueError(f"no number: '{text[:_SHOWN]}'") from None


def _in_csv(text: str, column: str) -> float:
    rows = list(csv.DictReader(text.splitlines(), skipinitialspace=True))
    if not rows:
        raise ValueError("no row below the first line")
    if column not in rows[0]:
        raise ValueError(f"no column '{column}'")
    return _real(rows[-1][column] or "")


def _matched(text: str, pattern: str) -> float:
    match = _last_match(text, pattern)
    if not match:
        raise ValueError(f"no match of its pattern {pattern}")
    return _real(match[0])


_SEARCH = """
import json, re, sys
pattern, text = json.load(sys.stdin)
json.dump(re.findall(pattern, text, re.MULTILINE)[-1:], sys.stdout)
"""


def _last_match(text: str, pattern: str) -> list[str]:
    """Return the last match of a pattern, or none.

    Raises
    ------
    ValueError
        When the search takes too long. In the main thread a signal ends it. Other threads receive
        no signals, so they search in a separate process.
    """
    sentence = f"its pattern {pattern} takes too long to search for"
    if threading.current_thread() is threading.main_thread():
        with _stopped_after(_SEARCH_SECONDS, sentence):
            return re.findall(pattern, text, re.MULTILINE)[-1:]
    command = [sys.executable, "-I", "-c", _SEARCH]
    both, seconds = json.dumps([pattern, text]), _SEARCH_SECONDS
    try:
        done = subprocess.run(command, input=both, capture_output=True, text=True, timeout=seconds)
        return list(json.loads(done.stdout))
    except subprocess.TimeoutExpired:
        raise ValueError(sentence) from None


@contextmanager
def _stopped_after(seconds: float, sentence: str) -> Iterator[None]:
    """Raise a `ValueError` when a search in the main thread takes longer."""

    def stop(number: int, frame: object) -> None:
        raise ValueError(sentence)

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _in_netcdf(path: Path, variable: str) -> Any:
    import netCDF4

    refuse_tricks(path)
    with netCDF4.Dataset(path) as data:
        if variable not in data.variables:
            raise ValueError(f"no variable '{variable}'")
        if data[variable].size * 8 > LONGEST:
            raise ValueError(f"too large: {data[variable].size} numbers")
        return np.ma.filled(np.ma.asarray(data[variable][...], dtype=float), np.nan).tolist()
