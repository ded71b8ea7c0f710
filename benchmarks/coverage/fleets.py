"""Fleets: life = depth / rate, with a lognormal rate that units share and a depth of their own."""

import numpy as np
from scipy import special, stats
from scipy.optimize import brentq

from benchmarks.coverage.scaled import CAUTIOUS, LIFE, lognormal_term
from benchmarks.coverage.tally import Tally
from uq.assess.fleet_numbers import HIGH, LOW, FleetNumbers
from uq.assess.fleet_units import Units
from uq.assess.scale_laws import IndependentScale
from uq.result.element import Element
from uq.result.nesting import Nesting
from uq.stats.dependent_rows import INDEPENDENT
from uq.stats.importance_weights import smoothed

SAMPLES = 200
OWN, SHARED = 0.5, 0.5
"""Standard deviations of the logarithms of depth and rate."""

NODES = np.linspace(-8, 8, 8001)

CASES = {
    "units": (50, 50, False, False),
    "some-units": (50, 10, False, False),
    "exact": (1, 50, True, False),
    "exact-many": (1, 40_000, True, False),
    "weighted-units": (10, 5, False, True),
    "weighted-exact": (1, 50, True, True),
}
"""Units of each sample, units of the fleet, whether the depth is integrated, whether samples are
weighted from a wider law of the rate, shifted, to its own, as inspections weight them."""

WIDER, SHIFTED = 1.2, 0.3

BEYOND = "10 of 200 samples lie beyond such a point: their share is exact, and conservative"
REASONS = {
    "P(at most": CAUTIOUS,
    "number ended": CAUTIOUS,
    "median of the first, ": BEYOND,
}
OF_COUNTS = {
    f"{quantity}, {share} % of samples": "conservative where units are counted: whatever the law"
    for quantity in ("median of the first", "number ended", "P(at most 1)", "P(at most 5)")
    for share in (5, 95)
}


def given(time, z):
    """Return P(a unit ends before a time) in a world whose rate has this probit."""
    return special.ndtr((np.log(time) + SHARED * z) / OWN)


def over_worlds(function):
    """Return the mean over worlds."""
    return float(np.average(function(NODES), weights=np.exp(-(NODES**2) / 2)))


def first_by(time, size):
    """Return P(the first of a fleet ends before a time)."""
    return over_worlds(lambda z: -np.expm1(size * special.log_ndtr(-special.ndtri(given(time, z)))))


def weighted_normals(size, rng):
    """Return normals of a wider law, shifted, and their weights as standard ones."""
    z = SHIFTED + WIDER * rng.standard_normal(size)
    return z, smoothed((((z - SHIFTED) / WIDER) ** 2 - z**2) / 2).weights


COUNTED_SAMPLES, COUNTED_UNITS, COUNTED_SIZE, BY = 150, 20, 5, 0.3
LAWS = {
    "gamma": stats.gamma(3, scale=0.5),
    "Gumbel of the logarithm": stats.invweibull(1.5, scale=0.5),
    "uniform": stats.uniform(0.3, 2.0),
    "two values": stats.rv_discrete(values=([1, 3], [0.07, 0.93])),
}
"""Laws of a life's scale that units of a sample share; each has a Weibull life of shape 2."""


def other_laws(name, repetitions):
    """Count bands of counted units whose shared law is not lognormal."""
    law = LAWS[name]
    tally = Tally(f"fleet of {COUNTED_SIZE}, units counted, shared law: {name}", COUNTED)
    shape = (COUNTED_SAMPLES, COUNTED_UNITS)
    sample, unit = np.unravel_index(np.arange(shape[0] * shape[1]), shape)
    place = Nesting(*shape, 1, sample, unit, 0 * unit, np.zeros(shape[0], np.int64))
    rng = np.random.default_rng(11)
    for _ in range(repetitions):
        scale = law.rvs(size=(COUNTED_SAMPLES, 1), random_state=rng)
        life = (scale * rng.weibull(2.0, shape)).ravel()
        nothing = np.zeros(life.size, dtype=bool)
        element = Element("life", "life", LIFE, {}, life, nothing, nothing)
        units = Units(element, place, None, ("strength",))
        failed = FleetNumbers(units, COUNTED_SIZE, 0, INDEPENDENT, True).failed(BY)
        for end, share in (("low", LOW), ("high", HIGH)):
            truth = COUNTED_SIZE * -np.expm1(-((BY / law.ppf(1 - share)) ** 2))
            quantity = f"number ended, {100 * share:g} % of samples"
            tally.estimate(quantity, truth, getattr(failed, end))
    return tally.lines()


COUNTED = {"number ended": "conservative: what counts of units allow whatever the law over samples"}


