"""Shares of levels in the variance of one number, in a table of samples, units and repeats."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from uq.contract import Floats
from uq.result.nesting import samples_have
from uq.sampling.designs import several
from uq.sampling.levels import CHANCE, LEVELS, OWN, SHARED
from uq.stats.estimate import Estimate
from uq.stats.intervals import sized
from uq.stats.variance_components import nested_shares

SOLVER = "solver"
"""The share of the error that each row states; the other shares contain it."""

SOURCES = (*LEVELS, SOLVER)

NONE, ALL = Estimate(0.0, 0.0, 0.0), Estimate(1.0, 1.0, 1.0)

_ONE_REPEAT = "one repeat per unit cannot separate chance from differences between units; {repeats}"
_ONE_UNIT = (
    "one unit per sample cannot separate shared inputs from differences between units; {units}"
)
_ONE_ROW = "one row per sample cannot separate shared inputs from chance; {repeats}"
INCLUDES_CHANCE = "that differences between units include chance"


@dataclass(frozen=True)
class LevelShares:
    """Shares of the variance of one target.

    Attributes
    ----------
    shares : dict of str to Estimate
        By the names in `SOURCES`.
    variance : float
        NaN where there is none.
    left_out : int
        Samples with too few values.
    notes : tuple of str
        Sentences on the transform of the output.
    integrated : tuple of str
        Inputs whose part of the variance is known exactly.
    """

    shares: Mapping[str, Estimate]
    variance: float = np.nan
    left_out: int = 0
    notes: tuple[str, ...] = ()
    integrated: tuple[str, ...] = ()

    @property
    def sentences(self) -> list[str]:
        """Sentences on missing shares or intervals, and on transforms of the output."""
        reasons: dict[str, list[str]] = {}
        for name, share in self.shares.items():
            if share.reason:
                reasons.setdefault(share.reason, []).append(name)
        sentences = [f"{', '.join(names)}: {reason}" for reason, names in reasons.items()]
        if self.left_out:
            sentences.append(f"left out: {samples_have(self.left_out)} too few values")
        exactly = [f"{' and '.join(self.integrated)} integrated exactly"] * bool(self.integrated)
        return [*exactly, *self.notes, *sentences]


def shares_of(
    table: Floats,
    varying: Collection[str],
    errors: Floats | None = None,
    replicate: Any = None,
    known_variances: Mapping[str, Floats] = MappingProxyType({}),
    design: str = "monte-carlo",
    weights: Floats | None = None,
) -> LevelShares:
    """Estimate the shares of the variance of one number per row.

    Parameters
    ----------
    table : ndarray, shape (samples, units, repeats)
        NaN where there is none.
    varying : collection of str
        The levels with varying inputs; others have only the share in `known_variances`.
    errors : ndarray, shape (samples, units, repeats), optional
        Numerical error of each, as a standard deviation.
    replicate : ndarray of int, shape (samples,), optional
        Where only replicates are independent.
    known_variances : dict of str to ndarray of shape (samples, units, repeats), optional
        Level -> variance that each row adds to it, of independent terms at their means in `table`.
    design : str, optional
        Design of the samples, for advice.
    weights : ndarray, shape (samples,), optional
        Of samples.

    Returns
    -------
    LevelShares
    """
    names = tuple(level for level in LEVELS if level in varying)
    places = _places(names, table.shape)
    places += tuple((level,) for level in LEVELS if level in known_variances and level not in names)
    of_each = (
        None
        if array is None
        else _reduced(np.broadcast_to(array[:, None, None], table.shape), names)
        for array in (replicate, weights)
    )
    replicate, weights = (None if array is None else array[:, 0, 0] for array in of_each)
    errors = None if errors is None else _reduced(errors, names)
    empty = int(np.isnan(table).all(axis=(1, 2)).sum())
    table, size = sized(_reduced(table, names))  # neither squares nor their sums overflow
    errors = None if errors is None else errors / size
    added = np.zeros((3, *table.shape))
    for place, levels in enumerate(places):
        for level in known_variances.keys() & set(levels):
            added[place] += _reduced(known_variances[level], names) / size / size
    components = nested_shares(table, errors, replicate, added, weights)
    shares = {SHARED: components.outer, OWN: components.middle, CHANCE: components.inner}
    if components.variance > 0:
        shares = dict.fromkeys(LEVELS, NONE)
        for levels, share in zip(
            places, components[:3] if len(places) > 1 else [ALL], strict=False
        ):
            shares |= _of_levels(levels, share, design)
    left_out = components.left_out if SHARED in names else empty
    return LevelShares(
        shares | {SOLVER: components.error}, components.variance * size * size, left_out
    )


def _reduced(table: Any, names: Collection[str]) -> Any:
    """Return the table over independent samples, units and repeats, without constant levels.

    Without chance, the repeats of a unit are one row; without anything own, units are repeats; with
    nothing shared, samples do not matter. Of two levels the inner one takes the place of units.
    """
    if CHANCE not in names:
        first = np.isfinite(table).argmax(axis=2)
        table = np.take_along_axis(table, first[..., None], axis=2)
    samples, units, repeats = table.shape
    if names == (SHARED,):
        return table[:, :1]
    if len(names) < 2:
        return table.reshape(-1, 1, 1)
    if OWN not in names:
        return table.reshape(samples, -1, 1)
    if SHARED not in names:
        return table.reshape(samples * units, repeats, 1)
    return table if units > 1 else table.reshape(samples, repeats, 1)


def _places(names: tuple[str, ...], shape: tuple[int, ...]) -> tuple[tuple[str, ...], ...]:
    """Return the levels confounded in each dimension of a reduced table, outermost first.

    Levels in one dimension cannot be separated.
    """
    _, units, repeats = shape
    if names == tuple(LEVELS) and repeats == 1 < units:
        return (SHARED,), (OWN, CHANCE)
    if names == tuple(LEVELS) and units == 1 < repeats:
        return (SHARED, OWN), (CHANCE,)
    several = {
        (SHARED, OWN): units > 1,
        (SHARED, CHANCE): units * repeats > 1,
        (OWN, CHANCE): repeats > 1,
        tuple(LEVELS): units > 1,
    }
    return tuple((name,) for name in names) if several.get(names, True) else (names,)


def _of_levels(levels: tuple[str, ...], share: Estimate, design: str) -> dict[str, Estimate]:
    """Return the shares of levels from the share of their dimension."""
    if len(levels) == 1:
        return {levels[0]: share}
    advice = {key: several(key, design) for key in ("units", "repeats")}
    one_repeat, one_unit, one_row = (
        Estimate(reason=why.format(**advice)) for why in (_ONE_REPEAT, _ONE_UNIT, _ONE_ROW)
    )
    if levels == (OWN, CHANCE):
        return {OWN: replace(share, assumes=INCLUDES_CHANCE), CHANCE: one_repeat}
    if OWN not in levels:
        return dict.fromkeys(levels, one_row)
    return dict.fromkeys(levels, one_unit) | ({CHANCE: one_repeat} if CHANCE in levels else {})
