"""Means and standard deviations of laws with light tails and heavy ones."""

import numpy as np
from scipy import stats

from benchmarks.coverage.tally import Tally
from uq.stats.dependent_rows import Dependence
from uq.stats.moments import moments

PARETO = {1.5: "Pareto, index 1.5: no variance", 0.8: "Pareto, index 0.8: no mean"}
LAWS = {
    "normal": stats.norm(),
    "uniform": stats.uniform(),
    "exponential": stats.expon(),
    "lognormal, sigma 0.5": stats.lognorm(0.5),
    "lognormal, sigma 1": stats.lognorm(1.0),
    "Weibull, shape 0.7": stats.weibull_min(0.7),
    "Pareto, index 6": stats.pareto(6),
}
HELD = "mean, held or refused"
CAUTIONED = "mean, held, refused or with a caution"
MEANS = [
    *((PARETO[1.5], stats.pareto(1.5), rows) for rows in (200, 1000, 10_000)),
    *((PARETO[0.8], stats.pareto(0.8), rows) for rows in (200, 1000)),
    *(("lognormal, sigma 1", LAWS["lognormal, sigma 1"], rows) for rows in (100, 200, 1000)),
    *(("gamma, shape 0.2", stats.gamma(0.2), rows) for rows in (100, 300)),
]


def means(repetitions):
    """Count the mean's interval, and how often it is refused."""
    lines = []
    for name, law, rows in MEANS:
        tally = Tally(f"{name}, {rows} independent rows", REASONS.get((name, rows)))
        for computed in _moments_of(law, rows, repetitions):
            refused = bool(computed.mean.reason)
            _count(tally, "mean", law.mean(), computed.mean, refused)
            open_ = refused or computed.caution is not None
            tally.add(CAUTIONED, 1.0, *_held(law.mean(), computed.mean, open_))
        lines += tally.lines()
    return lines


def scatters(repetitions):
    """Count the interval of the standard deviation, and how often it is refused."""
    lines = []
    for name, law in LAWS.items():
        for rows, replicates in ((64, 1), (200, 1), (1000, 1), (125, 8)):
            how = f"{rows} independent rows" if replicates == 1 else LATIN
            tally = Tally(f"{name}, {how}", REASONS.get((name, rows)))
            for computed in _moments_of(law, rows, repetitions, replicates):
                refused = bool(computed.sd.reason)
                _count(tally, "sd", law.std(), computed.sd, refused)
            lines += tally.lines()
    return lines


LATIN = "latin-hypercube of one input, 8 replicates of 125 rows"


def _moments_of(law, rows, repetitions, replicates=1):
    """Yield the moments of samples of a law, once for each repetition."""
    rng = np.random.default_rng(rows)
    replicate = np.repeat(np.arange(replicates), rows)
    for _ in range(repetitions):
        share = rng.random((replicates, rows))
        if replicates == 1:
            yield moments(law.ppf(share).ravel())
            continue
        share = (np.arange(rows) + share) / rows  # a row in each slice of each replicate
        values, inputs = law.ppf(share).ravel(), share.reshape(-1, 1)
        yield moments(values, Dependence(replicate, inputs))


def _count(tally, quantity, truth, interval, refused):
    tally.add(quantity, truth, interval.low, interval.high)
    tally.add(f"{quantity}, held or refused", 1.0, *_held(truth, interval, refused))


def _held(truth, interval, excused):
    """Return an interval that contains 1 if the given one contains the truth or is excused."""
    held = excused or interval.low <= truth <= interval.high
    return 1.0, 2.0 if held else 0.0


LEFT = "given only where the tail does not appear heavy, hence for samples without extreme values"
REFUSED = "refused in nearly all samples"
FEW = "200 rows distinguish such a law from a lognormal one in only 45 % of samples"
RAISED = "conservative: the upper end allows for more rows as extreme as the most extreme"
FARTHER = "conservative: the end on the side of the farther tail allows for two more outliers"
FEW_IN_REPLICATES = "replicates of 125 rows of a law with so heavy a tail seldom show the outliers"
FEW_OUTLIERS = "200 rows of a law with so heavy a tail seldom show the outliers that decide"
HELD_SD = "sd, held or refused"
REASONS = {
    **{
        (name, rows): {"mean": LEFT, HELD: REFUSED, CAUTIONED: REFUSED}
        for name, _, rows in MEANS
        if "Pareto" in name
    },
    (PARETO[1.5], 200): {"mean": LEFT, HELD: FEW},
    **{(name, rows): {"sd": RAISED} for name in LAWS for rows in (64, 125, 200, 1000)},
    **{(name, 64): {HELD_SD: REFUSED} for name in LAWS},
    ("lognormal, sigma 1", 200): {"mean": FARTHER, "sd": FEW_OUTLIERS, HELD_SD: FEW_OUTLIERS},
    ("lognormal, sigma 1", 125): {"sd": FEW_IN_REPLICATES, HELD_SD: FEW_IN_REPLICATES},
    **{("gamma, shape 0.2", rows): {"mean": FARTHER} for rows in (100, 300)},
}
"""Law and rows -> quantity -> why its coverage is not 95 %."""
