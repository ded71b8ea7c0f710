"""The depth worn by a time, between the depths whose lives a result has."""

from dataclasses import dataclass

import numpy as np

from uq.contract import Floats, Mask

_BETWEEN = 16
"""Places between two declared depths at which the monotone curve is tabulated."""


@dataclass(frozen=True)
class WornDepths:
    """Worn depth of each row as a function of time.

    The time to a depth is interpolated monotonically in the depth, from none at the beginning, and
    continued straight beyond the last depth. Between the last depth that a row reaches and the
    next, which it never reaches, it stays at the former.

    Parameters
    ----------
    depths : ndarray, shape (k,)
        Ascending, positive.
    lives : ndarray, shape (n, k)
        Time until each row reaches each depth; infinite where it never does, NaN where the row
        has none.
    """

    depths: Floats
    lives: Floats

    def at(self, time: Floats) -> Floats:
        """Return the depth of each row at its times.

        Parameters
        ----------
        time : ndarray, shape (n, g)
            In the unit of the lives.

        Returns
        -------
        ndarray, shape (n, g)
            NaN where a row has no life.
        """
        grid, curves = self._curves()
        depth = np.full(time.shape, np.nan)
        for row in np.flatnonzero(~np.isnan(self.lives).any(axis=1)):
            finite = np.isfinite(curves[row])
            depth[row] = np.interp(time[row], curves[row, finite], grid[finite])
            if finite.all():
                slope = (grid[-1] - grid[-2]) / (curves[row, -1] - curves[row, -2])
                later = np.maximum(time[row] - curves[row, -1], 0.0)
                depth[row] += later * slope
        return depth

    @property
    def settled(self) -> Mask:
        """Whether each row's wear stops before the last depth, shape (n,)."""
        return np.asarray(np.isposinf(self.lives).any(axis=1))

    def error(self) -> Floats:
        """Return how wrong each row is about a depth left out, relative, shape (n,).

        Of the depth between the first and the last at which it is worst; NaN with fewer than
        three depths, or where not all are reached.
        """
        worst = np.full(len(self.lives), np.nan)
        whole = np.isfinite(self.lives).all(axis=1)
        for place in range(len(self.depths) - 1):
            others = WornDepths(np.delete(self.depths, place), np.delete(self.lives, place, axis=1))
            guess = others.at(self.lives[:, place : place + 1])[:, 0]
            off = np.abs(guess / self.depths[place] - 1)
            worst[whole] = np.fmax(worst, off)[whole]
        return worst

    def _curves(self) -> tuple[Floats, Floats]:
        """Return depths and the time of each row to each of them."""
        from scipy.interpolate import PchipInterpolator

        ends = np.concatenate([[0.0], self.depths])
        grid = np.unique(
            np.concatenate(
                [np.linspace(a, b, _BETWEEN + 1) for a, b in zip(ends, ends[1:], strict=False)]
            )
        )
        curves = np.full((len(self.lives), len(grid)), np.inf)
        reached = np.isfinite(self.lives).sum(axis=1)
        for count in np.unique(reached):
            rows = reached == count
            upto = grid <= ends[count]
            times = np.column_stack([np.zeros(rows.sum()), self.lives[rows, :count]])
            if count:
                curve = PchipInterpolator(ends[: count + 1], times, axis=1)(grid[upto])
                curves[np.ix_(rows, upto)] = curve
            else:
                curves[rows, 0] = 0.0
        return grid, curves
