"""How far a run is: one moving line on a terminal, a plain line now and then elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from uq.interrupts import undone
from uq.job import Progress, Report

_PLAIN_SECONDS = 10.0


@contextmanager
def shown(quiet: bool) -> Iterator[Report]:
    """Yield a function that shows a `Progress` on standard error."""
    if quiet:
        yield lambda _: None
    elif sys.stderr.isatty():
        yield from _moving()
    else:
        yield _Plain()


class _Plain:
    def __init__(self) -> None:
        self._began = self._last = time.monotonic()

    def __call__(self, progress: Progress) -> None:
        now = time.monotonic()
        if now - self._last >= _PLAIN_SECONDS:
            self._last = now
            print(sentence(progress, now - self._began), file=sys.stderr, flush=True)


def _moving() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    began = time.monotonic()
    console = Console(stderr=True, highlight=False)
    columns = (BarColumn(bar_width=20), TextColumn("{task.description}", markup=False))
    with Bar(*columns, console=console, transient=True) as bar, undone(bar.stop):
        task = bar.add_task("starting", total=None)

        def show(progress: Progress) -> None:
            text = sentence(progress, time.monotonic() - began)
            bar.update(task, completed=progress.done, total=progress.total, description=text)

        yield show


def sentence(progress: Progress, seconds: float) -> str:
    """Say how far a run is after some seconds."""
    rate = (progress.done - progress.found) / seconds if seconds > 0 else 0.0
    left = (progress.total - progress.done) / rate if rate else 0.0
    return (
        f"{progress.done} of {progress.total} rows, {rate:.3g} rows/s, "
        f"{_clock(left)} left, {progress.failed} failed"
    )


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
