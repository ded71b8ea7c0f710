"""Fleets of a result: time of the first end, numbers ended by a time; as table and as facts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from uq.assess.fact import Fact
from uq.assess.fleet_numbers import Banded, FleetNumbers
from uq.assess.fleet_units import Units, units_of
from uq.assess.integrated_inputs import without_effect
from uq.assess.row_inputs import inputs_of
from uq.assess.summary import why_no_intervals
from uq.assess.summary_facts import quality_facts
from uq.assess.weighted_mixture import BY_WEIGHTS
from uq.errors import InputError, choices
from uq.result.element import Element
from uq.result.nesting import Nesting, samples_have, size_in_words
from uq.result.result import AnyResult, Result
from uq.sampling.designs import several
from uq.sampling.levels import SHARED
from uq.stats import estimate_json
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.importance_weights import ImportanceWeights, of_samples, quality, worth_in_words
from uq.text.units import beside

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Fleet:
    """Times and numbers of failures in fleets of one size.

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
    is_success : bool
        Whether the end of the life is wished for.
    units : str
        Of the life.
    weights : ImportanceWeights or None
        Of samples, where inspections have weighted them.
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
    is_success: bool = False
    units: str = "s"
    weights: ImportanceWeights | None = None

    @property
    def ended(self) -> str:
        """Participle for the end of a life: ``succeeded`` or ``ended``."""
        return "succeeded" if self.is_success else "ended"

    @property
    def sentences(self) -> list[str]:
        """Sentences on integrated inputs, missing numbers and assumptions."""
        exactly = [f"{' and '.join(self.integrated)} integrated exactly"] * bool(self.integrated)
        worth = [worth_in_words(self.weights)] if self.weights else []
        return [*exactly, *worth, *self.notes]


_SAMPLING = "the 95 % intervals cover sampling only, not the laws of the inputs, taken as exact"
_BETWEEN = "what all units of a fleet share spreads it from the 5 to the 95 % points"
_ALIKE = (
    "no input is shared by all units; a value common to all but unknown needs level = 'shared', and"
    " widens the spread of fleets"
)


