"""All laws of wear by name, and the tables of a study as numbers."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from models.numerics.keys import no_such_key
from models.numerics.wear_laws.edf import EDF
from models.numerics.wear_laws.law import MOST, WearLaw
from models.numerics.wear_laws.power import POWER
from models.numerics.wear_laws.running_in import RUNNING_IN

LAWS: tuple[WearLaw, ...] = (POWER, RUNNING_IN, EDF)

ARCHARD = "archard"
"""Name of the law that wears k U."""


def law_numbers(name: str, pairs: Sequence[tuple[str, str | float]]) -> NDArray[np.float64]:
    """Return a law that a study names, as numbers for `worn.wear_rate`.

    Parameters
    ----------
    name : str
        `ARCHARD`, or the name of one of `LAWS`.
    pairs : sequence of tuple
        Arguments and their values.

    Returns
    -------
    ndarray, shape (l, 1 + MOST)
        Index into `LAWS`, then the arguments; l = 0 for Archard's law.

    Raises
    ------
    ValueError
        With what is wrong, in one line.
    """
    places = {law.name: index for index, law in enumerate(LAWS)}
    if name not in (ARCHARD, *places):
        raise ValueError(f"wear law {name!r}: must be one of {', '.join((ARCHARD, *places))}")
    arguments = LAWS[places[name]].arguments if name in places else ()
    given = dict(pairs)
    unknown = sorted(given.keys() - {argument.name for argument in arguments})
    if unknown:
        allowed = [argument.name for argument in arguments]
        raise ValueError(no_such_key(f"wear law '{name}'", unknown[0], allowed))
    numbers = np.zeros((int(name in places), 1 + MOST))
    for row in numbers:
        row[0] = places[name]
        for place, argument in enumerate(arguments, 1):
            value = given.get(argument.name, argument.default)
            low, high = argument.bounds
            if isinstance(value, str) or not low <= value <= high:
                words = f"a number within {low!r} to {high!r} [{argument.unit}]"
                raise ValueError(f"wear law '{name}' needs {argument.name}, {words}")
            row[place] = value
    return numbers
