"""Problems whose answers are known: the studies, and the truth about them."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Annotated, NamedTuple

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from uq.assess.sensitivities import sensitivities
from uq.assess.sensitivity_table import sensitivity_facts
from uq.contract import Model, Output, Parameter
from uq.result import result_file
from uq.result.result import Result
from uq.study import row_sampling
from uq.study.definition import study_from_text
from uq.study.evaluate import evaluate
from uq.text.literals import toml

# One model for all: Ishigami's function, a jump between two regimes, lives with a heavy tail ------

TAIL_INDEX = 3
"""P(life > t) falls as t^-3: the mean and the variance exist, the skewness does not."""

SLOWEST = 0.4
"""A rate below this is none: such rows never end."""

HORIZON = 1.0
"""Where every life is censored that has not ended."""

ENDS = 0.4
"""Share of rows of ``mixed`` that end; which these are is known at once."""

EDGE = 1.2
"""The upper regime is where x1 + x2 is larger; there the output jumps by `JUMP`."""

JUMP = 3.0


@dataclass(frozen=True)
class Settings:
    """None."""


def _number(symbol, high=1.0):
    return Parameter(symbol, "1", "a number", (0.0, high), "definition of the problem")


class Inputs(NamedTuple):
    """Inputs of all problems."""

    x1: Annotated[float, _number("x_1")] = 0.5
    x2: Annotated[float, _number("x_2")] = 0.5
    x3: Annotated[float, _number("x_3")] = 0.5
    r1: Annotated[float, _number("r_1", 1e3)] = 1.0
    r2: Annotated[float, _number("r_2", 1e3)] = 1.0
    r3: Annotated[float, _number("r_3", 1e3)] = 1.0
    leaving: Annotated[float, _number("c", 1e6)] = 1.0


def _batch(x, seed, settings):
    x1, x2, x3, r1, r2, r3, leaving = np.ascontiguousarray(x.T)
    rate = r1 + r2 + r3  # of three exponential laws: gamma
    a, b, c = (2 * np.pi * u - np.pi for u in (x1, x2, x3))
    upper = x1 + x2 > EDGE
    with np.errstate(divide="ignore"):
        life = 1 / rate
    return {
        "ishigami": np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a),
        **_near(x, seed, settings)[0],
        "jump": x1 + x3 + JUMP * upper,
        "regime": upper.astype(np.int8),
        "life": life,
        "never": np.where(rate < SLOWEST, np.inf, life),
        "cut": np.minimum(life, HORIZON),
        "cut_censored": life > HORIZON,
        "left": np.minimum(life, leaving),
        "left_censored": life > leaving,
        **_mixed(x1, x2, leaving),
    }, np.zeros(len(x), np.int8)


def _near(x, seed, settings):
    """Ishigami's function without its interaction: a cheap twin."""
    a, b, c = (2 * np.pi * u - np.pi for u in np.ascontiguousarray(x.T)[:3])
    near = np.sin(a) + 7 * np.sin(b) ** 2
    return {"near": near}, np.zeros(len(x), np.int8)


def _mixed(x1, x2, leaving):
    """Lives of which most never end; the others may be censored."""
    with np.errstate(divide="ignore"):
        life = np.where(x1 < ENDS, np.sqrt(-np.log(x2)), np.inf)
    return {
        "mixed": np.where(np.isinf(life), life, np.minimum(life, leaving)),
        "mixed_censored": np.isfinite(life) & (life > leaving),
    }


def _life(meaning, censored):
    return Output("s", meaning, "lifetime", may_be_censored=censored)


PROBLEMS = Model(
    "problems",
    "Problems with known answers",
    "1",
    Inputs,
    Settings,
    {
        "ishigami": Output("1", "Ishigami's function"),
        "near": Output("1", "the same without its interaction"),
        "jump": Output("1", "a function that jumps between two regimes"),
        "regime": Output("1", "which regime", "category", categories=("lower", "upper")),
        "life": _life("a life with a heavy tail", False),
        "never": _life("the same life, never where the rate is low", False),
        "cut": _life("the same life, censored at a horizon", True),
        "left": _life("the same life, censored when a row leaves for reasons of its own", True),
        "mixed": _life("a life that may never end, else censored when a row leaves", True),
    },
    _batch,
    block=1024,
    cheap={"near": _near},
)

_UNIFORM = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
LAWS = {
    "x1": _UNIFORM,
    "x2": _UNIFORM,
    "x3": _UNIFORM,
    **dict.fromkeys(("r1", "r2", "r3"), {"distribution": "exponential", "mean": 1.0}),
    "leaving": {"distribution": "exponential", "mean": 1.5},
}
NAME = "benchmarks.coverage.problems:PROBLEMS"

LIFE = stats.invgamma(TAIL_INDEX)


def never_cdf(time):
    """Return P(T < t) where rows with a low rate never end."""
    return min(LIFE.cdf(time), stats.gamma(TAIL_INDEX).sf(SLOWEST))


MIXED = stats.weibull_min(2)
"""The law of those lives of ``mixed`` that end."""


# Ishigami's function ------------------------------------------------------------------------------

ISHIGAMI = {
    "S1": {"x1": 0.313905, "x2": 0.442411, "x3": 0.0},
    "ST": {"x1": 0.557589, "x2": 0.442411, "x3": 0.243684},
    "S2": {"x1,x2": 0.0, "x1,x3": 0.243684, "x2,x3": 0.0},
}
ISHIGAMI_MEAN = 3.5
ISHIGAMI_LAW = {"distribution": "uniform", "lower": -np.pi, "upper": np.pi}


