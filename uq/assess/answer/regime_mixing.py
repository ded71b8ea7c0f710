"""Intermingled regimes: more accurate inputs hardly reduce the uncertainty of the outcome."""

from uq.assess.answer.wording import rounded, share_text
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.regime_boundary import compared_rows, still_uncertain
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.stats.uncertainty_exponent import uncertainty_exponent


def intermingled(exponent: Estimate, rows: Result | None = None) -> Fact:
    """Return how intermingled the regimes are; without members if their boundary may be smooth.

    Parameters
    ----------
    exponent : Estimate
        The uncertainty exponent of the boundary between them.
    rows : Result, optional
        The rows that it is computed from.

    Returns
    -------
    Fact
        ``uncertainty_exponent``, and ``left``: the share of uncertain outcomes that remain so if
        all inputs are known twice as well; both with ends.
    """
    if not (exponent.has_interval and exponent.high < 1):
        return Fact({})
    left = still_uncertain(exponent)
    text = (
        f"The regimes are intermingled: with all inputs known twice as well, {share_text(left)} of"
        " the uncertain outcomes would stay uncertain; between smooth boundaries, 50 %"
        f" (uncertainty exponent {rounded(exponent.value)})."
    )
    numbers = {
        f"{name}{end}": value
        for name, estimate in (("uncertainty_exponent", exponent), ("left", left))
        for end, value in zip(("", "_low", "_high"), estimate.numbers, strict=True)
    }
    mentions = (("left",),)
    return Fact({"sentence": text} | numbers, (uncertainty_exponent,), rows=rows, mentions=mentions)


def mixing(findings: Findings) -> Fact:
    """Return how intermingled the regimes of a result are."""
    boundary = findings.boundary
    if boundary is None:
        return Fact({})
    return intermingled(boundary.estimate, compared_rows(findings.result))
