"""Outputs of a function: numbers, arrays and lives, declared or inferred from rows."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from numbers import Number
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.contract import Output, Status, high_name
from uq.errors import InputError, nearest

_MOST_NAMES = 5  # that a message lists


@dataclass(frozen=True)
class Censored:
    """A right-censored life: only a lower bound is known; see `censored`."""

    time: float


def censored(time: float) -> Censored:
    """Return a life that had not ended by a time, for a machine to return.

    Parameters
    ----------
    time : float
        Lower bound of the life.

    Examples
    --------
    >>> @uq.machine(returns={"life": uq.Returned("s", life=True)})
    ... def machine(rate: float = 1e-9, depth: float = 2.5e-4):
    ...     return {"life": depth / rate if rate > 1e-12 else uq.censored(1e9)}
    """
    return Censored(float(time))


@dataclass(frozen=True)
class Between(Censored):
    """A life known to end after `time` and not after `high`; see `between`."""

    high: float = np.inf


def between(low: float, high: float) -> Between:
    """Return a life known to end between two times, for a machine to return.

    Parameters
    ----------
    low, high : float
        It had not ended at `low`, 0 if that was never seen, and had ended at `high`.

    Examples
    --------
    >>> @uq.machine(returns={"life": uq.Returned("s", life=True, between=True)})
    ... def machine(rate: float = 1e-9, depth: float = 2.5e-4):
    ...     outage = 3e7 * (depth / rate // 3e7)  # inspected once a year
    ...     return {"life": uq.between(outage, outage + 3e7)}
    """
    if not 0 <= low < high:
        raise ValueError(f"uq.between({low!r}, {high!r}): low must be at least 0 and below high")
    return Between(float(low), float(high))


@dataclass(frozen=True)
class Returned:
    """Declaration of an output of a machine.

    Attributes
    ----------
    unit : str
        CF unit string, ``"1"`` for a pure number.
    meaning : str
    life : bool
        Whether it is a life: ``inf`` where it never ends, `censored` where only a bound is known.
    shape : tuple of int
        Of an array; () for a number.
    may_be_undefined : bool
        Whether NaN is legitimate.
    scales : dict of str to float
        Of a life, parameter -> exponent: see `uq.contract.Output`.
    between : bool
        Of a life: whether it may be known within an interval only, as by `uq.between`.
    """

    unit: str = "1"
    meaning: str = ""
    life: bool = False
    shape: tuple[int, ...] = ()
    may_be_undefined: bool = False
    scales: Mapping[str, float] = field(default_factory=dict, hash=False)
    between: bool = False

    def output(self, name: str) -> Output:
        """Return its declaration under a name."""
        return Output(
            self.unit,
            self.meaning or name.replace("_", " "),
            "lifetime" if self.life else "value",
            tuple(dimensions(name, self.shape)),
            may_be_undefined=self.may_be_undefined,
            may_be_between=self.life and self.between,
            scales=self.scales,
        )


def dimensions(name: str, shape: Sequence[int]) -> dict[str, list[int]]:
    """Return the dimensions of an array, with their coordinates, counted from 0."""
    is_vector = len(shape) == 1
    return {f"{name}_{'index' if is_vector else i}": list(range(n)) for i, n in enumerate(shape)}


def read_returns(label: str, returns: Mapping[str, Returned | str] | None) -> dict[str, Returned]:
    """Return the declared outputs of a machine, a unit alone as a `Returned`.

    Raises
    ------
    InputError
    """
    if returns is None:
        return {}
    if not isinstance(returns, Mapping):
        raise InputError(f"{label}: returns: must be a dict of outputs, not {returns!r}")
    tables = {name: table for name, table in returns.items() if isinstance(table, Returned)}
    faults = [
        f"{name!r} must be a unit or a uq.Returned, not {declaration!r}"
        for name, declaration in returns.items()
        if not (
            isinstance(declaration, str | Returned)
            and isinstance(name, str)
            and name.isidentifier()
        )
    ]
    faults += [
        f"shape of '{name}' must be a tuple of numbers above 0, not {table.shape!r}"
        for name, table in tables.items()
        if not _is_shape(table.shape)
    ]
    faults += [
        f"unit and meaning of '{name}' must be text"
        for name, table in tables.items()
        if not (isinstance(table.unit, str) and isinstance(table.meaning, str))
    ]
    if not returns:
        faults = ["name at least one output"]
    if faults:
        raise InputError(*(f"{label}: returns: {fault}" for fault in faults))
    return {
        n: Returned(declaration) if isinstance(declaration, str) else declaration
        for n, declaration in returns.items()
    }


def _is_shape(shape: Any) -> bool:
    return isinstance(shape, tuple) and all(isinstance(n, int) and n > 0 for n in shape)


class RowError(Exception):
    """Failure of a row, with a sentence for the user and the status of the row.

    Parameters
    ----------
    message : str
    status : Status
        By default the status of an invalid returned value.
    """

    def __init__(self, message: str, status: Status = Status.BAD_SHAPE):
        super().__init__(message)
        self.status = status


def numbers_of(value: Any, name: str) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return a value as an array of floats, and the mask of `censored` elements.

    Raises
    ------
    RowError
    """
    try:
        given = np.asarray(value)
        cut = np.zeros(given.shape, dtype=bool)
        if given.dtype == object:
            cut = np.asarray([isinstance(element, Censored) for element in given.flat]).reshape(
                given.shape
            )
            given = np.asarray([_plain(element) for element in given.flat]).reshape(given.shape)
        if given.dtype.kind not in "fiub":
            raise TypeError
        if not given.size:
            raise RowError(f"returned '{name}' as an empty array")
        return given.astype(float), cut
    except OverflowError:
        raise RowError(f"returned '{name}' with an integer too large for a float") from None
    except (TypeError, ValueError):
        kind = type(value).__name__
        raise RowError(f"returned '{name}' as {kind}, not as a number or array") from None


def _plain(element: Any) -> Any:
    """Return a number as a float, such as an integer of many digits or the time of a `Censored`."""
    if isinstance(element, Censored):
        return element.time
    number: Any = element
    return float(number) if isinstance(element, Number) else element


def _has_between(value: Any) -> bool:
    given = np.asarray(value)
    return given.dtype == object and any(isinstance(element, Between) for element in given.flat)


def upper_bounds(value: Any, numbers: NDArray[np.float64], cut: Any) -> NDArray[np.float64]:
    """Return the upper bounds of lives: of `between` its own, of `censored` infinity."""
    high = np.where(cut, np.inf, numbers)
    given = np.asarray(value)
    if given.dtype == object:
        for place, element in enumerate(given.flat):
            if isinstance(element, Between):
                high.flat[place] = element.high
    return high


def seen_in(row: Any) -> dict[str, Returned]:
    """Infer outputs from a row: names, shapes, and lives that are ``inf`` or `censored`.

    Raises
    ------
    RowError
        When it is not a dict of numbers.
    """
    if not isinstance(row, Mapping):
        raise RowError(f"returned {type(row).__name__}, not a dict")
    if not row:
        raise RowError("returned an empty dict; name at least one output")
    outputs = {}
    for name, value in row.items():
        if not (isinstance(name, str) and name.isidentifier()):
            raise RowError(f"returned {name!r}, which cannot be the name of an output")
        numbers, cut = numbers_of(value, name)
        life = bool(cut.any() or np.isposinf(numbers).any())
        outputs[name] = Returned(life=life, shape=numbers.shape, between=_has_between(value))
    return outputs


def joined(rows: Sequence[Mapping[str, Returned]]) -> dict[str, Returned]:
    """Merge the outputs inferred from rows: names and shapes of the first, lives of any."""
    return {
        name: replace(
            first,
            life=any(name in row and row[name].life for row in rows),
            between=any(name in row and row[name].between for row in rows),
        )
        for name, first in rows[0].items()
    }


def as_plain(returned: Mapping[str, Returned]) -> dict[str, dict[str, Any]]:
    """Return declarations as plain data, for `from_plain`."""
    return {name: asdict(declaration) for name, declaration in returned.items()}


def from_plain(data: Mapping[str, Mapping[str, Any]]) -> dict[str, Returned]:
    """Return declarations from plain data, the inverse of `as_plain`."""
    return {
        name: Returned(**{**entry, "shape": tuple(entry["shape"])}) for name, entry in data.items()
    }


def checked(
    returned: Any, expected: Mapping[str, Returned]
) -> Iterator[tuple[str, NDArray[np.float64], NDArray[np.bool_]]]:
    """Yield name, numbers and censoring mask of each output of a row.

    Upper bounds of a life that may be between two times follow it as ``<name>_high``. A tuple has
    the outputs in the order of `expected`, for compiled functions without dicts.

    Raises
    ------
    RowError
        When the outputs differ from `expected`, or a number is -inf or an unexpected NaN.
    """
    if isinstance(returned, tuple) and len(returned) == len(expected):
        returned = dict(zip(expected, returned, strict=True))
    if not isinstance(returned, Mapping):
        raise RowError(f"returned {type(returned).__name__}, not a dict")
    for name in expected:
        if name not in returned:
            names = [str(key) for key in returned]
            listed = ", ".join(f"'{key}'" for key in names[:_MOST_NAMES])
            listed += ", ..." * (len(names) > _MOST_NAMES)
            explanation = f"it returned {listed or 'an empty dict'}"
            raise RowError(f"returned no '{name}' ({explanation}){nearest(name, names)}")
    for name in returned:
        if name not in expected:
            raise RowError(f"returned '{name}', which 'returns' does not name")
    for name, declaration in expected.items():
        numbers, cut = numbers_of(returned[name], name)
        if numbers.shape != declaration.shape:
            shape = f"shape {numbers.shape}, expected {declaration.shape}"
            raise RowError(f"returned '{name}' with {shape}")
        if not declaration.life and (cut.any() or np.isposinf(numbers).any()):
            raise RowError(
                f"returned '{name}' as a life that has not ended, which it is not declared to be;"
                f" in Python: returns={{'{name}': uq.Returned(life=True)}}, in a machine file:"
                " life = true"
            )
        if not declaration.between and _has_between(returned[name]):
            raise RowError(
                f"returned '{name}' as a life between two times, which it is not declared to be;"
                f" write returns={{'{name}': uq.Returned(life=True, between=True)}}"
            )
        output = declaration.output(name)
        invalid = output.is_invalid(numbers)
        if invalid.any():
            message = f"'{name}' {output.absence(numbers[invalid][0])}"
            raise RowError(message, Status.NON_FINITE)
        yield name, numbers, cut
        if output.may_be_between:
            yield high_name(name), upper_bounds(returned[name], numbers, cut), cut
