"""A function compiled by numba as a machine: rows are computed by one compiled loop."""

import sys
from collections.abc import Callable
from functools import cache
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.machines.row_by_row import SEED, RowByRow


def is_compiled(function: Callable[..., Any]) -> bool:
    """Whether a function is compiled by numba."""
    if "numba" not in sys.modules:
        return False
    from numba.core.dispatcher import Dispatcher

    return isinstance(function, Dispatcher)


class Compiled(RowByRow):
    """A batch that computes rows by a compiled loop; see `RowByRow`.

    A row that raises, or returns an invalid value, is computed once more by itself for its message.
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

    None if the function does not return what it should, or if the bits of a row could depend on
    those computed with it.
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
    """Return a compiled function of a row and its seed, which is an argument in some place."""
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
    """Return a compiled function that keeps values, and returns whether their shapes are right."""
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
