"""Sobol' indices of a crossed design: SALib's estimators, intervals from the replicates."""

from itertools import combinations
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from SALib.analyze.sobol import first_order, second_order, total_order

from uq.designs.registry import NOISE
from uq.methods.few_rows import effective_rows, one_more_row, widened
from uq.methods.groups import grouped_rows, whole_groups
from uq.indices.targets import Index, Indices, RefusedError
from uq.intervals import is_constant, scatter_interval
from uq.rows.elements import Floats

MIN_GROUPS = 8
"""Fewer groups than this give no index worth the name."""


class Crossed(NamedTuple):
    """Where the rows of a crossed design stand.

    Attributes
    ----------
    order : ndarray of int, shape (R, N, blocks)
        Row of each replicate, group and block.
    place : dict of str to int
        Label of a block (``A``, ``AB_x1``, ..., ``B``) -> its place in a group.
    """

    order: NDArray[np.intp]
    place: dict[str, int]

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters, in the design's order."""
        return tuple(label[3:] for label in self.place if label.startswith("AB_"))

    @property
    def ends(self) -> list[int]:
        """The places of A and B, the independent rows of a group."""
        return [self.place["A"], self.place["B"]]


def crossed(ds: xr.Dataset) -> Crossed:
    """Find the groups of a crossed design.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    Crossed

    Raises
    ------
    InputError
        When a group lacks rows.
    """
    order, labels = grouped_rows(ds)
    return Crossed(order, {label: i for i, label in enumerate(labels)})


def sobol_indices(design: Crossed, values: Floats) -> Indices:
    """Estimate first-order, total and, where the design has them, second-order indices.

    Parameters
    ----------
    design : Crossed
    values : ndarray, shape (n,)
        One number per row of the result, NaN where there is none: its whole group is left out.

    Returns
    -------
    Indices
        From all groups together; the interval from the same estimate by replicates. Where the
        variance rests on few rows, it is widened by what one more such row might do. Of a random
        model `noise` is the total index of the seed.

    Raises
    ------
    RefusedError
        Too few groups, or a constant output.

    Notes
    -----
    Of a random model A and AB_i share a seed, B and BA_i another, and `NOISE` has the inputs of A
    and the seed of B. S1 and S2 are means of products of rows of both seeds, which noise enters
    through the variance alone. ST is a mean square of differences at one seed: of the noise it
    holds what it does together with the input.

    References
    ----------
    A. Saltelli et al., "Variance based sensitivity analysis of model output. Design and estimator
    for the total sensitivity index", Comput. Phys. Commun. 181, 259-270 (2010).
    """
    y, whole = values[design.order], whole_groups(values, design.order)
    kept = int(whole.sum())
    if kept < MIN_GROUPS:
        raise RefusedError(f"only {kept} of {whole.size} groups are whole; {MIN_GROUPS} are needed")
    ends = y[whole][:, design.ends]
    if is_constant(ends):
        raise RefusedError("the same value in all rows: there is no variance to apportion")
    # The estimators lose digits, and scatter more, on values far from zero (Sobol' 2001).
    y = (y - ends.mean()) / ends.std()

    values_of = _estimates(design, y[whole])
    replicates = [group[rows] for group, rows in zip(y, whole, strict=True)]
    scatter, notes = [], []
    if len(replicates) == 1:
        notes.append("no intervals: with replicates = 1 nothing shows the scatter of the indices")
    elif any(len(r) < 2 or is_constant(r[:, design.ends]) for r in replicates):
        notes.append("no intervals: in some replicates too few rows differ")
    else:
        scatter = [_estimates(design, replicate) for replicate in replicates]
    independent = y[whole][:, design.ends].ravel()
    more = one_more_row(independent, kept, len(replicates))
    if scatter and more:
        rows = effective_rows(independent) / len(replicates)
        notes.append(
            f"the variance rests on some {rows:.2g} rows of each replicate: intervals are widened"
            " by what one more such row might do, and are conservative"
        )
    indices: dict[str, dict[str, Index]] = {}
    for (kind, label), value in values_of.items():
        interval = scatter_interval(value, np.array([found[kind, label] for found in scatter]))
        interval = widened(value, interval, more)
        indices.setdefault(kind, {})[label] = Index(value, *interval)
    noise = indices.pop(NOISE, {}).get("")
    inert = [name for name in design.parameters if indices["ST"][name].value == 0]
    if inert:
        notes.append(f"no effect in any row, hence no interval: {', '.join(inert)}")
    return Indices(indices, tuple(notes), noise=noise)


def _estimates(design: Crossed, y: Floats) -> dict[tuple[str, str], float]:
    """Return each index from groups y, shape (n, blocks)."""
    block = {label: y[:, place] for label, place in design.place.items()}
    a, b = block["A"], block["B"]
    found = {}
    for name in design.parameters:
        found["S1", name] = first_order(a, block[f"AB_{name}"], b)
        found["ST", name] = total_order(a, block[f"AB_{name}"], b)
    if NOISE in block:
        found[NOISE, ""] = total_order(a, block[NOISE], b)
    if any(label.startswith("BA_") for label in block):
        for one, other in combinations(design.parameters, 2):
            found["S2", f"{one},{other}"] = second_order(
                a, block[f"AB_{one}"], block[f"AB_{other}"], block[f"BA_{one}"], b
            )
    return {key: float(value) for key, value in found.items()}
