"""Shares of the variance: shared by the units of a sample, own to a unit, due to chance."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import xarray as xr

from uq.analysis.statistics.counts import stated_error
from uq.analysis.switching import switching
from uq.contract import Floats
from uq.designs.levels import CHANCE, LEVELS, OWN, SHARED
from uq.errors import InputError
from uq.estimate import Estimate
from uq.indices.chosen import targets_of
from uq.indices.sensitivities import few_hits
from uq.indices.targets import Target, lightened, split_name
from uq.methods.indices import RefusedError
from uq.nested_variance import nested_shares
from uq.population.by_level import Scales, scales_by_level
from uq.rows.elements import (
    analysis_of,
    has_independent_samples,
    independent_rows,
    output_names,
    shown_outputs,
    why_no_statistics,
)
from uq.rows.nesting import (
    Nesting,
    levels_of,
    levels_that_vary,
    nesting_of,
    samples_have,
    size_in_words,
)
from uq.rows.variables import error_name
from uq.rows.weights import refuse_weights
from uq.tails import lacks_variance

SOLVER = "solver"
"""The share of the error that each row states; the other shares contain it."""

SOURCES = (*LEVELS, SOLVER)

NONE, ALL = Estimate(0.0, 0.0, 0.0), Estimate(1.0, 1.0, 1.0)

_ONE_REPEAT = Estimate(
    reason="a single repeat cannot separate chance from what is own to a unit; set repeats = 2"
)
_ONE_UNIT = Estimate(
    reason="a single unit cannot show what is shared and what is own; set units = 2"
)
_ONE_ROW = Estimate(
    reason="a single row a sample cannot separate what is shared from chance; set repeats = 2"
)
INCLUDES_CHANCE = "that chance counts as own"
SHARES_OF = "these are shares of the variance of its {form}"
NO_ERROR = "the model states no numerical error of it"
NO_ERROR_OF = "the numerical error is that of the output, not of its {form}"


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
        What replaces the output.
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
        """Why shares or intervals are missing, and what replaces the output."""
        reasons: dict[str, list[str]] = {}
        for name, one in self.shares.items():
            if one.reason:
                reasons.setdefault(one.reason, []).append(name)
        said = [f"{', '.join(names)}: {reason}" for reason, names in reasons.items()]
        if self.left_out:
            said.append(f"left out: {samples_have(self.left_out)} too few values")
        exactly = [f"{' and '.join(self.integrated)} integrated exactly"] * bool(self.integrated)
        return [*exactly, *self.notes, *said]


@dataclass(frozen=True)
class ByLevel:
    """What a result says of its levels.

    Attributes
    ----------
    samples, units, repeats : int
    inputs : dict of str to str
        Level of each input.
    outputs : dict of str to LevelShares
        By name of the target: the output, ``log(life)``, ``P(life<t)``.
    another_regime : Estimate or None
        Probability that a repeat ends in another regime; None without regimes.
    switching : ndarray, shape (n,)
        The same of each row; NaN where it is not known.
    """

    samples: int
    units: int
    repeats: int
    inputs: Mapping[str, str]
    outputs: Mapping[str, LevelShares]
    another_regime: Estimate | None
    switching: Floats

    @property
    def size(self) -> str:
        """Samples, units and repeats in words."""
        return size_in_words(self.samples, self.units, self.repeats)

    def inputs_on(self, level: str) -> list[str]:
        """Return the inputs on a level."""
        return [name for name, own in self.inputs.items() if own == level]


def by_level(ds: xr.Dataset, output: str | None = None, *, plain: bool = False) -> ByLevel:
    """Estimate the shares of the variance by level.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    output : str, optional
        Only this output, or this element of one; by default those that the study shows. Of a
        category, such as the regime, the targets are ``P(regime=label)``.
    plain : bool
        Whether lives are taken as computed, and nothing that only scales them is integrated.

    Returns
    -------
    ByLevel

    Raises
    ------
    InputError
        When the rows do not follow the laws of the inputs, or there is no such output.
    """
    refuse_weights(ds, "shares of levels", but_equal=True)
    if why := why_no_statistics(ds):
        raise InputError(f"no shares: the rows of a '{ds.attrs['design']}' design {why}")
    rows = independent_rows(ds)
    place, varying = nesting_of(rows), levels_that_vary(rows)
    replicate = None if has_independent_samples(rows) else place.replicate
    known = output_names(rows)
    shown = [one for one in shown_outputs(rows, analysis_of(rows)) if not _is_error(one, known)]
    found = {}
    for name in shown if output is None else [output]:
        for target in targets_of(rows, name):
            light = target if target.event else lightened(target, SHARES_OF)
            scales = Scales({}) if plain else _scales(rows, light)
            found[light.name] = _shares(rows, light, place, scales, replicate)
    switches = "regime" in known and output is None
    mean, each = switching(rows, place, varying) if switches else (None, np.empty(0))
    return ByLevel(place.samples, place.units, place.repeats, levels_of(rows), found, mean, each)


def _is_error(name: str, known: Collection[str]) -> bool:
    return name in {error_name(one) for one in known}


def _scales(rows: xr.Dataset, target: Target) -> Scales:
    """Return what is integrated of a target: of the logarithms of lives, what only scales them."""
    element = target.element
    if element is None or target.event or target.refused or not element.declared.scales:
        return Scales({})
    found = scales_by_level(rows, element)
    if split_name(target.name)[0] == "log" or not found.inputs:
        return found
    names = " and ".join(found.inputs)
    return Scales({}, f"{names} not integrated: the lives are replaced by their ranks")


def _shares(
    rows: xr.Dataset, target: Target, place: Nesting, scales: Scales, replicate: Any
) -> LevelShares:
    reason = target.refused
    values = scales.mean_logarithms(target.values)
    if not reason and not target.event and lacks_variance(values):
        reason = "the tail is too heavy for a variance to apportion"
    reason, few = _few(rows, target) if target.event and not reason else (reason, ())
    if reason:
        return LevelShares({name: Estimate(reason=reason) for name in SOURCES}, notes=target.notes)
    errors, why_none = _errors(rows, target)
    table = place.table(np.where(np.isfinite(values), values, np.nan))
    own = None if errors is None else place.table(errors)
    varying = levels_that_vary(rows, scales.inputs)
    known = {level: place.table(variance) for level, variance in scales.variances.items()}
    found = shares_of(table, varying, own, replicate, known)
    if errors is None:
        found = replace(found, shares={**found.shares, SOLVER: Estimate(reason=why_none)})
    notes = (*target.notes, *few, *filter(None, [scales.why_not_more]))
    return replace(found, notes=notes, integrated=scales.inputs)


def _few(rows: xr.Dataset, event: Target) -> tuple[str, tuple[str, ...]]:
    """Return why an event has too few hits for shares, or the warning that it has few."""
    try:
        return "", few_hits(rows, event)
    except RefusedError as refusal:
        return str(refusal), ()


def _errors(rows: xr.Dataset, target: Target) -> tuple[Floats | None, str]:
    """Return the numerical error of each row, of a logarithm the relative one; or why none."""
    stated = None if target.element is None else stated_error(rows, target.element)
    if stated is None or target.element is None:
        return None, NO_ERROR
    form = split_name(target.name)[0]
    if form == "log":
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.abs(stated.values / target.element.values), ""
    if form:
        return None, NO_ERROR_OF.format(form={"P": "event"}.get(form, form))
    return np.abs(stated.values), ""


def shares_of(
    table: Floats,
    varying: Collection[str],
    errors: Floats | None = None,
    replicate: Any = None,
    known: Mapping[str, Floats] = MappingProxyType({}),
) -> LevelShares:
    """Estimate the shares of the variance of one number per row.

    Parameters
    ----------
    table : ndarray, shape (samples, units, repeats)
        NaN where there is none.
    varying : collection of str
        The levels on which something varies; the share of the others is what is known of them.
    errors : ndarray, shape (samples, units, repeats), optional
        Numerical error of each, as a standard deviation.
    replicate : ndarray of int, shape (samples,), optional
        Where only replicates are independent.
    known : dict of str to ndarray of shape (samples, units, repeats), optional
        Level -> variance that each row adds to it, of independent terms at their means in `table`.

    Returns
    -------
    LevelShares
    """
    names = tuple(level for level in LEVELS if level in varying)
    places = _places(names, table.shape)
    places += tuple((level,) for level in LEVELS if level in known and level not in names)
    if replicate is not None:
        replicate = _reduced(np.broadcast_to(replicate[:, None, None], table.shape), names)
        replicate = replicate[:, 0, 0]
    errors = None if errors is None else _reduced(errors, names)
    table = _reduced(table, names)
    added = np.zeros((3, *table.shape))
    for place, levels in enumerate(places):
        for level in known.keys() & set(levels):
            added[place] += _reduced(known[level], names)
    found = nested_shares(table, errors, replicate, added)
    shares = {SHARED: found.outer, OWN: found.middle, CHANCE: found.inner}
    if found.variance > 0:
        shares = dict.fromkeys(LEVELS, NONE)
        for levels, share in zip(places, found[:3] if len(places) > 1 else [ALL], strict=False):
            shares |= _told(levels, share)
    return LevelShares(shares | {SOLVER: found.error}, found.variance, found.left_out)


def _reduced(table: Any, names: Collection[str]) -> Any:
    """Return what is independent, its units and their repeats, without levels on which none vary.

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
    """Return which levels are told apart: those in each place of a reduced table, outermost first.

    Levels in one place cannot be separated.
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


def _told(levels: tuple[str, ...], share: Estimate) -> dict[str, Estimate]:
    """Return the shares of levels from the share of their place."""
    if len(levels) == 1:
        return {levels[0]: share}
    if levels == (OWN, CHANCE):
        return {OWN: replace(share, assumes=INCLUDES_CHANCE), CHANCE: _ONE_REPEAT}
    if OWN not in levels:
        return dict.fromkeys(levels, _ONE_ROW)
    return dict.fromkeys(levels, _ONE_UNIT) | ({CHANCE: _ONE_REPEAT} if CHANCE in levels else {})