@cache
def _ishigami_rest():
    """Return what x1 and x3 add, at points that are equally likely."""
    mid = 2 * np.pi * (np.arange(1500) + 0.5) / 1500 - np.pi
    return (np.sin(mid)[:, None] * (1 + 0.1 * mid**4)).ravel()


def ishigami_cdf(y):
    """Return P(Y < y): sin^2 of a uniform angle follows the arcsine law."""
    share = np.clip((y - _ishigami_rest()) / 7, 0.0, 1.0)
    return float(np.mean(2 / np.pi * np.arcsin(np.sqrt(share))))


@cache
def ishigami_ppf(p):
    """Return the inverse of `ishigami_cdf`."""
    return brentq(lambda y: ishigami_cdf(y) - p, -11, 18, xtol=1e-8)


# The jump -----------------------------------------------------------------------------------------


@cache
def jump():
    """Return what is known of the jump, by the midpoint rule over x1 and x2.

    Returns
    -------
    dict
        ``share`` of the upper regime, ``mean``, ``within`` (mean of each regime), ``between``,
        ``S1`` and ``ST`` of the output, ``event`` (the same of the upper regime), ``cdf``.
    """
    n = 3000
    mid = (np.arange(n) + 0.5) / n
    # The probability of the upper regime in a cell is that of its corner cut off by the edge.
    upper = np.clip((mid[:, None] + mid[None, :] - EDGE) * n + 0.5, 0.0, 1.0)
    share = (2 - EDGE) ** 2 / 2
    expected = mid[:, None] + 0.5 + JUMP * upper  # given x1 and x2
    mean = 1.0 + JUMP * share
    variance = 1 / 6 + JUMP**2 * share * (1 - share) + 2 * JUMP * _covariance(mid, upper, share)
    # Of x1 and x2 in the upper corner the mean is at a third of its height from the edge.
    of_upper = 1 - (2 - EDGE) / 3
    of_lower = (0.5 - share * of_upper) / (1 - share)
    within = {"upper": of_upper + 0.5 + JUMP, "lower": of_lower + 0.5}
    between = share * (within["upper"] - mean) ** 2 + (1 - share) * (within["lower"] - mean) ** 2
    of_x1, of_x2 = expected.mean(axis=1).var(), expected.mean(axis=0).var()
    first = {"x1": of_x1 / variance, "x2": of_x2 / variance, "x3": 1 / 12 / variance}
    both = 1 - first["x3"]
    total = {"x1": both - first["x2"], "x2": both - first["x1"], "x3": first["x3"]}
    event = upper.mean(axis=1).var() / (share * (1 - share))
    return {
        "share": share,
        "mean": mean,
        "within": within,
        "between": between / variance,
        "S1": first,
        "ST": total,
        "event": {
            "S1": {"x1": event, "x2": event, "x3": 0.0},
            "ST": {"x1": 1 - event, "x2": 1 - event, "x3": 0.0},
        },
    }


def _covariance(mid, upper, share):
    return float((mid[:, None] * upper).mean() - 0.5 * share)


@cache
def jump_ppf(p, regime=None):
    """Quantile of the jump's output, of all rows or of those in a regime."""
    n = 1500
    mid = (np.arange(n) + 0.5) / n
    upper = np.clip((mid[:, None] + mid[None, :] - EDGE) * n + 0.5, 0.0, 1.0).mean(axis=1)
    weights = {"upper": upper, "lower": 1 - upper}
    chosen = [regime] if regime else list(weights)
    total = sum(weights[name].mean() for name in chosen)

    def below(y):  # x3 is uniform
        return (
            sum(
                np.mean(weights[name] * np.clip(y - mid - JUMP * (name == "upper"), 0, 1))
                for name in chosen
            )
            / total
        )

    return brentq(lambda y: below(y) - p, 0.0, 5.0, xtol=1e-9)


# Repetition ---------------------------------------------------------------------------------------


def study_of(method, samples, replicates=1, model=NAME, laws=None, second_order=False, **tables):
    """Return a study of a problem."""
    design = {"method": method, "samples": samples, "replicates": replicates}
    tables = {
        "study": {"name": "coverage", "model": "problems" if ":" in model else model},
        "design": design | {"second_order": second_order} | tables.pop("design", {}),
        "uncertain": laws or LAWS,
        **tables,
    }
    text = "\n".join(f"{table} = {toml(entries)}" for table, entries in tables.items())
    return study_from_text(text, model=model)


def with_seed(study, seed):
    """Return the same study with another seed."""
    return replace(study, design=study.design.model_copy(update={"seed": seed}))


def computed(study):
    """Return the result of a study, computed in this process and kept in memory."""
    rows = row_sampling.row_block(study, 0, row_sampling.rows(study))
    chunk = evaluate(study.model, study.settings, rows.x, rows.seed)
    return result_file.build(study, rows, chunk.columns, chunk.status, {})


def indices_of(ds, method=None, output=None):
    """Return the sensitivity indices of each output, as ``uq sensitivity --json`` has them."""
    return sensitivity_facts(sensitivities(Result(ds), method, output)).json["outputs"]


def repeated(study, repetitions):
    """Yield the results of a study under different seeds."""
    for seed in range(repetitions):
        yield computed(with_seed(study, seed))
