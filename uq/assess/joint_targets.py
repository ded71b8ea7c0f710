"""All elements of an output as one target: its sites, depths or times together."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from uq.assess.targets import FORMS, IndexTarget, lightened, number_of, split_name, transformed
from uq.result.element import Element
from uq.stats.intervals import sized
from uq.text.element_names import whole_name
from uq.text.numbers import percent


def wholes(elements: Sequence[Element], every: bool = False) -> Iterator[IndexTarget]:
    """Yield targets that are all elements of an output together.

    Parameters
    ----------
    elements : sequence of Element
        All those of one output.
    every : bool, optional
        Whether also those that must be asked for by name.

    Yields
    ------
    IndexTarget
        Numbers of shape (n, e). First what stands for each element by default, in one form for
        all: the logarithms if some have a heavy tail or are lifetimes, the ranks if some rows have
        no logarithm, else the values. If every target is asked for, the other forms follow.
        Nothing of an output with one element.
    """
    if len(elements) < 2:
        return
    first, name = elements[0], whole_name(elements[0].output)
    usual = _common(elements)
    target = _together(elements, usual)
    if first.is_lifetime or not usual:
        yield target
    else:
        note = f"{_HEAVY}: these are indices of their {FORMS[usual]}s; ask for {name} for their own"
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
    forms = {split_name(lightened(number_of(element)).name)[0] for element in elements}
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
        f"[:] is all {len(elements)} elements together, each weighted by its variance, of which"
        f" {elements[most].name} has {percent(variance[most] / variance.sum())}",
    )
