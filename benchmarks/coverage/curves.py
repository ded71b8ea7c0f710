"""Fits of the wrong law, and bands for whole survival curves."""

import numpy as np
from scipy import stats

from benchmarks.coverage.lives import FIT_ROWS, with_life
from benchmarks.coverage.tally import Tally
from uq.analysis.life_fit import fits_of
from uq.analysis.life_quantiles import B_LIVES
from uq.analysis.lifetime import survival
from uq.rows.elements import elements_of

EARLY = 0.05
"""Share of lives that end by infant mortality."""


class _Infant:
    """Weibull lives of which some end early."""

    early, late = stats.expon(scale=0.02), stats.weibull_min(3.0)

    def rvs(self, size, random_state):
        soon = random_state.random(size) < EARLY
        parts = (one.rvs(size, random_state=random_state) for one in (self.early, self.late))
        return np.where(soon, *parts)

    def ppf(self, p):
        time = np.geomspace(1e-6, 10, 200_001)
        return np.interp(p, EARLY * self.early.cdf(time) + (1 - EARLY) * self.late.cdf(time), time)


WRONG = {"gamma life, shape 2": stats.gamma(2.0), "life with 5 % infant mortality": _Infant()}


def wrong_fits(repetitions):
    """Count the B-lives of a wrong law, where it is not rejected."""
    lines = []
    for name, law in WRONG.items():
        tally = Tally(f"{name}, {FIT_ROWS} independent rows", REASONS)
        rng = np.random.default_rng(1)
        for _ in range(repetitions):
            ds = with_life(law.rvs(FIT_ROWS, random_state=rng))
            for family, fit in fits_of(*elements_of(ds, ["life"]), independent=True).items():
                tally.add(f"{family} refused", 1.0, 1.0, 2.0 if fit.refused else 0.0)
                if not fit.refused:
                    for label, p in B_LIVES.items():
                        marked = ", extrapolated" * (label in fit.extrapolated)
                        found = fit.b_lives[label]
                        tally.estimate(f"{label} of {family}{marked}", law.ppf(p), found)
        lines += tally.lines()
    return lines


WEIBULL = stats.weibull_min(2.0)


def bands(repetitions):
    """Count the bands that contain the entire curve, up to where they end."""
    lines = []
    for never, censored in ((0.0, False), (0.6, False), (0.0, True), (0.6, True)):
        for rows in (100, 500):
            how = f"{never:.0%} never end, " * bool(never)
            how += "others censored" if censored else "none censored"
            reason = {"survival": HALF_SEEN} if never and not censored else None
            tally = Tally(f"Weibull life, {how}, {rows} independent rows", reason)
            rng = np.random.default_rng(rows)
            for _ in range(repetitions):
                life = WEIBULL.rvs(rows, random_state=rng)
                left = rng.exponential(1.5, rows) if censored else np.full(rows, np.inf)
                ends = rng.random(rows) >= never
                values = np.where(ends, np.minimum(life, left), np.inf)
                curve = survival(with_life(values, ends & (left < life)), "life")
                held = _holds(curve, lambda t, never=never: never + (1 - never) * WEIBULL.sf(t))
                tally.add("survival, whole curve", 1.0, 1.0, 2.0 if held else 0.0)
            lines += tally.lines()
    return lines


HALF_SEEN = (
    "conservative: Kolmogorov's law describes the largest deviation over the entire distribution,"
    " of which only 40 % is finite"
)


def _holds(curve, truth):
    low, high, of_time = (curve[name].values for name in ("band_low", "band_high", "time"))
    known, true = np.isfinite(low), truth(of_time)
    at = (low <= true) & (true <= high)
    before_next = (low[:-1] <= true[1:]) & (true[1:] <= high[:-1])
    return bool(at[known].all() and before_next[known[:-1] & known[1:]].all())


LAW_ALONE = (
    "wrong law: below 1/61 its B1 comes from the law alone, is marked `extrapolated`, and is shown"
    " beside that of the other law"
)
REASONS = {
    "B": "wrong law, which 60 rows cannot detect",
    **{f"B1 of {law}, extrapolated": LAW_ALONE for law in ("weibull", "lognormal")},
    "weibull refused": "60 rows do not always distinguish the laws",
    "lognormal refused": "60 rows do not always distinguish the laws",
}
