"""Failure probabilities of units by world, and the time of the k-th failure of a fleet.

A world is a sample of a study: its units have the same shared inputs, and are independent given
these. What scales the lives of units alone is integrated inside each unit; what scales those of all
units of a world is integrated once per world, outside the product over its units.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, nan

import numpy as np

from uq.assess.integrated_inputs import (
    integrated,
    not_integrated,
    why_not_integrated,
    without_effect,
)
from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.sample import Sample
from uq.assess.scale_laws import Scale
from uq.assess.weighted_mixture import as_sample
from uq.contract import Floats, Mask
from uq.result.element import Element
from uq.result.nesting import Nesting
from uq.result.result import Result
from uq.sampling.levels import CHANCE, OWN, SHARED
from uq.stats.counting import fleet_failure_probabilities, more_than
from uq.stats.dependent_rows import Dependence

_NODES = 120
"""Integration steps between standard normal quantiles of -6 and 6, for inputs integrated per world.

For inputs that cause up to `_WIDE` times the spread of those integrated inside each unit; with a
larger ratio, proportionally more.
"""

_WIDE = 3.0
_WIDEST = 60.0
"""With a larger ratio, an input is not integrated per world: it would need too many steps."""

_TOO_WIDE = f"it scatters lives more than {_WIDEST:g} times as much as {{}}"


@dataclass(frozen=True)
class Units:
    """The lives of the units of each world.

    Attributes
    ----------
    element : Element
        Its rows.
    place : Nesting
        Nesting of these rows.
    shared : Scale or None
        Law of the inputs that scale all lives of a world alike.
    varying : tuple of str
        Inputs that differ between the units of a world and are not integrated. Without any,
        the probability of a unit's life is known in each world.
    why_not_more : str
        A sentence on the inputs that scale lives but are not integrated, or "".
    worlds_repeat : bool
        Whether some worlds have equal values of all shared inputs that are not integrated.
    design : str
        Design of the samples.
    of_worlds : ndarray, shape (samples,), or None
        Weights of the worlds, where inspections have weighted them.
    """

    element: Element
    place: Nesting
    shared: Scale | None
    varying: tuple[str, ...]
    why_not_more: str = ""
    worlds_repeat: bool = False
    design: str = "monte-carlo"
    of_worlds: Floats | None = None

    @property
    def integrated(self) -> tuple[str, ...]:
        """All integrated inputs."""
        return tuple(name for law in (self.element.law, self.shared) if law for name in law.inputs)

    @property
    def are_alike(self) -> bool:
        """Return whether all units of a world have the same known probability."""
        return not self.varying

    @property
    def end_together(self) -> bool:
        """Return whether units of a world end together, scaled by integrated inputs only."""
        return self.are_alike and self.shared is not None and self.element.law is None

    @property
    def nodes(self) -> Floats:
        """Standard normal quantiles of the inputs integrated once per world, shape (nodes,)."""
        if self.shared is None:
            return np.zeros(1)
        law = self.element.law
        finer = 1 if law is None else ceil(max(1.0, self.shared.spread / (_WIDE * law.spread)))
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
        probabilities, lives = [], self.element.values
        with np.errstate(over="ignore", under="ignore"):
            for shifts in self.shared.log_life_shifts(self.nodes):
                other = replace(self.element, values=lives * np.exp(shifts))
                probabilities.append(self._of_units(other.below(time)))
        return np.stack(probabilities, axis=-1)

    def _of_units(self, numbers: Floats) -> Floats:
        """Return the mean over repeats, shape (samples, units); of units that are alike, one."""
        table = self.place.table(np.where(self.element.present, numbers, np.nan))
        axes = (1, 2) if self.are_alike else 2
        present = np.isfinite(table)
        count = present.sum(axis=axes)
        sums = np.where(present, table, 0.0).sum(axis=axes)
        means = np.divide(sums, count, out=np.full(count.shape, np.nan), where=count > 0)
        return means[:, None] if self.are_alike else means

    def fleet(self, size: int, allow: int, dependence: Dependence) -> Sample:
        """Return the mixture of the times by which more than `allow` of `size` have ended.

        Its rows are worlds, each the law of this time. Worlds with too few units have none.
        """
        lives = np.where(self.element.present, self.element.values, np.inf)
        first = self.place.table(lives).min(axis=(1, 2), initial=np.inf, where=self._mask)
        enough = self._mask.any(axis=2).sum(axis=1) >= (1 if self.are_alike else size)
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
            self.of_worlds,
        )
        return as_sample(worlds, dependence)

    @property
    def _mask(self) -> Mask:
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

    @cached_property
    def _turns(self) -> Floats:
        units, element = self.units, self.units.element
        table = units.place.table(np.where(element.present, element.values, np.nan))
        times = fleet_failure_probabilities(table, self.size, self.allow, units.are_alike)
        place = units.place
        return times[place.sample, place.unit, place.repeat]

    @property
    def spread(self) -> float:
        return nan

    def below(self, lives: Floats, time: float) -> Floats:
        units = self.units
        if units.shared is not None and units.element.law is None:
            in_rows = self._turns * units.shared.below(units.element.values, time)
            probability = np.bincount(units.place.sample, in_rows, units.place.samples).astype(
                float
            )
        else:
            ended = units.ended(time)
            probability = more_than(ended, self.size, self.allow, units.are_alike) @ units.weights
        return np.where(np.isnan(lives), 0.0, np.clip(probability, 0.0, 1.0))


def units_of(rows: Result, element: Element, *, plain: bool = False) -> Units:
    """Return the units of the worlds of a result.

    Parameters
    ----------
    rows : Result
        Samples of a result.
    element : Element
        A life of these rows.
    plain : bool
        Whether lives are taken as computed.
    """
    place, levels = rows.nesting, rows.levels
    inner = shared = None
    inputs, why = inputs_of(rows), ""
    scales = element.declared.exponents and not plain
    if scales and element.censored.any():
        why = why_not_integrated(rows, element)
    elif scales:
        inner, kept = integrated(rows, element.declared, inputs, {OWN, CHANCE})
        shared, kept_outside = integrated(rows, element.declared, inputs, {SHARED})
        kept |= kept_outside
        if inner and shared and shared.spread >= _WIDEST * inner.spread:
            kept |= dict.fromkeys(shared.inputs, _TOO_WIDE.format(" and ".join(inner.inputs)))
            shared = None
        why = not_integrated(kept)
    idle = without_effect(inputs, element.declared)
    integrated_inputs = idle if inner is None else (*inner.inputs, *idle)
    varying = _unknown(levels, inputs.tied, integrated_inputs)
    if rows.is_random:
        varying = (*varying, "the model's own chance")
    integrated_inputs = idle if shared is None else (*shared.inputs, *idle)
    repeats = _repeats(
        inputs, [name for name in levels if levels[name] == SHARED], integrated_inputs, place
    )
    design = rows.design_name
    weights = rows.sample_weights("fleets")
    return Units(replace(element, law=inner), place, shared, varying, why, repeats, design, weights)


def _repeats(
    inputs: Inputs, shared: Collection[str], integrated_inputs: Collection[str], place: Nesting
) -> bool:
    """Return whether some worlds have equal values of all shared inputs that are not integrated."""
    names = {inputs.tied.get(name, name) for name in shared} - {*integrated_inputs}
    values = [inputs.values[name] for name in sorted(names)]
    return bool(values) and len(np.unique(values, axis=1).T) < place.samples


def _unknown(
    levels: Mapping[str, str], tied: Mapping[str, str], integrated_inputs: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the inputs of units that are not integrated."""
    return tuple(
        name
        for name, level in levels.items()
        if level != SHARED and tied.get(name, name) not in integrated_inputs
    )
