"""Terminal output of ``uq what-if``."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from uq.assess.answer.answer_sentences import MOST_REGIMES, RARE
from uq.assess.answer.quantities import by_importance
from uq.assess.answer.wording import called
from uq.assess.pairing import WORST
from uq.assess.statistic import Reader, Statistic
from uq.assess.statistics.counts import NEVER_ENDING
from uq.assess.summary import REGIME, Summary, summarise
from uq.assess.what_if import WhatIf, read_changes, reweighted_summary, what_if_facts
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.cli.summary_tables import Block
from uq.errors import InputError
from uq.files.whole_files import write_result
from uq.result.result import Result
from uq.stats.estimate import Estimate, difference, rounded_text
from uq.stats.importance_weights import ImportanceWeights
from uq.study.file import Tied
from uq.text import literals
from uq.text.numbers import (
    compared,
    estimated,
    in_brackets,
    law_in_unit,
    listed,
    number,
    percent,
    percent_range,
    printed,
    quantity,
)
from uq.text.units import PURE, beside, readable

_HEADER = ("", "as studied", "changed", "difference")
_AGAIN = ("settings.", "fixed.")
"""Changes with which rows are computed again instead of weighted."""

_PROBABILITIES = ("thresholds", NEVER_ENDING)
_IN_BRIEF = ("mean", "quantiles", *_PROBABILITIES)
"""Numbers in the table without ``--full``; of a threshold, one side."""
_MOST_LEADING = 2

Pair = tuple[Statistic, Statistic]
"""A number as studied and as changed."""
Line = tuple[str, ...]


class Table(NamedTuple):
    """The numbers of an element of an output, or the shares of a category.

    Attributes
    ----------
    name, meaning : str
    pairs : list of Pair
    block : Block or None
        Units of an output; None of a category.
    is_life : bool
    notes : tuple of str
    """

    name: str
    meaning: str
    pairs: list[Pair]
    block: Block | None = None
    is_life: bool = False
    notes: tuple[str, ...] = ()

    def of(self, *kinds: str) -> list[Pair]:
        """Return the numbers of these kinds; of a threshold, whether lives end or values exceed."""
        pairs = [pair for kind in kinds for pair in self.pairs if pair[0].key[0] == kind]
        return [pair for pair in pairs if pair[0].at is None or pair[0].falls == self.is_life]

    def leading(self, wanted: str) -> list[Pair]:
        """Return the main shares, the probabilities, or the quantile on the unwanted side."""
        if self.block is None:
            shares = [pair for pair in self.pairs if pair[0].estimate.value >= RARE]
            return sorted(shares, key=lambda pair: -pair[0].estimate.value)[:MOST_REGIMES]
        quantiles = sorted(self.of("quantiles"), key=lambda pair: float(pair[0].key[-1]))
        place = {"above": 0, "below": -1}.get(wanted, len(quantiles) // 2)
        quantile, events = quantiles[place:][:1], self.of("thresholds")
        return [*(quantile if self.is_life or not events else ()), *events][:_MOST_LEADING]

    def per(self, statistic: Statistic) -> float | None:
        """Return the size of the unit of a number; None for a share."""
        is_share = self.block is None or statistic.key[0] in _PROBABILITIES
        return None if self.block is None or is_share else self.block.per(statistic)

    def sentence(self, before: Statistic, after: Statistic) -> str:
        """Return a number as changed and as studied, each with its interval."""
        label, per, unit = before.label, self.per(before), "1"
        if self.block is not None and per is None:
            compared_name = self.block.compared or self.name
            label = estimated(label, self.block.units, compared_name, (before.at or 0.0,))
        elif self.block is not None:
            label, unit = f"{before.heading} of {self.name}", self.block.unit.name
        texts = []
        for estimate in (after.estimate, before.estimate):
            value, ends = _share(estimate) if per is None else rounded_text(estimate, per)
            texts.append(f"{beside(value, unit)}{f' ({ends})' * bool(ends)}")
        return printed(f"{label}: {', was '.join(texts)}")

    def show(self, *, full: bool) -> None:
        """Print these numbers as studied and as changed, and their differences."""
        unit = "" if self.block is None else in_brackets(self.block.unit)
        heading(f"\n{self.name}{unit}", self.meaning)
        lines: list[Line] = []
        for before, after in self.pairs if full or self.block is None else self.of(*_IN_BRIEF):
            label = before.label if self.block is None else self.block.label(before)
            lines += _lines(before, after, label, self.per(before))
        grid(lines, _HEADER)
        for text in self.notes:
            paragraph(text, indent=2)


def what_if(
    path: Path, texts: Sequence[str], target: Path | None, json: bool, full: bool = False
) -> None:
    """Print the subject of a result under changes and as studied, and a table of differences.

    Other laws of inputs weight the rows; other settings and fixed inputs compute them again, from
    what they have kept. `target` is where that result is written. Tables have every number of
    every output where `full`, else the main numbers of the subject.
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
    tables = [*_tables(result, studied, changed.summary)]
    subject = _subject(result, tables)
    heading(f"What if {'; '.join(texts)}?")
    before = dict.fromkeys(_as_studied(result, changes))
    paragraph(f"as studied: {'; '.join(before)}", indent=2)
    if subject is not None:
        for pair in subject.leading(_wanted(result, subject)):
            paragraph(subject.sentence(*pair), indent=2)
    for table in tables:
        if full or table is subject:
            table.show(full=full)
    absent = [name for name in changed.summary.outputs if name not in studied.outputs]
    if absent:
        note(f"{listed(absent)}: not in the result as studied, so without a difference.")
    for text in changed.summary.notes:
        note(text)
    weighted = f"weighted: worth {changed.effective_rows:.0f} independent ones"
    if full and isfinite(changed.pareto_k):
        weighted += f"; Pareto k = {changed.pareto_k:.2f}"
    again = [place.startswith(_AGAIN) for place in changes]
    ways = ["computed again from what they have kept"] * any(again) + [weighted] * (not all(again))
    note(
        f"The same rows, {', '.join(ways)}."
        + (target is not None) * " 'uq compare' shows the difference row by row."
        + " Below each value is its 95 % interval; *: that of the difference excludes zero."
        + full * _ON_DIFFERENCES
        + (not full) * " --full shows all numbers of all outputs."
    )


