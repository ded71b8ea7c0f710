"""Validation of named values for the parameters and settings of a model.

Study files, ``uq simulate --set`` and the Python API share them.
"""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from types import UnionType
from typing import Any, get_args, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from uq.contract import Model, Parameter, Table
from uq.errors import nearest, one_line


def unknown_name(kind: str, name: str, model: Model, names: tuple[str, ...]) -> str:
    """Return the message for a parameter, setting or output that a model does not have."""
    allowed = f" (allowed: {', '.join(names)})" if names else ", which has none"
    return f"no such {kind} of model '{model.name}'{nearest(name, names) or allowed}"


def parameter_problem(model: Model, name: str, value: Any) -> str | None:
    """Return the reason why a value is invalid for a parameter; None if it is valid.

    Parameters
    ----------
    model : Model
    name : str
        Name of a parameter, which may be unknown.
    value : object
        Value as given by the user.

    Returns
    -------
    str or None
    """
    if name not in model.parameter_names:
        return unknown_name("parameter", name, model, model.parameter_names)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "must be a number"
    try:
        float(value)
    except OverflowError:  # an integer of 309 digits or more; infinity is written inf
        return "must be a number"
    parameter = model.parameter(name)
    low, high = parameter.bounds
    if not low <= value <= high:
        return f"must be within {bounds_of(parameter)}"
    return None


def bounds_of(parameter: Parameter) -> str:
    """Return the bounds of a parameter as text for an error line."""
    low, high = parameter.bounds
    return f"{low!r} to {high!r} [{parameter.unit}]"


def setting_types(model: Model) -> dict[str, Any]:
    """Return the plain type of each setting, without its declaration."""
    hints = get_type_hints(model.settings, include_extras=True)
    return {name: get_args(hints[name])[0] for name in model.setting_names}


def read_settings(model: Model, given: Mapping[str, Any]) -> tuple[Any, dict[str, str]]:
    """Return the settings object of a model and the problems of the given values.

    Parameters
    ----------
    model : Model
    given : dict
        Setting -> value as written in a file.

    Returns
    -------
    settings : object or None
        None if there is a problem.
    problems : dict of str to str
        Setting -> its problem; the key ``""`` is for problems of the combination.
    """
    types = setting_types(model)
    values, problems = {}, {}
    for name, value in given.items():
        if name not in types:
            problems[name] = unknown_name("setting", name, model, model.setting_names)
            continue
        if types[name] == tuple[float, ...] and _is_number(value):
            value = [value]  # a list of one number
        with suppress(ValidationError):
            strict: TypeAdapter[Any] = TypeAdapter(types[name], config=ConfigDict(strict=True))
            # A number represents a word if the setting allows words such as nan and inf.
            is_word = isinstance(value, float) and model.setting(name).choices
            values[name] = strict.validate_python(_frozen(str(value) if is_word else value))
        if name not in values or not _allowed(model, name, values[name]):
            problems[name] = f"must be {_type_in_words(model, name, types[name])}"
    if problems:
        return None, problems
    try:
        return model.settings(**values), {}
    except ValueError as error:  # raised by the model for a combination of settings
        return None, {"": one_line(error)}


def fault_lines(
    label: str, given: Mapping[str, Any], problems: Mapping[str, str | None]
) -> list[str]:
    """Return the problems of given values as error lines, prefixed with the label."""
    return [
        f"{label}{name} = {given[name]!r}: {problem}" if name in given else problem
        for name, problem in problems.items()
        if problem
    ]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _frozen(value: Any) -> Any:
    """Return lists, including nested lists, as tuples, and tables as tuples of pairs."""
    if isinstance(value, Mapping):
        return tuple(value.items())
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value


def _numbers(value: Any) -> Iterator[Any]:
    """Yield the items of a setting that may be a list, or a list of lists."""
    if isinstance(value, tuple):
        for item in value:
            yield from _numbers(item)
    else:
        yield value


def _allowed(model: Model, name: str, value: Any) -> bool:
    declared = model.setting(name)
    if declared.choices:
        return value in declared.choices
    if declared.bounds is not None:
        low, high = declared.bounds
        return all(isinstance(n, str) or low <= n <= high for n in _numbers(value))
    return all(number == number for number in _numbers(value))  # nan is never intended


def _type_in_words(model: Model, name: str, kind: Any) -> str:
    declared = model.setting(name)
    if declared.choices:
        return f"one of {', '.join(declared.choices)}"
    words = _kind_in_words(kind)
    if declared.bounds is not None:
        low, high = declared.bounds
        words += f" within {low!r} to {high!r}"
    return words if declared.unit == "1" else f"{words} [{declared.unit}]"


def _kind_in_words(kind: Any) -> str:
    scalars = {int: "a whole number", float: "a number", bool: "true or false", str: "a text"}
    if kind in scalars:
        return scalars[kind]
    if kind == Table:
        return "a table of texts and numbers"
    if isinstance(kind, UnionType):
        return " or ".join(map(_kind_in_words, get_args(kind)))
    if not get_args(kind):
        return "of the right type"
    first, *others = get_args(kind)
    size = "" if Ellipsis in others else f" of {1 + len(others)}"
    return f"a list{size}, each {_kind_in_words(first)}"
