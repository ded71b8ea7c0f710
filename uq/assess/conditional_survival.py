"""The law of a life in each row, given that it has not ended by some time."""

from dataclasses import dataclass

import numpy as np

from uq.assess.posterior_scale import LearntScale
from uq.contract import Floats
from uq.result.element import RowLaw


@dataclass(frozen=True)
class Surviving:
    """The law of lives that outlast a time.

    Attributes
    ----------
    law : RowLaw
        Of all lives.
    gone : ndarray, shape (n,)
        The probability of each row that its life has ended by then.
    since : float
        That time.
    """

    law: RowLaw
    gone: Floats
    since: float

    @property
    def inputs(self) -> tuple[str, ...]:
        """Inputs that are integrated."""
        return self.law.inputs

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives due to the integrated inputs."""
        return self.law.spread

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,); 0 where no life outlasts that time."""
        more = np.maximum(self.law.below(lives, time) - self.gone, 0.0)
        with np.errstate(invalid="ignore"):
            return np.where(self.gone < 1, more / (1 - self.gone), 0.0)


def learnt_terms(law: RowLaw | None, lives: Floats, time: float) -> tuple[Floats, Floats] | None:
    """Return the means of Legendre terms of a shared input in each row, or None without one.

    Parameters
    ----------
    law : RowLaw or None
    lives : ndarray, shape (n,)
    time : float

    Returns
    -------
    tuple of ndarray, shape (n, terms), or None
        The means over the law of each row of the terms (`uq.stats.clusters.SharedInfluence`), and
        of the terms times whether T < time.
    """
    if isinstance(law, LearntScale) and law.terms is not None:
        return law.terms.means, law.terms_below(lives, time, law.terms)
    if not isinstance(law, Surviving):
        return None
    earlier, all_by = (learnt_terms(law.law, lives, at) for at in (law.since, time))
    if earlier is None or all_by is None:
        return None
    left = np.maximum(1 - law.gone, 1e-300)[:, None]
    by = np.where(law.gone[:, None] < 1, (all_by[1] - earlier[1]) / left, 0.0)
    return np.where(law.gone[:, None] < 1, (earlier[0] - earlier[1]) / left, 0.0), by
