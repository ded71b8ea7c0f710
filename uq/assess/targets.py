"""Targets of sensitivity indices: an output, its logarithm, rank, rate or event, row by row."""

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from uq.assess.sample import censored_before
from uq.contract import LARGEST_VALUE, Floats, cause_name
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats.intervals import sized
from uq.stats.order_statistics import mid_ranks
from uq.stats.tails import heavier_tail
from uq.text.numbers import counted, percent
from uq.text.quantities import read_quantity

LARGEST = 0.01
"""Share of the rows that a heavy tail is judged by: those farthest from the mean."""

HEAVY = 1 / 3
"""They hold 8 % of the variance of a normal law, 22 % of an exponential one, 49 % of a lognormal
one with sigma = 1; beyond a third the tail counts as heavy."""

FEWEST = 100
"""In fewer rows a single one is more than `LARGEST`: no tail is judged."""


Transformed = tuple[Floats, str]
"""One number per row, NaN where there is none; and why there can be none at all, or ""."""


def tail_share(values: Floats) -> float:
    """Return the share of the variance due to the 1 % of rows farthest from the mean.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.

    Returns
    -------
    float
        0 where there are fewer than `FEWEST` values, or all are the same.
    """
    defined = values[np.isfinite(values)]
    if len(defined) < FEWEST or not np.ptp(defined) > 0:
        return 0.0
    scaled = defined / np.abs(defined).max()  # squares neither overflow nor vanish
    squares = (scaled - scaled.mean()) ** 2
    farthest = int(np.ceil(LARGEST * len(defined)))
    largest = np.sort(np.partition(squares, len(squares) - farthest)[-farthest:])
    return float(largest.sum() / squares.sum())


def heaviness(values: Floats) -> str:
    """Return why indices of the variance of these values are about a few of them.

    Parameters
    ----------
    values : ndarray, shape (n,)
        NaN where there is none.

    Returns
    -------
    str
        A clause; "" where the largest 1 % hold less than `HEAVY` of the variance, and the tail's
        shape is compatible with a finite variance (`uq.stats.tails`).
    """
    share = tail_share(values)
    if share > HEAVY:
        return f"{100 * LARGEST:g} % of the rows account for {percent(share)} of the variance"
    tail = heavier_tail(values[np.isfinite(values)])
    if tail is not None and tail.no_variance:
        return f"the {tail.side} tail suggests an infinite variance (k = {tail.k:.2g})"
    return ""


def logarithm(element: Element) -> Transformed:
    """Return the natural logarithm of an output; refused if a row has none."""
    nothing = np.full(len(element.values), np.nan)
    counts = {
        ("never ends", "never end"): int(element.never.sum()),
        ("is censored", "are censored"): int(element.censored.sum()),
        ("is not positive", "are not positive"): int((element.values <= 0).sum()),
    }
    excluded = [counted(count, *words) for words, count in counts.items() if count]
    if excluded:
        rows = f"of {int(element.present.sum())} rows {' and '.join(excluded)}"
        return nothing, f"{rows}: no logarithm; ask for rank({element.name})"
    return np.log(element.values), ""


def rank(element: Element) -> Transformed:
    """Return the share of rows below each, ties counted by half.

    Parameters
    ----------
    element : Element
        Rows of a lifetime that never end, and those censored after all others have ended, share the
        highest rank: their order is neither known nor needed.

    Returns
    -------
    values : ndarray, shape (n,)
        Between 0 and 1.
    refused : str
        Where a row was censored before the last life ended: its rank is not known.

    References
    ----------
    A. Saltelli, I. M. Sobol', "About the use of rank transformation in sensitivity analysis of
    model output", Reliab. Eng. Syst. Saf. 50, 225-239 (1995).
    """
    values, present = element.values, element.present
    beyond = element.never | element.censored
    last = values[present & ~beyond].max(initial=-np.inf)
    unknown = int((element.censored & (values < last)).sum())
    if unknown:
        return (
            np.full(len(values), np.nan),
            f"{counted(unknown, 'row')} censored before the last life ended: the order of the rows"
            " is not known; ask for P(T < t) by a threshold in [analysis], or lengthen the horizon",
        )
    ranks = np.full(len(values), np.nan)
    ranks[present] = mid_ranks(np.where(beyond, np.inf, values)[present])
    return ranks, ""


