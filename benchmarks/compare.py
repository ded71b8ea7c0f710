"""Comparison of tools: each with its cheapest setting that is accurate enough, timed in turn."""

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

_REPEAT = 3


class Rival(NamedTuple):
    """A tool.

    Attributes
    ----------
    run : callable
        ``run(rows, setting)`` returns the results of the first rows, row by row.
    settings : sequence of float
        From cheap to expensive.
    rows : int
        To be timed.
    """

    run: Callable[[int, Any], Any]
    settings: Sequence[float]
    rows: int


def clock(function, repeat=_REPEAT):
    """Return the result and the best time of some calls [s], after one that warms up."""
    best = np.inf
    result = function()
    for _ in range(repeat):
        seconds = _seconds(function)
        best = min(best, seconds)
    return result, best


def _seconds(function):
    began = time.perf_counter()
    function()
    return time.perf_counter() - began


def cheapest(settings, error, goal):
    """Return the cheapest setting with an error below the goal, and the error."""
    for setting in settings:
        reached = error(setting)
        if reached <= goal:
            return setting, reached
    raise RuntimeError(f"no setting reaches {goal}")


def compare(rivals, error_of, known_rows, goal, unit="", amount=1.0):
    """Print the tools' settings, errors and times, and the ratios of times to the first tool's.

    Returns these ratios by tool.

    Parameters
    ----------
    rivals : dict of str to Rival
    error_of : callable
        ``error_of(results)`` of a tool's first rows, `known_rows` at most.
    known_rows : int
        Rows of known results; a tool that is timed on fewer is judged by fewer.
    goal : float
        Largest error.
    unit : str
        Of the error, after a space.
    amount : float
        Work done in a row, in the unit to which times refer.
    """
    print(f"  largest error of up to {known_rows} rows at most {goal:.0e}{unit}")
    chosen = {
        name: cheapest(
            rival.settings,
            lambda setting, rival=rival: error_of(rival.run(min(known_rows, rival.rows), setting)),
            goal,
        )
        for name, rival in rivals.items()
    }
    best = dict.fromkeys(rivals, np.inf)
    for _ in range(_REPEAT):  # by turns, so that a busy host is unfair to nobody
        for name, rival in rivals.items():
            setting, _ = chosen[name]
            seconds = _seconds(lambda rival=rival, s=setting: rival.run(rival.rows, s))
            best[name] = min(best[name], seconds / (rival.rows * amount))
    first = next(iter(best.values()))
    ratios = {name: each / first for name, each in best.items()}
    for name, (setting, error) in chosen.items():
        time_each, ratio = f"{best[name] * 1e3:9.4f} ms", f"{ratios[name]:7.1f}"
        print(f"    {name:32s} {setting:9.3g} {error:9.1e} {time_each} {ratio}")
    return ratios
