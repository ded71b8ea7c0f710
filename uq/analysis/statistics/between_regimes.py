"""The share of the variance that lies between the regimes."""

from collections.abc import Iterator
from math import isfinite

from uq.analysis.regime_split import between_share
from uq.analysis.statistics.statistic import JSON, REPORT, TERMINAL, Context, Kind, Statistic
from uq.indices.targets import number_of
from uq.rows.elements import Element, output_names
from uq.wording import number


def _shown(share: float) -> str:
    """Return the share in words; it is corrected for chance, so it may be negative."""
    return number(share) if share > 0 else "none seen"


_KIND = Kind(shown=_shown, readers=frozenset((JSON, TERMINAL, REPORT)))


def between_regimes(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the share of the variance between regimes, of a life by its logarithm or rank."""
    target = number_of(element)
    if "regime" not in output_names(context.rows) or target.refused:
        return
    codes = context.rows["regime"].values
    split = between_share(target.values, codes, context.replicate)
    if isfinite(split.value):
        label = "variance between regimes"
        yield Statistic(("between_regimes",), label, split, kind=_KIND, of=target.name)
