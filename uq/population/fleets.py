"""Fleets: units of one world, and how many of them have ended.

A world is a sample of a study: its units have the same shared inputs, and are independent given
these. What scales the lives of units alone is integrated inside each unit; what scales those of all
units of a world is integrated once per world, outside the product over its units.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, nan

import numpy as np
import xarray as xr
from scipy import special

from uq.contract import Floats, Mask
from uq.designs.levels import CHANCE, OWN, SHARED
from uq.intervals import Replicates
from uq.population.functionals import Population
from uq.population.scale_laws import IndependentScale
from uq.population.scaling import inputs_of, integrated
from uq.rows.element import Element, RowLaw
from uq.rows.nesting import Nesting, levels_of, nesting_of

_NODES = 120
"""Steps between standard normal quantiles of -6 and 6, of what is integrated once per world and
causes up to `_WIDE` times the spread of what is integrated inside each unit; else as many times."""

_WIDE = 3.0
_WIDEST = 60.0
_MOST_NUMBERS = 10_000_000


@dataclass(frozen=True)
class Units:
    """The lives of the units of each world.

    Attributes
    ----------
    element : Element
        Its rows.
    place : Nesting
        Of these rows.
    shared : IndependentScale or None
        What scales all lives of a world alike, integrated at `nodes`.
    varying : tuple of str
        What differs between the units of a world and is not integrated. With nothing of this kind,
        the probability of a unit's life is known in each world.
    """

    element: Element
    place: Nesting
    shared: IndependentScale | None
    varying: tuple[str, ...]

    @property
    def integrated(self) -> tuple[str, ...]:
        """All that is integrated."""
        return tuple(name for law in (self.element.law, self.shared) if law for name in law.inputs)

    @property
    def are_alike(self) -> bool:
        """Whether all units of a world have the same known probability."""
        return not self.varying

    @property
    def nodes(self) -> Floats:
        """Standard normal quantiles of what is integrated once per world, shape (nodes,)."""
        if self.shared is None or self.element.law is None:
            return np.zeros(1)
        finer = ceil(max(1.0, self.shared.spread / (_WIDE * self.element.law.spread)))
        return np.linspace(-6.0, 6.0, finer * _NODES + 1)

    @property
    def weights(self) -> Floats:
        """The weight of each node, shape (nodes,)."""
        density = np.exp(-(self.nodes**2) / 2)
        return np.asarray(density / density.sum())

    def ended(self, time: float) -> Floats:
        """Return P(a unit has ended before a time), shape (samples, units, nodes).

        The mean over its repeats; NaN without a life.
        """
        if self.shared is None:
            return self._of_units(self.element.below(time))[..., None]
        assert self.element.law is not None
        lives = self.element.values
        with np.errstate(over="ignore", under="ignore"):
            longer = np.exp(self.shared.term.at(self.nodes)[:, None] - self.shared.drawn)
            each = [self._of_units(self.element.law.below(lives * by, time)) for by in longer]
        return np.stack(each, axis=-1)

    def _of_units(self, numbers: Floats) -> Floats:
        """Return the mean over repeats, shape (samples, units); of units that are alike, one."""
        table = self.place.table(np.where(self.element.present, numbers, np.nan))
        axes = (1, 2) if self.are_alike else 2
        known = np.isfinite(table)
        count = known.sum(axis=axes)
        sums = np.where(known, table, 0.0).sum(axis=axes)
        found = np.divide(sums, count, out=np.full(count.shape, np.nan), where=count > 0)
        return found[:, None] if self.are_alike else found

    def fleet(self, size: int, allow: int, part: Replicates) -> Population:
        """Return the population of the times by which more than `allow` of `size` have ended.

        Its rows are worlds, each the law of this time. Worlds with too few units have none.
        """
        lives = np.where(self.element.present, self.element.values, np.inf)
        first = self.place.table(lives).min(axis=(1, 2), initial=np.inf, where=self._there)
        enough = self._there.any(axis=2).sum(axis=1) >= (1 if self.are_alike else size)
        first = np.where(enough, first, np.nan)
        element = self.element
        worlds = Element(
            element.name,
            element.output,
            element.declared,
            element.place,
            first,
            np.zeros(len(first), dtype=bool),
            np.isnan(first),
            _MoreThan(self, size, allow),
        )
        return Population(worlds, part)

    @property
    def _there(self) -> Mask:
        return np.isfinite(self.place.table(np.where(self.element.present, 0.0, np.nan)))


@dataclass(frozen=True)
class _MoreThan:
    """The law of the time by which more than `allow` of `size` units of a world have ended."""

    units: Units
    size: int
    allow: int

    @property
    def inputs(self) -> tuple[str, ...]:
        return self.units.integrated

    @property
    def spread(self) -> float:
        return nan

    def below(self, lives: Floats, time: float) -> Floats:
        ended = self.units.ended(time)
        if self.allow >= self.size:
            more = np.zeros(ended[:, 0].shape)
        elif self.units.are_alike:
            more = special.bdtrc(self.allow, self.size, ended[:, 0])
        else:
            more = 1 - at_most(ended, self.size, self.allow)
        return np.where(np.isnan(lives), 0.0, np.clip(more @ self.units.weights, 0.0, 1.0))


def units_of(rows: xr.Dataset, element: Element) -> Units:
    """Return the units of the worlds of a result.

    Parameters
    ----------
    rows : xarray.Dataset
        Samples of a result.
    element : Element
        A life of these rows.
    """
    place, levels = nesting_of(rows), levels_of(rows)
    own: RowLaw | None = None
    shared = None
    inputs = inputs_of(rows)
    if element.declared.scales and not element.censored.any():
        own = integrated(rows, element.declared, inputs, {OWN, CHANCE}).law
        common = integrated(rows, element.declared, inputs, {SHARED}).law if own else None
        if own and isinstance(common, IndependentScale) and common.spread < _WIDEST * own.spread:
            shared = common
    known = () if own is None else own.inputs
    varying = _unknown(levels, inputs.tied, known)
    if rows.attrs.get("random"):
        varying = (*varying, "the model's own chance")
    return Units(replace(element, law=own), place, shared, varying)


def _unknown(
    levels: Mapping[str, str], tied: Mapping[str, str], known: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the inputs of units that are not integrated."""
    return tuple(
        name
        for name, level in levels.items()
        if level != SHARED and tied.get(name, name) not in known
    )


