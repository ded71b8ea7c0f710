"""Counting intervals of Shapley effects of dependent inputs: problems of `dependent_effects`."""

from dataclasses import replace
from typing import Annotated, NamedTuple

import numpy as np

from benchmarks.coverage.dependent_effects import (
    AMONG_SIGNS,
    NAMES,
    among_waves,
    matrix,
    of_exponential,
    of_lognormal,
    of_normal,
    of_signs,
    of_waves,
)
from benchmarks.coverage.problems import Settings, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.assess.design_sample import sample_of
from uq.contract import Model, Output, Parameter
from uq.indices.index import SHAPLEY, RefusedError
from uq.indices.methods import METHODS
from uq.indices.shapley import controlled, parts_of
from uq.result.result import Result
from uq.stats.estimate import NOTHING
from uq.stats.intervals import scatter_interval

CORRELATIONS = (0.0, 0.3, 0.6, 0.9)
MILD, STEEP = 1 / 6, 1 / 2
NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
EXPONENTIAL = {"distribution": "exponential", "mean": 1.0}
SIGN = {"distribution": "discrete-choice", "values": [-1.0, 1.0]}
SIGNED = {"x1": SIGN, "x2": SIGN, "x3": NORMAL}
WAVING = dict.fromkeys(NAMES[:3], {"distribution": "uniform", "lower": -np.pi, "upper": np.pi})


def _number(symbol):
    return Parameter(symbol, "1", "a number", (-1e3, 1e3), "definition of the problem")


class Inputs(NamedTuple):
    """Inputs of the sums."""

    x1: Annotated[float, _number("x_1")] = 0.0
    x2: Annotated[float, _number("x_2")] = 0.0
    x3: Annotated[float, _number("x_3")] = 0.0
    x4: Annotated[float, _number("x_4")] = 0.0


def _batch(x, seed, settings):
    x1, x2, x3, _ = np.ascontiguousarray(x.T)
    weighted = x1 + x2 + 2 * x3
    outputs = {
        "weighted": weighted,
        "interacting": weighted + x1 * x3,
        "mild": np.exp(MILD * weighted),
        "steep": np.exp(STEEP * weighted),
        "sum": x1 + x2 + x3,
        "waves": np.sin(x1) * (1 + 0.1 * x3**4) + 7 * np.sin(x2) ** 2,
    }
    return outputs, np.zeros(len(x), np.int8)


SUMS = Model(
    "sums",
    "Sums of dependent inputs",
    "1",
    Inputs,
    Settings,
    {
        "weighted": Output("1", "x1 + x2 + 2 x3"),
        "interacting": Output("1", "x1 + x2 + 2 x3 + x1 x3"),
        "mild": Output("1", "e to the power of a sixth of x1 + x2 + 2 x3"),
        "steep": Output("1", "e to the power of half of x1 + x2 + 2 x3"),
        "sum": Output("1", "x1 + x2 + x3"),
        "waves": Output("1", "Ishigami's function"),
    },
    _batch,
    block=1024,
)
NAME = "benchmarks.coverage.dependent:SUMS"


def ranks(correlations):
    """Return the rank correlations of normal variables with some correlations."""
    rank_correlations = 6 / np.pi * np.arcsin(np.asarray(correlations) / 2)
    np.fill_diagonal(rank_correlations, 1.0)
    return rank_correlations.tolist()


def study(output, laws, correlations, samples, method="shapley"):
    """Return a study of one of the outputs."""
    dependence = {"parameters": list(laws), "rank_correlation": ranks(correlations)}
    return study_of(
        method,
        samples,
        model=NAME,
        laws=laws,
        dependence=dependence,
        analysis={"outputs": [output]},
    )


EXACT = "exact: the output is a polynomial in the normal scores, and its effects a formula"
FAR = "conservative: few paths far out hold most of the errors, and their leverage widens intervals"
TAIL = "few paths hold most of the variance; by default the indices are those of the logarithm"


