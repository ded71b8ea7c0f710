"""The names of the elements of an output with dimensions."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np


def places(
    output: str, coordinates: Mapping[str, Any]
) -> Iterator[tuple[str, tuple[int, ...], dict[str, Any]]]:
    """Yield name, index and coordinates of each element of an output, in order.

    Parameters
    ----------
    output : str
    coordinates : dict of str to array
        Of each dimension, in order.

    Yields
    ------
    tuple
        Coordinates in names are written like Python's repr, without quotes.
    """
    axes = {dim: np.asarray(axis) for dim, axis in coordinates.items()}
    for index in np.ndindex(*map(len, axes.values())):
        place = {dim: axes[dim][i].item() for dim, i in zip(axes, index, strict=True)}
        label = ",".join(f"{dim}={value}" for dim, value in place.items())
        yield f"{output}[{label}]" if label else output, index, place
