"""The law of a life in each row, of which an input is integrated as inspections leave it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import special

from uq.contract import Floats
from uq.rows.weights import SCALE_QUANTILES

SCORES = np.concatenate([[-8.0], np.linspace(-4.0, 4.0, 25), [8.0]])
"""Standard normal quantiles at which the law of the input is kept."""


@dataclass(frozen=True)
class LearntScale:
    """An input that scales lives, given the inspections and all else in a row.

    Attributes
    ----------
    inputs : tuple of str
        Its name.
    exponent : float
    drawn : ndarray, shape (n,)
        The values of the rows.
    quantiles : ndarray, shape (n, q)
        Of its law in each row, at `SCORES`; the score is linear in their logarithms between them,
        and nothing lies beyond the first and last.
    """

    inputs: tuple[str, ...]
    exponent: float
    drawn: Floats
    quantiles: Floats

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithms of lives that it causes."""
        return float(abs(self.exponent) * np.log(self.drawn).std())

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,)."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            share = self._below(self.drawn * (time / lives) ** (1 / self.exponent))
        if self.exponent < 0:
            share = 1 - share
        return np.where(np.isnan(lives), 0.0, share)

    def _below(self, values: Floats) -> Floats:
        """Return the probability that the input of each row lies below a value."""
        count = (self.quantiles <= values[:, None]).sum(axis=1)
        after = np.clip(count, 1, len(SCORES) - 1)
        low, high = (
            np.take_along_axis(self.quantiles, i[:, None], 1)[:, 0] for i in (after - 1, after)
        )
        part = np.log(values / low) / np.log(high / low)
        score = SCORES[after - 1] + part * (SCORES[after] - SCORES[after - 1])
        inside = (count > 0) & (count < len(SCORES))
        return np.where(inside, special.ndtr(score), (count > 0).astype(float))


def learnt_scale(rows: xr.Dataset, exponents: Mapping[str, float]) -> LearntScale | None:
    """Return the law that inspections left of the input that is integrated, if it scales lives.

    Parameters
    ----------
    rows : xarray.Dataset
        Of one inspected unit, or others: these have none.
    exponents : dict of str to float
        Of the inputs that only scale these lives.
    """
    name = learnt_input(rows)
    if name not in exponents:
        return None
    return LearntScale((name,), exponents[name], rows[name].values, rows[SCALE_QUANTILES].values)


def learnt_input(rows: xr.Dataset) -> str:
    """Return the input whose law in each row the inspections of a unit left, or ""."""
    return str(rows[SCALE_QUANTILES].attrs["input"]) if SCALE_QUANTILES in rows else ""
