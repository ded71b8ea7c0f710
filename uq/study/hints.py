"""Hints on intervals, indices and bounds that a study cannot give, before rows are computed.

Hints are not faults: each may be intended.
"""

from collections.abc import Iterator
from math import prod
from typing import TYPE_CHECKING

from uq.contract import Model
from uq.indices.methods import METHODS, fed_by
from uq.machines.row_by_row import undeclared_lives
from uq.sampling.designs import DESIGNS, PATHS, PLAIN
from uq.stats.order_statistics import is_within, rows_for_bound, rows_to_reach
from uq.stats.quantile_functions import student
from uq.study.file import USUAL
from uq.text.numbers import counted, listed
from uq.text.quantities import nearest_unit, unknown_factor

if TYPE_CHECKING:
    from uq.study.definition import Study

REPLICATES = 8
"""Advised number of replicates."""

_LARGE_CV = 2.0
_FEW = 3  # replicates with which an interval is about twice as wide, or more


def hints(study: "Study") -> list[str]:
    """Return a sentence with a remedy for each number that a study cannot give.

    Parameters
    ----------
    study : Study
        Study of a model with declared outputs.
    """
    return [
        *_unknown_units(study.model),
        *_percentages(study),
        *undeclared_lives(study.model, study.analysis.outputs),
        *_intervals(study),
        *_indices(study),
        *_ends_of_samples(study),
    ]


def _percentages(study: "Study") -> Iterator[str]:
    """Yield a hint for each coefficient of variation that looks like a percentage."""
    for name, law in study.uncertain.items():
        cv = getattr(law, "cv", None)
        if cv is not None and cv >= _LARGE_CV:
            yield (
                f"[uncertain.{name}] cv = {cv:g}: the standard deviation is {cv:g} times the mean;"
                f" if {cv:g} % is meant, write cv = {cv / 100:g}"
            )


def _unknown_units(model: Model) -> Iterator[str]:
    """Yield a hint for each unit of a model that may be misspelt."""
    units = {f"parameter '{name}'": model.parameter(name).unit for name in model.parameter_names}
    units |= {f"output '{name}'": output.unit for name, output in model.outputs.items()}
    for owner, unit in units.items():
        if odd := unknown_factor(unit):
            yield (
                f"{owner} has unit '{unit}': '{odd}' is not a usual unit{nearest_unit(odd)}; as a"
                " unit of your own it is shown as written, and no other unit converts to it"
            )


def _intervals(study: "Study") -> Iterator[str]:
    """Yield a hint if replicates, or samples of several rows, are too few for an interval."""
    design = study.design
    kind = DESIGNS[design.method]
    key, count, least = "replicates", design.replicates, REPLICATES
    why = f"the rows of a '{design.method}' design are not independent"
    remedy = f"set {key} = {least}"
    if kind.independent or design.independent:
        if design.rows_of_a_sample == 1:
            return
        key, count, why = "samples", design.samples, "the rows of one sample are not independent"
        remedy = f"set {key} = {least} or more"
    elif kind.imported:
        why = "how the rows were drawn is unknown"
        remedy = "set independent = true if they are independent draws from the laws"
    numbers = "number but its indices" if kind.layout is PATHS else "number"
    if count == 1:
        yield f"[design] {key} = 1: no {numbers} will have an interval, since {why}; {remedy}"
    elif count <= _FEW:
        wider = student(0.975, count - 1) / student(0.975, least - 1)
        yield (
            f"[design] {key} = {count}: intervals will be about {wider:.2g} times as wide as from"
            f" {least} with as many rows in all; {remedy}"
        )


def _indices(study: "Study") -> Iterator[str]:
    """Yield a hint for each sensitivity method that has too few groups of rows.

    The default method of a plain sample is skipped, since other statistics require fewer rows.
    """
    design, kind = study.design, DESIGNS[study.design.method]
    groups = design.samples * design.replicates
    default = () if kind.layout is PLAIN else fed_by(kind)[:1]
    for name in study.analysis.sensitivity or default:
        method = METHODS[name]
        if groups < method.least:
            needed = counted(method.least, *method.layout.group)
            yield f"sensitivity '{name}' needs {needed}, and there will be {groups} at most"


def _ends_of_samples(study: "Study") -> Iterator[str]:
    """Yield a hint for quantiles and tolerance bounds that require a larger sample size."""
    design, analysis = study.design, study.analysis
    rows = design.samples * design.replicates * design.rows_of_a_sample
    if DESIGNS[design.method].layout is not PLAIN:
        return
    if beyond := [p for p in analysis.quantiles if not is_within(p, rows)]:
        yield (
            f"[analysis] quantiles: {listed([f'{p:g}' for p in beyond])} of {counted(rows, 'row')}"
            f" will have no value; {max(map(rows_to_reach, beyond))} rows are needed"
        )
    for key in ("tolerance", "joint_bounds"):
        if getattr(analysis, key):
            bounds = _joint(study) if key == "joint_bounds" else 1
            coverage, confidence = analysis.tolerance or USUAL
            needed = rows_for_bound(coverage, confidence, bounds=bounds)
            if rows < needed:
                yield (
                    f"[analysis] {key}: {counted(rows, 'row')} will give no bound;"
                    f" {needed} are needed if no row is invalid"
                )


def _joint(study: "Study") -> int:
    """Return the number of joint bounds."""
    axes, outputs = study.model.coordinates(study.settings), study.model.outputs
    bounds = 0
    for name, side in study.analysis.joint_bounds.items():
        elements = prod(len(axes[dim]) for dim in outputs[name].dims)
        bounds += elements * (2 if side == "both" else 1)
    return bounds
