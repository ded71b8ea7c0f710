"""What is wrong with what an answer says of levels and of its rows: the rows deny it."""

import re

import numpy as np
from answered import numbers_in
from scipy.stats import binomtest

import uq
from uq.assess.answer.repeat_interval import found_again


def denied_levels(ds, conclusions):
    """Compare shares with those of `uq.levels`, and count the repeats that end elsewhere."""
    if (levels := conclusions.levels) is None:
        return
    shares = uq.levels(ds)["share"].sel(output=levels.target)
    computed_shares = [100 * float(shares.sel(level=level.name)) for level in levels.levels]
    shown = [float(share) for share in re.findall(r"([\d.]+) % \(", levels.sentence)]
    if not np.allclose(shown, computed_shares, atol=0.06):
        yield levels.sentence
    several = [level.share for level in levels.levels]
    if not all(0 <= estimate.low <= estimate.value <= estimate.high <= 1 for estimate in several):
        yield f"interval of {levels.sentence}"
    if len(several) == 2:  # what is not on one level is on the other
        first, last = several
        if not np.allclose((first.low, first.high), (1 - last.high, 1 - last.low), atol=0.02):
            yield f"intervals of {levels.sentence}"
    if levels.switching:
        switches = uq.levels(ds)["another_regime"].values
        exact = binomtest(round(switches.sum()), len(switches)).proportion_ci()
        expected = [100 * switches.mean(), 100 * exact.low, 100 * exact.high]
        if not np.allclose(numbers_in(levels.switching)[:3], expected, atol=2.5):
            yield levels.switching


def denied_mixing(ds, conclusions):
    """Compare what better known inputs would save with the exponent of the table of regimes."""
    if not (sentence := conclusions.mixing.sentence):
        return
    table = uq.regimes(ds)
    names = ("uncertainty_exponent", "uncertainty_exponent_low", "uncertainty_exponent_high")
    exponents = [float(table[name]) for name in names]
    value, high, low = (100 * 2 ** -min(max(exponent, 0.0), 1.0) for exponent in exponents)
    if exponents[2] >= 1 or not np.allclose(
        numbers_in(sentence), [value, low, high, 50, exponents[0]], atol=0.06, rtol=0.01
    ):
        yield sentence


def denied_enough(ds, conclusions):
    """Compare what another seed would find and the errors with those of the rows."""
    sufficiency, lead = conclusions.enough, conclusions.lead
    if conclusions.regimes_first:
        low, high = found_again(conclusions.regimes[0].share, False)
        expected = sufficiency.again.members.get("expected")
        if expected and not np.allclose((expected["low"], expected["high"]), (low, high)):
            yield sufficiency.sentence
    elif lead is not None and sufficiency.again.members != lead.repeated.members:
        yield sufficiency.sentence
    if sufficiency.errors is not None:
        errors = uq.enough(ds, lead.name).loc[lead.name]
        expected = np.array([errors["own"], errors["sampling"]]) / lead.range.unit.per
        if not np.allclose(numbers_in(sufficiency.finer), expected, rtol=0.01):
            yield sufficiency.finer
