"""What to do, by rules: mend, add rows, measure, tighten, or nothing."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil, isfinite, isinf

import xarray as xr

from uq.analysis.findings import Findings
from uq.analysis.summary import why_no_intervals
from uq.conclusions.contributions import Contribution
from uq.conclusions.parts import Event, Quantity
from uq.conclusions.quantities import quantities
from uq.conclusions.remedies import Advice
from uq.conclusions.settling import MOST, Unsettled, bounds_unsettled, unsettled
from uq.conclusions.sources import ASSUMED, mark
from uq.conclusions.tightening import changes_of
from uq.conclusions.tolerances import tighten, twins
from uq.conclusions.words import (
    called,
    called_together,
    sentence,
    share_text,
)
from uq.keys import key_of
from uq.rows.commands import file_of, model_option
from uq.rows.elements import analysis_of
from uq.rows.nesting import is_nested
from uq.rows.results import failed
from uq.rows.variables import is_error, outputs_of
from uq.rows.weights import has_weights
from uq.wording import capitalized, counted, grouped, rows_in_words


def advise(
    findings: Findings, answered: Sequence[Quantity], weighed: bool = True
) -> Iterator[Advice]:
    """Yield what to do, the most urgent first; nothing where inspections have weighted the rows.

    Parameters
    ----------
    findings : Findings
    answered : sequence of Quantity
        The one that the study is about first.
    weighed : bool
        Whether the rows are weighed to say what a tighter tolerance would change; otherwise a
        command says it.
    """
    if has_weights(findings.ds):
        return
    how = _tighten if weighed else _ask
    found = [
        *_mend(findings, answered),
        *_measure(findings, answered),
        *([*how(findings, answered)] or _keep(answered)),
        *_add_rows(findings, answered),
    ]
    if answered and all(one.rule in ("known", "tighten", "keep") for one in found):
        found = [one for one in found if one.rule != "known"]  # it says so, too
        nothing = "Nothing else" if found else "Nothing"
        settled = "what the study asks is settled, and no law that matters is an assumption"
        found.append(Advice("nothing", f"{nothing}: {settled}."))
    yield from found


def _mend(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    ds = findings.ds
    lost, rows = int(failed(ds).sum()), ds.sizes["sample"]
    most = analysis_of(ds).max_failed
    why = [f"the study allows {100 * most:g} % to fail"] * (rows > 0 and lost > most * rows)
    why += [one.what for one in bounds_unsettled(findings, answered) if isinf(one.factor)]
    if why:
        yield Advice(
            "failed",
            f"Mend the {counted(lost, 'failed row')} first: {why[0]};"
            f" 'uq rerun {file_of(ds)} --failed{model_option(ds)}' computes failed rows again,"
            " if necessary with other settings.",
        )


def _leading(answered: Sequence[Quantity]) -> tuple[Contribution | None, Event | None]:
    """Return what contributes most to what the study is about, and the event that it decides."""
    for quantity in answered[:1]:
        of_events = ((event.ranking, event) for event in quantity.events)
        for ranking, event in (*of_events, (quantity.ranking, None)):
            if ranking is not None and ranking.leads:
                return ranking.leader, event
    return None, None


def _measure(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, event = _leading(answered)
    if leader is None:
        return
    ds = findings.ds
    assumed = tuple(n for n in leader.inputs if mark(str(ds[n].attrs["source"])) == ASSUMED)
    if not assumed:
        one = len(leader.inputs) == 1
        yield Advice(
            "known",
            f"Measure nothing first: {'the law' if one else 'the laws'} of {leader.words},"
            f" which {'matters' if one else 'matter'} most, {'is' if one else 'are'} not assumed.",
            leader.inputs,
        )
        return
    one = len(assumed) == 1
    words = called_together(assumed)
    to_what = f" to how many {event.said}" if event else ""
    yield Advice(
        "measure",
        f"Measure {words} first: {'it matters' if one else 'they matter'} most{to_what}, and"
        f" {'its law is' if one else 'their laws are'} assumed.",
        assumed,
    )


def _tighten(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, _ = _leading(answered)
    if leader is not None:
        yield from tighten(findings.ds, answered[0], leader)


def _keep(answered: Sequence[Quantity]) -> Iterator[Advice]:
    """Yield where to keep the input that decides an event, where the event is settled to differ."""
    _, event = _leading(answered)
    if event is None or event.curve is None or (more := answered[0].wants_more) is None:
        return
    place = event.curve.most if more else event.curve.least
    there, overall = event.curve.shares[place], event.share
    if there.low > overall.high if more else there.high < overall.low:
        path = ("quantities", answered[0].name, "events", event.name, "decided_by")
        yield Advice(
            "keep",
            f"So that {'more' if more else 'fewer'} {event.said}, keep {called(event.over)}"
            f" {event.part(place)}: {share_text(there)} do there.",
            (event.over,),
            key=key_of(*path, verb="answer"),
        )


def _ask(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, _ = _leading(answered)
    if leader is None:
        return
    inputs = twins(leader)  # of many at once, the rows may show nothing
    changes = changes_of(findings.ds, answered[0], inputs)
    if not changes:
        return
    given = " ".join(f"--set {name}={value:.6g}" for name, value in changes.items())
    words = called_together(inputs)
    command = f"uq what-if {file_of(findings.ds)} {given}"
    text = f"See what half the scatter of {words} would change: {command}"
    yield Advice("tighten", text, inputs)


def verdict(findings: Findings, output: str | None = None) -> list[str]:
    """Return whether the rows are enough, in sentences, the least settled first.

    Parameters
    ----------
    findings : Findings
    output : str, optional
        Only for this output, or this element of one.
    """
    rows = findings.ds.sizes["sample"]
    asked = [one for one in quantities(findings) if output in (None, one.name, one.output)]
    if rows and (why := _no_intervals(findings.ds)):
        return [f"Whether the rows are enough is not known: {why}."]
    open_ones = _open(findings, asked)
    if not open_ones:
        return ["Enough rows: what the study asks is settled."] if rows and asked else []
    return [
        f"Not enough rows: {_settled(one, findings.ds)}"
        if isfinite(one.factor)
        else f"{sentence(one.what)} More rows would not help."
        for one in open_ones
    ]


def _settled(one: Unsettled, ds: xr.Dataset) -> str:
    """Return what is not settled, and how many rows in all would settle it."""
    return f"{one.what}; {_needed(one, ds)} in all would settle it."


def _no_intervals(ds: xr.Dataset) -> str:
    return why_no_intervals(ds).removeprefix("no intervals: ")


def _open(findings: Findings, answered: Sequence[Quantity]) -> list[Unsettled]:
    """Return what the rows do not settle, the least settled first.

    How well numerical errors are known is asked only where nothing else is.
    """
    known = outputs_of(findings.ds)
    own = [one for one in answered if not is_error(one.output, known)] or answered
    found = [
        replace(one, what=f"{one.what} ({quantity.words})") if len(own) > 1 else one
        for quantity in own
        for one in unsettled(quantity)
    ]
    found += bounds_unsettled(findings, own)
    return sorted(found, key=lambda one: -one.factor)


def _needed(one: Unsettled, ds: xr.Dataset) -> str:
    """Return the rows that would settle it, and of how many samples where these have several."""
    many = "more than" if one.factor > MOST else "about"
    factor = min(one.factor, MOST)
    rows = f"{many} {rows_in_words(factor * ds.sizes['sample'])} rows"
    samples = rows_in_words(factor * int(ds.attrs["samples"]))
    return f"{rows} ({samples} samples)" if is_nested(ds) else rows


def _add_rows(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    rows = findings.ds.sizes["sample"]
    if answered and (why := _no_intervals(findings.ds)):
        yield Advice("rows", f"Let the estimates have intervals: {why}.")
    open_ones = [one for one in _open(findings, answered) if isfinite(one.factor)]
    if not open_ones or not rows:
        return
    worst, *less = open_ones
    more = ""
    if less:
        are, them = ("is", "it") if len(less) == 1 else ("are", "them")
        listed = f"'uq convergence {file_of(findings.ds)}' lists {them}"
        more = f"; {len(less)} more {are} not settled ({listed})"
    yield Advice(
        "rows",
        f"Compute {_needed(worst, findings.ds)} instead of {grouped(rows)}: {worst.what}{more}.",
        rows=ceil(min(worst.factor, MOST) * rows),
        others=tuple(capitalized(_settled(one, findings.ds)) for one in less),
    )
