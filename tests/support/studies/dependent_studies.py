"""Results of studies of dependent inputs, and what their Shapley effects are compared with."""

from asked_indices import sensitivities

from benchmarks.coverage import dependent, problems

PAIR = {"parameters": ["x3", "x1"], "rank_correlation": [[1.0, -0.7], [-0.7, 1.0]]}


def weighted(r, samples=2048):
    laws = dict.fromkeys(dependent.NAMES, dependent.NORMAL)
    return problems.computed(dependent.study("weighted", laws, dependent.matrix(r), samples))


def entry_of(ds):
    (entry,) = sensitivities(ds)["outputs"].values()
    return entry


def assert_near(effects, truth):
    """Compare with half an interval more, as one of several 95 % intervals may miss."""
    for name, value in truth.items():
        low, high = effects[name]["low"], effects[name]["high"]
        assert abs(effects[name]["value"] - value) < 0.75 * (high - low) < 0.1, name
