"""Terminal output of ``uq sensitivity``, ``uq levels`` and ``uq trace``: tables of 80 columns."""

import re
from collections.abc import Iterator
from contextlib import suppress
from math import isfinite
from pathlib import Path
from typing import Any

from uq.assess.answer.wording import NumberTarget, called
from uq.assess.components_by_level import by_level
from uq.assess.nested_table import SOLVER, LevelShares
from uq.assess.sensitivities import Sensitivities, Values, lines
from uq.assess.statistics.quantiles import SIDES
from uq.assess.summary_facts import levels_facts
from uq.cli.printing import grid, heading, note, paragraph, print_json, title
from uq.errors import InputError
from uq.indices.index import BY_CORRELATION, S1, IndexKind, Indices
from uq.render.trace.trace import Trace, trace_json, traced
from uq.result.result import Result
from uq.sampling.levels import LEVELS
from uq.stats.importance_weights import worth_in_words
from uq.text import keys
from uq.text.numbers import counted, in_brackets, percent, quantity
from uq.text.units import powers, typical, unit_of


def show(result: Result, sensitivities: Sensitivities) -> None:
    """Print the sensitivity indices of each target, or the reason if there are none."""
    dropped = sensitivities.groups_dropped
    lost = f", {counted(dropped, 'group')} dropped" if dropped else ""
    more = f"of {counted(sensitivities.rows_used, 'row')}{lost}"
    heading(f"Sensitivity by {sensitivities.method}", more)
    for name, target_indices in sensitivities.targets.items():
        target = NumberTarget(result, name)
        kinds = target_indices.kinds().items()
        effects = [estimates for kind, estimates in kinds if _is_effect(kind)]
        values = [index.value for estimates in effects for index in estimates.values()]
        unit = unit_of(target.units if values else "1", typical(values))
        heading(f"\n{target.name}{in_brackets(unit)}", target.meaning)
        if target_indices.refused:
            paragraph(target_indices.refused, indent=2)
            continue
        for of_pairs in (False, True):
            table = target_indices.kinds(of_pairs=of_pairs)
            if table:
                header = (text for kind in table for text in (kind.key, "95 % interval"))
                remark = ("",) * bool(target_indices.indices.by_correlation)
                shown = list(_lines(table, target_indices.indices, unit.size))
                most = _MOST_PAIRS if of_pairs else len(shown)
                grid(shown[:most], header=("", *header, *remark))
                if rest := shown[most:]:
                    pairs = counted(len(rest), "more pair")
                    paragraph(f"{pairs}, none above {rest[0][1]}, are in --json", indent=2)
        if noise := target_indices.indices.noise:
            share = (S1.text(noise.value), S1.interval(noise))
            grid([("noise", *share)], header=("", "share of variance", "95 % interval"))
        for text in target_indices.indices.notes:
            paragraph(text, indent=2)


_MOST_PAIRS = 12
"""Pairs of inputs that are printed: those with the largest indices."""


def _is_effect(kind: IndexKind) -> bool:
    """Return whether an index is in the unit of the output."""
    return kind.unit == "output"


def _lines(table: Values, indices: Indices, per: float) -> Iterator[list[str]]:
    borrowed = indices.by_correlation
    for label, estimates in lines(table, indices.nulls):
        pairs = [
            (kind, estimate.over(per) if _is_effect(kind) else estimate)
            for kind, estimate in zip(table, estimates, strict=True)
        ]
        cells = ((kind.text(estimate.value), kind.interval(estimate)) for kind, estimate in pairs)
        remark = [BY_CORRELATION * (label in borrowed)] if borrowed else []
        yield [label, *(text for pair in cells for text in pair), *remark]


def levels(result: Path, output: str | None, plain: bool, json: bool) -> None:
    """Show the variance components by level."""
    opened = Result.open(result)
    decomposition = by_level(opened, output, plain=plain)
    if json:
        print_json(levels_facts(decomposition).json)
        return
    title(opened, decomposition.size)
    grid([(level, ", ".join(decomposition.inputs_on(level)) or "-") for level in LEVELS])
    for name, shares in decomposition.outputs.items():
        heading(f"\n{NumberTarget(opened, name).name}", "shares of the variance")
        grid(_share_lines(shares), header=("", "share", "95 % interval", ""))
        for text in shares.sentences:
            paragraph(text, indent=2)
    if (another := decomposition.another_regime) is not None:
        heading("\nregime", "probability that a repeat ends in another")
        line = ("another regime", S1.text(another.value), S1.interval(another))
        grid([line], header=("", "probability", "95 % interval"))
        if another.reason:
            paragraph(another.reason, indent=2)
    if decomposition.weights is not None:
        note(worth_in_words(decomposition.weights))
    if any(isfinite(shares.shares[SOLVER].value) for shares in decomposition.outputs.values()):
        note("the solver's share is contained in the others")


