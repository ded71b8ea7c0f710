"""Plain function as a machine, row by row or compiled by numba."""

import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from inspect import signature
from math import inf
from numbers import Real
from typing import Any, TypeVar, get_args, get_type_hints, overload

import numpy as np
from numpy.typing import NDArray

from uq.contract import ROW_NAME, Floats, Model, Parameter
from uq.errors import InputError
from uq.machines.returned import Returned, read_returns
from uq.machines.row_by_row import SEED, Fields, RowByRow, model_from
from uq.machines.study_defaults import StudyDefaults


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether a function is compiled by numba."""
    if "numba" not in sys.modules:
        return False
    from numba.core.dispatcher import Dispatcher

    return isinstance(function, Dispatcher)


class Compiled(RowByRow):
    """A batch that computes rows by a compiled loop; see `RowByRow`.

    A row that raises, or returns an invalid value, is recomputed alone to obtain its message.
    """

    def __call__(
        self, x: Floats, seed: NDArray[np.uint64], settings: object
    ) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]:
        """Compute rows; see `uq.contract.Batch`."""
        shapes = tuple(len(declaration.shape) for declaration in self.returned.values())
        loop = _loop_of(self.function, self.names, shapes)
        if loop is None:
            return super().__call__(x, seed, settings)
        columns = self.blank(len(x))
        bad = np.zeros(len(x), dtype=bool)
        loop(x, seed, bad, tuple(columns[name] for name in self.returned))
        for name, declaration in self.returned.items():
            values = columns[name].reshape(len(x), -1)
            bad |= declaration.output(name).is_invalid(values).any(axis=1)
            if not declaration.life:
                bad |= np.isposinf(values).any(axis=1)
        status, messages = np.zeros(len(x), np.int8), dict[int, str]()
        if bad.any():
            places = np.flatnonzero(bad)
            again, status[bad], texts = super().__call__(x[bad], seed[bad], settings)
            for name, values in again.items():
                columns[name][bad] = values
            messages = {int(places[i]): text for i, text in texts.items()}
        return columns, status, messages

    def row(self, row: list[float], seed: int) -> Any:
        """Call the function on a row, with a seed of the type that the loop uses."""
        return super().row(row, np.uint64(seed))  # type: ignore[arg-type]


@cache
def _loop_of(
    function: Any, names: tuple[str, ...], dims: tuple[int, ...]
) -> Callable[..., None] | None:
    """Return a compiled loop over rows.

    None if the return type of the function is wrong, or if the result of a row could depend on
    the rows computed with it.
    """
    import numba

    config: Any = numba.config
    loose = any(
        function.targetoptions.get(option) for option in ("fastmath", "parallel", "forceobj")
    )
    if loose or config.USING_SVML:
        return None
    arguments = list(signature(function.py_func).parameters)
    place = arguments.index(SEED) if SEED in arguments else None
    called = _called(function, len(names), place)
    kept = _kept(dims)

    @numba.njit(nogil=True)
    def loop(x: Any, seed: Any, bad: Any, columns: Any) -> None:
        for i in range(len(x)):
            try:
                bad[i] = not kept(called(x[i], seed[i]), columns, i)
            except Exception:  # numba knows no other
                bad[i] = True

    try:  # on no rows
        columns = tuple(np.empty((0,) * (1 + n)) for n in dims)
        loop(np.empty((0, len(names))), np.empty(0, np.uint64), np.empty(0, np.bool_), columns)
    except Exception:  # computed by itself, each row has an error message
        return None
    return loop


def _called(function: Any, count: int, place: int | None) -> Any:
    """Return a compiled function of a row and its seed, passed as argument number `place`."""
    import numba
    from numba.np.unsafe import ndarray

    as_tuple: Any = ndarray.to_fixed_tuple

    if place is None:
        return numba.njit(lambda row, seed: function(*as_tuple(row, count)))

    @numba.njit
    def call(row: Any, seed: Any) -> Any:
        x = as_tuple(row, count)
        return function(*x[:place], seed, *x[place:])

    return call


def _kept(dims: tuple[int, ...]) -> Any:
    """Return a compiled function that stores values and returns whether shapes match."""
    import numba

    if not dims:
        return numba.njit(lambda values, columns, i: len(values) == 0)
    others, is_number = _kept(dims[1:]), dims[0] == 0

    @numba.njit
    def keep(values: Any, columns: Any, i: int) -> bool:
        if is_number:
            columns[0][i] = values[0]
        elif values[0].shape == columns[0].shape[1:]:
            columns[0][i] = values[0]
        else:
            return False
        return others(values[1:], columns[1:], i)

    return keep


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
    *,
    returns: Mapping[str, Returned | str] | None = None,
    title: str = "",
    version: str = "1",
    row_name: tuple[str, str] = ROW_NAME,
    headline: Sequence[str] = (),
    uncertain: Mapping[str, Mapping[str, Any]] | None = None,
) -> Callable[[F], F]: ...
def machine(
    function: Any = None,
    *,
    returns: Mapping[str, Returned | str] | None = None,
    title: str = "",
    version: str = "1",
    row_name: tuple[str, str] = ROW_NAME,
    headline: Sequence[str] = (),
    uncertain: Mapping[str, Mapping[str, Any]] | None = None,
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
        study are run to infer the outputs.
    title : str
        One line; by default the first line of the docstring.
    version : str
        To be changed whenever the same input may give different numbers for reasons that are not
        in its source.
    row_name : tuple of str
        Singular and plural of what a row represents, as cards name it: ``("pump", "pumps")``.
    headline : sequence of str
        Outputs that a new study (`uq init`) reports, the most important first.
    uncertain : dict of str to dict, optional
        Argument -> its law in a new study, with the keys of ``[uncertain.NAME]`` in a study file.

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
        defaults = StudyDefaults(row_name, headline, uncertain or {})
        setattr(function, _MARK, (returns, title, version, defaults))
        return function

    return mark if function is None else mark(function)


def is_machine(candidate: object) -> bool:
    """Whether an object was declared by `machine`."""
    return isinstance(getattr(candidate, _MARK, None), tuple)


def model_of(function: Callable[..., Any], returned: Mapping[str, Returned] | None = None) -> Model:
    """Return the model of a function under `machine`.

    Parameters
    ----------
    function : callable
    returned : dict of str to Returned, optional
        Outputs, if it does not declare them. Without either, the model has no outputs.

    Raises
    ------
    InputError
        When its arguments or declarations cannot be used.
    """
    returns, title, version, defaults = getattr(function, _MARK)
    plain = _plain(function)
    name = plain.__name__
    label = f"machine '{name}'"
    fields, wants_seed = _parameters(plain, label)
    outputs = read_returns(label, returns) or dict(returned or {})
    title = title or next(iter((plain.__doc__ or "").strip().splitlines()), name)
    kind = Compiled if is_compiled(function) else RowByRow
    batch = kind(function, tuple(fields), outputs, wants_seed)
    return model_from(name, title, version, fields, outputs, batch, wants_seed, defaults)


def _plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the original Python function, without wrappers and compiler."""
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
