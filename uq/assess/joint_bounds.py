"""Tolerance bounds that hold for several outputs at once."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from uq.contract import Floats
from uq.result.element import Element
from uq.result.result import Result
from uq.stats import order_statistics
from uq.study.file import USUAL, AnalysisTable

SIDES = {"lower": ("lower",), "upper": ("upper",), "both": ("lower", "upper")}
"""Requested side of the bounds -> the bounds of each element of an output."""


class JointBound(NamedTuple):
    """One of several bounds that hold at once.

    Attributes
    ----------
    element, side : str
    value : float
        NaN with too few rows.
    beyond : bool
        Whether it is infinite only because rows are censored.
    rows_needed : float
        For all of them; infinite where too many rows fail.
    """

    element: str
    side: str
    value: float
    beyond: bool
    rows_needed: float


def joint_bounds(rows: Result, analysis: AnalysisTable) -> list[JointBound]:
    """Return the bounds that a study asks for.

    Parameters
    ----------
    rows : Result
        The independent rows of a result. Those in which one of the outputs is undefined are left
        out; failed rows count as outside.
    analysis : AnalysisTable
    """
    wanted = list(_wanted(rows, analysis.joint_bounds))
    if not wanted:
        return []
    failed = np.logical_or.reduce([element.failed for element, _ in wanted])
    present = np.logical_and.reduce([element.present for element, _ in wanted])
    lost = int(failed.sum())
    tolerance = analysis.tolerance or USUAL
    early, late = (
        order_statistics.joint_bounds(
            [_upward(element, side, censored)[present] for element, side in wanted],
            lost,
            *tolerance,
        )
        for censored in (False, True)
    )
    rows_seen = int(present.sum()) + lost
    needed = order_statistics.rows_still_needed(rows_seen, lost, *tolerance, len(wanted))
    return [
        JointBound(
            element.name,
            side,
            (-1 if side == "lower" else 1) * last,
            bool(np.isposinf(last) > np.isposinf(first)),
            needed,
        )
        for (element, side), first, last in zip(wanted, early, late, strict=True)
    ]


class Needed(NamedTuple):
    """The rows that bounds need if none fails: of one bound, or of several that hold at once."""

    rows: int
    bounds: int


def rows_needed(rows: Result, analysis: AnalysisTable) -> dict[str, Needed]:
    """Return the rows that the bounds of a study need, by key of its [analysis].

    Parameters
    ----------
    rows : Result
        Some of its rows.
    analysis : AnalysisTable
    """
    by_key = {}
    if analysis.tolerance:
        by_key["tolerance"] = Needed(order_statistics.rows_for_bound(*analysis.tolerance), 1)
    if bounds := len(list(_wanted(rows, analysis.joint_bounds))):
        needed = order_statistics.rows_for_bound(*(analysis.tolerance or USUAL), bounds=bounds)
        by_key["joint_bounds"] = Needed(needed, bounds)
    return by_key


def _wanted(rows: Result, asked: Mapping[str, str]) -> Iterator[tuple[Element, str]]:
    for element in rows.elements(tuple(asked)):
        for side in SIDES[asked[element.output]]:
            yield element, side


def _upward(element: Element, side: str, censored: bool) -> Floats:
    """Return values that an upper bound bounds; rows censored end when last seen, or never."""
    if side == "lower":
        return -element.values
    return np.where(element.censored & censored, np.inf, element.values)
