"""The answer of a study, computed once from what is known of its result."""

from collections.abc import Iterator
from weakref import WeakKeyDictionary

import xarray as xr

from uq.analysis.findings import Findings
from uq.analysis.summary import REGIME
from uq.conclusions.advice import advise
from uq.conclusions.parts import Answer, Event
from uq.conclusions.quantities import event, quantities
from uq.rows.elements import analysis_of
from uq.rows.results import failed


def answer(ds: xr.Dataset) -> Answer:
    """Say what can be promised, what it depends on, and what to do.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.

    Returns
    -------
    Answer
        Displays itself; its parts hold the numbers behind each sentence.

    Examples
    --------
    >>> found = uq.answer(uq.run("studies/exponential-wear.toml"))
    >>> found.lead.promise.lower < found.lead.range.low.value  # a cautious bound
    True
    """
    return conclude(Findings(ds))


_KNOWN: WeakKeyDictionary[Findings, dict[bool, Answer]] = WeakKeyDictionary()


def conclude(findings: Findings, weighed: bool = True) -> Answer:
    """Return the answer from what is known of a result, computed once.

    Parameters
    ----------
    findings : Findings
    weighed : bool
        As for `advise`. Weighing takes half a second, most of it for loading scipy.stats.
    """
    known = _KNOWN.setdefault(findings, {})
    if weighed not in known:
        known[weighed] = _concluded(findings, weighed)
    return known[weighed]


def _concluded(findings: Findings, weighed: bool) -> Answer:
    ds = findings.ds
    found = tuple(quantities(findings)) if findings.rows.sizes["sample"] else ()
    regimes = tuple(regimes_of(findings))
    return Answer(
        str(ds.attrs["title"]),
        ds.sizes["sample"],
        int(failed(ds).sum()),
        found,
        regimes,
        tuple(advise(findings, found, weighed)),
        tuple(findings.summary.notes),
        regimes_first=bool(regimes) and analysis_of(ds).outputs[:1] == (REGIME,),
    )


def regimes_of(findings: Findings) -> Iterator[Event]:
    """Yield the regimes that occur, the most frequent first; one alone needs no words."""
    shares = [one for one in findings.summary.regimes.values() if one.facts["count"]]
    for one in sorted(shares, key=lambda one: -one.facts["count"]) * (len(shares) > 1):
        yield event(findings, f"P(regime={one.label})", one.label, one)
