"""Shapley effects of dependent inputs by nearest neighbours, for comparison."""

from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.coverage.dependent import CASES, PATHS, study, title
from benchmarks.coverage.dependent_effects import shares
from benchmarks.coverage.problems import repeated
from benchmarks.coverage.tally import Tally
from uq.stats.intervals import scatter_interval

PARTS = 8
NEIGHBOURS = 3


def by_neighbours(x, y):
    """Estimate Shapley effects from independent rows: rows nearest in some inputs share these.

    B. Broto, F. Bachoc, M. Depecker, "Variance reduction for estimation of Shapley effects and
    adaptation to unknown input distribution", SIAM/ASA J. Uncertain. Quantif. 8, 693-716 (2020).
    """
    d = x.shape[1]
    left = {(): y.var(ddof=1), tuple(range(d)): 0.0}
    for size in range(1, d):
        for subset in combinations(range(d), size):
            _, near = cKDTree(x[:, subset]).query(x[:, subset], NEIGHBOURS)
            left[subset] = y[near].var(axis=1, ddof=1).mean()
    return shares(lambda subset: left[()] - left[tuple(sorted(subset))], d)


def neighbours(repetitions, cases=CASES):
    """Count the intervals of nearest neighbours, by Student's t of parts of as many rows."""
    lines = []
    for words, case in cases.items():
        names, rows = list(case.laws), len(case.laws) + 1
        tally = Tally(title(words, rows))
        case_study = study(case.output, case.laws, case.correlations, PATHS * rows, "monte-carlo")
        for ds in repeated(case_study, repetitions):
            x, y = ds[names].to_dataarray().values.T, ds[case.output].values
            effects = np.array([by_neighbours(x[i::PARTS], y[i::PARTS]) for i in range(PARTS)])
            for name, values in zip(names, effects.T, strict=True):
                ends = scatter_interval(values.mean(), values)
                by = f"nearest neighbours in {PARTS} parts"
                if case.truth[name] > 0:
                    tally.add(f"shapley {name}", case.truth[name], *ends, by)
        lines += tally.lines()
    return lines
