"""The elements of a result's outputs, and the independence and weights of its rows."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import inf, prod
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats as Floats
from uq.contract import Mask as Mask
from uq.contract import Output, cause_name, censored_name, entered_name, high_name
from uq.errors import InputError, choices, nearest
from uq.result.element import Element as Element
from uq.result.element import elements_in, places
from uq.result.nesting import is_nested, nesting_of
from uq.result.result_file import failed, refuse_empty
from uq.result.variables import outputs_of
from uq.result.weights import (
    LAW_INFLUENCE,
    LAW_TERMS,
    ROWS,
    has_next_rows,
    has_rounds,
    largest_weight,
    row_weights,
)
from uq.sampling.designs import CURVES, DESIGNS, NOISE
from uq.stats.dependent_rows import INDEPENDENT, Dependence, SharedInfluence
from uq.stats.importance_weights import (
    ImportanceWeights,
    effective_rows,
    is_negligible,
    tail_shape,
)
from uq.study.reading import study_of_result
from uq.text.element_names import MOST_PLACES, Place, is_whole, place_of, whole_name


def independent_rows(ds: xr.Dataset) -> xr.Dataset:
    """Return the rows for plain statistics: blocks A and B of a crossed design, else all rows.

    The other blocks repeat the values of A and B. No row is returned if `why_no_statistics` gives a
    reason.

    Raises
    ------
    InputError
        When the result has no rows at all.
    """
    refuse_empty(ds)
    labels = [] if why_no_statistics(ds) else flags(ds["block"])
    plain = [c for c, label in labels if label != NOISE and not label.startswith(("AB_", "BA_"))]
    chosen = np.isin(ds["block"].values, plain)
    return ds if chosen.all() else ds.isel(row=chosen)


def why_no_statistics(ds: xr.Dataset) -> str:
    """Return why the rows of a result do not support plain statistics (a predicate), or ""."""
    design = DESIGNS[ds.attrs["design"]]
    if not design.follows_laws:
        return "do not follow the laws of the inputs"
    if ds.attrs.get("random") and design.layout is CURVES:
        return "share seeds along a curve, as the model is random"
    return ""


def dependence_of(rows: xr.Dataset) -> Dependence:
    """Return the dependence between rows: in replicates of a design, samples of several rows, ...

    Inspections that have weighted all rows jointly make all of them dependent.
    """
    is_weighted_jointly = LAW_INFLUENCE in rows.variables
    are_samples = has_independent_samples(rows)
    if not is_nested(rows) and not is_weighted_jointly:
        if are_samples:
            return INDEPENDENT
        return Dependence(rows["replicate"].values, inputs_of(rows))
    place = nesting_of(rows)
    labels = place.sample if are_samples else rows["replicate"].values
    return Dependence(
        labels,
        samples=place.samples,
        are_samples=are_samples,
        shared=_shared_influence(rows, labels) if is_weighted_jointly else None,
    )


def inputs_of(rows: xr.Dataset) -> Floats:
    """Return the values of the uncertain inputs, shape (n, d)."""
    columns = [v.values for v in rows.variables.values() if v.attrs.get("role") == "input"]
    return np.column_stack(columns) if columns else np.empty((rows.sizes["row"], 0))


def _shared_influence(rows: xr.Dataset, labels: NDArray[np.integer]) -> SharedInfluence:
    """Return the influence of weighted rows on the posterior law of a shared input."""
    influence = rows[LAW_INFLUENCE]
    scaled = influence.values * (len(labels) / influence.attrs[ROWS])
    return SharedInfluence(scaled, labels, np.arange(len(labels)), rows[LAW_TERMS].values)


def has_independent_samples(ds: xr.Dataset) -> bool:
    """Whether samples are independent, however many rows each has."""
    if has_rounds(ds):
        return has_next_rows(ds)
    design = DESIGNS[ds.attrs["design"]]
    return design.independent or (
        design.imported and study_of_result(ds.attrs["study"]).design.independent
    )


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
    labelled = variable.copy(data=np.array(words)[order][places])
    meanings = " ".join(word for code, word in flags(variable) if code >= 0)
    labelled.attrs = {"long_name": variable.attrs["long_name"], "flag_meanings": meanings}
    return labelled


def category_codes(ds: xr.Dataset, name: str) -> dict[str, NDArray[np.int8]]:
    """Return the codes of a category, by the name of its element.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, or some rows of one.
    name : str
        ``period`` for all elements, ``period[site=left]`` for one.

    Returns
    -------
    dict of str to ndarray, shape (n,)

    Raises
    ------
    InputError
        When it has no such element.
    """
    output = name.partition("[")[0]
    axes = {str(dim): ds[dim].values for dim in ds[output].dims[1:]}
    values: Any = ds[output].values
    chosen = list(places(output, axes)) if name == output else place_of(name, axes)
    if not chosen:
        raise _no_such_element(name, [label for label, *_ in places(output, axes)])
    return {label: values[(slice(None), *index)] for label, index, _ in chosen}


def _no_such_element(name: str, names: Collection[str]) -> InputError:
    return InputError(f"no such element '{name}'{nearest(name, names)} (allowed: {choices(names)})")


def thinned_outputs(ds: xr.Dataset, declared: Mapping[str, Output] | None = None) -> dict[str, int]:
    """Return the number of elements of each output that is described at selected elements only.

    These outputs have more than `MOST_PLACES` elements, and the study does not name them. Outputs
    as `declared`, where that is known.
    """
    declared = outputs_of(ds) if declared is None else declared
    sizes = {name: prod(ds.sizes[dim] for dim in output.dims) for name, output in declared.items()}
    huge = {name: size for name, size in sizes.items() if size > MOST_PLACES}
    named = study_of_result(ds.attrs["study"]).analysis.outputs if huge else ()
    return {name: size for name, size in huge.items() if name not in named}


def elements_of(
    ds: xr.Dataset,
    outputs: Sequence[str],
    every: bool = False,
    declared: Mapping[str, Output] | None = None,
    lost: Mask | None = None,
) -> Iterator[Element]:
    """Yield the elements of outputs in order, skipping categories.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, or some rows of one.
    outputs : sequence of str
        Names of outputs.
    every : bool
        Whether to yield all elements of `thinned_outputs`, too.
    declared : dict of str to Output, optional
        The outputs of the result, where they are already read.
    lost : ndarray of bool, shape (n,), optional
        The failed rows, where they are already known.

    Yields
    ------
    Element

    Raises
    ------
    InputError
        When the result has no such output.
    """
    declared = outputs_of(ds) if declared is None else declared
    thinned = () if every else thinned_outputs(ds, declared)
    for output in outputs:
        most = MOST_PLACES if output in thinned else inf
        where = partial(places, output, most=most)
        yield from _elements_at(ds, output, where, declared, lost)


def _elements_at(
    ds: xr.Dataset,
    output: str,
    where: Callable[[Mapping[str, Any]], Iterable[Place]],
    outputs: Mapping[str, Output],
    lost: Mask | None = None,
) -> Iterator[Element]:
    """Yield elements of an output, unless it is a category; `where` selects coordinates."""
    flag = censored_name(output)
    if output not in outputs:
        raise InputError(
            f"no such output '{output}'{nearest(output, outputs)} (allowed: {choices(outputs)})"
        )
    declared = outputs[output]
    if not declared.is_category:
        axes = {dim: ds[dim].values for dim in declared.dims}
        censored = ds.variables[flag] if flag in ds else None
        lost = failed(ds) if lost is None else lost
        rows = lost, row_weights(ds), largest_weight(ds)
        values = ds.variables[output]
        beside = {
            key: ds.variables[name]
            for key, name in zip(_COMPANIONS, _companion_names(output), strict=True)
            if declared.is_lifetime and name in ds.variables
        }
        yield from elements_in(output, declared, values, censored, axes, *rows, where(axes), beside)


_COMPANIONS = ("high", "entered", "causes")


def _companion_names(output: str) -> tuple[str, str, str]:
    return high_name(output), entered_name(output), cause_name(output)


def named_elements(ds: xr.Dataset, name: str) -> list[Element]:
    """Return the elements of the output, or the one element, that a name refers to.

    Parameters
    ----------
    ds : xarray.Dataset
    name : str
        ``time_to_depth`` or ``time_to_depth[:]`` for all its elements,
        ``time_to_depth[site=left,depth=0.00025]`` for one.

    Returns
    -------
    list of Element

    Raises
    ------
    InputError
        When there is no such output or element, or it is a category.
    """
    output = name.partition("[")[0]
    whole = name == output or is_whole(name)
    matches = (
        [] if whole else list(_elements_at(ds, output, partial(place_of, name), outputs_of(ds)))
    )
    if matches:
        return matches
    elements = list(elements_of(ds, [output], every=True))
    if not elements:
        raise InputError(
            f"'{output}' is a category, not a number; 'uq summary' shows the shares of its labels,"
            f" and 'uq sensitivity --output {output}' what determines them"
        )
    if name == output or (name == whole_name(output) and len(elements) > 1):
        return elements
    raise _no_such_element(name, [element.name for element in elements])


def weights_of(rows: xr.Dataset) -> ImportanceWeights | None:
    """Return the weights of rows with their quality, None if rows have no weights.

    Parameters
    ----------
    rows : xarray.Dataset
        The independent rows of a result, or samples of several rows.
    """
    weights = row_weights(rows)
    if weights is None:
        return None
    of_samples = dependence_of(rows).sums_of_samples(weights)
    k, most = tail_shape(of_samples), largest_weight(rows)
    is_bounded = has_next_rows(rows)  # by the mixture's own density
    k = min(k, 0.0) if is_bounded or is_negligible(most, len(of_samples)) else k
    return ImportanceWeights(weights, k, len(of_samples), effective_rows(of_samples), most)
