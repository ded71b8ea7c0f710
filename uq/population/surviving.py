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
    seen : float
        The time [s].
    """

    law: RowLaw
    seen: float

    @property
    def inputs(self) -> tuple[str, ...]:
        """What it integrates."""
        return self.law.inputs

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of all lives that this causes."""
        return self.law.spread

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) given T > `seen` of each row, shape (n,); 0 where T cannot be."""
        gone, by = self.law.below(lives, self.seen), self.law.below(lives, max(time, self.seen))
        with np.errstate(invalid="ignore"):
            return np.where(gone < 1, (by - gone) / (1 - gone), 0.0)
