"""How far a run is: a few moving lines on a terminal, plain lines now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from math import isinf

from uq.interrupts import undone
from uq.running.options import Progress, Report
from uq.wording import duration, number

_PLAIN_SECONDS = 10.0
_PLAIN_WIDTH = 120
_COMPILING = "compiling the model: once, and it may take a minute"


@contextmanager
def shown(quiet: bool) -> Iterator[Report]:
    """Yield a function that shows a `Progress` on standard error."""
    if quiet:
        yield lambda _: None
    elif sys.stderr.isatty():
        yield from _moving()
    else:
        yield _Plain()


@cache
def say_compiling() -> None:
    """Say once, to somebody who looks, that a model is being compiled."""
    if sys.stderr.isatty():
        _print(_COMPILING)


class Pace:
    """Rows per second since the first arrived: before that, a model may have been compiled."""

    def __init__(self) -> None:
        self._first: tuple[int, float] | None = None

    def __call__(self, progress: Progress, now: float) -> float:
        """Return the pace at some time [s]; 0 while it is not known."""
        if self._first is None:
            self._first = progress.done, now
        done, began = self._first
        return (progress.done - done) / (now - began) if now > began else 0.0


class _Plain:
    def __init__(self) -> None:
        self._last = time.monotonic()
        self._pace = Pace()
        self._dashboard = ""
        self._compiling = False

    def __call__(self, progress: Progress) -> None:
        if progress.compiling:
            if not self._compiling:
                _print(_COMPILING)
            self._compiling = True
            return
        now = time.monotonic()
        pace = self._pace(progress, now)
        if progress.dashboard not in ("", self._dashboard):
            self._dashboard = progress.dashboard
            _print(f"dask dashboard: {self._dashboard}")
        if now - self._last >= _PLAIN_SECONDS:
            self._last = now
            line = sentence(progress, pace)
            for more in details(progress):
                if len(line) + len(more) + 2 <= _PLAIN_WIDTH:
                    line += f"; {more}"
            _print(line)


def _print(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _moving() -> Iterator[Report]:
    from rich.console import Console, Group
    from rich.live import Live
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar
    from rich.text import Text

    pace = Pace()
    console = Console(stderr=True, highlight=False)
    columns = (BarColumn(bar_width=10), TextColumn("{task.description}", markup=False))
    bar = Bar(*columns, console=console)
    task = bar.add_task("starting", total=None)
    with Live(bar, console=console, transient=True) as live, undone(live.stop):
        dashboard = ""

        def show(progress: Progress) -> None:
            nonlocal dashboard
            if progress.compiling:
                bar.update(task, description=_COMPILING)
                return
            text = sentence(progress, pace(progress, time.monotonic()))
            bar.update(task, completed=progress.done, total=progress.total, description=text)
            lines = [Text(line, no_wrap=True, overflow="ellipsis") for line in details(progress)]
            live.update(Group(bar, *lines))
            if progress.dashboard not in ("", dashboard):
                dashboard = progress.dashboard
                live.console.print(f"dask dashboard: {dashboard}", markup=False)

        yield show


def sentence(progress: Progress, pace: float) -> str:
    """Say how far a run is, at some rows per second; 0 if that is not known."""
    said = f"{progress.done} of {progress.total} rows, "
    if pace:
        left = (progress.total - progress.done) / pace
        said += f"{pace:.3g} rows/s, {_clock(left)} left, "
    return f"{said}{progress.failed} failed"


def details(progress: Progress) -> list[str]:
    """Say how rows ended that are not sound, and what the others say so far; a line for each."""
    lines = []
    if lost := {label: n for label, n in progress.status.items() if n and label != "ok"}:
        lines.append(", ".join(f"{label} {n}" for label, n in lost.items()))
    if progress.median is not None:
        name, median = progress.median
        told = duration(median) or f"{number(median)} s"
        lines.append(f"median {name}: {'most rows do not end' if isinf(median) else told}")
    if progress.shares:
        lines.append(", ".join(f"{name} {share:.0%}" for name, share in progress.shares.items()))
    return lines


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
