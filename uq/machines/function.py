"""A plain function as a machine: its arguments are parameters, its dict are outputs."""

import inspect
from collections.abc import Callable, Mapping
from math import inf
from numbers import Real
from typing import Any, TypeVar, get_args, get_type_hints, overload

from uq.contract import Model, Parameter
from uq.errors import InputError
from uq.machines.compiled_function import Compiled, is_compiled
from uq.machines.returned import Returned, read_returns
from uq.machines.row_by_row import SEED, Fields, RowByRow, model_from

_MARK = "_uq_machine"

_UNFIT = (
    (inspect.iscoroutinefunction, "is written with 'async def'; write it with 'def'"),
    (inspect.isasyncgenfunction, "is written with 'async def'; write it with 'def'"),
    (inspect.isgeneratorfunction, "has a 'yield'; it must return its outputs"),
)

F = TypeVar("F", bound=Callable[..., Any])


@overload
def machine(function: F) -> F: ...
@overload
def machine(
    *, returns: Mapping[str, Returned | str] | None = None, title: str = "", version: str = "1"
) -> Callable[[F], F]: ...
def machine(
    function: Any = None,
    *,
    returns: Mapping[str, Returned | str] | None = None,
    title: str = "",
    version: str = "1",
) -> Any:
    """Make a plain function a machine that studies can run.

    Parameters
    ----------
    function : callable
        Its arguments are named floats, whose defaults are the nominal values; annotations
        ``Annotated[float, "m", (0.0, 1.0), "a width"]`` add unit, bounds and meaning. An argument
        ``seed`` gets the seed of the row. It returns a dict of numbers and arrays; a life that
        never ends is ``inf``, one that is not followed to its end `uq.censored`.
    returns : dict of str to str or Returned, optional
        Output -> its unit, or more about it; the function may then return a tuple in this order,
        as functions compiled by numba do. Without it, the nominal row and the first 64 rows of a
        study show what is returned.
    title : str
        One line; by default the first line of the docstring.
    version : str
        To be changed whenever the same input may give different numbers for reasons that are not
        in its source.

    Returns
    -------
    callable
        The function itself.

    Raises
    ------
    InputError
        When it is not a function.

    Examples
    --------
    >>> @uq.machine
    ... def spring(stiffness: float = 2.0, force: float = 1.0):
    ...     return {"deflection": force / stiffness}
    """

    def mark(function: F) -> F:
        plain = _plain(function)
        if not inspect.isfunction(plain) or plain.__name__ == "<lambda>":
            raise InputError(
                f"@uq.machine: {function!r} is not a function with a name; write one with 'def'"
            )
        if kind := next((word for test, word in _UNFIT if test(function)), ""):
            raise InputError(f"machine '{plain.__name__}': {kind}")
        setattr(function, _MARK, (returns, title, version))
        return function

    return mark if function is None else mark(function)


def is_machine(candidate: object) -> bool:
    """Whether something was declared by `machine`."""
    return isinstance(getattr(candidate, _MARK, None), tuple)


def model_of(function: Callable[..., Any], returned: Mapping[str, Returned] | None = None) -> Model:
    """Return the model of a function under `machine`.

    Parameters
    ----------
    function : callable
    returned : dict of str to Returned, optional
        What it returns, where it does not declare it. Without either, the model has no outputs.

    Raises
    ------
    InputError
        When its arguments or declarations cannot be used.
    """
    returns, title, version = getattr(function, _MARK)
    plain = _plain(function)
    name = plain.__name__
    label = f"machine '{name}'"
    fields, wants_seed = _parameters(plain, label)
    outputs = read_returns(label, returns) or dict(returned or {})
    title = title or next(iter((plain.__doc__ or "").strip().splitlines()), name)
    kind = Compiled if is_compiled(function) else RowByRow
    batch = kind(function, tuple(fields), outputs, wants_seed)
    return model_from(name, title, version, fields, outputs, batch, wants_seed)


def _plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function as it was written, without wrappers and compiler."""
    return inspect.unwrap(getattr(function, "py_func", function))


def _parameters(function: Callable[..., Any], label: str) -> tuple[Fields, bool]:
    """Return its parameters with their nominal values, and whether it wants the seed."""
    faults, fields = [], dict[str, tuple[Parameter, float]]()
    try:
        hints = get_type_hints(function, include_extras=True)
    except (NameError, TypeError, SyntaxError, AttributeError) as error:
        raise InputError(f"{label}: annotations: {error}") from None
    signature = inspect.signature(function)
    for name, argument in signature.parameters.items():
        if name != SEED:
            try:
                fields[name] = _field(argument, hints.get(name, float))
            except InputError as error:
                faults.append(f"{label}: {error}")
    if not fields and not faults:
        faults.append(f"{label}: has no arguments, so nothing to study")
    if faults:
        raise InputError(*faults)
    return fields, SEED in signature.parameters


def _field(argument: inspect.Parameter, hint: Any) -> tuple[Parameter, float]:
    """Return the parameter and the nominal value that an argument declares."""
    name, default = argument.name, argument.default
    if argument.kind not in (argument.POSITIONAL_OR_KEYWORD, argument.KEYWORD_ONLY):
        raise InputError(f"argument '{argument}': only named floats can be parameters")
    if not isinstance(default, Real):
        given = "no default" if default is argument.empty else f"{default!r}"
        raise InputError(f"argument '{name}' has {given}; its nominal value is needed")
    unit, bounds, meaning = "1", (-inf, inf), name.replace("_", " ")
    words = iter(("unit", "meaning"))
    for extra in get_args(hint)[1:] if hint is not float else ():
        if isinstance(extra, Parameter):
            return extra, float(default)
        if isinstance(extra, tuple) and [isinstance(bound, Real) for bound in extra] == [True] * 2:
            bounds = (float(extra[0]), float(extra[1]))
        elif isinstance(extra, str):
            if next(words, "") == "unit":
                unit = extra
            else:
                meaning = extra
        else:
            problem = "a unit, a pair of bounds or a meaning is expected"
            raise InputError(f"argument '{name}': annotation {extra!r}: {problem}")
    source = "assumed: the default of the function"
    return Parameter(name, unit, meaning, bounds, source), float(default)