def drawn(units, integrated, weighted, rng):
    """Return the units of random worlds."""
    shape = (SAMPLES, units)
    depth = OWN * rng.standard_normal(shape)
    rate, weights = rng.standard_normal(SAMPLES), None
    if weighted:
        rate, weights = weighted_normals(SAMPLES, rng)
    life = np.exp(depth - SHARED * rate[:, None]).ravel()
    nothing = np.zeros(life.size, dtype=bool)
    law = IndependentScale(("depth",), lognormal_term(OWN), depth.ravel()) if integrated else None
    element = Element("life", "life", LIFE, {}, life, nothing, nothing, law)
    sample, unit = np.unravel_index(np.arange(life.size), shape)
    place = Nesting(SAMPLES, units, 1, sample, unit, 0 * unit, np.zeros(SAMPLES, np.int64))
    varying = () if integrated else ("depth",)
    return Units(element, place, None, varying, of_worlds=weights)


def worlds_scaled(rest, rng, samples=100, units=10):
    """Return units whose rate is integrated, in worlds that share something else, too."""
    shape = (samples, units)
    rate, other = (
        np.broadcast_to(sigma * rng.standard_normal((samples, 1)), shape)
        for sigma in (SHARED, rest)
    )
    life = np.exp(OWN * rng.standard_normal(shape) - rate + other).ravel()
    nothing = np.zeros(life.size, dtype=bool)
    element = Element("life", "life", LIFE, {}, life, nothing, nothing)
    sample, unit = np.unravel_index(np.arange(life.size), shape)
    place = Nesting(samples, units, 1, sample, unit, 0 * unit, np.zeros(samples, np.int64))
    scale = IndependentScale(("rate",), lognormal_term(SHARED), -rate.ravel())
    return Units(element, place, scale, ("depth",))


def shared_scale(repetitions):
    """Count fleets where only what units share is integrated, and units are counted."""
    lines, size, allow, time = [], 5, 1, np.exp(-0.6)
    for rest in (0.0, 0.3):
        spread = np.hypot(SHARED, rest)

        def ended(z, spread=spread):
            return special.ndtr((np.log(time) + spread * z) / OWN)

        name = f"fleet of {size}, 100 samples of 10 units, a shared rate integrated"
        tally = Tally(name + f" and {rest:g} beside it" * bool(rest), REASONS | OF_COUNTS)
        rng = np.random.default_rng(3)
        for _ in range(repetitions):
            fleet = FleetNumbers(worlds_scaled(rest, rng), size, allow, INDEPENDENT, True)
            failed, kept = fleet.failed(time), fleet.at_most_allowed(time)
            tally.estimate("number ended", size * over_worlds(ended), failed.estimate)
            share = over_worlds(lambda z, p=ended: special.bdtr(allow, size, p(z)))
            tally.estimate(f"P(at most {allow})", share, kept.estimate)
            for end, share in (("low", LOW), ("high", HIGH)):
                text = f"{100 * share:g} % of samples"
                z = stats.norm.ppf(share)
                tally.estimate(f"number ended, {text}", size * ended(z), getattr(failed, end))
                least = special.bdtr(allow, size, ended(-z))
                tally.estimate(f"P(at most {allow}), {text}", least, getattr(kept, end))
        lines += tally.lines()
    return lines


def fleets(name, repetitions):
    """Count what `uq fleet` reports."""
    units, size, integrated, weighted = CASES[name]
    how = "depth integrated" if integrated else f"of {units} units"
    how += ", weighted" * weighted
    tally = Tally(f"fleet of {size}, {SAMPLES} samples, {how}", REASONS | OF_COUNTS)
    middle = brentq(lambda x: first_by(np.exp(x), size) - 0.5, -8, 2)
    time, allow = np.exp(middle + 0.3), size // 10
    z = {share: stats.norm.ppf(share) for share in (LOW, HIGH)}
    reached = -np.expm1(np.log(0.5) / size)
    rng = np.random.default_rng(7)
    for _ in range(repetitions):
        fleet = FleetNumbers(
            drawn(units, integrated, weighted, rng), size, allow, INDEPENDENT, True
        )
        first, failed, kept = fleet.first(0.5), fleet.failed(time), fleet.at_most_allowed(time)
        tally.estimate("median of the first", np.exp(middle), first.estimate)
        mean = over_worlds(lambda z: given(time, z))
        tally.estimate("number ended", size * mean, failed.estimate)
        share = over_worlds(lambda z: special.bdtr(allow, size, given(time, z)))
        tally.estimate(f"P(at most {allow})", share, kept.estimate)
        for end, share in (("low", LOW), ("high", HIGH)):
            text = f"{100 * share:g} % of samples"
            alone = np.exp(OWN * special.ndtri(reached) + SHARED * z[share])
            tally.estimate(f"median of the first, {text}", alone, getattr(first, end))
            tally.estimate(
                f"number ended, {text}", size * given(time, z[share]), getattr(failed, end)
            )
            least = special.bdtr(allow, size, given(time, -z[share]))
            tally.estimate(f"P(at most {allow}), {text}", least, getattr(kept, end))
    return tally.lines()
