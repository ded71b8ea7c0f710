"""Few hits and failed rows: shares, indices and twins of events seen rarely, or not at all."""

from dataclasses import replace

import numpy as np
from scipy import stats

from benchmarks.coverage.problems import NAME, ishigami_ppf, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.assess.design_sample import sample_of
from uq.assess.sensitivities import few_hits
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.assess.targets import IndexTarget
from uq.assess.two_fidelities import with_twin
from uq.indices.index import RefusedError
from uq.indices.methods import METHODS
from uq.result.result import Result
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import NOTHING
from uq.stats.intervals import share_interval

UNIFORMS = {
    name: {"distribution": "uniform", "lower": 0.0, "upper": 1.0} for name in ("x1", "x2", "x3")
}
EXPECTED = (0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 18.0)
ROWS = 1024


def shares(repetitions):
    """Count the intervals of shares of few hits, and their lower ends alone."""
    lines = []
    for how, dependence in (
        (f"{ROWS} independent rows", INDEPENDENT),
        (f"8 replicates of {ROWS // 8} independent rows", Dependence(np.arange(ROWS) % 8)),
    ):
        tally = Tally(f"a share of few hits, {how}", REASONS)
        for expected in EXPECTED:
            share, rng = expected / ROWS, np.random.default_rng(int(10 * expected))
            for _ in range(repetitions):
                low, high = share_interval(rng.random(ROWS) < share, dependence)
                tally.add(f"{expected:g} hits expected", share, low, high)
                tally.add(f"{expected:g} hits expected, lower end", share, low, np.inf)
        lines += tally.lines()
    return lines


# Indices ------------------------------------------------------------------------------------------


def _event(share, high, low):
    return lambda x1, x2, x3: np.where(x1 + x2 > 2 - np.sqrt(2 * share), high(x3), low(x3))


def _regimes(share):
    return _event(share, lambda x: 30 * x, lambda x: x)


def _shifted(share):
    return _event(share, lambda x: 3 + 10 * (x - 0.5), lambda x: x)


OUTPUTS = {
    f"event of {share:.1%}": (_event(share, np.ones_like, np.zeros_like), True)
    for share in (0.013, 0.03, 0.05, 0.1)
} | {
    f"two regimes, {name}, {share:.0%}": (build(share), False)
    for name, build in (("one of scatter 30", _regimes), ("one shifted, of scatter 10", _shifted))
    for share in (0.03, 0.05, 0.1)
}


RAREST = next(iter(OUTPUTS))


def truths(function, n=600, thin=60):
    """Return S1 and ST of a function of three uniform inputs, by the midpoint rule."""
    mid, few = (np.arange(n) + 0.5) / n, (np.arange(thin) + 0.5) / thin
    y = function(mid[:, None, None], mid[None, :, None], few[None, None, :])
    first = {f"x{i + 1}": y.mean(axis=tuple({0, 1, 2} - {i})).var() / y.var() for i in range(3)}
    total = {f"x{i + 1}": y.var(axis=i).mean() / y.var() for i in range(3)}
    return {"S1": first, "ST": total}


def indices(repetitions):
    """Count the Sobol' indices of events, and of two regimes that scatter unequally."""
    study = study_of("saltelli", 128, 8, laws=UNIFORMS, analysis={"outputs": ["jump"]})
    tallies = {
        name: Tally(
            f"{name}, saltelli, 8 replicates of 128 groups of 5 rows",
            dict.fromkeys(("S1", "ST"), REFUSED) if name == RAREST else REASONS,
        )
        for name in OUTPUTS
    }
    expected = {name: truths(function) for name, (function, _) in OUTPUTS.items()}
    for ds in repeated(study, repetitions):
        sample = sample_of(Result(ds))
        for name, (function, is_event) in OUTPUTS.items():
            values = function(*(ds[x].values for x in UNIFORMS)).astype(float)
            try:
                few_hits(ds, IndexTarget(name, None, values, event=is_event))
                by_kind = METHODS["sobol"].indices(replace(sample, values=values)).values
            except RefusedError:
                by_kind = {}
            by_key = {kind.key: of_inputs for kind, of_inputs in by_kind.items()}
            for kind, of_inputs in expected[name].items():
                for x, truth in of_inputs.items():
                    if truth > 1e-6:
                        index = by_key[kind][x] if by_kind else NOTHING
                        tallies[name].add(f"{kind} {x}", truth, index.low, index.high)
    return [line for tally in tallies.values() for line in tally.lines()]


