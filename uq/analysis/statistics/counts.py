"""How many rows have no value, or one less accurate than requested."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from uq.analysis.stated_error import stated_error
from uq.analysis.statistics.statistic import COLUMNS, COUNT, FACT, JSON, REPORT, Context, Statistic
from uq.estimate import Estimate
from uq.rows.elements import Element
from uq.wording import percent


def counts(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield how many rows never end, are censored, are undefined, or failed."""
    for name in ("never", "censored", "undefined", "failed"):
        number = float(getattr(element, name).sum())
        yield Statistic((name,), name, Estimate(number), "rows", COUNT)


_MISSED = replace(COUNT, write=FACT.write, readers=frozenset((JSON, COLUMNS, REPORT)))
_NONE_MISSED = replace(_MISSED, readers=frozenset((JSON, COLUMNS)))


def accuracy(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield how many rows state an error beyond the accuracy requested.

    Rows count if their value is finite and not censored; one that states no error falls short.
    """
    asked = context.rows[element.output].attrs.get("accuracy")
    error = stated_error(context.rows, element)
    if asked is None or error is None:
        return
    known = np.isfinite(element.values) & ~element.censored
    kept = np.abs(error.values[known]) <= asked * np.abs(element.values[known])
    rows, missed = len(kept), int((~kept).sum())
    share = missed / rows if rows else None
    words = ""
    if missed and share is not None:
        words = f"accuracy {asked:g} not reached in {missed} row{'s' if missed > 1 else ''}"
        words += f" ({percent(share)})"
    yield Statistic(
        ("accuracy",),
        "rows short of the accuracy",
        Estimate(float(missed)),
        "rows",
        _MISSED if missed else _NONE_MISSED,
        column="accuracy_missed",
        more=percent(share) if missed and share is not None else "",
        notes=(words,) if words else (),
        facts={"accuracy": {"asked": float(asked), "rows": rows, "missed": missed, "share": share}},
    )
