"""Rows without a value or less accurate than requested, and the effect of stated errors."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from uq.assess.sample import SelectedRows, share
from uq.assess.statistic import COUNT, FACT, Context, Reader, Statistic, StatisticKind, placed
from uq.assess.weighted_mixture import as_sample
from uq.contract import Mask
from uq.result.element import Element
from uq.result.result import Result
from uq.result.variables import error_name
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import effective_rows
from uq.text.numbers import counted, percent

NEVER_ENDING = "never_ending"
"""Key of the probability that a life never ends."""

ENDED_AT_ONCE = "ended_at_once"
"""Key of the probability that a life is zero."""

_NEVER = StatisticKind(readers=Reader.JSON | Reader.COLUMNS | Reader.COMPARED)
_EFFECTIVE = StatisticKind(form="number", text="{:.0f}", readers=COUNT.readers)


@placed(json=5, columns=3)
def counts(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the numbers of rows by what they lack, and the share that never ends, if any does."""
    for name in ("never", "censored", "undefined", "failed"):
        number = float(getattr(element, name).sum())
        label = "invalid" if name == "failed" else name
        yield Statistic((name,), label, Estimate(number), "rows", COUNT, column=name)
    if element.is_lifetime and element.never.any():
        sample = context.sample(element)
        yield Statistic(
            (NEVER_ENDING,),
            "never succeeds" if element.declared.success else "never ends",
            sample.never_ending(),
            kind=_NEVER,
            column=NEVER_ENDING,
            estimator=share(_never),
            by=sample.by[NEVER_ENDING],
        )


def ended_at_once(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the probability that a life is zero, if any is; P(T < 0) does not count it."""
    if not element.is_lifetime or not ((element.values == 0) & ~element.censored).any():
        return
    sample = context.sample(element)
    longer = sample.probability_above(0.0)
    yield Statistic(
        (ENDED_AT_ONCE,),
        "succeeds at once" if element.declared.success else "ends at once",
        replace(longer, value=1 - longer.value, low=1 - longer.high, high=1 - longer.low),
        column=ENDED_AT_ONCE,
        by=sample.by["probability_above"],
    )


def _never(element: Element) -> SelectedRows | None:
    """Return which rows never end; None where censored rows may not end."""
    if element.censored.any() and not element.declared.never_known_at_once:
        return None
    return SelectedRows(~element.failed, element.never.astype(float))


def never_ending(element: Element, dependence: Dependence) -> Estimate:
    """Estimate the probability that a life never ends; unknown where censored rows may not end."""
    return as_sample(element, dependence).never_ending()


def effective(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield Kish's number of rows of equal weight, or samples, that are worth as much."""
    if (number := context.sample(element).effective_rows) is not None:
        yield Statistic(
            ("effective_rows",),
            "effective rows",
            Estimate(number),
            kind=_EFFECTIVE,
            column="effective_rows",
            by=(effective_rows,),
        )


@placed(columns=4)
def accuracy(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the number of rows whose stated error exceeds the requested accuracy.

    Rows count if their value is finite and not censored; one that states no error falls short.
    """
    asked = context.rows.dataset[element.output].attrs.get("accuracy")
    error = stated_error(context.rows, element)
    if asked is None or error is None:
        return
    ended = np.isfinite(element.values) & ~element.censored
    kept = np.abs(error.values[ended]) <= asked * np.abs(element.values[ended])
    rows, missed = len(kept), int((~kept).sum())
    share = missed / rows if rows else None
    lost = percent(share) if missed and share else ""
    words = f"accuracy {asked:g} not reached in {counted(missed, 'row')} ({lost})"
    readers = FACT.readers | Reader.REPORT if missed else FACT.readers
    yield Statistic(
        ("accuracy",),
        "rows short of the accuracy",
        Estimate(float(missed)),
        "rows",
        replace(COUNT, form=FACT.form, readers=readers),
        column="accuracy_missed",
        more=lost,
        notes=(words,) if missed else (),
        facts={"accuracy": {"asked": float(asked), "rows": rows, "missed": missed, "share": share}},
    )


def stated_error(result: Result, element: Element) -> Element | None:
    """Return the error that the model states for an element of these rows, None if it states none.

    Parameters
    ----------
    result : Result
    element : Element
    """
    name = error_name(element.output)
    if name not in result.output_names:
        return None
    return next((error for error in result.elements([name]) if error.place == element.place), None)


def off_by_error(element: Element, error: Element, sign: int) -> Element:
    """Return the same rows, each with a value that differs by the error stated for it.

    What never ends, is censored or states no error stays as it is; no life becomes negative.

    Parameters
    ----------
    element, error : Element
    sign : {-1, 1}
        Whether the values become smaller or larger.
    """
    values = np.where(
        _stated(element, error), element.values + sign * np.abs(error.values), element.values
    )
    return replace(element, values=np.maximum(values, 0.0) if element.is_lifetime else values)


def error_share(element: Element, error: Element) -> float:
    """Return the mean square of the errors as a share of the variance; of lives, of logarithms.

    Of the rows that state an error; NaN where these have no variance.
    """
    kept = _stated(element, error)
    values, errors = element.values[kept], error.values[kept]
    if element.is_lifetime:
        positive = values > 0
        values, errors = values[positive], errors[positive]
        values, errors = np.log(values), errors / values
    variance = float(np.var(values)) if len(values) else 0.0
    return float(np.mean(np.square(errors))) / variance if variance > 0 else np.nan


def stating_none(element: Element, error: Element) -> int:
    """Return the number of rows with a value but without a stated error."""
    return int((_may_err(element) & ~np.isfinite(error.values)).sum())


def _stated(element: Element, error: Element) -> Mask:
    return _may_err(element) & np.isfinite(error.values)


def _may_err(element: Element) -> Mask:
    return np.isfinite(element.values) & ~element.censored