def rate(element: Element) -> Transformed:
    """Return the inverse of a life, 0 if it never ends; refused if a row has none."""
    with np.errstate(divide="ignore", over="ignore"):
        inverse = 1 / element.values
    if censored := int(element.censored.sum()):
        refused = (
            f"{counted(censored, 'lifetime is', 'lifetimes are')} censored, and the rate not known;"
            " ask for P(T < t) by a threshold in [analysis], or lengthen the horizon"
        )
    elif too_short := int((inverse > LARGEST_VALUE).sum()):
        rows, unit = counted(too_short, "row has", "rows have"), element.declared.unit
        refused = f"{rows} lifetime zero or below {1 / LARGEST_VALUE:g} {unit}: no rate"
    else:
        refused = ""
    return inverse, refused


@dataclass(frozen=True)
class IndexTarget:
    """One number per row, or one for each element of an output.

    Attributes
    ----------
    name : str
        Name of the element, or ``log(element)``, ``rank(element)``; for lifetimes also
        ``rate(element)`` and ``P(element<t)``; for regimes ``P(regime=label)``; ``output[:]`` for
        all elements together.
    element : Element or None
        None for a category or a whole output.
    values : ndarray, shape (n,) or (n, e)
        NaN for rows that failed or have no value.
    refused : str
        Why there can be no index of it, or "".
    event : bool
        Whether the values indicate if something happened, 1, or not, 0.
    notes : tuple of str
        Sentences on the transform of the output.
    """

    name: str
    element: Element | None
    values: Floats
    refused: str = ""
    event: bool = False
    notes: tuple[str, ...] = ()

    @property
    def sizes(self) -> Floats:
        """Return the values or, of an array, distances of rows from their mean, shape (n,)."""
        if self.values.ndim == 1:
            return self.values
        whole = self.values[np.isfinite(self.values).all(axis=1)]
        middle = whole.mean(axis=0) if len(whole) else 0.0
        away, size = sized(whole - middle)
        return size * np.asarray(np.linalg.norm(away, axis=1))


def where_it_happens(event: IndexTarget) -> Floats:
    """Return the output that an event is about in the rows in which it happens, NaN in others."""
    assert event.element is not None
    return np.where(event.values == 1, event.element.for_thresholds, np.nan)


def targets(
    elements: Iterable[Element],
    thresholds: Mapping[str, tuple[float, ...]],
    every: bool = False,
    only: str | None = None,
) -> Iterator[IndexTarget]:
    """Yield the targets of elements.

    Parameters
    ----------
    elements : iterable of Element
    thresholds : dict of str to tuple of float
        Output -> times t of its probabilities P(T < t), for lifetimes.
    every : bool, optional
        Whether also those that must be asked for by name.
    only : str, optional
        With `every`, only those of this form, as in `split_name`; by default all.

    Yields
    ------
    IndexTarget
        The target of `number_of`, and for a lifetime T the events T < t. With `every`: a value or
        angle as it is; the logarithm and the rank of a value or lifetime; for a lifetime also the
        rate 1/T and the events; for others the events y > t, of an angle's magnitude.
    """
    for element in elements:
        if not (every and (element.is_lifetime or only)):
            yield number_of(element)
        if every and not element.is_angle:
            for form in ("log", "rank", "rate")[: 3 if element.is_lifetime else 2]:
                if only in (None, form):
                    yield transformed(element, form)
        if (element.is_lifetime or every) and only in (None, "P"):
            for threshold in thresholds.get(element.output, ()):
                yield _event(element, threshold)


def number_of(element: Element) -> IndexTarget:
    """Return one number per row that has moments.

    A value or angle is such a number. A lifetime is replaced by its logarithm where every row's
    life is finite, uncensored and positive, else by its rank.
    """
    if not element.is_lifetime:
        return IndexTarget(element.name, element, element.values)
    logarithmic = transformed(element, "log")
    return transformed(element, "rank") if logarithmic.refused else logarithmic


_TRANSFORMS = {"log": logarithm, "rank": rank, "rate": rate}
"""Name -> transformation of an element."""

FORMS = {"log": "logarithm", "rank": "rank", "rate": "inverse"}
"""The same in words."""

_EVENT = re.compile(r"P\(\s*\|?([^<>|]+?)\|?\s*([<>])\s*(.+)\)")


def split_name(name: str) -> tuple[str, str, str]:
    """Split the name of a target into the form, the element, and the threshold.

    Parameters
    ----------
    name : str

    Returns
    -------
    tuple of str
        ``("log", "life[depth=0.5]", "")`` of ``log(life[depth=0.5])``, ``("P", "life", "1000.0")``
        of ``P(life<1000.0)`` and ``P(life>1000.0)``, ``("P", "regime=fast", "")`` of
        ``P(regime=fast)``, ``("", "y", "")`` of ``y``.
    """
    for form in (*_TRANSFORMS, "P"):
        if name.startswith(f"{form}(") and name.endswith(")"):
            text = name[len(form) + 1 : -1]
            inside, _, threshold = text.partition("<" if "<" in text else ">")
            return form, inside, threshold
    return "", name, ""


