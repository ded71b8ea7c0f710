"""Targets that a user names, or that suit a method."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from uq.assess import targets
from uq.assess.targets import (
    FORMS,
    IndexTarget,
    canonical,
    category_targets,
    number_of,
    split_name,
    threshold_text,
    transformed,
    transformed_if_heavy,
    with_tail_note,
)
from uq.errors import InputError, choices, nearest
from uq.indices.index import RefusedError
from uq.indices.measures import MIN_SIDE
from uq.indices.method import SensitivityMethod
from uq.indices.methods import METHODS
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.designs import PLAIN
from uq.stats.intervals import sized
from uq.text.element_names import is_whole, whole_name
from uq.text.numbers import counted, grouped, percent, rows_in_words
from uq.text.quantities import read_threshold


def wholes(elements: Sequence[Element], every: bool = False) -> Iterator[IndexTarget]:
    """Yield targets that are all elements of an output together.

    Parameters
    ----------
    elements : sequence of Element
        All elements of one output.
    every : bool, optional
        Whether to include targets that are only computed on request.

    Yields
    ------
    IndexTarget
        Numbers of shape (n, e). First the default form, the same for all elements: logarithms if
        some have a heavy tail or are lifetimes, ranks if some rows have no logarithm, else the
        values. If `every`, the other forms follow. Nothing for an output with one element.
    """
    if len(elements) < 2:
        return
    first, name = elements[0], whole_name(elements[0].output)
    usual = _common(elements)
    target = _together(elements, usual)
    if first.is_lifetime or not usual:
        yield target
    else:
        note = f"{_HEAVY}: indices are of the {FORMS[usual]}s; ask for {name} for the values"
        yield replace(target, notes=(*target.notes, note))
    if not every or first.is_angle:
        return
    for form in ("log", "rank", "rate") if first.is_lifetime else ("", "log", "rank"):
        if form != usual:
            other = _together(elements, form)
            better = () if form else (f"{_HEAVY}: {usual}({name}) is more informative",)
            yield replace(other, notes=other.notes + better)


_HEAVY = "some elements have a heavy tail"


def _common(elements: Sequence[Element]) -> str:
    """Return the form that serves all elements."""
    forms = {split_name(transformed_if_heavy(number_of(element)).name)[0] for element in elements}
    if len(forms) == 1:
        return forms.pop()
    no_logarithm = any(transformed(element, "log").refused for element in elements)
    return "rank" if "rank" in forms or no_logarithm else "log"


def _together(elements: Sequence[Element], form: str) -> IndexTarget:
    parts = [
        transformed(element, form) if form else IndexTarget(element.name, element, element.values)
        for element in elements
    ]
    name = whole_name(elements[0].output)
    values = np.column_stack([part.values for part in parts])
    lacking = [part.name for part in parts if not np.isfinite(part.values).any()]
    refused = next((part.refused for part in parts if part.refused), "")
    if lacking and not refused:
        others = "; ask for the other elements by name" if len(lacking) < len(parts) else ""
        refused = f"no row has a {lacking[0]}{others}"
    notes = _weights(elements, values[np.isfinite(values).all(axis=1)])
    return IndexTarget(f"{form}({name})" if form else name, None, values, refused, notes=notes)


def _weights(elements: Sequence[Element], values: np.ndarray) -> tuple[str, ...]:
    """Return a sentence on the weights of the elements; none where nothing varies."""
    if len(values) == 0 or not (variance := sized(values)[0].var(axis=0)).any():
        return ()
    most = int(variance.argmax())
    return (
        f"[:] combines all {len(elements)} elements, each weighted by its variance:"
        f" {elements[most].name} contributes most, {percent(variance[most] / variance.sum())}",
    )


FEWEST_HITS = 5
"""With fewer in each replicate an event has no indices."""

ENOUGH_HITS = 20
"""With fewer in each replicate the indices come with a warning."""


def few_hits(result: Result, target: IndexTarget, intervals: bool = True) -> tuple[str, ...]:
    """Return the warning for an event with few hits or misses; any two values make one.

    Parameters
    ----------
    result : Result
        The result that the target is of.
    target : IndexTarget
    intervals : bool, optional
        Whether its indices have any.

    Returns
    -------
    tuple of str
        One sentence or none; none for all elements of an output together.

    Raises
    ------
    RefusedError
        Fewer than `FEWEST_HITS` in each replicate.
    """
    if target.values.ndim > 1:
        return ()
    values, replicates = target.values, int(result.dataset.attrs.get("replicates", 1))
    if not (target.event or len(np.unique(values[np.isfinite(values)])) == 2):
        return ()
    if not result.why_no_statistics:
        with_hits = Result(result.dataset.assign(hit=("row", values)))
        values = with_hits.independent.dataset["hit"].values
    defined = values[np.isfinite(values)]
    hits = defined > defined.min(initial=np.inf)
    rarer = int(min(hits.sum(), (~hits).sum()))
    if not 0 < rarer < ENOUGH_HITS * replicates:
        return ()  # without any the method refuses
    side = ("hit",) if rarer == hits.sum() else ("miss", "misses")
    per_replicate = f", {rarer / replicates:.2g} in each replicate" if replicates > 1 else ""
    samples = int(result.dataset.attrs["samples"])
    needed = rows_in_words(ENOUGH_HITS * replicates / rarer * samples)
    remedy = f"about {needed} samples instead of {grouped(samples)} would give {ENOUGH_HITS}"
    seen = f"only {counted(rarer, *side)} in {counted(len(hits), 'row')}{per_replicate}"
    if rarer < FEWEST_HITS * replicates:
        if target.event and result.design.layout is not PLAIN:
            remedy += f", and 'regional' of a 'monte-carlo' design needs {MIN_SIDE} in all"
        raise RefusedError(f"{seen}: {FEWEST_HITS} are needed for an index; {remedy}")
    widened = result.design.crossed
    narrow = ", and intervals may be too narrow" if intervals and not widened else ""
    return (f"{seen}: the indices are rough{narrow}; {remedy}",)


def chosen(
    result: Result, method: str, output: str | Sequence[str] | None
) -> Iterator[IndexTarget]:
    """Yield the targets that a user means.

    Parameters
    ----------
    result : Result
        A result.
    method : str
    output : str or sequence of str, optional
        Names; by default all that suit the method, of the outputs that the study asks for.

    Yields
    ------
    IndexTarget
        One at a time, as each holds a number per row. Of several names, unknown ones are skipped.

    Raises
    ------
    InputError
        When there is none.
    """
    asked = METHODS[method]
    if output is None:
        has_suitable = False
        for name in result.shown_outputs(result.analysis):
            for target in targets_of(result, name):
                if _suits(asked, target):
                    yield target if asked.scale_free else transformed_if_heavy(target)
                    has_suitable = True
            if asked.aggregates:
                yield from wholes(_elements(result, name))
        if not has_suitable and result.failed.all():
            raise InputError("every row is invalid: no index can be estimated")
        if not has_suitable and not asked.takes_numbers:
            raise InputError(
                f"'{method}' needs an event: a category, or a lifetime with a threshold in"
                " [analysis]; for another value with a threshold t, use --output 'P(y > t)'"
            )
        if not has_suitable:
            raise InputError("no output is numeric: there is no variance to apportion")
        return
    named = [
        target
        for name in ([output] if isinstance(output, str) else output)
        for target in _named(result, name, asked.aggregates)
    ]
    if not named and isinstance(output, str):
        output = _canonical(result, output)
        form, inside, threshold = split_name(output)
        if is_whole(inside) and form == "P":
            raise InputError(
                f"'{output}': an event concerns a single element; name that instead of [:]"
            )
        if is_whole(inside) and not asked.aggregates:
            able = ", ".join(name for name, candidate in METHODS.items() if candidate.aggregates)
            raise InputError(
                f"'{method}' has no index of all elements together (methods that do: {able})"
            )
        if output == inside:
            raise InputError(f"no row has a value of {output}: there is no variance to apportion")
        names = [target.name for target in targets_of(result, output_in(inside), every=True)]
        if form == "P" and threshold:
            events = choices(name for name in names if split_name(name)[0] == "P")
            raise InputError(
                f"no such event '{output}' (allowed: {events}); [analysis] thresholds make others"
            )
        raise InputError(f"no such output '{output}'{nearest(output, names)}")
    yield from named if asked.scale_free else map(with_tail_note, named)


def _suits(method: SensitivityMethod, target: IndexTarget) -> bool:
    if target.event:
        return method.takes_events and not (method.conditional and target.element is None)
    return method.takes_numbers


def _named(result: Result, name: str, aggregated: bool) -> list[IndexTarget]:
    """Return the targets that a user means by a name; none for an unknown name."""
    name = _canonical(result, name)
    form, inside, _ = split_name(name)
    if is_whole(inside):
        every = list(wholes(_elements(result, output_in(inside)), every=True)) if aggregated else []
        return [target for target in every if target.name == name] or every[: not form]
    candidates = list(targets_of(result, output_in(inside), every=True, form=form))
    name = _as_stored(name, output_in(inside), candidates)
    if form:
        return [target for target in candidates if target.name == name]
    untransformed = [target for target in candidates if split_name(target.name)[0] == ""]
    has_whole = aggregated and name in result.dataset and len(_elements(result, name)) > 1
    whole = _named(result, whole_name(name), aggregated) if has_whole else []
    return [*(untransformed or targets_of(result, name)), *whole]


def _canonical(result: Result, written: str) -> str:
    """Return the name of a target, a threshold in the unit of its output."""
    name = canonical(written)
    output = split_name(name)[1].partition("[")[0]
    if output not in result.dataset or not (text := threshold_text(written)):
        return name
    units = result.dataset[output].attrs["units"]
    read_threshold("threshold", text, output, units)  # or refuse it
    return canonical(written, units)


def _as_stored(name: str, element: str, candidates: Sequence[IndexTarget]) -> str:
    """Return a name in which the element is spelt as in the result."""
    stored_element = candidates[0].element if candidates else None
    return (
        name
        if stored_element is None or "[" not in element
        else name.replace(element, stored_element.name)
    )


def output_in(inside: str) -> str:
    """Return the output or element that the name of a target is about, without any label."""
    return re.sub(r"^([^\[=]*(?:\[.*?\])?)=.*$", r"\1", inside)


def _elements(result: Result, name: str) -> list[Element]:
    """Return the elements that belong together: none of a category."""
    return [] if result.is_category(name.partition("[")[0]) else result.named_elements(name)


def targets_of(
    result: Result, name: str, every: bool = False, form: str | None = None
) -> Iterator[IndexTarget]:
    """Return the targets of an output or of one element of it.

    Parameters
    ----------
    result : Result
        A result.
    name : str
    every : bool, optional
        Whether also those that must be asked for by name.
    form : str, optional
        Only those of this form, as in `split_name`; by default all.

    Returns
    -------
    iterator of IndexTarget
        Of a category, or an element of one, whether a row is in each that occurs.
    """
    if result.is_category(name.partition("[")[0]):
        return category_targets(result, name)
    elements = result.elements([name]) if name in result.dataset else result.named_elements(name)
    return targets.targets(elements, result.analysis.thresholds, every, form)
