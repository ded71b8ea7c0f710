"""The posterior as a result: its rows weighted, with the inspections inside."""

import json
from collections.abc import Iterator, Sequence
from hashlib import sha256
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtri

from uq.assess.row_inputs import inputs_of
from uq.assess.scale_laws import SCORES, terms_at
from uq.contract import Floats
from uq.errors import InputError, choices, first_fault_alone, nearest
from uq.learning.inspections import COLUMNS, Inspection, read_tables
from uq.learning.integrated_input import free_scales
from uq.learning.posterior import Posterior
from uq.result.result import AnyResult, Result
from uq.result.variables import error_name
from uq.result.weights import (
    INPUT,
    INSPECTED,
    INSPECTIONS,
    INTEGRATED,
    LAW_INFLUENCE,
    LAW_SCORES,
    LAW_TERMS,
    LEDGER,
    MODEL_ERROR,
    MOST,
    NEW_ROWS,
    OF_UNIT,
    ONLY_INSPECTED,
    ROWS,
    SCALE_SCORES,
    SCORE,
    UNIT_INFLUENCE,
    UNIT_MOST,
    UNIT_SCALE,
    UNIT_SCORES,
    UNIT_WEIGHT,
    WEIGHT,
    WORLDS,
)
from uq.sampling.truncation import cdf_within
from uq.stats.importance_weights import ImportanceWeights
from uq.text.numbers import counted

PRIOR = "prior_"
_LAW = (LAW_INFLUENCE, UNIT_INFLUENCE, LAW_TERMS, LAW_SCORES)
_WEIGHTS = (WEIGHT, UNIT_WEIGHT, UNIT_MOST, UNIT_SCALE, UNIT_SCORES, *_LAW)
_NESTING = ("world", "unit", "repeat")
_COMPRESSED = {"zlib": True, "complevel": 1}
"""Most rows represent one inspected unit and have equal entries for all others."""


def as_result(
    rows: Result,
    posterior: Posterior,
    inspections: Sequence[Inspection],
    model_cv: float,
    new_rows: int = 0,
) -> xr.Dataset:
    """Return a result with its rows weighted by a posterior.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    posterior : Posterior
        The posterior of these rows.
    inspections : sequence of Inspection
    model_cv : float
    new_rows : int
        Number of new rows that were allowed, 0 if none was required.

    Returns
    -------
    xarray.Dataset
        ``weight`` of each row as an uninspected unit; ``unit_weight`` (inspected, sample) as each
        inspected unit. An integrated input has values drawn from its posterior, and the lives that
        it scales are rescaled to them; computed values are kept with the prefix ``prior_``.
        ``unit_scale`` (inspected, sample): posterior draw of the integrated input of each inspected
        unit in each row; ``unit_scale_scores`` (inspected, sample, score): its posterior law.
        ``learnt_law_pulls``, ``learnt_law_follows`` (sample, term), ``unit_law_pulls``
        (inspected, sample, term), ``learnt_law_scores`` (score,): posterior law of an integrated
        input that all units share, and influence of the rows (`uq.learning.scale_posterior`).
        Attributes: ``inspections``, and ``ledger``, a digest of each.
    """
    if taken := [name for name in _WEIGHTS if name in rows.dataset.variables]:
        raise InputError(f"the model has a '{taken[0]}', which is what weights are called here")
    dataset, scale, n = rows.dataset, posterior.scale, len(rows)
    if scale is not None:
        assert posterior.any_unit.scale is not None
        replaced = _rescaled(rows, scale.name, posterior.any_unit.scale)
        kept = {f"{PRIOR}{name}": _as_prior(rows.dataset[name]) for name in replaced}
        dataset = rows.dataset.assign(replaced | kept)
    meaning = "how much the row counts, given the inspections"
    attrs = {"role": WEIGHT, "units": "1", "long_name": meaning}
    both, units = ("inspected", "row"), posterior.units.values()
    of_units = [_among_all(unit.rows, unit.weights.weights, n, 0.0) for unit in units]
    most = [unit.weights.most for unit in units]
    variables = {
        WEIGHT: ("row", posterior.any_unit.weights.weights, attrs),
        UNIT_WEIGHT: (both, np.stack(of_units), attrs | {"long_name": f"{meaning} of the unit"}),
        UNIT_MOST: ("inspected", most, attrs | {"long_name": "the largest possible unit_weight"}),
    }
    if scale is not None:
        scales = [_among_all(unit.rows, unit.scale, n, np.nan) for unit in units]
        of_scale = {"role": WEIGHT, "units": rows.dataset[scale.name].attrs["units"]}
        of_scale["long_name"] = f"{scale.name} of the inspected unit"
        variables[UNIT_SCALE] = (both, np.stack(scales), of_scale)
        laws = [_among_all(unit.rows, unit.scores, n, SCORES) for unit in units]
        meaning = f"normal score before, of {scale.name} of the inspected unit"
        variables[UNIT_SCORES] = ((*both, SCORE), np.stack(laws), attrs | {"long_name": meaning})
        variables |= _of_law(posterior, scale.name, attrs)
        meaning = "normal score given the inspections and the rest of the row"
        dataset = dataset.assign_coords(
            {SCORE: (SCORE, SCORES, {"long_name": meaning, "units": "1"})}
        )
    dataset = dataset.assign(variables).assign_coords(
        inspected=("inspected", list(posterior.units))
    )
    given = f"{counted(len(inspections), 'inspection')} of {counted(len(units), 'unit')}"
    if posterior.only_inspected:
        dataset = dataset.assign_attrs({ONLY_INSPECTED: posterior.only_inspected})
    new_attrs = {
        "title": f"{_prior_title(rows)}, given {given}",
        INTEGRATED: scale.name if scale else "",
        INSPECTIONS: json.dumps([as_table(inspection) for inspection in inspections]),
        LEDGER: json.dumps([digest(inspection) for inspection in inspections]),
        MODEL_ERROR: float(model_cv),
        NEW_ROWS: new_rows,
        WORLDS: posterior.likelihoods.worlds,
        "prior_title": _prior_title(rows),
    }
    for name, variable in dataset.variables.items():
        variable.encoding["_FillValue"] = None
        if name in (UNIT_WEIGHT, UNIT_SCALE, UNIT_SCORES, UNIT_INFLUENCE):
            variable.encoding |= _COMPRESSED
    return dataset.assign_attrs(new_attrs)


