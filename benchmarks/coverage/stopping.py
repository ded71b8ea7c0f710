"""Runs that stop when an interval is narrow enough, for the worst half-width."""

from dataclasses import replace

import numpy as np
from scipy import special, stats

from benchmarks.coverage import dependent, known_indices, scaled
from benchmarks.coverage.indices import NAMES, ishigami
from benchmarks.coverage.problems import (
    EDGE,
    ISHIGAMI,
    ISHIGAMI_MEAN,
    JUMP,
    LIFE,
    MIXED,
    ishigami_cdf,
    jump,
    jump_ppf,
    repeated,
    study_of,
)
from benchmarks.coverage.tally import Tally
from uq.assess import stopping
from uq.assess.design_sample import sample_of
from uq.contract import Output
from uq.indices.index import S1, SHAPLEY, ST, RefusedError
from uq.indices.method import DesignSample
from uq.indices.methods import METHODS
from uq.indices.sobol import sobol_indices
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.stats.dependent_rows import INDEPENDENT
from uq.stats.estimate import NOTHING
from uq.study.file import DesignTable, Until

HALF_WIDTHS = 60
"""Required half-widths that are tried; the one at which most stops are wrong counts."""

ENDING = 0.4  # share of lives of the last kind that end
LEAVING = 1.5  # mean time at which a row leaves


def _life(u):
    """Return lives with a heavy tail: the inverse of the sum of three exponential rates."""
    return -1 / np.log(u[..., :3]).sum(axis=-1)


def _left(u):
    """Return the same lives, censored when a row leaves."""
    return _cut(_life(u), u)


def _mixed(u):
    """Return Weibull lives of which most never end; the others may be censored."""
    ends = u[..., 0] < ENDING
    return _cut(np.where(ends, MIXED.isf(u[..., 1]), np.inf), u)


def _cut(life, u):
    leaving = -LEAVING * np.log(u[..., 3])
    censored = np.isfinite(life) & (life > leaving)
    return np.where(censored, leaving, life), censored


def _jump(u):
    return u[..., 0] + u[..., 2] + JUMP * (u[..., 0] + u[..., 1] > EDGE)


def _lognormal(u):
    return np.exp(special.ndtri(u[..., 0]))


def _ishigami(u):
    x = 2 * np.pi * u[..., :3] - np.pi
    return ishigami(x.reshape(-1, 3)).reshape(u.shape[:-1])


VALUE, LIFETIME = Output("1", "a value"), Output("s", "a life", "lifetime")
INPUTS = 4

ROWS = {
    "mean": (_ishigami, VALUE, {}, ISHIGAMI_MEAN),
    "mean, lognormal": (_lognormal, VALUE, {}, np.exp(0.5)),
    "median": (_jump, VALUE, {"quantile": 0.5}, jump_ppf(0.5)),
    "P(> 2.5)": (_jump, VALUE, {"above": 2.5}, jump()["share"]),
    "P(> 9.0)": (_ishigami, VALUE, {"above": 9.0}, 1 - ishigami_cdf(9.0)),
    "B10": (_life, LIFETIME, {"b_life": "B10"}, LIFE.ppf(0.1)),
    "B50, censored": (_left, LIFETIME, {"b_life": "B50"}, LIFE.ppf(0.5)),
    "B10, never or censored": (_mixed, LIFETIME, {"b_life": "B10"}, MIXED.ppf(0.1 / ENDING)),
}
"""Quantity -> function of points of the unit cube, its output, until, truth."""


def rows(method, samples, replicates, repetitions):
    """Count the intervals of statistics at which runs stop."""
    each = f"{replicates} replicates of at most" if replicates > 1 else "at most"
    tally = Tally(f"runs that stop, {method}, {each} {samples} samples", REASONS)
    design = _design(method, samples, replicates)
    sizes, level = stopping.interim_sizes(design), stopping.confidence(design)
    part = np.arange(samples * replicates) % replicates
    for quantity, (function, output, asked, truth) in ROWS.items():
        until, looks = Until(output="y", half_width=1.0, **asked), []
        for seed in range(repetitions):
            whole = _element(function(_points(design, INPUTS, seed)), output)
            elements = [_first(whole, size * replicates) for size in sizes]
            replicate = [
                None if replicates == 1 else part[: len(element.values)] for element in elements
            ]
            looks.append(
                [
                    stopping.statistic(element, until, labels, level)
                    for element, labels in zip(elements, replicate, strict=True)
                ]
            )
        _stop(tally, quantity, looks, [[truth] * len(sizes)] * repetitions)
    return tally.lines()


