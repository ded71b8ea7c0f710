"""Sensitivity indices of a result, by every method that its design feeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan

import numpy as np

from uq.assess.chosen_targets import chosen, few_hits
from uq.assess.design_sample import sample_of
from uq.assess.row_inputs import notes_on_inputs, why_dependent
from uq.assess.targets import IndexTarget, where_it_happens
from uq.contract import Mask
from uq.errors import InputError, nearest
from uq.indices.index import IndexKind, Indices, Null, RefusedError
from uq.indices.method import DesignSample, SensitivityMethod
from uq.indices.methods import METHODS, designs_for, fed_by, for_dependent_inputs
from uq.result.result import Result
from uq.sampling.designs import DESIGNS, PLAIN
from uq.stats.estimate import Estimate
from uq.stats.tails import lacks_variance

Values = Mapping[IndexKind, Mapping[str, Estimate]]


def ranking(values: Values) -> list[str]:
    """Return the inputs, or pairs of them, the most important by the last kind of index first."""
    last = list(values.values())[-1]
    return sorted(last, key=lambda label: -size(last[label]))


def size(index: Estimate) -> float:
    """Return the value of an index; 0 where there is none."""
    return index.value if isfinite(index.value) else 0.0


def lines(values: Values, nulls: Mapping[IndexKind, Null]) -> list[tuple[str, list[Estimate]]]:
    """Return label and estimates, one of each kind, of each line of a table.

    Parameters
    ----------
    values : dict of IndexKind to dict
    nulls : dict of IndexKind to Null
        Limits of indices of inputs without effect; unknown for pairs.

    Returns
    -------
    list of tuple
    """
    ranked = ranking(values)
    entries = [(label, [by_label[label] for by_label in values.values()]) for label in ranked]
    limits = [nulls.get(kind, Null(nan)) for kind in values]
    if any(isfinite(null.limit) for null in limits):
        entries.append(("(an input without effect)", [Estimate(null.limit) for null in limits]))
    if any(isfinite(null.largest) for null in limits):
        label = f"(largest of {len(ranked)} such inputs)"
        entries.append((label, [Estimate(null.largest) for null in limits]))
    return entries


ONE_ROW = (
    "from one row of each sample, since rows of one sample are not independent; see 'uq levels'"
)
"""The note on indices where samples have several rows."""


@dataclass(frozen=True)
class TargetIndices:
    """The indices of a target, or the reason why it has none.

    Attributes
    ----------
    name : str
        Name of the target.
    rows_used, groups_dropped : int
        Rows, and groups of rows, with and without a value in each row.
    indices : Indices
        Empty where there are none.
    refused : str
        Why there are none, or "".
    rows_factor : float
        Factor on the sample size that would give some; NaN if unknown.
    """

    name: str
    rows_used: int
    groups_dropped: int
    indices: Indices = Indices({})
    refused: str = ""
    rows_factor: float = nan

    def kinds(self, of_pairs: bool = False) -> dict[IndexKind, Mapping[str, Estimate]]:
        """Return the indices of single inputs, or of pairs."""
        values = self.indices.values.items()
        return {kind: indices for kind, indices in values if kind.of_pairs == of_pairs}


@dataclass(frozen=True)
class Sensitivities:
    """Indices of targets by one method.

    Attributes
    ----------
    method : str
    rows_used, groups_dropped : int
        Of the rows with a value of every target that has indices.
    targets : dict of str to TargetIndices
        By name.
    rows : Result
        The rows that rank inputs, one of each sample.
    """

    method: str
    rows_used: int
    groups_dropped: int
    targets: Mapping[str, TargetIndices]
    rows: Result


def methods(result: Result, dependent: bool | None = None) -> tuple[str, ...]:
    """Return the methods that the study asks for, or else the default of its design.

    For dependent inputs, one that does not assume independence.
    """
    dependent = bool(why_dependent(result)) if dependent is None else dependent
    feeds = fed_by(result.design, dependent)
    asked = result.analysis.sensitivity
    return tuple(name for name in asked if name in feeds) or feeds[:1] or asked


def sensitivities(
    result: Result,
    method: str | None = None,
    output: str | Sequence[str] | None = None,
    regime: str | None = None,
) -> Sensitivities:
    """Estimate sensitivity indices.

    Parameters
    ----------
    result : Result
        A result.
    method : str, optional
        By default the first of `methods`.
    output : str or sequence of str, optional
        An output, one element of it, or one of the names that this function returns; by default
        the outputs that the study wants to see. All elements of an output together are a target of
        their own, ``output[:]``, where the method adds them up. Of a category, such as the regime,
        the targets are ``P(regime=label)``: whether a row is in each that occurs. For a lifetime
        they are its logarithm, or its rank where rows never end or are censored, and ``P(life<t)``;
        its rate 1/T is ``rate(life)``. A value with a heavy tail is by default replaced by its
        logarithm or rank; its own name gives the value itself. Of several names, unknown ones are
        skipped.
    regime : str, optional
        Use the rows in this regime only. Among them the inputs depend on each other.

    Returns
    -------
    Sensitivities
        A group (a row, in designs without groups) counts as dropped if any target with indices
        lacks it.

    Raises
    ------
    InputError
        When the design cannot feed the method, or there is no such output.
    """
    result.refuse_empty()
    result.refuse_if_weighted("sensitivity indices")
    if regime is not None:
        result = result.within_regime(regime)
        why = "within a regime the inputs depend on each other"
    else:
        why = why_dependent(result)
    ranked = result.ranked
    by = result.ranked_in_words
    nested, result = result.is_nested, ranked.first_rows
    method = method or [*methods(result, bool(why)), *fed_by(result.design)][0]
    _check_method(result.design_name, method, why, regime is not None)
    sample, notes = sample_of(result), tuple(filter(None, (by, *notes_on_inputs(result))))
    if nested:
        notes = (*notes, ONE_ROW)
    if sample.random and METHODS[method].noise:
        notes = (*notes, METHODS[method].noise)
    targets: dict[str, TargetIndices] = {}
    whole: list[Mask] = []
    used: list[Mask] = []
    for target in chosen(result, method, output):
        quantiles = _quantiles(target, result.analysis.quantiles)
        target_sample = replace(sample, values=target.values, quantiles=quantiles)
        targets[target.name] = target_indices = indices_of_target(
            result, METHODS[method], target, target_sample, notes
        )
        (whole if target_indices.refused else used).append(target_sample.whole)
    if nested:
        targets = {
            name: replace(indices, refused=f"{indices.refused}; {ONE_ROW}")
            if indices.refused
            else indices
            for name, indices in targets.items()
        }
    counts = _counts(*(used or whole), rows=len(sample.values))
    return Sensitivities(method, *counts, targets, result)


def indices_of_target(
    result: Result,
    method: SensitivityMethod,
    target: IndexTarget,
    sample: DesignSample,
    notes: tuple[str, ...] = (),
) -> TargetIndices:
    """Estimate the indices of a target, or give the reason why there are none.

    Parameters
    ----------
    result : Result
        The result that the target is of.
    method : SensitivityMethod
    target : IndexTarget
    sample : DesignSample
        With its values.
    notes : tuple of str, optional
        Sentences to add to those of the indices.

    Returns
    -------
    TargetIndices
    """
    caution = result.design.caution
    counts = _counts(sample.whole, rows=len(sample.values))
    try:
        if target.refused:
            raise RefusedError(target.refused)
        if target.element is not None and target.element.entered is not None:
            raise RefusedError(
                "rows that entered late do not represent the lives that ended before"
            )
        if method.of_variance and not target.event and lacks_variance(target.sizes):
            raise RefusedError(_no_variance(target))
        asked = _conditioned(target, sample) if method.conditional else sample
        method.refuse_few_groups(asked)  # in them even a continuous output may have two values
        # Rows in which the event happens have no other side.
        few = () if method.conditional else few_hits(result, target, bool(method.intervals))
        indices = method.indices(asked).with_possible_ends
    except RefusedError as refusal:
        factor = refusal.rows_factor
        return TargetIndices(target.name, *counts, refused=str(refusal), rows_factor=factor)
    combined = (*target.notes, *few, *filter(None, [caution]), *indices.notes, *notes)
    return TargetIndices(target.name, *counts, replace(indices, notes=combined))


def _conditioned(target: IndexTarget, sample: DesignSample) -> DesignSample:
    """Return the output of the rows in which an event happens."""
    if not target.event or target.element is None:
        raise RefusedError(
            "not an event of an output: ask for P(y > t) or P(T < t) by a threshold in [analysis];"
            " for what matters within a regime, use --regime"
        )
    return replace(sample, values=where_it_happens(target))


def _counts(*whole: Mask, rows: int) -> tuple[int, int]:
    """Return the number of rows in groups complete for all targets, and of incomplete groups."""
    every = np.logical_and.reduce(whole)
    return int(every.sum()) * (rows // every.size), int((~every).sum())


def _no_variance(target: IndexTarget) -> str:
    name = target.element.name if target.element else target.name
    logarithm = f"log({name})"
    others = f"{logarithm}, where all rows are positive, or " * (target.name != logarithm)
    return (
        f"the tail of {target.name} is too heavy for a variance to apportion; ask for"
        f" {others}rank({name})"
    )


def _quantiles(target: IndexTarget, asked: tuple[float, ...]) -> dict[str, float]:
    """Return the names of quantiles of a target; B10 of a life is where its rate is high."""
    if target.element is not None and target.element.is_lifetime:
        return {"B10": 0.9 if target.name.startswith("rate(") else 0.1, "B50": 0.5}
    return {f"Q{probability!r}": probability for probability in asked}


def _check_method(design: str, method: str, dependent: str, in_regime: bool) -> None:
    usable = fed_by(DESIGNS[design], bool(dependent))
    if in_regime and DESIGNS[design].layout is not PLAIN:
        usable = ()  # within a regime, inputs depend otherwise than the design assumes
    if method in usable:
        return
    if method in fed_by(DESIGNS[design]):
        only = METHODS[method].assumes_independence
        assumed = "independent inputs" if only else "inputs that depend as their design states"
        others = [name for name in for_dependent_inputs() if METHODS[name].layout is PLAIN]
        raise InputError(
            f"method '{method}' assumes {assumed}, but {dependent}"
            f" (methods that do not: {', '.join(others)})"
        )
    if method not in METHODS:
        names = sorted(METHODS)
        raise InputError(
            f"no such method '{method}'{nearest(method, names)} (allowed: {', '.join(names)})"
        )
    raise InputError(
        f"method '{method}' needs a design of {' or '.join(designs_for(method))}; this result is of"
        f" design '{design}', which feeds {', '.join(usable)}"
    )