def _of_law(posterior: Posterior, scale: str, attrs: dict[str, Any]) -> dict[str, Any]:
    """Return the variables of the law of an input that all units share."""
    if (law := posterior.law) is None:
        return {}
    influence = posterior.influence
    influence_attrs = attrs | {
        "long_name": f"pull on terms of the law of {scale}",
        ROWS: len(influence),
    }
    of_terms = attrs | {"long_name": "terms in the row"}
    of_scores = attrs | {"long_name": f"normal score before, of {scale}"}
    units = np.stack([unit.without_own(influence) for unit in posterior.units.values()])
    return {
        LAW_INFLUENCE: (
            ("row", "term"),
            posterior.any_unit.without_own(influence),
            influence_attrs,
        ),
        UNIT_INFLUENCE: (("inspected", "row", "term"), units, influence_attrs),
        LAW_TERMS: (("row", "term"), posterior.any_unit.terms, of_terms),
        LAW_SCORES: (SCORE, law.scores, of_scores),
    }


def prior_of(result: Result) -> Result:
    """Return the prior rows of a posterior, without the effect of inspections."""
    if not result.has_weights:
        return result
    dataset = result.dataset
    kept = [
        name for name, column in dataset.data_vars.items() if column.attrs.get("role") == "prior"
    ]
    back = {}
    for name in kept:
        original = str(name).removeprefix(PRIOR)
        back[original] = dataset[original].copy(data=dataset[name].values)
    weights = [name for name in (*_WEIGHTS, INSPECTED, SCORE) if name in dataset]
    prior = dataset.assign(back).drop_vars([*kept, *weights])
    attrs = {name: text for name, text in dataset.attrs.items() if name not in _OF_POSTERIOR}
    prior.attrs = attrs | {"title": _prior_title(result)}
    return Result(prior)


_OF_POSTERIOR = (
    *(INTEGRATED, INSPECTIONS, LEDGER, MODEL_ERROR, NEW_ROWS),
    *(WORLDS, ONLY_INSPECTED, "prior_title"),
)