# Twins --------------------------------------------------------------------------------------------

HITS = (2.0, 4.5, 9.0, 18.0)


def twin(repetitions):
    """Count probabilities by a twin that rest on few hits."""
    limits = {hits: ishigami_ppf(1 - hits / 300) for hits in HITS}
    analysis = {
        "outputs": ["ishigami"],
        "thresholds": {"ishigami": list(limits.values())},
        "twin": "near",
    }
    study = study_of("monte-carlo", 300, laws=UNIFORMS, analysis=analysis)
    tally = Tally("Ishigami, 300 independent rows and 30,000 of a cheap twin", REASONS)
    for ds in repeated(study, repetitions):
        estimates = with_twin(Result(ds), NAME).outputs["ishigami"]
        for hits, limit in limits.items():
            estimate = estimates[f"P(>{limit!r})"].estimate
            tally.estimate(f"by the twin, {hits:g} hits expected", hits / 300, estimate)
    return tally.lines()


# Failed rows --------------------------------------------------------------------------------------

LIFE = stats.weibull_min(1.5, scale=3.5)
FAILED = 0.08


def failed(repetitions):
    """Count the bounds where rows fail among the longest lives."""
    study = study_of(
        "monte-carlo",
        1000,
        laws=UNIFORMS,
        analysis={"outputs": ["life"], "thresholds": {"life": [5.0]}, "quantiles": [0.5]},
    )
    tally = Tally(f"1000 independent rows, {FAILED:.0%} of which fail, the longest lives", REASONS)
    blank = next(repeated(study, 1))
    for seed in range(repetitions):
        life = LIFE.ppf(np.random.default_rng(seed).random(1000))
        lost = life > LIFE.isf(FAILED)
        ds = blank.copy(deep=True)
        ds["life"].values[:] = np.where(lost, np.nan, life)
        ds["status"].values[lost] = 2
        entry = summary_facts(summarise(Result(ds))).json["outputs"]["life"]
        above = entry["thresholds"]["5.0"]["above"]
        median, b10 = entry["quantiles"]["0.5"], entry["b_lives"]["B10"]
        for quantity, truth, statistic in (
            ("P(> 5.0)", LIFE.sf(5.0), above),
            ("quantile 0.5", LIFE.median(), median),
            ("B10", LIFE.ppf(0.1), b10),
        ):
            tally.add(
                f"{quantity}, with failed rows",
                truth,
                statistic["failed_low"],
                statistic["failed_high"],
            )
            tally.entry(quantity, truth, statistic, by="uq, of the rows that did not fail")
    return tally.lines()


EXACT = "conservative by design: Clopper and Pearson's interval, where hits are few"
WIDENED = "conservative by design: widened by the effect of one more row, where few rows matter"
BOUNDS = "conservative by design: bounds with all failed rows on either side"
REFUSED = "refused: fewer than 5 hits in each replicate"
REASONS = (
    {f"{hits:g} hits expected": EXACT for hits in EXPECTED}
    | {f"by the twin, {hits:g} hits expected": EXACT for hits in HITS}
    | {f"{kind} {x}": WIDENED for kind in ("S1", "ST") for x in UNIFORMS}
    | {f"{quantity}, with failed rows": BOUNDS for quantity in ("P(> 5.0)", "quantile 0.5", "B10")}
)
