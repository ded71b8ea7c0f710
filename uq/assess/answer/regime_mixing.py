"""Intermingled regimes: more accurate inputs hardly reduce the uncertainty of the outcome."""

from dataclasses import dataclass

from uq.assess.answer.wording import rounded, share_text
from uq.assess.findings import Findings
from uq.assess.regime_boundary import still_uncertain
from uq.stats.estimate import NOTHING, Estimate


@dataclass(frozen=True)
class Intermingled:
    """How intermingled the regimes are.

    Attributes
    ----------
    exponent : Estimate
        The uncertainty exponent of the boundary between them; without a number if unknown.
    """

    exponent: Estimate = NOTHING

    @property
    def left(self) -> Estimate:
        """Share of uncertain outcomes that remain so if all inputs are known twice as well."""
        return still_uncertain(self.exponent)

    @property
    def sentence(self) -> str:
        """Sentence on intermingled regimes; "" if the boundary may be smooth."""
        if not (self.exponent.has_interval and self.exponent.high < 1):
            return ""
        left = share_text(self.left)
        return (
            f"The regimes are intermingled: with all inputs known twice as well, {left} of the"
            " uncertain outcomes would stay uncertain; between smooth boundaries, 50 %"
            f" (uncertainty exponent {rounded(self.exponent.value)})."
        )


def intermingled(findings: Findings) -> Intermingled:
    """Return how intermingled the regimes of a result are."""
    boundary = findings.boundary
    return Intermingled() if boundary is None else Intermingled(boundary.estimate)