def fleet(
    result: AnyResult,
    size: int,
    by: float | Sequence[float] = (),
    allow: int = 0,
    output: str | None = None,
    *,
    plain: bool = False,
) -> "pd.DataFrame":
    """Estimate the time of the first failure in a fleet, and the number of failures by a time.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result, or a posterior of `uq.update`, whose fleets are of units never inspected. Units
        of a fleet have the same shared inputs, and are those of a sample.
    size : int
        Number of units: at most the ``units`` of the study, any number where all that differs
        between units only scales their lives.
    by : float or sequence of float, optional
        Times [s]; by default the thresholds of the study.
    allow : int, optional
        Number of units that may have ended.
    output : str, optional
        A life, or one element of it; needed where the study shows several.
    plain : bool, optional
        Whether to take lives as computed; by default what only scales them is integrated.

    Returns
    -------
    pandas.DataFrame
        Lines: ``first``, for each quantile ``at`` of the study the time at which the first ends;
        ``failed``, the number that has ended before the time ``at``; ``at_most_allowed``, the
        probability that at most `allow` have. Each has its ``value``, a mean over all samples, with
        its 95 % interval ``low``, ``high``; ``band_low`` and ``band_high``, the 5 and 95 % points
        over what is shared of the same given that, each with its own interval; ``reason``, why
        one of them is missing; and ``assumes``, what the points assume. Where rows failed,
        ``failed_low`` and ``failed_high``.

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
    result = Result.of(result)
    times = [float(by)] if isinstance(by, int | float) else [float(time) for time in by]
    estimates = fleet_of(result, size, times, allow, output, plain=plain)
    lines = [("first", p, banded) for p, banded in estimates.first.items()]
    for time, (failed, at_most) in estimates.by.items():
        lines += [("failed", time, failed), ("at_most_allowed", time, at_most)]
    import pandas as pd

    table = pd.DataFrame([_line(*line) for line in lines]).set_index("quantity")
    table.attrs = {
        "output": estimates.output,
        "size": size,
        "allow": allow,
        "samples": estimates.samples,
    }
    table.attrs.update(quality(estimates.weights))
    return table


def _line(quantity: str, at: float, banded: Banded) -> dict[str, object]:
    line: dict[str, object] = {"quantity": quantity, "at": at}
    line |= dict(zip(("value", "low", "high"), banded.estimate.numbers, strict=True))
    for name, end in (("band_low", banded.low), ("band_high", banded.high)):
        line |= dict(zip((name, f"{name}_low", f"{name}_high"), end.numbers, strict=True))
    if banded.failed is not None:
        line |= {"failed_low": banded.failed.low, "failed_high": banded.failed.high}
    line["reason"] = "; ".join(reasons(banded))
    line["assumes"] = banded.low.assumes or banded.high.assumes
    return line


def reasons(banded: Banded) -> list[str]:
    """Return why numbers are missing, each reason once."""
    ends = (banded.estimate, banded.low, banded.high)
    return list(dict.fromkeys(end.reason for end in ends if end.reason))


def fleet_of(
    result: Result,
    size: int,
    by: Sequence[float] = (),
    allow: int = 0,
    output: str | None = None,
    *,
    plain: bool = False,
) -> Fleet:
    """Return the numbers that `fleet` tabulates."""
    if why := result.why_no_statistics:
        raise InputError(f"no fleet: the rows of a '{result.design_name}' design {why}")
    if size < 1 or allow < 0:
        raise InputError("uq fleet: the size must be at least 1, and what is allowed at least 0")
    if bad := [time for time in by if not 0 < time < inf]:
        raise InputError(f"uq fleet: {bad[0]!r} is not a time after the start")
    rows = result.independent
    element = lifetime_element(rows, output)
    units = units_of(rows, element, plain=plain)
    _refuse(units, size)
    analysis = result.analysis
    times = list(by) or list(analysis.thresholds.get(element.output, ()))
    for time in times:
        if count := int(element.unknown_sides(time).sum()):
            raise InputError(
                f"uq fleet: {count} of {len(element.values)} lives were censored before"
                f" {beside(repr(time), element.declared.unit)}; ask for an earlier time, or compute"
                " a longer horizon"
            )
    dependence = _dependence_of_samples(rows, units.place)
    idle = without_effect(inputs_of(rows), element.declared)
    varies = SHARED in rows.levels_that_vary(idle)
    fleet_numbers = FleetNumbers(units, size, allow, dependence, varies)
    first = {p: fleet_numbers.first(p) for p in analysis.quantiles}
    ended = {
        time: (fleet_numbers.failed(time), fleet_numbers.at_most_allowed(time)) for time in times
    }
    place = units.place
    enough = int(fleet_numbers.first_of.element.present.sum())
    notes = []
    if enough < place.samples:
        notes.append(f"{samples_have(place.samples - enough)} too few units with a life")
    if lost := int(element.failed.sum()):
        notes.append(f"{lost} of {len(element.values)} rows are invalid")
    notes += filter(None, [units.why_not_more, why_no_intervals(result)])
    if not why_no_intervals(result):
        notes.append(f"{_SAMPLING}: {_BETWEEN if varies else _ALIKE}")
    assumed = {end.assumes for both in fleet_numbers.ends for end in both if end.assumes}
    notes += [
        f"the 5 and 95 % points assume {assumption.removeprefix('that ')}" for assumption in assumed
    ]
    design = size_in_words(place.samples, place.units, place.repeats)
    names = units.integrated
    of_life = bool(element.declared.success), element.declared.unit
    weights = None if units.of_worlds is None else of_samples(units.of_worlds)
    numbers = enough, design, names, first, ended
    return Fleet(element.name, size, allow, *numbers, notes, *of_life, weights)


def lifetime_element(rows: Result, output: str | None) -> Element:
    """Return the named life, or the only one."""
    outputs = rows.outputs
    shown = [name for name in rows.shown_outputs(rows.analysis) if outputs[name].is_lifetime]
    asked = [output] if output is not None else shown
    lives = [element for name in asked for element in rows.lifetimes(name)]
    if not lives:
        raise InputError("uq fleet: the study shows no life")
    if len(lives) > 1:
        names = choices([life.name for life in lives])
        raise InputError(f"uq fleet: several lives; name one with --output ({names})")
    return lives[0]


def _refuse(units: Units, size: int) -> None:
    if size > units.place.units and not units.are_alike:
        names = ", ".join(units.varying)
        verb = "is" if len(units.varying) == 1 else "are"
        raise InputError(
            f"uq fleet: a fleet of {size} needs samples of as many units, now {units.place.units}:"
            f" in [design] {several('units', units.design, size)}; fewer are sufficient only if all"
            f" differences between units are integrated exactly, and {names} {verb} not"
        )


def _dependence_of_samples(rows: Result, place: Nesting) -> Dependence:
    """Return the dependence between samples."""
    if rows.dependence.shared is not None:
        _, first = np.unique(place.sample, return_index=True)
        return rows.dependence[first]
    return INDEPENDENT if rows.has_independent_samples else Dependence(place.replicate)


def fleet_facts(fleets: Fleet) -> Fact:
    """Return the numbers of fleets of one size."""
    notes = tuple(fleets.notes)
    quality = {
        name: replace(fact, notes=notes) for name, fact in quality_facts(fleets.weights).items()
    }
    numbers: dict[str, Any] = {
        "output": fleets.output,
        "size": fleets.size,
        "allow": fleets.allow,
        "samples": fleets.samples,
        "integrated": list(fleets.integrated),
        "first": {"quantiles": {repr(p): _banded(banded) for p, banded in fleets.first.items()}},
        "by": {
            repr(time): {"failed": _banded(failed), "at_most_allowed": _banded(at_most)}
            for time, (failed, at_most) in fleets.by.items()
        },
        "notes": fleets.notes,
    }
    return Fact(quality | numbers, (fleet, *BY_WEIGHTS), notes=notes)


def _banded(banded: Banded) -> dict[str, Any]:
    entry = estimate_json.whole(banded.estimate) | estimate_json.failed(banded.failed)
    for name, end in (("band_low", banded.low), ("band_high", banded.high)):
        entry[name] = estimate_json.number(end.value)
        entry |= estimate_json.flag(f"{name}_", end, "value")
        for which in ("low", "high"):
            entry[f"{name}_{which}"] = estimate_json.number(getattr(end, which))
            entry |= estimate_json.flag(f"{name}_{which}_", end, which)
        if end.reason:
            entry[f"{name}_reason"] = end.reason
        if end.assumes:
            entry[f"{name}_assumes"] = end.assumes
    return entry
