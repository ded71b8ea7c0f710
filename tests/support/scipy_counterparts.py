"""Laws of inputs as `scipy.stats` has them, to compare their functions and moments with."""

from math import exp, log, log1p, sqrt

import numpy as np
from scipy import stats

from uq.sampling.listed_values import Steps
from uq.sampling.scipy_laws import PAIRS


def _lognormal(law):
    if law.mean is None:
        return stats.lognorm(s=law.sigma, scale=law.median)
    variance = log1p(law.cv * law.cv)
    return stats.lognorm(s=sqrt(variance), scale=exp(log(law.mean) - variance / 2))


COUNTERPARTS = {
    "uniform": lambda law: stats.uniform(loc=law.lower, scale=law.upper - law.lower),
    "loguniform": lambda law: stats.loguniform(a=law.lower, b=law.upper),
    "normal": lambda law: stats.norm(loc=law.mean, scale=law.sd),
    "truncated-normal": lambda law: stats.truncnorm(
        a=(law.lower - law.mean) / law.sd,
        b=(law.upper - law.mean) / law.sd,
        loc=law.mean,
        scale=law.sd,
    ),
    "lognormal": _lognormal,
    "wear-coefficient": lambda law: stats.lognorm(s=law.sigma, scale=law.share * PAIRS[law.pair]),
}


def of_scipy(law):
    """Return a law, before `truncate`, as a frozen distribution with moments."""
    if counterpart := COUNTERPARTS.get(law.distribution):
        return counterpart(law)
    frozen = law.frozen()
    if isinstance(frozen, Steps):
        shares = np.diff(frozen.cumulated, prepend=0.0)
        return stats.rv_discrete(values=(frozen.values, shares))
    return frozen
