"""How far a run is, for whoever watches it."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple


class Progress(NamedTuple):
    """How far a run is.

    Attributes
    ----------
    done, total, failed : int
        Rows.
    found : int
        Rows among those done that were there from the start.
    status : dict of str to int
        Status label -> rows.
    median : tuple of (str, float) or None
        Name and median of a life [s] that is of interest, among the rows that arrived in this
        process.
    shares : dict of str to float
        Of regimes, among the same rows.
    dashboard : str
        Address of the page of a dask cluster, or "".
    compiling : bool
        Whether the model is being compiled, for which rows wait.
    """

    done: int
    total: int
    failed: int
    found: int = 0
    status: Mapping[str, int] = MappingProxyType({})
    median: tuple[str, float] | None = None
    shares: Mapping[str, float] = MappingProxyType({})
    dashboard: str = ""
    compiling: bool = False


Report = Callable[[Progress], object]
"""What is called whenever rows have arrived."""
