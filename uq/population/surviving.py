"""The law of a life in each row, given that it has not ended by some time."""

from dataclasses import dataclass

import numpy as np

from uq.contract import Floats
from uq.rows.element import RowLaw


@dataclass(frozen=True)
class Surviving:
    """The law of lives that outlast a time.

    Attributes
    ----------
    law : RowLaw
        Of all lives.
    gone : ndarray, shape (n,)
        The probability of each row that its life has ended by then.
    """

    law: RowLaw
    gone: Floats

    @property
    def inputs(self) -> tuple[str, ...]:
        """What it integrates."""
        return self.law.inputs

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of all lives that this causes."""
        return self.law.spread

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,); 0 where no life outlasts that time."""
        more = np.maximum(self.law.below(lives, time) - self.gone, 0.0)
        with np.errstate(invalid="ignore"):
            return np.where(self.gone < 1, more / (1 - self.gone), 0.0)
