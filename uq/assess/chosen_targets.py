"""Targets that a user names, or that suit a method."""

import re
from collections.abc import Iterator, Sequence

from uq.assess import targets
from uq.assess.joint_targets import wholes
from uq.assess.targets import (
    IndexTarget,
    canonical,
    category_targets,
    lightened,
    split_name,
    threshold_text,
    with_tail_note,
)
from uq.errors import InputError, choices, nearest
from uq.indices.method import SensitivityMethod
from uq.indices.methods import METHODS
from uq.result.element import Element
from uq.result.result import Result
from uq.text.element_names import is_whole, whole_name
from uq.text.quantities import read_threshold


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
                    yield target if asked.scale_free else lightened(target)
                    has_suitable = True
            if asked.aggregates:
                yield from wholes(_elements(result, name))
        if not has_suitable and result.failed.all():
            raise InputError("every row failed: there is nothing to explain")
        if not has_suitable and not asked.takes_numbers:
            raise InputError(
                f"'{method}' needs an event: a category, or a time of a lifetime in"
                " [analysis] thresholds; name that of a value with such a threshold t:"
                " --output 'P(y > t)'"
            )
        if not has_suitable:
            raise InputError("none of the outputs is a number: there is nothing to apportion")
        return
    named = [
        target
        for name in ([output] if isinstance(output, str) else output)
        for target in _named(result, name, asked.aggregates)
    ]
    if not named and isinstance(output, str):
        output = canonical(output)
        form, inside, threshold = split_name(output)
        if is_whole(inside) and form == "P":
            raise InputError(f"'{output}': an event is that of one element; name it instead of [:]")
        if is_whole(inside) and not asked.aggregates:
            able = ", ".join(name for name, candidate in METHODS.items() if candidate.aggregates)
            raise InputError(
                f"'{method}' has no index of all elements together (methods that do: {able})"
            )
        if output == inside:
            raise InputError(f"no row has a {output}: there is nothing to apportion")
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
    written, name = name, canonical(name)
    form, inside, _ = split_name(name)
    if (output := inside.partition("[")[0]) in result.dataset and (text := threshold_text(written)):
        read_threshold(
            "threshold", text, output, result.dataset[output].attrs["units"]
        )  # or refuse it
    if is_whole(inside):
        every = list(wholes(_elements(result, output_in(inside)), every=True)) if aggregated else []
        return [target for target in every if target.name == name] or every[: not form]
    candidates = list(targets_of(result, output_in(inside), every=True))
    name = _as_stored(name, output_in(inside), candidates)
    if form:
        return [target for target in candidates if target.name == name]
    untransformed = [target for target in candidates if split_name(target.name)[0] == ""]
    has_whole = aggregated and name in result.dataset and len(_elements(result, name)) > 1
    whole = _named(result, whole_name(name), aggregated) if has_whole else []
    return [*(untransformed or targets_of(result, name)), *whole]


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


def targets_of(result: Result, name: str, every: bool = False) -> Iterator[IndexTarget]:
    """Return the targets of an output or of one element of it.

    Parameters
    ----------
    result : Result
        A result.
    name : str
    every : bool, optional
        Whether also those that must be asked for by name.

    Returns
    -------
    iterator of IndexTarget
        Of a category, or an element of one, whether a row is in each that occurs.
    """
    if result.is_category(name.partition("[")[0]):
        return category_targets(result, name)
    elements = result.elements([name]) if name in result.dataset else result.named_elements(name)
    return targets.targets(elements, result.analysis.thresholds, every)
