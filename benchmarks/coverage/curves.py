"""Fits of the wrong law, and bands for whole survival curves."""

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from benchmarks.coverage.lives import FIT_ROWS, with_life
from benchmarks.coverage.tally import Tally
from uq.assess.life_fit import fits_of
from uq.assess.statistics.quantiles import B_LIVES
from uq.assess.survival import survival
from uq.result.elements import elements_of
from uq.stats.location_scale import FAMILIES

EARLY = 0.05
"""Share of lives that end by infant mortality."""


class _Infant:
    """Weibull lives of which some end early."""

    early, late = stats.expon(scale=0.02), stats.weibull_min(3.0)

    def rvs(self, size, random_state):
        soon = random_state.random(size) < EARLY
        parts = (law.rvs(size, random_state=random_state) for law in (self.early, self.late))
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
            element = next(elements_of(ds, ["life"]))
            for family, fit in fits_of(element, independent=True, laws=[*FAMILIES]).items():
                tally.add(f"{family} refused", 1.0, 1.0, 2.0 if fit.refused else 0.0)
                if not fit.refused:
                    for label, p in B_LIVES.items():
                        marked = ", extrapolated" * (label in fit.extrapolated)
                        estimate = fit.b_lives[label]
                        tally.estimate(f"{label} of {family}{marked}", law.ppf(p), estimate)
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
            tally = Tally(f"Weibull life, {how}, {rows} independent rows")
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


# Laws of the time at which rows leave; the scale gives the share of censored rows.
LEAVING = {
    "exponentially": stats.expon(),
    "early": stats.weibull_min(0.5),
    "all at one time": stats.uniform(1.0, 1e-9),
}
CENSORED = (0.5, 0.8, 0.95)


def censored_bands(rows, repetitions):
    """Count bands and pointwise intervals where most rows are censored."""
    lines = []
    for how, law in LEAVING.items():
        for share in CENSORED:
            name = f"Weibull life, {share:.0%} censored, leaving {how}, {rows} independent rows"
            tally = Tally(name, {"survival": FEW_ENDS, "S(": FEW_AT_RISK})
            rng = np.random.default_rng(rows)
            scale = _scale(law, share)
            times = _times_seen(law, scale)
            for _ in range(repetitions):
                life = WEIBULL.rvs(rows, random_state=rng)
                left = scale * law.rvs(rows, random_state=rng)
                curve = survival(with_life(np.minimum(life, left), left < life), "life")
                if np.isfinite(curve["band_low"]).any():
                    held = _holds(curve, WEIBULL.sf)
                    tally.add("survival, whole curve", 1.0, 1.0, 2.0 if held else 0.0)
                _count_at(tally, curve, times)
            lines += tally.lines()
    return lines


def _scale(law, share):
    """Return the scale of the times of leaving at which a share of rows is censored."""
    left = law.ppf((np.arange(2000) + 0.5) / 2000)
    return np.exp(brentq(lambda x: np.mean(WEIBULL.sf(np.exp(x) * left)) - share, -20, 20))


def _times_seen(law, scale):
    """Return times by which 30, 80 and 95 % of the ends that are seen have come."""
    time = np.linspace(0, 4, 40_001)
    seen = WEIBULL.pdf(time) * law.sf(time / scale)
    ended = np.cumsum(seen) / seen.sum()
    return {share: time[np.searchsorted(ended, share)] for share in (0.3, 0.8, 0.95)}


def _count_at(tally, curve, times):
    """Count pointwise intervals; before the first end there is none, and the last time is open."""
    for share, time in times.items():
        place = int(np.searchsorted(curve["time"].values, time, side="right")) - 1
        if place == curve.sizes["time"] - 1:
            continue
        low, high = (float(curve[name][max(place, 0)]) for name in ("low", "high"))
        held = place < 0 or np.isnan(low) or low <= WEIBULL.sf(time) <= high
        quantity = f"S(t), {share:.0%} of ends seen by t, held or before the first end"
        tally.add(quantity, 1.0, 1.0, 2.0 if held else 0.0)


FEW_ENDS = "few ends: counts are discrete; without any, no band"
FEW_AT_RISK = "few ends or few rows at risk: counts are discrete, beta products conservative"


def _holds(curve, truth):
    low, high, of_time = (curve[name].values for name in ("band_low", "band_high", "time"))
    finite, true = np.isfinite(low), truth(of_time)
    at = (low <= true) & (true <= high)
    before_next = (low[:-1] <= true[1:]) & (true[1:] <= high[:-1])
    return bool(at[finite].all() and before_next[finite[:-1] & finite[1:]].all())


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
