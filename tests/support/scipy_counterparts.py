"""Laws of inputs as `scipy.stats` has them, to compare their functions and moments with."""

from math import exp, log, log1p, sqrt

from scipy import stats


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
}


def of_scipy(law):
    """Return a law, before `truncate`, as a frozen distribution with moments."""
    counterpart = COUNTERPARTS.get(law.distribution)
    return counterpart(law) if counterpart else law.frozen()
