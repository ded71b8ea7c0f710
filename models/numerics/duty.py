"""Duty: states of operation, mixed or in sequence, as tables of a study and as numbers.

A state has the share of time that it takes, or its duration in a cycle that repeats; factors on the
wear and on what the machine names; an offset of the gap, by thermal expansion. What shares leave of
the time, nothing runs. A state without wear is off: lives are times of a calendar.

In mixed duty the rate of wear is the sum of share times rate over the states, each of which keeps a
response of its own: changes from state to state are assumed to be short, and to lead to the same
response every time.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel
from models.numerics.keys import no_such_key

ORDERS = ("mixed", "sequence")

TIME, WEAR, OFFSET, FACTORS = range(4)
"""Columns of a duty: the share, or the end in a cycle [s]; the factor of wear [1]; the offset of
the gap [m]; the first of the factors that a machine names [1]."""

_LONGEST, _LARGEST, _OFFSET = 1e12, 1e6, 1e-2
_ROUNDING = 1e-9  # of a sum of shares


def _number(
    name: str, given: dict[str, str | float], key: str, bounds: tuple[float, float], default: float
) -> float:
    value = given.pop(key, default)
    low, high = bounds
    if isinstance(value, str) or not low <= value <= high:
        raise ValueError(f"duty state '{name}' needs {key}, a number within {low!r} to {high!r}")
    return float(value)


def duty_numbers(
    tables: Sequence[Sequence[tuple[str, str | float]]],
    order: str,
    factors: Sequence[str],
    has_gaps: bool = True,
) -> NDArray[np.float64]:
    """Return the duty that a study states, as numbers.

    Parameters
    ----------
    tables : sequence of sequence of tuple
        Each with pairs of a key and its value: ``name``, ``share`` or ``duration`` [s], ``wear``,
        ``gap_offset`` [m], and the factors. Without tables there is one state.
    order : str
        One of `ORDERS`.
    factors : sequence of str
        Names of a machine's factors.
    has_gaps : bool
        Whether the machine has gaps, which may have an offset.

    Returns
    -------
    ndarray, shape (s, 3 + f)

    Raises
    ------
    ValueError
        With what is wrong, in one line.
    """
    if not tables:
        return np.array([[1.0, 1.0, 0.0] + [1.0] * len(factors)])
    time, longest = ("share", 1.0) if order == "mixed" else ("duration", _LONGEST)
    rows: list[list[float]] = []
    names: list[str] = []
    for number, pairs in enumerate(tables, 1):
        given = dict(pairs)
        name = str(given.pop("name", number))
        if name in names:
            raise ValueError(f"two duty states are called '{name}'")
        names.append(name)
        row = [_number(name, given, time, (0.0, longest), np.nan)]
        row.append(_number(name, given, "wear", (0.0, _LARGEST), 1.0))
        offset = given if has_gaps else {}
        row.append(_number(name, offset, "gap_offset", (-_OFFSET, _OFFSET), 0.0))
        row += [_number(name, given, factor, (0.0, _LARGEST), 1.0) for factor in factors]
        if given:
            allowed = ["name", time, "wear", *["gap_offset"] * has_gaps, *factors]
            owner = f"duty state '{name}', in order '{order}',"
            raise ValueError(no_such_key(owner, min(given), allowed))
        rows.append(row)
    numbers = np.array(rows)
    total = float(numbers[:, TIME].sum())
    if order == "mixed":
        if total > 1 + _ROUNDING:
            raise ValueError(f"the shares of the duty states sum to {total:.6g}, more than 1")
        return numbers
    if not (numbers[:, TIME] > 0).all():
        raise ValueError("the duration of every duty state must be positive")
    numbers[:, TIME] = np.cumsum(numbers[:, TIME])
    return numbers


def history_numbers(points: Sequence[Sequence[float]]) -> NDArray[np.float64]:
    """Return a history of the gap, shape (2, k): times [s] and changes [m].

    Parameters
    ----------
    points : sequence of sequence of float
        Each a time and a change.

    Raises
    ------
    ValueError
        If the times do not ascend from 0, the first change is not 0, or a change is too large.
    """
    history = np.array(points, float).reshape(-1, 2).T
    if history.shape[1]:
        later = np.flatnonzero(~(np.diff(history[0]) > 0))
        if len(later):
            before, after = history[0, later[0] : later[0] + 2].tolist()
            raise ValueError(f"gap_history must ascend in time: {after:g} s follows {before:g} s")
        if history[0, 0] != 0 or history[1, 0] != 0:
            raise ValueError("gap_history must begin with time 0 and change 0")
        largest = float(history[1, np.abs(history[1]).argmax()])
        if not abs(largest) <= _OFFSET:
            bounds = f"{-_OFFSET!r} to {_OFFSET!r} [m]"
            raise ValueError(f"changes of gap_history must be within {bounds}: {largest:g}")
    return np.ascontiguousarray(history)


@kernel
def end_of_state(state, duty):
    """Return the end of state number 0, 1, 2, ... of a sequence that repeats [s]."""
    count = len(duty)
    return (state // count) * duty[count - 1, TIME] + duty[state % count, TIME]


@kernel
def offset_of_state(state, duty, in_sequence):
    """Return the offset of the gaps in a state [m]; in mixed duty the largest of all states."""
    if in_sequence:
        return duty[state % len(duty), OFFSET]
    largest = duty[0, OFFSET]
    for s in range(1, len(duty)):
        largest = max(largest, duty[s, OFFSET])
    return largest