_ON_DIFFERENCES = (
    " The interval of a difference is conservative: it allows for any correlation of the two"
    " estimates. Differences of probabilities are in percentage points."
)


def _as_studied(result: Result, changes: Mapping[str, Any]) -> Iterator[str]:
    """Yield what each change replaces."""
    for table, name in dict.fromkeys((*place.split(".")[:2],) for place in changes):
        if table == "uncertain":
            law = result.study.uncertain[name]
            assert not isinstance(law, Tied)  # whose changes are refused
            factor = "" if law.times is None else f"{law.times} times "
            unit = PURE if law.times else result.input_unit(name)
            yield f"{called(name)} {factor}{law_in_unit(law, unit)}"
        elif table == "fixed":
            variable = result.dataset[name]
            yield f"{called(name)} {quantity(float(variable), variable.attrs['units'])}"
        elif table == "settings":
            value = result.study.settings.get(name)
            yield f"{name} {'at its default' if value is None else literals.shown(value)}"
        elif result.study.dependence is not None:
            words, ranks = result.study.dependence.words, result.study.dependence.rank_correlation
            of_copula = words or "normal copula"
            yield f"rank correlations {ranks}" if name == "rank_correlation" else of_copula


def _tables(result: Result, studied: Summary, changed: Summary) -> Iterator[Table]:
    """Yield the numbers of each category and element that both have."""
    for name, shares in changed.shares.items():
        pairs = [*_pairs(studied.shares.get(name, {}).values(), shares.values())]
        yield Table(
            name, readable(result.dataset[name.partition("[")[0]].attrs["long_name"]), pairs
        )
    for name, output in changed.outputs.items():
        if name not in studied.outputs:
            continue
        declared = result.outputs[name.partition("[")[0]]
        block = Block(output.readable_unit, output.units, compared(name, declared.is_angle))
        notes = dict.fromkeys(text for part in output.statistics for text in part.notes)
        pairs = [*_pairs(studied.outputs[name].statistics, output.statistics)]
        meaning = readable(declared.meaning)
        yield Table(name, meaning, pairs, block, declared.is_lifetime, (*notes,))


def _subject(result: Result, tables: Sequence[Table]) -> Table | None:
    """Return the numbers that the study is about; None without any."""
    first, *_ = (*result.analysis.outputs, "")
    names = [*by_importance(result, result.analysis)]
    if first == REGIME:
        names.insert(0, REGIME)
    ranks = {name: rank for rank, name in reversed([*enumerate(names)])}
    asked = [table for table in tables if table.name.partition("[")[0] in ranks]
    return min(asked, key=lambda table: ranks[table.name.partition("[")[0]], default=None)


def _wanted(result: Result, subject: Table) -> str:
    """Return the wanted side of the values of the subject."""
    output = subject.name.partition("[")[0]
    if subject.is_life:
        return "below" if result.outputs[output].success else "above"
    return result.analysis.wanted.get(output, "")


def _changed(result: Result, changes: Mapping[str, Any], target: Path | None) -> WhatIf:
    """Return the summary under changes; write rows computed again to `target`, if given."""
    laws = {place: value for place, value in changes.items() if not place.startswith(_AGAIN)}
    others = {place: value for place, value in changes.items() if place.startswith(_AGAIN)}
    if target is not None and (not others or laws):
        raise InputError("-o: only rows computed again are written: change settings or [fixed]")
    again = result
    if others:
        from uq.execution.recomputation import recompute

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


def _lines(
    before: Statistic, after: Statistic, label: str, per: float | None = None
) -> Iterator[Line]:
    """Yield a line of values in a unit of size `per`, of shares if None, and one of intervals."""
    first, second = before.estimate, after.estimate
    apart = Estimate()
    if isfinite(first.value) and isfinite(second.value):
        apart = difference(first.finite, second.finite, WORST)
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
