"""The progress of a run: a live display on a terminal, occasional plain lines elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from math import isinf

from uq.execution.options import Progress, Report
from uq.files.interrupts import undone
from uq.text.literals import plain_line
from uq.text.numbers import duration, number

_PLAIN_SECONDS = 10.0
_PLAIN_WIDTH = 120
_START_SECONDS = 5.0  # in which the processes of a run start
_COMPILING = "compiling the model (once; it may take a minute)"


@contextmanager
def shown(quiet: bool) -> Iterator[Report]:
    """Yield a function that shows a `Progress` on standard error."""
    if quiet:
        yield lambda _: None
    else:
        yield from _moving() if sys.stderr.isatty() else _plain()


@cache
def say_compiling() -> None:
    """Report once, on a terminal only, that a model is being compiled."""
    if sys.stderr.isatty():
        say(_COMPILING)


class Pace:
    """Rows per second, without the time in which processes start and models compile.

    Time counts from the arrival of the first rows, or from the start if these rows took longer than
    starting processes: slow rows of several workers arrive together.
    """

    def __init__(self) -> None:
        self._began: tuple[int, float] | None = None
        self._arrived = False

    def __call__(self, progress: Progress, now: float) -> float:
        """Return the pace at a time [s]; 0 while it is unknown."""
        if progress.compiling:
            self._began = None
            return 0.0
        if self._began is None:
            self._began = progress.done, now
        if progress.done > progress.reused and not self._arrived:
            self._arrived = True
            if now - self._began[1] < _START_SECONDS:
                self._began = progress.done, now
        done, began = self._began
        return (progress.done - done) / (now - began) if now > began else 0.0


def _plain() -> Iterator[Report]:
    pace, shown_at = Pace(), time.monotonic()
    once = cache(say)

    def show(progress: Progress) -> None:
        nonlocal shown_at
        now = time.monotonic()
        speed = pace(progress, now)
        if progress.compiling:
            once(_COMPILING)
            return
        if progress.dashboard:
            once(f"dask dashboard: {progress.dashboard}")
        if now - shown_at >= _PLAIN_SECONDS:
            shown_at = now
            line = sentence(progress, speed)
            for more in details(progress):
                if len(line) + len(more) + 2 <= _PLAIN_WIDTH:
                    line += f"; {more}"
            say(line)

    yield show


def say(line: str) -> None:
    """Print a line on standard error."""
    print(line, file=sys.stderr, flush=True)


def say_plain(*lines: str) -> None:
    """Print lines on standard error, without control characters."""
    for line in lines:
        say(plain_line(line))


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
    latest = Progress(0, 0, 0), 0.0, 0.0

    def picture() -> Group:
        progress, speed, then = latest
        if not progress.total:
            return Group(bar)
        text = sentence(progress, speed, time.monotonic() - then)
        if progress.compiling:
            text = _COMPILING
        bar.update(task, completed=progress.done, total=progress.total or None, description=text)
        lines = [Text(line, no_wrap=True, overflow="ellipsis") for line in details(progress)]
        return Group(bar, *lines)

    with (
        Live(get_renderable=picture, console=console, transient=True) as live,
        undone(live.stop),
    ):
        once = cache(partial(live.console.print, markup=False))

        def show(progress: Progress) -> None:
            nonlocal latest
            now = time.monotonic()
            latest = progress, pace(progress, now), now
            if progress.dashboard:
                once(f"dask dashboard: {progress.dashboard}")

        yield show


def sentence(progress: Progress, pace: float, since: float = 0.0) -> str:
    """Return the progress of a run.

    Parameters
    ----------
    progress : Progress
    pace : float
        Rows per second; 0 if that is unknown.
    since : float
        How long ago that was [s].
    """
    text = f"{progress.done} of {progress.total} rows, "
    if progress.under_way:
        text += f"{progress.under_way} under way, "
    if pace:
        left = max((progress.total - progress.done) / pace - since, 0.0)
        text += f"{pace:.3g} rows/s, {_clock(left)} left, "
    return f"{text}{progress.failed} failed"


def details(progress: Progress) -> list[str]:
    """Return lines on the status of failed rows and on preliminary statistics of the others."""
    lines = []
    if lost := [f"{label} {n}" for label, n in progress.status.items() if n and label != "ok"]:
        lines.append(", ".join(lost))
    if progress.median is not None:
        name, median = progress.median
        text = duration(median) or f"{number(median)} s"
        lines.append(f"median {name}: {'most rows never end' if isinf(median) else text}")
    if progress.shares:
        lines.append(", ".join(f"{name} {share:.0%}" for name, share in progress.shares.items()))
    return lines


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
