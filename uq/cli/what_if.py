"""Terminal output of ``uq what-if``."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from uq.assess.pairing import WORST
from uq.assess.statistic import Reader, Statistic
from uq.assess.statistics.counts import NEVER_ENDING
from uq.assess.summary import summarise
from uq.assess.what_if import WhatIf, read_changes, reweighted_summary, what_if_facts
from uq.cli.printing import console, grid, heading, note, paragraph, print_json, title
from uq.errors import InputError
from uq.files.whole_files import write_result
from uq.result.result import Result
from uq.stats import two_samples
from uq.stats.estimate import Estimate, rounded_text
from uq.stats.importance_weights import ImportanceWeights
from uq.text.numbers import compared, estimated, in_brackets, number, percent, percent_range
from uq.text.units import readable, typical, unit_of

_HEADER = ("", "as studied", "changed", "difference")
_AGAIN = ("settings.", "fixed.")
"""Changes with which rows are computed again instead of weighted."""

_PROBABILITIES = ("thresholds", NEVER_ENDING)


def what_if(path: Path, texts: Sequence[str], target: Path | None, json: bool) -> None:
    """Print the statistics of a result as studied, under changes, and their differences.

    Other laws of inputs weight the rows; other settings and fixed inputs compute them again, from
    what they have kept. `target` is where that result is written.
    """
    result = Result.open(path)
    changes = read_changes(texts)
    if target is not None and target.resolve() == path.resolve():
        raise InputError(f"-o {target}: is the result itself; name another file")
    changed = _changed(result, changes, target)
    if json:
        print_json(what_if_facts(changed).json)
        return
    studied = summarise(result)
    title(result)
    console.print(f"What if: {'; '.join(texts)}", soft_wrap=True)
    for name, shares in changed.summary.shares.items():
        heading(f"\n{name}")
        of_study = studied.shares.get(name, {})
        pairs = [(of_study[label], share) for label, share in shares.items() if label in of_study]
        lines = (_lines(*pair, pair[0].label) for pair in pairs)
        grid(chain.from_iterable(lines), _HEADER)
    for name, output in changed.summary.outputs.items():
        if name not in studied.outputs:
            note(f"{name}: not in the result as studied, so without a difference.")
            continue
        declared = result.outputs[name.partition("[")[0]]
        quantiles = (statistic.estimate.value for statistic in output.parts["quantiles"])
        unit = unit_of(output.units, typical(quantiles))
        heading(f"\n{name}{in_brackets(unit)}", readable(declared.meaning))
        variable = compared(name, declared.is_angle)
        table: list[Line] = []
        for before, after in _pairs(studied.outputs[name].statistics, output.statistics):
            asked = () if before.at is None else (before.at,)
            label = estimated(before.label, output.units, variable, asked)
            per = unit.size if before.unit == output.units else 1.0
            is_share = before.key[0] in _PROBABILITIES
            table += _lines(before, after, label, None if is_share else per)
        grid(table, _HEADER)
        for text in dict.fromkeys(text for part in output.statistics for text in part.notes):
            paragraph(text, indent=2)
    for text in changed.summary.notes:
        note(text)
    weighted = f"weighted: worth {changed.effective_rows:.0f} independent ones"
    if isfinite(changed.pareto_k):
        weighted += f"; Pareto k = {changed.pareto_k:.2f}"
    again = [place.startswith(_AGAIN) for place in changes]
    ways = ["computed again from what they have kept"] * any(again) + [weighted] * (not all(again))
    note(
        f"The same rows, {', '.join(ways)}."
        + (target is not None) * " 'uq compare' shows the difference row by row."
        + " Below each value is its 95 % interval, conservative for a difference: it allows for any"
        " correlation of the two estimates. *: the interval excludes zero. Differences of"
        " probabilities are in percentage points."
    )


def _changed(result: Result, changes: Mapping[str, Any], target: Path | None) -> WhatIf:
    """Return the summary under changes; write rows computed again to `target`, if given."""
    laws = {place: value for place, value in changes.items() if not place.startswith(_AGAIN)}
    others = {place: value for place, value in changes.items() if place.startswith(_AGAIN)}
    if target is not None and (not others or laws):
        raise InputError("-o: only rows computed again are written: change settings or [fixed]")
    again = result
    if others:
        from uq.execution.recomputed_result import recompute

        if target is not None:
            others |= {"study.name": target.stem}
        again = Result(recompute(result, others))
    if target is not None:
        write_result(again.dataset, target)
    if laws:
        return reweighted_summary(again, laws)
    n = len(again)
    equal = ImportanceWeights(np.ones(n), -inf, n, float(n))
    return WhatIf(summarise(again), float(n), nan, equal)


def _pairs(
    before: Iterable[Statistic], after: Iterable[Statistic]
) -> Iterator[tuple[Statistic, Statistic]]:
    """Yield each number that both have, as studied and changed."""
    changed = {statistic.key: statistic for statistic in after}
    for statistic in before:
        other = changed.get(statistic.key)
        if other is not None and statistic.is_read_by(Reader.COMPARED):
            yield statistic.best, other.best


Line = tuple[str, ...]


def _lines(
    before: Statistic, after: Statistic, label: str, per: float | None = None
) -> Iterator[Line]:
    """Yield a line of values in a unit of size `per`, of shares if None, and one of intervals."""
    first, second = before.estimate, after.estimate
    apart = Estimate()
    if isfinite(first.value) and isfinite(second.value):
        apart = two_samples.difference(first.finite, second.finite, WORST)
    excludes = apart.low > 0 or apart.high < 0
    cells = [_share(both) if per is None else rounded_text(both, per) for both in (first, second)]
    value, ends = _difference(apart, 0.01 if per is None else per)
    points = " points" * (per is None and isfinite(apart.value))
    yield label, cells[0][0], cells[1][0], f"{value}{points}{' *' * excludes}"
    if cells[0][1] or cells[1][1] or ends:
        yield "", cells[0][1], cells[1][1], ends


def _share(estimate: Estimate) -> tuple[str, str]:
    """Return a share in per cent and its interval."""
    value, low, high = estimate.numbers
    ends = percent_range(low, high) if estimate.has_interval else ""
    return percent(value) if isfinite(value) else "-", ends


def _difference(apart: Estimate, per: float) -> tuple[str, str]:
    """Return a difference and its interval, to three digits: an end near zero shows its sign."""
    value, low, high = (number(float(f"{size / per:.3g}")) for size in apart.numbers)
    return value if isfinite(apart.value) else "-", f"{low} to {high}" * apart.has_interval