def as_unit(result: AnyResult, label: str) -> xr.Dataset:
    """Return the rows of a posterior, weighted to represent one inspected unit.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of `uq.update`.
    label : str
        Of the unit, as in the inspections.

    Returns
    -------
    xarray.Dataset
        A result with weights, which every reader of results takes.

    Raises
    ------
    InputError
        When the rows have no weights, or no such unit was inspected.
    """
    result = Result.of(result)
    if not result.has_weights:
        raise InputError("a unit can be named only of a result of 'uq update'")
    labels = [str(inspected) for inspected in result.dataset[INSPECTED].values]
    if label not in labels:
        raise InputError(
            f"unit '{label}' was not inspected{nearest(label, labels)} (allowed: {choices(labels)})"
        )
    place = labels.index(label)
    prior, name = prior_of(result), result.dataset.attrs[INTEGRATED]
    rows = prior.dataset
    if name:
        scale, drawn = result.dataset[UNIT_SCALE].values[place], rows[name].values
        rows = rows.assign(_rescaled(prior, name, np.where(np.isnan(scale), drawn, scale)))
        if UNIT_SCORES in result.dataset:  # posteriors of older versions have none
            law = result.dataset[UNIT_SCORES]
            attrs = law.attrs | {INPUT: name}
            rows = rows.assign({SCALE_SCORES: (law.dims[1:], law.values[place], attrs)})
        if LAW_INFLUENCE in result.dataset:
            rows = rows.assign(_law_of_unit(result, Result(rows), place))
    if result.dataset.attrs[WORLDS] == 1 and prior.nesting.repeats == 1:
        # Rows of one sample share nothing: each has a separate value of the integrated input.
        rows = rows.drop_vars(_NESTING, errors="ignore")
    weight = result.dataset.variables[WEIGHT].copy(data=result.dataset[UNIT_WEIGHT].values[place])
    weight.attrs[MOST] = float(result.dataset[UNIT_MOST].values[place])
    attrs = {"title": f"{_prior_title(result)}, unit {label}", OF_UNIT: label}
    return rows.assign({WEIGHT: weight}).assign_attrs(attrs)


def _law_of_unit(result: Result, rows: Result, place: int) -> dict[str, Any]:
    """Return the variables of the shared law for the rows of a unit."""
    name, inputs = result.dataset.attrs[INTEGRATED], inputs_of(rows)
    law, influence = result.dataset[LAW_SCORES], result.dataset[UNIT_INFLUENCE]
    below = cdf_within(inputs.laws[name], rows.dataset[name].values, inputs.bounds[name])
    return {
        LAW_INFLUENCE: (influence.dims[1:], influence.values[place], influence.attrs),
        LAW_TERMS: (influence.dims[1:], terms_at(law.values, ndtri(below))),
        LAW_SCORES: law,
    }


def every_unit(result: Result) -> Iterator[tuple[str, Result]]:
    """Yield the rows of a posterior as any unit, labelled "", then as each inspected one."""
    yield "", result
    for label in map(str, result.dataset[INSPECTED].values):
        yield label, Result(as_unit(result, label))


def inspections_of(result: Result) -> list[Inspection]:
    """Return the inspections used by a posterior."""
    with first_fault_alone():
        return read_tables(json.loads(result.dataset.attrs.get(INSPECTIONS, "[]")))


def as_table(inspection: Inspection) -> dict[str, object]:
    """Return an inspection as a table: column -> value, without empty columns."""
    values = {name: getattr(inspection, name) for name in COLUMNS}
    return {name: value for name, value in values.items() if value is not None}


def digest(inspection: Inspection) -> str:
    """Return the digest that identifies an inspection in the log."""
    return sha256(json.dumps(as_table(inspection), sort_keys=True).encode()).hexdigest()[:16]


def _prior_title(result: Result) -> str:
    return str(result.dataset.attrs.get("prior_title", result.dataset.attrs["title"]))


def _among_all(
    places: NDArray[np.intp], values: Floats | None, n: int, other: float | Floats
) -> Floats:
    """Scatter the values of some rows into an array of all n rows, with a fill value."""
    filled = np.full((n, *np.shape(other)), other)
    if values is not None:
        filled[places] = values
    return filled


def _as_prior(variable: xr.DataArray) -> xr.DataArray:
    about = {"role": "prior", "long_name": f"before the inspections: {variable.attrs['long_name']}"}
    return variable.assign_attrs(variable.attrs | about)


def _rescaled(rows: Result, name: str, values: Floats) -> dict[str, xr.DataArray]:
    """Return the variables with new values of an input, equal inputs, and rescaled lives."""
    inputs, outputs = inputs_of(rows), rows.outputs
    members = (name, *(member for member, leader in inputs.tied.items() if leader == name))
    rescaled = {member: rows.dataset[member].copy(data=values) for member in members}
    ratio = values / rows.dataset[name].values
    for output, declared in outputs.items():
        exponent = free_scales(inputs, declared).get(name)
        for scaled in (output, error_name(output)) if exponent else ():
            if scaled in outputs:
                variable = rows.dataset[scaled]
                factor = (ratio**exponent).reshape(-1, *[1] * (variable.ndim - 1))
                rescaled[scaled] = variable.copy(data=variable.values * factor)
    return rescaled


def unit_quality(result: Result) -> list[ImportanceWeights]:
    """Return the weights of a posterior, for uninspected units and each inspected unit."""
    return [weights for _, rows in every_unit(result) if (weights := rows.weights) is not None]
