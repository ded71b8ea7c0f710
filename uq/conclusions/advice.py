"""What to do, by rules: mend, add rows, measure, tighten, or nothing."""

from collections.abc import Iterator, Sequence

import xarray as xr

from uq.analysis.findings import Findings
from uq.conclusions.contributions import Contribution
from uq.conclusions.parts import Quantity
from uq.conclusions.quantities import quantities
from uq.conclusions.remedies import Advice
from uq.conclusions.settling import MOST, Unsettled, unsettled
from uq.conclusions.sources import ASSUMED, mark
from uq.conclusions.tightening import changes_of, tightened
from uq.conclusions.words import called_together, grouped, rows_in_words
from uq.rows.elements import analysis_of
from uq.rows.nesting import is_nested
from uq.rows.results import failed
from uq.rows.weights import has_weights


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
    tighten = _tighten if weighed else _ask
    found = [
        *_mend(findings),
        *_measure(findings, answered),
        *tighten(findings, answered),
        *_add_rows(findings, answered),
    ]
    if answered and not any(one.rule != "tighten" for one in found):
        nothing = "Nothing else" if found else "Nothing"
        settled = "what the study asks is settled, and no law that matters is an assumption"
        found.append(Advice("nothing", f"{nothing}: {settled}."))
    yield from found


def _mend(findings: Findings) -> Iterator[Advice]:
    ds = findings.ds
    lost, rows = int(failed(ds).sum()), ds.sizes["sample"]
    most = analysis_of(ds).max_failed
    if rows and lost > most * rows:
        yield Advice(
            "failed",
            f"Mend the {lost} failed rows first: the study allows {100 * most:g} % to fail;"
            " 'uq rerun --failed' computes them again, if necessary with other settings.",
        )


def leading(answered: Sequence[Quantity]) -> tuple[Contribution | None, str]:
    """Return what contributes most to what the study is about, and the event that it decides."""
    for quantity in answered[:1]:
        of_events = ((event.ranking, event.said) for event in quantity.events)
        for ranking, said in (*of_events, (quantity.ranking, "")):
            if ranking is not None and ranking.leads:
                return ranking.leader, said
    return None, ""


def _measure(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, said = leading(answered)
    if leader is None:
        return
    ds = findings.ds
    assumed = tuple(n for n in leader.inputs if mark(str(ds[n].attrs["source"])) == ASSUMED)
    if assumed:
        one = len(assumed) == 1
        words = called_together(assumed)
        to_what = f" to how many {said}" if said else ""
        yield Advice(
            "measure",
            f"Measure {words} first: {'it matters' if one else 'they matter'} most{to_what}, and"
            f" {'its law is' if one else 'their laws are'} assumed.",
            assumed,
        )


def _tighten(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, _ = leading(answered)
    if leader is None:
        return
    found = list(tightened(findings.ds, answered[0], leader.inputs))
    is_life = answered[0].promise is not None and answered[0].promise.is_life
    known = [one for one in found if not one.reason and (one.lengthens or not is_life)]
    known = [one for one in known if one.is_seen]
    unknown = [one for one in found if one.reason]
    for one in (known or unknown)[:1]:
        yield Advice("tighten", one.sentence, leader.inputs, tightened=one)


def _ask(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    leader, _ = leading(answered)
    changes = None if leader is None else changes_of(findings.ds, answered[0], leader.inputs)
    if leader is None or not changes:
        return
    given = " ".join(f"--set {name}={value:.6g}" for name, value in changes.items())
    words = called_together(leader.inputs)
    text = f"See what half the scatter of {words} would change: uq what-if OUT {given}"
    yield Advice("tighten", text, leader.inputs)


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
    open_ones = [one for quantity in asked for one in unsettled(quantity)]
    if not open_ones:
        return ["Enough rows: what the study asks is settled."] if rows and asked else []
    return [
        f"Not enough rows: {one.what}; {_needed(one, findings.ds)} would settle it."
        for one in sorted(open_ones, key=lambda one: -one.factor)
    ]


def _needed(one: Unsettled, ds: xr.Dataset) -> str:
    """Return the rows that would settle it, and of how many samples where these have several."""
    many = "more than" if one.factor > MOST else "about"
    factor = min(one.factor, MOST)
    rows = f"{many} {rows_in_words(factor * ds.sizes['sample'])} rows"
    samples = rows_in_words(factor * int(ds.attrs["samples"]))
    return f"{rows} ({samples} samples)" if is_nested(ds) else rows


def _add_rows(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Advice]:
    rows = findings.ds.sizes["sample"]
    open_ones = [one for quantity in answered for one in unsettled(quantity)]
    if not open_ones or not rows:
        return
    worst = max(open_ones, key=lambda one: one.factor)
    more = f"; {len(open_ones) - 1} more are not settled" if len(open_ones) > 1 else ""
    yield Advice(
        "rows",
        f"Compute {_needed(worst, findings.ds)} instead of {grouped(rows)}: {worst.what}{more}.",
        rows=int(min(worst.factor, MOST) * rows) + 1,
    )
