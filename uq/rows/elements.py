"""The elements of a result's outputs: one plain array each, with the outcome of every row."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Floats, Mask, Output
from uq.designs.layouts import CURVES, NOISE
from uq.designs.registry import DESIGNS
from uq.errors import InputError, choices, nearest
from uq.intervals import Replicates
from uq.rows.columns import censored_name
from uq.rows.results import elements, failed
from uq.rows.variables import outputs_of
from uq.study.file import AnalysisTable, StudyFile
from uq.study.reading import read_study_text


@dataclass(frozen=True)
class Element:
    """One number per row: an output, or one element of an output that has dimensions.

    Attributes
    ----------
    name : str
        ``work_rate[site=left]``.
    output : str
        ``work_rate``.
    declared : Output
        The declaration of the output; not a category.
    place : dict of str to object
        Dimension -> coordinate; empty for an output without dimensions.
    values : ndarray, shape (n,)
        NaN where there is no value; +inf for a life that never ends.
    censored : ndarray of bool, shape (n,)
        Where the value is only a lower bound.
    failed : ndarray of bool, shape (n,)
        Where the value is missing because the row failed.
    """

    name: str
    output: str
    declared: Output
    place: dict[str, Any]
    values: Floats
    censored: Mask
    failed: Mask

    @property
    def units(self) -> str:
        """CF unit string."""
        return self.declared.unit

    @property
    def meaning(self) -> str:
        """One line that describes the output."""
        return self.declared.meaning

    @property
    def is_lifetime(self) -> bool:
        """Whether it is the time until an event."""
        return self.declared.is_lifetime

    @property
    def is_angle(self) -> bool:
        """Whether its sign is a direction."""
        return self.declared.is_angle

    @property
    def for_thresholds(self) -> Floats:
        """The values, or of an angle their magnitudes, shape (n,)."""
        return self.declared.for_thresholds(self.values)

    @property
    def undefined(self) -> Mask:
        """Where the row is sound but the value is undefined."""
        return np.isnan(self.values) & ~self.failed

    @property
    def never(self) -> Mask:
        """Where a life is known never to end."""
        return np.isposinf(self.values) & ~self.censored

    @property
    def present(self) -> Mask:
        """Where there is a value."""
        return ~np.isnan(self.values)

    def unknown_sides(self, threshold: float) -> Mask:
        """Return where rows were censored below a threshold, so that their side is unknown."""
        return self.censored & (self.values < threshold)

    @property
    def at_least(self) -> Floats:
        """The values, shape (present,), with censored ones at their lower bound."""
        return self.values[self.present]

    @property
    def at_most(self) -> Floats:
        """The values, shape (present,), with censored ones at infinity."""
        return np.where(self.censored, np.inf, self.values)[self.present]


def analysis_of(ds: xr.Dataset) -> AnalysisTable:
    """Return the [analysis] of the study in a result."""
    return study_file_of(ds).analysis


def study_file_of(ds: xr.Dataset) -> StudyFile:
    """Return the study in a result."""
    return read_study_text(ds.attrs["study"], "study of this result")


def independent_rows(ds: xr.Dataset) -> xr.Dataset:
    """Return the rows for plain statistics: blocks A and B of a crossed design, all rows of others.

    The other blocks repeat the values of A and B. No row is returned where `why_no_statistics`.
    """
    labels = [] if why_no_statistics(ds) else flags(ds["block"])
    plain = [c for c, label in labels if label != NOISE and not label.startswith(("AB_", "BA_"))]
    chosen = np.isin(ds["block"].values, plain)
    return ds if chosen.all() else ds.isel(sample=chosen)


def why_no_statistics(ds: xr.Dataset) -> str:
    """Return why the rows of a result do not support plain statistics (a predicate), or ""."""
    design = DESIGNS[ds.attrs["design"]]
    if not design.follows_laws:
        return "do not follow the laws of the inputs"
    if ds.attrs.get("random") and design.layout is CURVES:
        return "share seeds along a curve, as the model is random"
    return ""


def replicates_of(rows: xr.Dataset) -> Replicates:
    """Return the replicate of each row, or None if the rows are independent."""
    return None if are_independent(rows) else rows["replicate"].values


def are_independent(ds: xr.Dataset) -> bool:
    """Whether the rows of a result (blocks A and B of a crossed design) are independent."""
    design = DESIGNS[ds.attrs["design"]]
    return design.independent or (design.imported and study_file_of(ds).design.independent)


def flags(variable: xr.DataArray) -> list[tuple[int, str]]:
    """Return the codes of a CF flag variable with their labels."""
    codes = np.atleast_1d(variable.attrs["flag_values"]).tolist()
    return list(zip(codes, variable.attrs["flag_meanings"].split(), strict=True))


def labels(variable: xr.DataArray) -> xr.DataArray:
    """Return the labels of the codes of a variable.

    Parameters
    ----------
    variable : xarray.DataArray
        The ``status``, the ``regime`` or another category of a result, or some rows of it.

    Returns
    -------
    xarray.DataArray
        Of the same shape, for instance to colour a figure or to group by.

    Raises
    ------
    InputError
        When the variable is not a category.
    """
    if "flag_values" not in variable.attrs:
        raise InputError(f"'{variable.name}' is not a category and has no labels")
    codes, words = zip(*flags(variable), strict=True)
    order = np.argsort(codes)
    places = np.searchsorted(codes, variable.values, sorter=order)
    found = variable.copy(data=np.array(words)[order][places])
    found.attrs = {"long_name": variable.attrs["long_name"]}
    return found


def shown_outputs(ds: xr.Dataset, analysis: AnalysisTable) -> tuple[str, ...]:
    """Return the outputs that a study names, or all if it names none."""
    named = tuple(dict.fromkeys((*analysis.outputs, *analysis.thresholds)))
    return named if analysis.outputs else output_names(ds)


def output_names(ds: xr.Dataset) -> tuple[str, ...]:
    """Return the names of all outputs of a result."""
    return tuple(outputs_of(ds))


def elements_of(ds: xr.Dataset, outputs: Sequence[str]) -> Iterator[Element]:
    """Yield the elements of some outputs in order, skipping categories.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, or some rows of one.
    outputs : sequence of str
        Names of outputs.

    Yields
    ------
    Element

    Raises
    ------
    InputError
        When the result has no such output.
    """
    unsound, known = failed(ds), outputs_of(ds)
    for output in outputs:
        if output not in known:
            raise InputError(
                f"no such output '{output}'{nearest(output, known)} (allowed: {choices(known)})"
            )
        variable, declared = ds[output], known[output]
        if declared.is_category:
            continue
        flag = censored_name(output)
        for name, column in elements(variable):
            place = {str(dim): column[dim].item() for dim in variable.dims if dim != "sample"}
            values = column.values
            absent = declared.is_absent(values)
            censored = np.zeros(len(values), dtype=bool)
            if flag in ds:
                censored = ds[flag].sel(place).values.astype(bool) & ~absent
            known_values = np.where(absent, np.nan, values)
            yield Element(name, output, declared, place, known_values, censored, absent & unsound)


def named_elements(ds: xr.Dataset, name: str) -> list[Element]:
    """Return the elements of the output, or the one element, that a name refers to.

    Parameters
    ----------
    ds : xarray.Dataset
    name : str
        ``time_to_depth`` for all its elements, ``time_to_depth[site=left,depth=0.00025]`` for one.

    Returns
    -------
    list of Element

    Raises
    ------
    InputError
        When there is no such output or element, or it is a category.
    """
    output = name.partition("[")[0]
    found = list(elements_of(ds, [output]))
    if not found:
        raise InputError(
            f"'{output}' is a category, not a number; 'uq summary' shows the shares of regimes, and"
            f" 'uq sensitivity --output {output}' what determines them"
        )
    if name == output:
        return found
    chosen = [element for element in found if element.name == name]
    if not chosen:
        names = [element.name for element in found]
        raise InputError(
            f"no such element '{name}'{nearest(name, names)} (allowed: {choices(names)})"
        )
    return chosen


def lifetimes(ds: xr.Dataset, name: str) -> list[Element]:
    """Return the elements of a lifetime that a name refers to; see `named_elements`.

    Raises
    ------
    InputError
        Also when the output is not a lifetime.
    """
    found = named_elements(ds, name)
    if not found[0].is_lifetime:
        lives = [one for one, output in outputs_of(ds).items() if output.is_lifetime]
        raise InputError(f"'{name}' is not a lifetime (lifetimes: {choices(lives)})")
    return found