def integrated(repetitions):
    """Count B10 of lives that a lognormal input scales, at which runs stop."""
    tally = Tally("runs that stop, at most 2048 lives scaled by an input", {"": scaled.CAUTIOUS})
    design = _design("monte-carlo", 2048, 1)
    sizes, level = stopping.interim_sizes(design), stopping.confidence(design)
    until, looks = Until(output="y", half_width=1.0, b_life="B10"), []
    for seed in range(repetitions):
        rest, drawn = np.random.default_rng(seed).standard_normal((2, design.samples))
        elements = [scaled.element(rest[:n], drawn[:n], scaled.lognormal_term(1.0)) for n in sizes]
        looks.append(
            [stopping.statistic(element, until, INDEPENDENT, level) for element in elements]
        )
    truth = float(np.exp(np.sqrt(2) * stats.norm.ppf(0.1)))
    _stop(tally, "B10", looks, [[truth] * len(sizes)] * repetitions)
    return tally.lines()


def _design(method, samples, replicates):
    return DesignTable(method=method, samples=samples, replicates=replicates)


def _points(design, inputs, seed):
    """Return the points of a design, its replicates in turn, shape (rows, [blocks,] inputs)."""
    points = DESIGNS[design.method].unit_rows(
        seed=seed,
        replicates=design.replicates,
        d=inputs,
        samples=design.samples,
        second_order=False,
        start=0,
        stop=design.samples,
    )
    return points.reshape(-1, *points.shape[2 if points.shape[2] > 1 else 3 :])


def _element(computed, output):
    values, censored = (
        computed if isinstance(computed, tuple) else (computed, np.zeros(len(computed), bool))
    )
    return Element("y", "y", output, {}, values, censored, np.zeros(len(values), bool))


def _first(element, rows):
    kept = {name: getattr(element, name)[:rows] for name in ("values", "censored", "failed")}
    return replace(element, **kept)


INDICES = {
    "ishigami": ("Ishigami", _ishigami, ISHIGAMI),
    "jump": ("two regimes", _jump, {kind: jump()[kind] for kind in ("S1", "ST")}),
}
"""Problem -> its name in the table, function of points of the unit cube, indices."""

PAIR = ("x1", "x2")
GROUPS = 256


def indices(name, repetitions, replicates=8):
    """Count the intervals of Sobol' indices, and of their differences, at which runs stop."""
    title, function, truth = INDICES[name]
    words = f"runs that stop, {title}, saltelli, {replicates} replicates of at most {GROUPS} groups"
    tally = Tally(words, REASONS)
    design = _design("saltelli", GROUPS, replicates)
    sizes, level = stopping.interim_sizes(design), stopping.confidence(design)
    blocks = ("A", *(f"AB_{input_name}" for input_name in NAMES), "B")
    seen = []
    for seed in range(repetitions):
        values = function(_points(design, len(NAMES), seed))
        values = values.reshape(GROUPS, replicates, -1).swapaxes(0, 1)
        seen.append([_indices_of(values[:, :size], blocks, level) for size in sizes])
    for kind in (S1, ST):
        expected = dict(truth[kind.key])
        expected[" - ".join(PAIR)] = expected[PAIR[0]] - expected[PAIR[1]]
        asked = {"widest": NAMES, "of x1": NAMES[:1], " - ".join(PAIR): (" - ".join(PAIR),)}
        for quantity, names in asked.items():
            looks = [[_widest(estimates[kind], names) for estimates in run] for run in seen]
            _stop_at(tally, f"{kind.key} {quantity}", looks, expected)
    return tally.lines()


