"""Origin of a number: estimators, rows and their states."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from uq.render.trace.citations import Citation
from uq.result.result import Result


@dataclass(frozen=True)
class Origin:
    """Estimators and rows of a number.

    Attributes
    ----------
    estimators : tuple of Citation
        Of the number, and of its interval.
    rows : xarray.Dataset
        The rows of the result that suffice to recompute it.
    states : dict of str to int
        Number of these rows with a value, failed, censored and so on.
    notes : tuple of str
        Sentences on it.
    """

    estimators: tuple[Citation, ...]
    rows: Result
    states: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def rows_behind(result: Result) -> Result:
    """Return the independent rows of a result, or all rows if none is independent."""
    rows = result.independent
    return rows if len(rows) else result
