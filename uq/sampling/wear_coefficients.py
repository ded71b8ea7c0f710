"""Published wear coefficients of pairs of materials, as a law that a study refers to by name.

They belong to the work-rate of sliding. That of impacts wears less per joule, by a factor that is
as uncertain as the coefficient itself.
"""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

from uq.errors import nearest
from uq.sampling.law import Law, Positive
from uq.sampling.scipy_laws import LogNormalLaw

PAIRS = {
    "inconel-600/inconel-600": 1.2e-13,
    "inconel-600tt/inconel-600tt": 1.4e-15,
    "inconel-600/steel-405": 6.2e-14,
    "inconel-690/steel-405": 4.1e-16,
    "inconel-600/z10c13": 9.9e-14,
    "inconel-690/z6c13": 7.7e-15,
    "steel-304l/steel-304l-guide": 1e-14,
    "steel-304l-guide/steel-304l": 1.5e-14,
    "steel-316l/steel-304l": 1e-14,
    "steel-304l/steel-316l": 5e-15,
    "chromed/steel": 1e-16,
    "steel/chromed": 5e-14,
    "inconel-600/steel-304-cold-water": 9.3e-15,
    "inconel-690/steel-304-cold-water": 1.62e-14,
}
"""Worn body/counter-body -> wear coefficient [m2 N-1], as the data bank of Code_Aster states it."""


def _known_pair(pair: str) -> str:
    if pair not in PAIRS:
        problem = f"no such pair of materials{nearest(pair, PAIRS)}"
        raise ValueError(f"{problem} (worn body/counter-body: {', '.join(PAIRS)})")
    return pair


class WearCoefficient(Law):
    """Lognormal about the published wear coefficient of a pair of materials, never pooled."""

    unit: ClassVar[str] = "m2 N-1"
    pure = ("sigma", "share")

    distribution: Literal["wear-coefficient"]
    pair: Annotated[str, AfterValidator(_known_pair)] = Field(
        description="worn body/counter-body", json_schema_extra={"enum": list(PAIRS)}
    )
    sigma: Positive = Field(1.0, description="standard deviation of the logarithm; 1 is assumed")
    share: Positive = Field(
        1.0, description="wear per joule of impacts over that of sliding; 0.05 to 0.5 are plausible"
    )
    source: str = Field(
        "assumed: lognormal about the value of Code_Aster's data bank, of sliding work-rate",
        description="where the numbers come from; shown in every result",
    )

    def frozen(self) -> Any:
        """Return the law before truncation, of a coefficient in m2 N-1."""
        return LogNormalLaw(self.share * PAIRS[self.pair], self.sigma)
