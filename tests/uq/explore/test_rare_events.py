"""Rare events: known probabilities, design points, inputs that depend on each other."""

import numpy as np
import openturns as ot
import pytest
from limit_states import PARTS, PLANE
from rare_studies import LAST, WEAR, branches, close, interval, linear, study
from scipy import integrate, stats

import uq as api
from uq.explore.rare_events import rare_event
from uq.explore.subset_simulation import subset_simulation
from uq.sampling.copulas import copula_of_rank
from uq.sampling.unit_cube import inside
from uq.study.row_sampling import row_block

LIFE = stats.lognorm(s=np.hypot(0.5, 0.2), scale=1e6)
KNOWN = [
    # Normal and uniform sums, and a lognormal life: closed forms.
    (branches(), "sum", 4.753424, False, 1e-6),
    (branches(), "sum", -4.264891, True, 1e-5),
    (linear(), "y", LAST, False, 1e-6),
    (study("exponential-wear", WEAR), "life", LIFE.ppf(1e-5), True, 1e-5),
    (study("exponential-wear", WEAR), "life", LIFE.isf(1e-5), False, 1e-5),
    # Echard, Gayton, Lemaire, Relun, Reliab. Eng. Syst. Saf. 111, 232-240 (2013): 9.09e-6.
    (study("oscillator", PARTS), "excess", 0.0, False, 9.09e-6),
    # Waarts (2000), as in Echard, Gayton, Lemaire, Struct. Saf. 33, 145-154 (2011): 2.22e-3.
    (branches(), "demand", 0.0, False, 2.22e-3),
    (branches(), "turn", 4.753424, False, 2e-6),
    # The event y > 4.5 of a stair of quarters is that of a normal beyond 4.75.
    (branches(), "step", 4.5, False, stats.norm.sf(4.75)),
]


@pytest.mark.parametrize(("of", "output", "threshold", "below", "truth"), KNOWN)
def test_subset_simulation_finds_known_probabilities(of, output, threshold, below, truth):
    ds = rare_event(of, output, threshold, below)
    assert close(ds, truth)
    assert interval(ds)[1] < 2.5 * interval(ds)[0]
    assert int(ds["rows"]) < 60_000


@pytest.mark.parametrize(("names", "beyond"), [(("x1", "x2"), 4.264891), (tuple("abcd"), 3.719016)])
def test_subset_simulation_agrees_with_that_of_openturns(names, beyond):
    d = len(names)

    def margin(u):
        return np.asarray(u).sum(axis=1) / np.sqrt(d) - beyond

    ot.RandomGenerator.SetSeed(1)
    function = ot.PythonFunction(d, 1, func_sample=lambda u: margin(u)[:, None])
    vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(d)))
    algorithm = ot.SubsetSampling(ot.ThresholdEvent(vector, ot.Greater(), 0.0))
    algorithm.setMaximumOuterSampling(80)
    algorithm.setBlockSize(100)
    algorithm.run()
    theirs = algorithm.getResult().getProbabilityEstimate()
    replicates = subset_simulation(margin, d, 1000, np.random.default_rng(1).spawn(8))
    ours = np.mean([replicate.probability for replicate in replicates])
    truth = stats.norm.sf(beyond)
    assert ours == pytest.approx(truth, rel=0.25)
    assert ours == pytest.approx(theirs, rel=0.5)


@pytest.mark.parametrize(
    ("of", "output", "threshold", "below", "truth"),
    [pytest.param(*event, marks=[pytest.mark.slow] * (event[1] == "y")) for event in KNOWN[:-1]],
)
def test_importance_sampling_finds_known_probabilities(of, output, threshold, below, truth):
    ds = rare_event(of, output, threshold, below, method="importance")
    assert close(ds, truth)
    assert interval(ds)[1] < 1.5 * interval(ds)[0]
    assert "subset" in ds.attrs["notes"]


def test_every_design_point_is_found():
    ds = rare_event(branches(), "demand", 0.0, method="importance")
    assert ds["reliability_index"].values == pytest.approx([3.0, 3.0, 3.5, 3.5], abs=1e-3)
    corners = {tuple(np.sign(point).astype(int)) for point in ds["location"].values}
    assert corners == {(1, 1), (-1, -1), (1, -1), (-1, 1)}
    assert ds["first_order"].values == pytest.approx(stats.norm.sf([3, 3, 3.5, 3.5]), rel=1e-2)


