"""Names of the elements of an output with dimensions."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from math import inf, prod
from typing import Any

import numpy as np

MOST_PLACES = 500
"""Largest number of elements described individually, unless a study names the output."""


Place = tuple[str, tuple[int, ...], dict[str, Any]]
"""Name, index and coordinates of an element."""


def places(output: str, coordinates: Mapping[str, Any], most: float = inf) -> Iterator[Place]:
    """Yield name, index and coordinates of each element of an output, in order.

    Parameters
    ----------
    output : str
    coordinates : dict of str to array
        Coordinates of each dimension, in order.
    most : float
        Largest number of elements, evenly spread along each dimension.

    Yields
    ------
    Place
        Coordinates in names are written like Python's repr, without quotes.
    """
    axes = {dim: np.asarray(axis) for dim, axis in coordinates.items()}
    for index in product(*spread([len(axis) for axis in axes.values()], most)):
        place = {dim: axes[dim][i].item() for dim, i in zip(axes, index, strict=True)}
        label = ",".join(f"{dim}={value}" for dim, value in place.items())
        yield f"{output}[{label}]" if label else output, index, place


def place_of(name: str, coordinates: Mapping[str, Any]) -> list[Place]:
    """Return a list with the element of this name; empty if there is none.

    Numbers may be written in any way: ``[instant=3600]`` is ``[instant=3600.0]``.
    """
    axes = tuple((dim, tuple(np.asarray(axis).tolist())) for dim, axis in coordinates.items())
    place = _by_name(name.partition("[")[0], axes).get(_read(name))
    return [place] if place else []


def same_name(name: str, names: Iterable[str]) -> str:
    """Return the equivalent name from a list, or the name itself if none; see `place_of`."""
    return {_read(candidate): candidate for candidate in names}.get(_read(name), name)


@lru_cache(maxsize=4)
def _by_name(
    output: str, axes: tuple[tuple[str, tuple[Any, ...]], ...]
) -> dict[tuple[Any, ...], Place]:
    return {_read(place[0]): place for place in places(output, dict(axes))}


def _read(name: str) -> tuple[Any, ...]:
    """Return the parts of a name, with numeric coordinates as numbers."""
    output, _, rest = name.partition("[")
    parts = (part.partition("=") for part in rest.removesuffix("]").split(","))
    return output, *((dim.strip(), _number(text.strip())) for dim, _, text in parts)


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def spread(lengths: Sequence[int], most: float) -> list[list[int]]:
    """Return evenly spread indices along each dimension, for at most `most` elements.

    The longest dimensions are thinned first.

    Examples
    --------
    >>> spread([2, 9], most=10)
    [[0, 1], [0, 2, 4, 6, 8]]
    """
    counts = list(lengths)
    while prod(counts) > most:
        longest = counts.index(max(counts))
        counts[longest] = counts[longest] * 15 // 16
    return [
        np.linspace(0, length - 1, count).round().astype(int).tolist()
        for length, count in zip(lengths, counts, strict=True)
    ]


def whole_name(output: str) -> str:
    """Return the name for all elements of an output together: ``work_rate[:]``."""
    return f"{output}{_WHOLE}"


def is_whole(name: str) -> bool:
    """Whether a name denotes all elements together."""
    return name.endswith(_WHOLE)


_WHOLE = "[:]"