class Case(NamedTuple):
    """A problem.

    Attributes
    ----------
    output : str
    laws : dict
    correlations : ndarray
        Of normal scores.
    truth : dict of str to float
    reason : str
        Why the coverage is off, or "".
    """

    output: str
    laws: dict
    correlations: np.ndarray
    truth: dict
    reason: str = ""


BELLS, DECAYS = dict.fromkeys(NAMES, NORMAL), dict.fromkeys(NAMES, EXPONENTIAL)
CASES = {
    **{
        f"correlation {r:g}": Case("weighted", BELLS, matrix(r), of_normal(r), EXACT)
        for r in CORRELATIONS
    },
    "interaction": Case("interacting", BELLS, matrix(0.6), of_normal(0.6, 1.0), EXACT),
    **{
        f"exponential, correlation {r:g}": Case(
            "weighted", DECAYS, matrix(r), of_exponential(r), FAR
        )
        for r in CORRELATIONS
    },
    "mild lognormal": Case("mild", BELLS, matrix(0.6), of_lognormal(0.6, MILD), FAR),
    "steep lognormal": Case("steep", BELLS, matrix(0.6), of_lognormal(0.6, STEEP), TAIL),
    "two signs and a number": Case("sum", SIGNED, AMONG_SIGNS, of_signs()),
}
WAVES = {
    f"waves, correlation {r:g}": Case("waves", WAVING, among_waves(r), of_waves(r))
    for r in (0.6, 0.9)
}
PATHS = 512
REFUSED = dict.fromkeys(NAMES, {"low": None, "high": None})
ALONE = "paths without polynomials"
UNRAISED = "residuals without leverage"


def of_paths_alone(ds, output):
    """Return the Shapley effects of a result that its paths show, without a control variate.

    Empty where they do not tell the variance from zero.
    """
    sample = sample_of(Result(ds))
    none = np.full_like(sample.scores, np.nan)
    sample = replace(sample, values=ds[output].values, scores=none)
    try:
        return METHODS["shapley"].indices(sample).values[SHAPLEY]
    except RefusedError:
        return {}


def of_residuals(ds, output):
    """Return the Shapley effects of a result with intervals from the residuals as they are."""
    sample = replace(sample_of(Result(ds)), values=ds[output].values)
    parts, _ = controlled(sample, parts_of(sample, sample.grouped[sample.whole]))
    mean = parts.mean(axis=0)
    shares = mean / mean.sum()
    errors = (parts - mean - shares * (parts - mean).sum(axis=1, keepdims=True)) / mean.sum()
    ends = [scatter_interval(*pair) for pair in zip(shares, errors.T, strict=True)]
    return dict(zip(sample.inputs, ends, strict=True))


def title(words, rows):
    """Return the title of the table of a case."""
    return f"dependent inputs, {words}, shapley, {PATHS} paths of {rows} rows"


def shapley(repetitions, cases=CASES):
    """Count the Shapley effects of dependent inputs."""
    lines = []
    for words, case in cases.items():
        tally = Tally(title(words, len(case.laws) + 1), {"shapley": case.reason})
        case_study = study(case.output, case.laws, case.correlations, PATHS)
        for ds in repeated(case_study, repetitions):
            ours = indices_of(ds, output=[case.output])[case.output].get("shapley", REFUSED)
            alone = of_paths_alone(ds, case.output)
            unraised = of_residuals(ds, case.output) if case.reason == FAR else {}
            for name, value in case.truth.items():
                if value > 0:  # else it is zero in every path
                    tally.entry(f"shapley {name}", value, ours[name])
                    tally.estimate(f"shapley {name}", value, alone.get(name, NOTHING), ALONE)
                    if unraised:
                        tally.add(f"shapley {name}", value, *unraised[name], UNRAISED)
        lines += tally.lines()
    return lines