def at_most(ended: Floats, size: int, allow: int) -> Floats:
    """Return the probability that at most some of a fleet of a world's units have ended.

    Parameters
    ----------
    ended : ndarray, shape (samples, units, nodes)
        Independent probabilities of the units; NaN for units that do not take part.
    size, allow : int

    Returns
    -------
    ndarray, shape (samples, nodes)
        The mean over all fleets of `size` different units: unbiased for units drawn anew, where
        any power of the units' mean probability is not. NaN where there are fewer units.
    """
    samples, units, nodes = ended.shape
    rows = np.sort(np.moveaxis(ended, 1, 2).reshape(samples * nodes, units), axis=1)
    counts = np.isfinite(rows).sum(axis=1)
    found = np.full(len(rows), np.nan)
    for count in np.unique(counts[counts >= size]):
        of = rows[counts == count, :count]
        certain = bool(np.isin(of, (0.0, 1.0)).all())
        found[counts == count] = (_of_certain if certain else _of_any)(of, size, min(allow, size))
    return found.reshape(samples, nodes)


def _of_certain(ended: Floats, size: int, allow: int) -> Floats:
    """Return it of units that have ended or have not: the hypergeometric law."""
    units = ended.shape[1]
    count = np.arange(units + 1.0)
    some = np.arange(allow + 1.0)[:, None]
    each = _log_choose(count, some) + _log_choose(units - count, size - some)
    table = np.exp(each - _log_choose(units, size)).sum(axis=0)
    return np.asarray(np.minimum(table, 1.0)[ended.sum(axis=1).astype(int)])


def _log_choose(n: Floats | float, k: Floats | float) -> Floats:
    n, k = np.asarray(n, float), np.asarray(k, float)
    found: Floats = special.gammaln(n + 1) - special.gammaln(k + 1) - special.gammaln(n - k + 1)
    return found


def _of_any(ended: Floats, size: int, allow: int) -> Floats:
    """Return it of units with any probabilities.

    The mean over fleets of r of the first m units, of which unit m is in a share r / m: a recursion
    over m of weighted means, in which nothing cancels.
    """
    rows, units = ended.shape
    most = max(1, _MOST_NUMBERS // ((size + 1) * (allow + 1)))
    if rows > most:
        blocks = np.array_split(ended, -(-rows // most))
        return np.concatenate([_of_any(block, size, allow) for block in blocks])
    chance = np.zeros((size + 1, allow + 1, rows))
    chance[0, 0] = 1.0
    for m in range(1, units + 1):
        p = ended[:, m - 1]
        low, high = max(1, size - (units - m)), min(m, size)
        share = (np.arange(low, high + 1) / m)[:, None, None]
        before = chance[low - 1 : high]
        added = before * (1 - p)
        added[:, 1:] += before[:, :-1] * p
        chance[low : high + 1] = (1 - share) * chance[low : high + 1] + share * added
    return np.asarray(chance[size].sum(axis=0))