def _indices_of(values, blocks, level):
    groups = np.arange(values.size).reshape(values.shape)
    sample = DesignSample(values.ravel(), {}, groups, blocks, confidence=level, difference=PAIR)
    return sobol_indices(sample).values


PATHS = 2048
DEPENDENT = ("exponential, correlation 0.6", "two signs and a number")


def shapley(repetitions):
    """Count the Shapley effects, and their differences, at which runs stop."""
    ishigami = study_of("shapley", PATHS, model="ishigami", laws=known_indices.LAWS)
    lines = _paths("Ishigami", ishigami, "y", known_indices.ISHIGAMI_SHAPLEY, repetitions)
    for words in DEPENDENT:
        case = dependent.CASES[words]
        study = dependent.study(case.output, case.laws, case.correlations, PATHS)
        effects = {name: effect for name, effect in case.truth.items() if effect > 0}
        lines += _paths(words, study, case.output, effects, repetitions)
    return lines


def _paths(title, study, output, truth, repetitions):
    tally = Tally(f"runs that stop, {title}, shapley, at most {PATHS} paths", REASONS)
    until = Until(output=output, half_width=1.0, index="shapley")
    design = study.design.model_copy(update={"until": until})
    sizes, level = stopping.interim_sizes(design), stopping.confidence(design)
    expected = truth | {" - ".join(PAIR): truth[PAIR[0]] - truth[PAIR[1]]}
    asked = {"widest": tuple(truth), "of x1": PAIR[:1], " - ".join(PAIR): (" - ".join(PAIR),)}
    seen = []
    for ds in repeated(study, repetitions):
        sample = replace(sample_of(Result(ds)), confidence=level, difference=PAIR)
        sample = replace(sample, values=ds[output].values)
        seen.append([_effects(sample, size) for size in sizes])
    for quantity, names in asked.items():
        looks = [[_widest(estimates, names) for estimates in run] for run in seen]
        _stop_at(tally, f"shapley {quantity}", looks, expected)
    return tally.lines()


def _effects(sample, size):
    """Return the effects that the first paths show; without intervals where they are refused."""
    kept = {name: getattr(sample, name)[:, :size] for name in ("groups", "direction", "scores")}
    try:
        return METHODS["shapley"].indices(replace(sample, **kept)).values[SHAPLEY]
    except RefusedError:
        return dict.fromkeys((*sample.inputs, " - ".join(PAIR)), NOTHING)


def _stop_at(tally, quantity, looks, expected):
    """Count the intervals of labelled estimates at which runs stop."""
    truths = [[expected[label] for label, _ in run] for run in looks]
    _stop(tally, quantity, [[estimate for _, estimate in run] for run in looks], truths)


def _widest(estimates, names):
    return max(((name, estimates[name]) for name in names), key=lambda pair: _half(pair[1]))


def _half(estimate):
    return (estimate.high - estimate.low) / 2


def _stop(tally, quantity, looks, truths):
    """Count the intervals at which runs stop, for the worst of many required half-widths."""
    half = np.array([[_half(estimate) for estimate in run] for run in looks])
    wrong = np.array(
        [
            [
                not estimate.low <= truth <= estimate.high
                for estimate, truth in zip(run, true_values, strict=True)
            ]
            for run, true_values in zip(looks, truths, strict=True)
        ]
    )
    stops = []
    for required in np.quantile(half[np.isfinite(half)], np.linspace(0.01, 0.99, HALF_WIDTHS)):
        enough = half <= required
        enough[:, -1] = True
        stops.append(enough.argmax(axis=1))
    runs = np.arange(len(looks))
    worst = max(stops, key=lambda stop: wrong[runs, stop].mean())
    for run, true_values, stop in zip(looks, truths, worst, strict=True):
        tally.estimate(quantity, true_values[stop], run[stop])


WIDEST = "conservative: of all inputs, that with the widest interval counts"
REASONS = {
    "": "conservative: no other check has a chance, or those of successive checks overlap",
    "S1 widest": WIDEST,
    "ST widest": WIDEST,
    "shapley widest": WIDEST,
}
"""Beginning of a quantity -> why its coverage is not 95 %."""
