"""Fleets: when the first of some units ends, and how many have ended by a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp, expm1, isfinite, isnan, log, log1p
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from scipy import special

from uq.analysis.failed_rows import bounds, with_failed_at
from uq.designs.levels import SHARED
from uq.errors import InputError, choices
from uq.estimate import Estimate
from uq.intervals import Replicates
from uq.population import worlds
from uq.population.fleets import Units, units_of
from uq.population.functionals import first_step, root
from uq.rows.elements import (
    Element,
    analysis_of,
    has_independent_samples,
    independent_rows,
    lifetimes,
    shown_outputs,
    why_no_statistics,
)
from uq.rows.nesting import levels_that_vary, size_in_words
from uq.rows.variables import outputs_of

if TYPE_CHECKING:
    import pandas as pd

LOW, HIGH = 0.05, 0.95
"""Of worlds, at the ends of a band."""

ALIKE = "samples share nothing that varies"
_FARTHEST = 8.2  # probit of a probability
_SETTLED = 1e-4  # of the logarithm of a time, or of a probit


@dataclass(frozen=True)
class Banded:
    """A number of a fleet.

    Attributes
    ----------
    estimate : Estimate
        The mean over what is own and chance, and over what is shared.
    low, high : Estimate
        Its 5 and 95 % points over what is shared.
    failed : Estimate or None
        The ends of the interval of `estimate` with the failed rows at best and at worst.
    """

    estimate: Estimate
    low: Estimate
    high: Estimate
    failed: Estimate | None = None


@dataclass(frozen=True)
class Fleet:
    """What a result says of fleets of some size.

    Attributes
    ----------
    output : str
        The life.
    size, allow : int
    samples : int
        Independent worlds with enough units.
    design : str
        Samples, units and repeats.
    integrated : tuple of str
        Inputs that are integrated exactly.
    first : dict of float to Banded
        Probability -> quantile of the time at which the first ends.
    by : dict of float to tuple of Banded
        Time -> number that has ended, probability that at most `allow` have.
    notes : list of str
    """

    output: str
    size: int
    allow: int
    samples: int
    design: str
    integrated: tuple[str, ...]
    first: dict[float, Banded]
    by: dict[float, tuple[Banded, Banded]]
    notes: list[str]


def fleet(
    ds: xr.Dataset,
    size: int,
    by: float | Sequence[float] = (),
    allow: int = 0,
    output: str | None = None,
) -> "pd.DataFrame":
    """Estimate when the first unit of a fleet ends, and how many have ended by a time.

    Parameters
    ----------
    ds : xarray.Dataset
        A result. Units of a fleet have the same shared inputs, and are those of a sample.
    size : int
        Number of units: at most the ``units`` of the study, any number where all that differs
        between units only scales their lives.
    by : float or sequence of float, optional
        Times [s]; by default the thresholds of the study.
    allow : int, optional
        Number of units that may have ended.
    output : str, optional
        A life, or one element of it; needed where the study shows several.

    Returns
    -------
    pandas.DataFrame
        Lines: ``first``, for each quantile ``at`` of the study the time at which the first ends;
        ``failed``, the number that has ended before the time ``at``; ``at_most_allowed``, the
        probability that at most `allow` have. Each has its ``value``, a mean over all samples, with
        its 95 % interval ``low``, ``high``; ``band_low`` and ``band_high``, the 5 and 95 % points
        over what is shared of the same given that, each with its own interval; and ``reason``, why
        one of them is missing. Where rows failed, ``failed_low`` and ``failed_high``.

    Raises
    ------
    InputError
        When the samples have too few units, a row was censored before a time, or there is no such
        life.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> table = uq.fleet(ds, 1, by=1e6)
    >>> list(table.index.unique())
    ['first', 'failed', 'at_most_allowed']
    """
    times = [float(by)] if isinstance(by, int | float) else [float(one) for one in by]
    found = fleet_of(ds, size, times, allow, output)
    lines = [("first", p, one) for p, one in found.first.items()]
    for time, (failed, at_most) in found.by.items():
        lines += [("failed", time, failed), ("at_most_allowed", time, at_most)]
    import pandas as pd

    table = pd.DataFrame([_line(*line) for line in lines]).set_index("quantity")
    table.attrs = {"output": found.output, "size": size, "allow": allow, "samples": found.samples}
    return table


def _line(quantity: str, at: float, one: Banded) -> dict[str, object]:
    found: dict[str, object] = {"quantity": quantity, "at": at}
    found |= dict(zip(("value", "low", "high"), one.estimate.numbers, strict=True))
    for name, end in (("band_low", one.low), ("band_high", one.high)):
        found |= dict(zip((name, f"{name}_low", f"{name}_high"), end.numbers, strict=True))
    if one.failed is not None:
        found |= {"failed_low": one.failed.low, "failed_high": one.failed.high}
    found["reason"] = "; ".join(reasons(one))
    return found


def reasons(one: Banded) -> list[str]:
    """Return why numbers are missing, each reason once."""
    ends = (one.estimate, one.low, one.high)
    return list(dict.fromkeys(end.reason for end in ends if end.reason))


def fleet_of(
    ds: xr.Dataset,
    size: int,
    by: Sequence[float] = (),
    allow: int = 0,
    output: str | None = None,
) -> Fleet:
    """Return what `fleet` tabulates."""
    if why := why_no_statistics(ds):
        raise InputError(f"no fleet: the rows of a '{ds.attrs['design']}' design {why}")
    if size < 1 or allow < 0:
        raise InputError("uq fleet: the size must be at least 1, and what is allowed at least 0")
    if bad := [time for time in by if not time > 0]:
        raise InputError(f"uq fleet: {bad[0]!r} is not a time after the start")
    rows = independent_rows(ds)
    element = the_life(rows, output)
    units = units_of(rows, element)
    _refuse(units, size)
    analysis = analysis_of(ds)
    times = list(by) or list(analysis.thresholds.get(element.output, ()))
    for time in times:
        if count := int(element.unknown_sides(time).sum()):
            raise InputError(
                f"uq fleet: {count} of {len(element.values)} lives were censored before {time!r} s;"
                " ask for an earlier time, or compute a longer horizon"
            )
    part = None if has_independent_samples(rows) else units.place.replicate
    of = FleetNumbers(units, size, allow, part, SHARED in levels_that_vary(rows))
    first = {p: of.first(p) for p in analysis.quantiles}
    ended = {time: (of.failed(time), of.at_most_allowed(time)) for time in times}
    place = units.place
    enough = int(of.first_of.element.present.sum())
    notes = []
    if enough < place.samples:
        notes.append(f"{place.samples - enough} samples have too few units with a life")
    if lost := int(element.failed.sum()):
        notes.append(f"{lost} of {len(element.values)} rows failed")
    assumed = {one.assumes for both in of.ends for one in both if one.assumes}
    notes += [f"the 5 and 95 % points assume {one.removeprefix('that ')}" for one in assumed]
    design = size_in_words(place.samples, place.units, place.repeats)
    names = units.integrated
    return Fleet(element.name, size, allow, enough, design, names, first, ended, notes)


def the_life(rows: xr.Dataset, output: str | None) -> Element:
    """Return the element of a life that is meant: the only one, unless it is named."""
    outputs = outputs_of(rows)
    shown = [one for one in shown_outputs(rows, analysis_of(rows)) if outputs[one].is_lifetime]
    asked = [output] if output is not None else shown
    found = [element for one in asked for element in lifetimes(rows, one)]
    if not found:
        raise InputError("uq fleet: the study shows no life")
    if len(found) > 1:
        names = choices([one.name for one in found])
        raise InputError(f"uq fleet: several lives; name one with --output ({names})")
    return found[0]


def _refuse(units: Units, size: int) -> None:
    if size > units.place.units and not units.are_alike:
        names = ", ".join(units.varying)
        raise InputError(
            f"uq fleet: a fleet of {size} needs samples of as many units: set units = {size} in"
            f" [design], now {units.place.units}; more than that only where all that differs"
            f" between units is integrated exactly, and {names} is not"
        )


class FleetNumbers:
    """The numbers of fleets of one size, with bands, and with failed rows at best and worst.

    Parameters
    ----------
    units : Units
    size, allow : int
    part : ndarray of int, shape (samples,), or None
        The replicate of each sample; None where samples are independent.
    varies : bool
        Whether what samples share varies.
    """

    def __init__(self, units: Units, size: int, allow: int, part: Replicates, varies: bool):
        self._size, self._allow, self._part = size, allow, part
        self._units = units
        self._varies = varies
        self.ends: list[tuple[Estimate, Estimate]] = []
        self._cases = [units]
        if units.element.failed.any():
            lost = (with_failed_at(units.element, life) for life in (0.0, np.inf))
            self._cases += [replace(units, element=one) for one in lost]
        self._first = [one.fleet(size, 0, part) for one in self._cases]
        self._beyond = [one.fleet(size, allow, part) for one in self._cases]
        self._alone = [one.fleet(1, 0, part) for one in self._cases]
        self.first_of = self._first[0]
        self._spreads: dict[float, worlds.Exceeding] = {}

    def first(self, probability: float) -> Banded:
        """Return a quantile of the time at which the first ends."""
        found = [self._within_horizon(one.quantile(probability)) for one in self._first]
        reached = -expm1(log1p(-probability) / self._size)
        value = found[0].value

        def band(share: float) -> Estimate:
            return self._time_of(share, reached, value) if isfinite(value) else Estimate()

        return self._banded(found, band, is_life=True)

    def failed(self, time: float) -> Banded:
        """Return the number that has ended before a time."""
        found = [_times(one.below(time), self._size) for one in self._alone]

        def band(share: float) -> Estimate:
            return _times(self._unit_at(time, share), self._size)

        return self._banded(found, band)

    def at_most_allowed(self, time: float) -> Banded:
        """Return the probability that no more have ended before a time than allowed."""
        found = [_complement(one.below(time)) for one in self._beyond]

        def band(share: float) -> Estimate:
            p = self._unit_at(time, 1 - share)
            kept = [self._kept(one) for one in p.numbers]
            return replace(p, value=kept[0], low=kept[2], high=kept[1])

        return self._banded(found, band)

    def _kept(self, p: float) -> float:
        if self._allow >= self._size:
            return 1.0
        return float(special.bdtr(self._allow, self._size, p)) if p == p else p

    def _banded(
        self,
        found: Sequence[Estimate],
        band: Callable[[float], Estimate],
        is_life: bool = False,
    ) -> Banded:
        one, *lost = found
        if self._varies and not isnan(one.value):
            low, high = band(LOW), band(HIGH)
        else:
            low = high = Estimate() if self._varies else replace(one, reason=one.reason or ALIKE)
        self.ends.append((low, high))
        if not lost:
            return Banded(one, low, high)
        least, most = sorted(lost, key=lambda end: end.value)
        return Banded(one, low, high, bounds(one, least, most, is_life))

    def _within_horizon(self, found: Estimate) -> Estimate:
        """Return a time, or why it is not known where rows were censored before it."""
        element = self._units.element
        if not element.censored.any():
            return found
        horizon = element.values[element.censored].min()
        if found.value >= horizon:
            return Estimate(reason="rows were censored before that time")
        beyond = found.high >= horizon
        return replace(found, high=np.inf, beyond=("high",)) if beyond else found

    def _exceeding(self, time: float) -> worlds.Exceeding:
        """Return the spread over worlds of P(a unit has ended before a time)."""
        if time not in self._spreads:
            units = self._units
            ended = units.ended(time)
            if units.are_alike:
                known = np.isfinite(ended[:, 0, 0])
                part = None if self._part is None else self._part[known]
                self._spreads[time] = worlds.known(ended[known, 0], units.nodes, part)
            else:
                self._spreads[time] = worlds.Noisy(ended, units.weights, self._part)
        return self._spreads[time]

    def _unit_at(self, time: float, share: float) -> Estimate:
        """Return the point of P(a unit has ended) below which it is in a share of worlds."""
        exceeding = self._exceeding(time)
        middle = exceeding(0.5)
        if isnan(middle.value):
            return middle

        def at(name: str) -> float:
            def excess(z: float) -> float:
                return float(getattr(exceeding(float(special.ndtr(z))), name)) - (1 - share)

            if excess(-_FARTHEST) <= 0:
                return 0.0
            if excess(_FARTHEST) >= 0:
                return 1.0
            return float(special.ndtr(root(excess, (-_FARTHEST, _FARTHEST), _SETTLED)))

        return replace(middle, value=at("value"), low=at("low"), high=at("high"))

    def _time_of(self, share: float, probability: float, near: float) -> Estimate:
        """Return the time by which a share of worlds has a larger probability of a unit's end."""
        reasons = []

        def at(name: str) -> float:
            def excess(x: float) -> float:
                one = self._exceeding(exp(x))(probability)
                if isnan(found := float(getattr(one, name))):
                    raise _UnknownError(one.reason)
                return found - share

            try:
                start = log(near)
                side = 1.0 if excess(start) < 0 else -1.0
                there = first_step(start, 0.1 * side, lambda x: (excess(x) >= 0) == (side > 0))
                return np.nan if there is None else exp(root(excess, there, _SETTLED))
            except _UnknownError as unknown:
                reasons.append(str(unknown))
                return np.nan

        return Estimate(at("value"), at("high"), at("low"), next(iter(reasons), ""))


class _UnknownError(ArithmeticError):
    """The spread over worlds is not known there."""


def _times(one: Estimate, factor: float) -> Estimate:
    value, low, high = (factor * number for number in one.numbers)
    return replace(one, value=value, low=low, high=high)


def _complement(one: Estimate) -> Estimate:
    return replace(one, value=1 - one.value, low=1 - one.high, high=1 - one.low)
