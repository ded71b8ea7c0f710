"""Card, answer and summary of a result, 80 columns wide."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from math import isnan
from pathlib import Path
from typing import NamedTuple

from rich.text import Text

from uq.assess.answer.answer import conclude
from uq.assess.answer.answer_sentences import Answer
from uq.assess.card import card_of
from uq.assess.findings import Findings
from uq.assess.life_fit import Fit
from uq.assess.regimes import in_words
from uq.assess.statistic import Reader, Statistic
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.summary import REGIME, Described, Summary
from uq.assess.targets import split_name
from uq.cli.printing import CELLS, console, grid, heading, note, paragraph, title
from uq.render.card import lines_of
from uq.result.result import Result
from uq.stats.estimate import Estimate, failed_bounds_text, interval_text
from uq.text.literals import plain
from uq.text.numbers import compared, counted, estimated, in_brackets, number, percent
from uq.text.units import ReadableUnit, readable

_MOST_EFFECTS = 3


def show_findings(findings: Findings, *, explain: bool = False, full: bool = False) -> None:
    """Print the answer of a study in sentences, its statistics, or by default its card."""
    answer = conclude(findings)
    if explain:
        show_answer(answer)
    if full:
        show_summary(findings.result, findings.summary, findings.boundary)
    if explain or full:
        return
    for line in lines_of(card_of(findings, answer)):
        text = Text(plain(line.text), style="magenta" if line.warns else "")
        text.stylize("bold", *line.bold)
        console.print(text, soft_wrap=True)


def show_card(path: Path, notes: Iterable[str]) -> None:
    """Print the card of a result that has just been written, and notes on it."""
    show_findings(Findings(Result.open(path)))
    for text in notes:
        note(text)


def show_summary(result: Result, summary: Summary, boundary: Statistic | None = None) -> None:
    """Print a summary, and how intermingled its regimes are."""
    design = f"{result.design_name}, {counted(summary.samples, 'row')}"
    if not summary.rows_used:
        design += ", none independent"
    elif summary.rows_used < summary.samples:
        design += f", statistics from the {summary.rows_used} independent ones"
    title(result, design)
    grid([(label, str(count), _example(result, label)) for label, count in summary.status.items()])
    regimes = {REGIME: summary.regimes} if summary.regimes else {}
    for name, shares in (regimes | summary.categories).items():
        heading(f"\n{name}", str(result.dataset[name.partition("[")[0]].attrs["long_name"]))
        lines = [_share(share) for share in shares.values()]
        grid(lines, header=("", "share", "95 % interval", "rows", "with invalid rows"))
        if name == REGIME and boundary is not None and boundary.estimate.has_interval:
            stated = f"{boundary.label} {boundary.words()} ({interval_text(boundary.estimate)})"
            paragraph(f"{stated}: {in_words(boundary)}", indent=2)
    for name, output in summary.outputs.items():
        meaning = readable(result.dataset[name.partition("[")[0]].attrs["long_name"])
        unit = output.readable_unit
        is_angle = result.outputs[name.partition("[")[0]].is_angle
        block = Block(unit, output.units, compared(name, is_angle))
        heading(f"\n{name}{in_brackets(block.unit)}", meaning)
        grid(_lines(output, block), header=(*CELLS, ""))
        for text in _reasons(output, block):
            paragraph(text, indent=2)
        for statistic in output.statistics:
            for text in statistic.notes:
                paragraph(text, indent=2)
        if output.fits:
            _show_fits(output, block)
    for text in summary.notes:
        note(text)


def show_answer(answer: Answer) -> None:
    """Print the answer: tolerance bounds, main drivers and recommended actions."""
    lead = answer.lead
    if answer.failed or lead is None:
        paragraph(answer.rows_sentence, indent=0)
    of_lead = lead.lines if lead else []
    sampling_lines = [*answer.level_lines, answer.enough.sentence]
    if answer.regimes_first:
        causes = (cause.named_cause for cause in answer.regime_causes)
        regimes = answer.regimes_sentence, answer.mixing.sentence
        lines = [*regimes, *sampling_lines, *causes, *of_lead]
    else:
        lines = [*of_lead, *sampling_lines, answer.regimes_sentence]
    for line in filter(None, lines):
        paragraph(line, indent=0)
    if lead is not None and lead.ranking_sentence and (ranking := lead.ranking) is not None:
        paragraph(ranking.sentence, indent=0)
        for contribution in ranking.contributions[:_MOST_EFFECTS]:
            if contribution.effect:
                paragraph(f"{contribution.words}: {contribution.effect}", indent=2)
    if answer.ties:
        paragraph(answer.ties, indent=0)
    if lead is not None and lead.earliest is not None:
        for line in lead.earliest.lines:
            paragraph(line, indent=0)
    for advice in answer.advice:
        paragraph(f"To do: {advice.text[:1].lower()}{advice.text[1:]}", indent=0)
    console.print()


Line = tuple[str, str, str, str]


class Block(NamedTuple):
    """Format of the numbers of an output: shown unit, model unit, and comparison."""

    unit: ReadableUnit
    units: str
    compared: str

    def per(self, statistic: Statistic) -> float:
        """Return the size of the unit of a statistic."""
        return self.unit.size if statistic.unit == self.units else 1.0

    def label(self, statistic: Statistic) -> str:
        """Return the name of a statistic."""
        asked = () if statistic.at is None else (statistic.at,)
        return estimated(statistic.label, self.units, self.compared, asked)


def _share(statistic: Statistic) -> tuple[str, ...]:
    share = (statistic.label, statistic.words(), interval_text(statistic.estimate))
    return *share, str(statistic.facts["count"]), failed_bounds_text(statistic.failed)


def _lines(output: Described, block: Block) -> Iterator[Line]:
    """Yield label, value, interval and remark, in the unit of the block."""
    for part in output.parts.values():
        shown = [statistic for statistic in part if _is_shown(statistic)]
        for statistic in shown:
            yield from _of_statistic(statistic, block)
            if otherwise := _otherwise(statistic):
                yield from _of_statistic(otherwise, block)
                yield "", otherwise.estimate.assumes.removeprefix("that "), "", ""
        for assumed in dict.fromkeys(statistic.estimate.assumes for statistic in shown):
            if assumed:
                yield "", f"{shown[0].kind.name} assume", assumed.removeprefix("that "), ""


def _is_shown(statistic: Statistic) -> bool:
    return statistic.is_read_by(Reader.TERMINAL) and bool(statistic.words())


def _otherwise(statistic: Statistic) -> Statistic | None:
    """Return the statistic by another estimator, if that has a separate label."""
    otherwise = statistic.otherwise
    return otherwise if otherwise and otherwise.label else None


def _of_statistic(statistic: Statistic, block: Block) -> Iterator[Line]:
    per, more = block.per(statistic), ""
    if statistic.unit == "rows":
        more = statistic.unit
    elif form := split_name(statistic.of)[0]:
        more = f"of its {form}"
    elif undefined := statistic.facts.get("undefined"):
        more = f"{percent(undefined)} undefined"
    yield block.label(statistic), statistic.words(per), statistic.interval(per), more
    if worst := failed_bounds_text(statistic.failed, per):
        yield "  with invalid rows", "", worst, ""


def _reasons(output: Described, block: Block) -> Iterator[str]:
    """Yield the reasons for missing numbers, each once, unless a note states it."""
    lacking: dict[str, list[str]] = {}
    noted = {text for statistic in output.statistics for text in statistic.notes}
    for statistic in output.statistics:
        if not _is_shown(statistic):
            continue
        candidates = []
        if otherwise := _otherwise(statistic):
            candidates = [statistic, otherwise]
        elif isnan(statistic.estimate.value) and statistic.rows_needed is None:
            candidates = [statistic] * (not statistic.otherwise)
        for missing in candidates:
            reason = missing.estimate.reason
            if reason and reason not in noted:
                lacking.setdefault(reason, []).append(block.label(missing))
    for reason, labels in lacking.items():
        yield f"{', '.join(labels)}: {reason}"


_LAWS_IN_A_TABLE = 2


def _show_fits(output: Described, block: Block) -> None:
    """Print the adequate life distributions with their B-lives, and why others are rejected.

    B-lives as estimated from the rows alone are beside them.
    """
    fits = output.fits
    for law, fit in fits.items():
        if fit.refused:
            paragraph(f"{law}: {fit.refused}", indent=2)
    accepted = {law: fit for law, fit in fits.items() if not fit.refused}
    if not accepted:
        return
    named = list(accepted.items())
    for first in range(0, len(named), _LAWS_IN_A_TABLE):
        _show_laws(dict(named[first : first + _LAWS_IN_A_TABLE]), output, block)
    for assumed in dict.fromkeys(fit.assumes for fit in accepted.values()):
        paragraph(f"The numbers of a fitted law assume {assumed}.", indent=2)


def _show_laws(accepted: Mapping[str, Fit], output: Described, block: Block) -> None:
    lines: list[tuple[str, ...]] = []
    if any(not isnan(fit.p_value) for fit in accepted.values()):
        tests = chain(*((_p_value(fit), "") for fit in accepted.values()))
        lines.append(("p of the test", *tests, ""))
    if any(not isnan(fit.log_likelihood) for fit in accepted.values()):
        aics = chain(*((number(fit.aic), "") for fit in accepted.values()))
        lines.append(("aic", *aics, ""))
    laws = [{**fit.parameters, **fit.b_lives} for fit in accepted.values()]
    parameters = dict.fromkeys(chain(*(fit.parameters for fit in accepted.values())))
    for name in (*parameters, *B_LIVES):
        extrapolated = any(name in fit.extrapolated for fit in accepted.values())
        per = 1.0 if name in _PURE_PARAMETERS else block.unit.size
        numbers = chain(*(_cells(law.get(name), per) for law in laws))
        of_rows = output.find("b_lives", name) if name in B_LIVES else None
        rows = number(of_rows.best.estimate.value / per) if of_rows else ""
        lines.append((f"{name}, extrapolated" if extrapolated else name, *numbers, rows))
    header = (cell for law in accepted for cell in (law, "95 % interval"))
    grid(lines, header=("", *header, "rows"))


_PURE_PARAMETERS = ("shape", "sigma", "share", "shape_1", "shape_2")


def _p_value(fit: Fit) -> str:
    return "" if isnan(fit.p_value) else f"{fit.p_value:.2g}"


def _cells(estimate: Estimate | None, per: float) -> tuple[str, str]:
    return (
        ("", "")
        if estimate is None
        else (number(estimate.value / per), interval_text(estimate, per))
    )


def _example(result: Result, status: str) -> str:
    return str(result.dataset["status"].attrs.get(f"example_{status.replace('-', '_')}", ""))
