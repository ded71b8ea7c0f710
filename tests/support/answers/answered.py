"""Answers to read: numbers out of sentences, and a life with a known law."""

import re
from functools import cache

import numpy as np
from computed import asking, computed, linear, study_of, with_output

from uq.assess.answer.answer import answer

DAY = 86400.0
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"
IN_TEXT = re.compile(r"(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?")


def numbers(pattern, text):
    match = re.fullmatch(pattern.replace("#", NUMBER), text)
    assert match, text
    return [float(group) for group in match.groups()]


def numbers_in(text):
    """Return the numbers of a sentence, without those of names such as x1."""
    return [float(number.rstrip(".")) for number in IN_TEXT.findall(text)]


@cache
def lifetime():
    """A life with a known law, of independent rows: rate contributes 25/26 of the log variance."""
    lognormal = {"distribution": "lognormal"}
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 1},
        "uncertain": {
            "rate": lognormal | {"median": 2.5e-10, "sigma": 0.5, "source": "assumed: a guess"},
            "depth": lognormal | {"median": 2.5e-4, "sigma": 0.1, "source": "measured"},
        },
        "analysis": {"thresholds": {"life": 10 * DAY}},
    }
    ds = computed(study_of(tables))
    return ds, answer(ds)


def locking(samples):
    """A success that weak motors miss: x4 below 0.3 never locks."""
    ds = linear(samples=samples)
    x = ds["x4"].values
    ds = with_output(ds, "locking", np.where(x > 0.3, 9 - 5 * x, np.inf), "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    return asking(ds, outputs=["locking"], thresholds={"locking": 20.0})