def _share_lines(level_shares: LevelShares) -> Iterator[tuple[str, str, str, str]]:
    for name, share in level_shares.shares.items():
        assumes = share.assumes.removeprefix("that ")
        yield name, S1.text(share.value), S1.interval(share), assumes


_MOST_OF_HASH = 40  # characters of a hash


def trace(result: Path, key: str, model: str | None, json: bool) -> int:
    """Show where a number comes from; return the exit code."""
    opened = Result.open(result)
    provenance = traced(opened, key, model)
    print_json(trace_json(provenance)) if json else _show_trace(opened, provenance)
    return 0 if provenance.equal else 1


def _show_trace(result: Result, provenance: Trace) -> None:
    heading(provenance.key)
    if words := _words(result, provenance.path):
        paragraph(words, indent=2)
    unit = _unit(result, provenance.path)
    numbers = provenance.numbers.items()
    grid([(name, *_with_unit(name, value, unit, provenance.path[-1])) for name, value in numbers])
    heading("\nestimator")
    for citation in provenance.estimators:
        paragraph(citation.does, indent=2)
        paragraph(citation.code, indent=4)
        for source in citation.sources or ("no source: a definition",):
            paragraph(source, indent=4)
    heading("\nrows", f"{provenance.rows_used} of {provenance.rows}")
    paragraph(provenance.which, indent=2)
    grid([(str(count), state) for state, count in provenance.states.items()])
    for text in provenance.notes:
        paragraph(text, indent=2)
    heading("\nmade by")
    here = {f"{name} here": version for name, version in provenance.versions_here.items()}
    made = {**provenance.recorded, **provenance.versions, **here}
    grid([(name, str(value)[:_MOST_OF_HASH]) for name, value in made.items()])  # hashes are longer
    equal = "equal to the bit" if provenance.equal else f"NOT EQUAL: {provenance.again}"
    note(f"Computed again from these rows: {equal}.")


_IN_UNIT = (
    *("mean", "mean_interval", "sd", "sd_interval", "quantiles", "b_lives", "tolerance"),
    *("promise", "range", "own_error", "sampling_error"),
)
"""Parts of an output with values in its unit."""
_SHARES = ("thresholds", "events", "regimes", "regime", "categories")
"""Parts whose values are probabilities."""
_IN_WORDS = {"b_lives": "", "promise": "tolerance bound", "own_error": "numerical error"}
_BARE = re.compile("coverage|confidence|accuracy|count|samples|(rows|never|share_).*|.*_is_row")
"""Names of numbers without a unit."""


def _target(result: Result, path: keys.Path) -> NumberTarget | None:
    """Return the output that a path names, or what is derived from one; None without any."""
    if path[1:] and path[0] in ("outputs", "quantities"):
        with suppress(InputError, LookupError):
            return NumberTarget(result, path[1])
    return None


def _words(result: Result, path: keys.Path) -> str:
    """Return a number in words; "" of those that their key describes."""
    target = _target(result, path)
    if target is None:
        return ""
    of = ", ".join(filter(None, (target.name, target.meaning)))
    match path[2:]:
        case ("quantiles", p, *rest):
            words = f"{100 * float(p):g} % quantile"
        case ("thresholds", t, ("above" | "below") as side, *rest):
            words = target.label(f"P({SIDES[side]}{t})")
        case ("events", name, *rest):
            words = NumberTarget(result, name).name
        case ("estimates", label, *rest):
            words = target.label(label)
        case (first, *rest):
            words = _IN_WORDS.get(first, first)
        case _:
            return of
    return f"{called(' '.join(filter(None, (words, *rest))))} of {of}"


def _unit(result: Result, path: keys.Path) -> str:
    """Return the CF unit of values at a path, % of probabilities and shares, "" of others."""
    target = _target(result, path)
    if path[1:2] in (("stated",), ("sampled",)):
        return str(result.dataset[path[0]].attrs["units"])
    if any(part in _SHARES for part in path[:3]):
        return "%"
    if target is None or not path[2:]:
        return ""
    if path[2] in (*LEVELS, SOLVER):
        return "%"
    if path[2] == "estimates":
        return "%" if path[3].startswith("P(") else target.units
    return target.units if path[2] in _IN_UNIT or path[2:4] == ("earliest", "lives") else ""


def _with_unit(name: str, value: Any, unit: str, last: str) -> tuple[str, str]:
    """Return a number in full, and as it is read in another unit."""
    text = "null" if value is None else str(value)
    is_bare = _BARE.fullmatch(name) or (name == "value" and _BARE.fullmatch(last))
    if isinstance(value, str) or value is None or unit in ("", "1") or is_bare:
        return text, ""
    if unit == "%":
        return text, percent(value)
    readable = quantity(value, unit)
    return f"{text} {powers(unit)}", readable * (not readable.endswith(f" {powers(unit)}"))