def test_what_is_not_rare_is_found_by_the_first_rows_and_said():
    ds = rare_event(linear(), "y", 5.0)
    assert close(ds, 0.5)
    assert int(ds["rows"]) == 8000
    assert "not a rare event" in ds.attrs["notes"]


def test_the_typical_row_of_the_event_is_shown():
    typical = rare_event(linear(), "y", LAST)["typical"].sel(parameter=["x1", "x4"]).values
    # Given y > 10 - h, the shortfalls i (1 - x_i) are uniform on a simplex of size h.
    median = 1 - stats.beta(1, 4).median() * (10 - LAST) / np.array([1, 4])
    assert typical == pytest.approx(median, abs=0.02)


RANK = 0.6
H = 0.01  # (2 - a)(2.5 - b) > 5 - H, a and b uniform: an integral over a
CORNER = integrate.quad(lambda a: (H - 2.5 * a) / (2.0 - a), 0.0, H / 2.5)[0]


def beyond_by_gumbel(total):
    """Return P(x1 + x2 > total) of standard normal x1 and x2 with a Gumbel copula."""
    copula = copula_of_rank("gumbel", RANK)

    def density(z):
        u, v = (inside(np.array([stats.norm.cdf(at)])) for at in (z, total * np.sqrt(2.0) - z))
        return stats.norm.pdf(z) * (1 - copula.conditional(v, u)[0])

    return integrate.quad(density, -8.0, 8.0, limit=400)[0]


TIES = [
    # x1 and x2 standard normal with the correlation of a Gaussian copula; the same; one a multiple.
    (
        PLANE,
        {"parameters": ["x1", "x2"], "rank_correlation": [[1.0, RANK], [RANK, 1.0]]},
        5.0,
        stats.norm.sf(5.0 / np.sqrt(1.0 + 2.0 * np.sin(np.pi * RANK / 6.0))),
    ),
    (
        PLANE,
        {
            "parameters": ["x1", "x2"],
            "rank_correlation": [[1.0, RANK], [RANK, 1.0]],
            "copula": "gumbel",
        },
        5.0,
        beyond_by_gumbel(5.0),
    ),
    (PLANE | {"x2": {"equals": "x1"}}, None, 5.0, stats.norm.sf(5.0 / np.sqrt(2.0))),
    (
        {
            "x1": {"distribution": "uniform", "lower": 1.0, "upper": 2.0},
            "x2": {"distribution": "uniform", "lower": 0.5, "upper": 1.5, "times": "x1"},
        },
        None,
        (5.0 - H) / np.sqrt(2.0),
        CORNER,
    ),
]


@pytest.mark.parametrize(
    ("inputs", "dependence", "threshold", "truth"), TIES, ids=("normal", "gumbel", "tied", "scaled")
)
def test_inputs_that_depend_on_each_other_do_so_in_a_rare_event(
    inputs, dependence, threshold, truth
):
    tables = {"dependence": dependence} if dependence else {}
    ds = rare_event(study("branches", inputs, **tables), "sum", threshold, samples=500, workers=0)
    assert close(ds, truth)


@pytest.mark.slow
def test_a_rare_angle_of_the_vibrator_against_brute_force():
    of = api.load_study("studies/vibrator-tolerances.toml")
    alone = of.model.alone("theory_disphasing_angle")
    limit, hits, total = 0.55, 0, 4_000_000
    every = of.with_samples(total)
    for start in range(0, total, 100_000):
        x, seed, *_ = row_block(every, start, start + 100_000)
        angle = alone.batch(x, seed, of.settings)[0]["theory_disphasing_angle"]
        hits += int((np.abs(angle) > limit).sum())
    brute = stats.binomtest(hits, total).proportion_ci(method="wilson")
    estimate = rare_event(of, "theory_disphasing_angle", limit)
    full = rare_event(of, "disphasing_angle", limit, method="importance")
    print(f"\nbrute force {hits / total:.3g}, subset {interval(estimate)}, full {interval(full)}")
    assert 3e-6 < hits / total < 3e-5
    for ds in (estimate, full):
        assert interval(ds)[0] < brute.high and brute.low < interval(ds)[1]
