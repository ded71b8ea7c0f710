"""The progress of a run: a live display on a terminal, occasional plain lines elsewhere."""

import sys
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from math import isinf

from uq.execution.options import Progress, Report
from uq.files.interrupts import undone
from uq.text.literals import plain_line
from uq.text.numbers import duration, elapsed, number

_PLAIN_SECONDS = 10.0
_PLAIN_WIDTH = 120
_START_SECONDS = 5.0  # in which the processes of a run start
_PAUSE_SECONDS = 1.0  # without a row under way: longer than it takes to keep rows
_WINDOW_SECONDS = 5.0  # least time over which rows are counted
_MINUTE = 59.5  # s
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

    Time counts from the arrival of the first rows, or from the start if one row took longer than
    starting processes: slow rows of several workers arrive together. Only the later half of that
    time counts, so that a slow beginning and changes of load are forgotten.
    """

    def __init__(self) -> None:
        self._last = Progress(0, 0, 0), 0.0
        self._arrived = False
        self._seen: deque[tuple[int, float]] = deque()
        self._began = 0.0

    def __call__(self, progress: Progress, now: float) -> float:
        """Return the pace at a time [s]; 0 while it is unknown."""
        (last, before), self._last = self._last, (progress, now)
        if progress.compiling:
            self._seen.clear()
            return 0.0
        idle = progress.under_way and not last.under_way and progress.done == last.done
        if idle and now - before > _PAUSE_SECONDS:  # workers have started
            self._seen.clear()
        if progress.done > progress.reused and not self._arrived:
            self._arrived = True
            is_chunk = progress.done > progress.reused + 1  # its time includes loading the model
            if self._seen and (is_chunk or now - self._began < _START_SECONDS):
                self._seen.clear()
        if not self._seen:
            self._began = now
        self._seen.append((progress.done, now))
        earliest = now - max(_WINDOW_SECONDS, (now - self._began) / 2)
        while len(self._seen) > 1 and self._seen[1][1] <= earliest:
            self._seen.popleft()
        done, since = self._seen[0]
        return (progress.done - done) / (now - since) if now > since else 0.0


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
        about = f"about {elapsed(left)}" if left >= _MINUTE else "less than 1 min"
        text += f"{pace:.3g} rows/s, {about} left, "
    return f"{text}{progress.failed} invalid"


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