def canonical(name: str, units: str = "1") -> str:
    """Return the name of a target, of ``P(life < 24 hours)`` that is ``P(life<86400.0)``."""
    match = _EVENT.fullmatch(name)
    if match is None:
        return name
    for read in (float, partial(read_quantity, units=units)):
        with suppress(ValueError):
            return f"P({match[1]}{match[2]}{float(read(match[3]))!r})"
    return f"P({match[1]}{match[2]}{match[3]})"


def threshold_text(name: str) -> str:
    """Return the threshold in the name of an event as written: ``24 hours``; "" without one."""
    match = _EVENT.fullmatch(name)
    return match[3] if match else ""


def transformed(element: Element, form: str, notes: tuple[str, ...] = ()) -> IndexTarget:
    """Return the ``log``, ``rank`` or ``rate`` of an element."""
    values, refused = _TRANSFORMS[form](element)
    if form == "rank" and (top := int((element.never | element.censored).sum())):
        several = "rows that never end or are censored share"
        rows = counted(top, "row that never ends or is censored has", several)
        notes += (f"{rows} the highest rank",)
    return IndexTarget(f"{form}({element.name})", element, values, refused, notes=notes)


INDICES_OF = "indices are of its {form}; ask for {name} for the output itself"


def transformed_if_heavy(target: IndexTarget, template: str = INDICES_OF) -> IndexTarget:
    """Return the transform of a heavy-tailed value, for methods that apportion a variance.

    Parameters
    ----------
    target : IndexTarget
    template : str
        Of its note, with the ``form`` that replaces the output and its ``name``.

    Returns
    -------
    IndexTarget
        The logarithm, where all rows are positive and its own tail is not heavy, else the rank,
        with a note; `target` itself where `heaviness` finds nothing.
    """
    if not (why := _heaviness(target)):
        return target
    assert target.element is not None
    form = _lighter_form(target.element)
    note = template.format(form=FORMS[form], name=target.name)
    return transformed(target.element, form, (f"{why}: {note}",))


def with_tail_note(target: IndexTarget) -> IndexTarget:
    """Return a target with a note if its tail is heavy, for methods that apportion a variance."""
    if not (why := _heaviness(target)):
        return target
    assert target.element is not None
    other = f"{_lighter_form(target.element)}({target.name})"
    return replace(target, notes=(*target.notes, f"{why}: {other} is more informative"))


def _heaviness(target: IndexTarget) -> str:
    """Return why indices of the variance of a value are not informative, or ""."""
    element = target.element
    if element is None or element.is_lifetime or element.is_angle or target.name != element.name:
        return ""
    return heaviness(target.values)


def _lighter_form(element: Element) -> str:
    logarithms, refused = logarithm(element)
    return "rank" if refused or heaviness(logarithms) else "log"


def _event(element: Element, threshold: float) -> IndexTarget:
    unknown = element.unknown_sides(threshold)
    refused = censored_before(unknown) if element.is_lifetime and unknown.any() else ""
    sign, hits = ("<", element.below) if element.is_lifetime else (">", element.above)
    values = np.where(element.present, hits(threshold), np.nan)
    name = f"P({element.name}{sign}{threshold!r})"
    return IndexTarget(name, element, values, refused, event=True)


def category_targets(result: Result, output: str) -> Iterator[IndexTarget]:
    """Yield, for each label of a category such as the regime, the indicator of that label.

    Parameters
    ----------
    result : Result
        A result, or some rows of one.
    output : str
        An output of kind ``category``, or one element of it.

    Yields
    ------
    IndexTarget
        NaN for rows that failed before they had a category; a sound row of no category has none.
        Refused of causes where a life is censored: another might have ended it later.
    """
    lost, category = result.failed, output.partition("[")[0]
    life = next((name for name in result.outputs if cause_name(name) == category), "")
    for name, codes in result.codes(output).items():
        refused = _unknown_causes(result, name.replace(category, life, 1)) if life else ""
        for code, label in flags(result.dataset[category]):
            if code >= 0 and (hits := codes == code).any():
                values = np.where((codes < 0) & lost, np.nan, hits)
                yield IndexTarget(f"P({name}={label})", None, values, refused, event=True)


def _unknown_causes(result: Result, life: str) -> str:
    (element,) = result.named_elements(life)
    unknown = int((element.censored & ~element.within_interval).sum())
    if not unknown:
        return ""
    return (
        f"{counted(unknown, 'row is', 'rows are')} censored, and what would end it is not known;"
        " ask for P(T < t) by a threshold in [analysis], or lengthen the horizon"
    )
