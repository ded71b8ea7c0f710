"""Rows of a result in the layout that a sensitivity method requires.

The rows themselves do not show which input changes from row to row of a group: a factor recovered
from a product is rounded, and seems to change where only what it multiplies does; a discrete input
may keep its value in its own step. Therefore the points of the design are drawn once more.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.assess.row_inputs import correlated_inputs, independent_inputs, scores_of_inputs
from uq.contract import Floats
from uq.errors import InputError
from uq.indices.method import DesignSample
from uq.result.elements import flags
from uq.result.result import Result
from uq.sampling.dependence import conditional_paths, normal_correlations
from uq.sampling.designs import PLAIN
from uq.stats.dependent_rows import Dependence
from uq.study.file import Tied
from uq.study.input_checks import laws_of


def with_scores(sample: DesignSample, result: Result, unit: Floats) -> DesignSample:
    """Return a sample of paths with the normal scores of its inputs.

    Parameters
    ----------
    sample : DesignSample
        Without scores.
    result : Result
        The result that it is of.
    unit : ndarray, shape (R, N, k, d)
        The points of its design, independent.

    Returns
    -------
    DesignSample
    """
    from scipy.special import ndtri

    names, laws = list(sample.inputs), laws_of(result.dataset.attrs["study"])
    unit, matrix = unit.copy(), np.eye(len(names))
    stated = result.study.dependence
    discrete = {name for name, law in laws.items() if law.discrete}
    if stated is not None:
        places = [names.index(name) for name in stated.parameters]
        if stated.pair is not None or discrete & set(stated.parameters):
            # Their scores are not jointly normal, or those behind their values are not known.
            discrete |= set(stated.parameters)
        else:
            paths = unit[..., places].reshape(-1, unit.shape[2], len(places))
            none = [None] * len(places)
            paths = conditional_paths(paths, stated.joint, none)
            unit[..., places] = paths.reshape(*unit.shape[:-1], len(places))
            matrix[np.ix_(places, places)] = normal_correlations(stated.rank_correlation)
    scores = ndtri(unit)
    scores[..., [names.index(name) for name in discrete]] = np.nan
    return replace(sample, scores=scores, matrix=matrix)


def sample_of(result: Result) -> DesignSample:
    """Find the groups of a design, in which no row has a value yet.

    Parameters
    ----------
    result : Result
        A result, its rows in any order.

    Returns
    -------
    DesignSample

    Raises
    ------
    InputError
        When a group lacks rows, or rows are not those of the design.
    """
    layout = result.design.layout
    nothing = np.full(len(result), np.nan)
    sample = DesignSample.plain(nothing, independent_inputs(result), random=result.is_random)
    if layout is PLAIN:
        sample = replace(sample, normal=scores_of_inputs(result))
        if result.has_independent_samples:
            return sample
        return replace(sample, dependence=Dependence(result.dataset["replicate"].values))
    groups, blocks = _grouped_rows(result)
    sample = replace(
        sample,
        groups=groups.transpose(0, 2, 1) if layout.by_block else groups,
        blocks=blocks,
        correlated=correlated_inputs(result),
    )
    if not layout.one_at_a_time:
        return sample
    unit = _unit(result, groups, len(sample.inputs))
    sample = replace(sample, direction=_directions(result, groups, unit))
    return with_scores(sample, result, unit) if layout.given_the_rest else sample


def _grouped_rows(result: Result) -> tuple[NDArray[np.intp], tuple[str, ...]]:
    """Return the row of each replicate, group and block, shape (R, N, k), and the blocks' names."""
    labels = flags(result.dataset["block"])
    keys = np.stack([result.dataset[name].values for name in ("replicate", "group", "block")])
    order = np.lexsort(keys[::-1])
    if order.size % len(labels) == 0:
        groups = keys[:, order].reshape(3, -1, len(labels))
        whole = (np.ptp(groups[:2], axis=2) == 0).all()
        if whole and (groups[2] == [code for code, _ in labels]).all():
            order = order.reshape(result.dataset.attrs["replicates"], -1, len(labels))
            return order, tuple(label for _, label in labels)
    raise InputError("rows of the design are missing: its indices need whole groups")


def _directions(result: Result, order: NDArray[np.intp], unit: Floats) -> Floats:
    """Return the steps of a design in which one input changes at a time: `DesignSample.direction`.

    Raises
    ------
    InputError
        When the rows are not those of the design.
    """
    entries = result.study.uncertain
    scales = {name: e.times for name, e in entries.items() if not isinstance(e, Tied)}
    parameters = list(scales)
    direction = np.sign(np.diff(unit, axis=2))
    changing = direction != 0
    sound = bool((changing.sum(axis=-1) == 1).all())
    moving = changing.copy()
    dependent = [parameters.index(name) for name in correlated_inputs(result)]
    # Correlated inputs that have changed are drawn again when another one changes.
    among = changing[..., dependent]
    moving[..., dependent] = among.any(axis=-1, keepdims=True) & (among.cumsum(axis=2) > 0)
    for column, (name, times) in enumerate(scales.items()):
        values = result.dataset[name].values[order]
        still = ~(moving[..., column] | moving[..., parameters.index(times or name)])
        sound &= bool((values[..., 1:] == values[..., :-1])[still].all())
    if not sound:
        raise InputError(
            f"the rows differ from those of a '{result.design_name}' design as it is drawn now, so"
            " the effect of an input cannot be determined: run the study again"
        )
    return np.asarray(direction)


def _unit(result: Result, order: NDArray[np.intp], d: int) -> Floats:
    """Draw the points of the unit cube that the rows come from, shape (*order.shape, d)."""
    first = order[..., 0]
    group, replicate = (
        result.dataset["group"].values[first],
        result.dataset["replicate"].values[first],
    )
    start, stop = int(group.min()), int(group.max()) + 1
    sizes: dict[str, Any] = {
        name: int(result.dataset.attrs[name]) for name in ("seed", "replicates", "samples")
    }
    second_order = bool(result.dataset.attrs["second_order"])
    points = result.design.unit_rows(
        d=d, second_order=second_order, start=start, stop=stop, **sizes
    )
    return points[group - start, replicate]
