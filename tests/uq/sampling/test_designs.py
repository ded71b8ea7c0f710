"""Points of the unit cube: the promises every design makes, and those that tell them apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from SALib.sample import fast_sampler
from SALib.sample import sobol as salib_sobol
from scipy.stats import kstest, qmc
from wordings import sentence

from uq.sampling.designs import CURVES, DESIGNS, TRAJECTORIES
from uq.sampling.unit_cube import STEP, replicate_seed

SIZE = 64
DRAWN = [name for name, design in DESIGNS.items() if design.draw is not None]
REPEATING = [  # values on levels, or on one curve for all
    name for name in DRAWN if DESIGNS[name].layout in (TRAJECTORIES, CURVES) or name == "rbd-fast"
]
POWERS = [name for name in DRAWN if DESIGNS[name].power_of_two]
LEAST = [(name, DESIGNS[name].least) for name in DRAWN if DESIGNS[name].least > 1]


def points(method, start=0, stop=SIZE, *, samples=None, seed=5, replicates=2, d=3, **more):
    samples = max(SIZE, DESIGNS[method].least) if samples is None else samples
    return DESIGNS[method].unit_rows(
        seed=seed,
        replicates=replicates,
        d=d,
        samples=samples,
        second_order=more.get("second_order", False),
        start=start,
        stop=stop,
    )


@pytest.mark.parametrize("method", DRAWN)
def test_points_lie_inside_the_open_cube(method):
    cube = points(method)
    assert cube.shape == (SIZE, 2, DESIGNS[method].blocks(3, False), 3)
    assert np.all((cube > 0) & (cube < 1))


@given(
    method=st.sampled_from(DRAWN),
    cuts=st.lists(st.integers(0, SIZE), max_size=4),
    second_order=st.booleans(),
)
def test_any_cutting_gives_the_same_bits(method, cuts, second_order):
    edges = [0, *sorted(cuts), SIZE]
    parts = [
        points(method, start, stop, second_order=second_order)
        for start, stop in zip(edges, edges[1:], strict=False)
    ]
    whole = points(method, second_order=second_order)
    assert np.concatenate(parts).tobytes() == whole.tobytes()


@pytest.mark.parametrize("method", DRAWN)
def test_more_samples_append_where_the_design_says_so(method):
    first, again = points(method), points(method, 0, SIZE, samples=4 * SIZE)
    if DESIGNS[method].append_only or not method.startswith("morris"):
        assert np.array_equal(first, again) == DESIGNS[method].append_only


@pytest.mark.parametrize("method", [name for name in DRAWN if name not in REPEATING])
def test_replicates_and_seeds_have_nothing_in_common(method):
    cube, other = points(method, replicates=3), points(method, seed=6)
    groups = [cube[:, 0, 0], cube[:, 1, 0], cube[:, 2, 0], other[:, 0, 0], other[:, 1, 0]]
    assert len({value for group in groups for value in group.ravel()}) == 5 * SIZE * 3


@pytest.mark.parametrize("method", REPEATING)
@pytest.mark.parametrize("seed", [0, 5])
def test_replicates_and_seeds_differ(method, seed):
    cube, other = points(method, seed=seed), points(method, seed=6)
    np.testing.assert_array_equal(cube, points(method, seed=seed))
    assert (cube[:, 0] != cube[:, 1]).mean() > 0.4
    assert (cube != other).mean() > 0.4


@pytest.mark.parametrize("method", DRAWN)
def test_a_replicate_does_not_depend_on_how_many_there_are(method):
    few, many = points(method, replicates=2), points(method, replicates=5)
    np.testing.assert_array_equal(few, many[:, :2])


def test_replicates_draw_from_the_streams_numpy_calls_independent():
    spawned = np.random.SeedSequence(2026).spawn(3)
    for replicate, seed in enumerate(spawned):
        ours = replicate_seed(2026, replicate).generate_state(8)
        np.testing.assert_array_equal(ours, seed.generate_state(8))


def test_means_of_replicates_scatter_as_independent_ones():
    means = points("monte-carlo", 0, 200, samples=200, replicates=400, d=1).mean(axis=0).ravel()
    # Standard error of a mean of 200 uniform numbers, and of that scatter among 400: 3.5 %.
    assert means.std(ddof=1) == pytest.approx(np.sqrt(1 / 12 / 200), rel=0.15)


@pytest.mark.parametrize("second_order", [False, True])
def test_saltelli_rows_are_those_of_salib(second_order):
    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}
    cube = points("saltelli", second_order=second_order)
    for replicate in range(2):
        theirs = salib_sobol.sample(
            problem,
            SIZE,
            calc_second_order=second_order,
            seed=np.random.default_rng(replicate_seed(5, replicate)),
        )
        np.testing.assert_array_equal(cube[:, replicate].reshape(-1, 3), theirs)


def test_blocks_are_named_in_row_order():
    names = DESIGNS["saltelli"].layout.labels(("p", "q"), True, False)
    assert names == ("A", "AB_p", "AB_q", "BA_p", "BA_q", "B")
    a, ab_p, ab_q, ba_p, ba_q, b = points("saltelli", d=2, second_order=True)[0, 0]
    assert (ab_p[0], ab_p[1]) == (b[0], a[1])
    assert (ab_q[0], ab_q[1]) == (a[0], b[1])
    assert (ba_p[0], ba_p[1]) == (a[0], b[1])
    assert (ba_q[0], ba_q[1]) == (b[0], a[1])


def test_blocks_of_a_plain_design_are_samples():
    assert DESIGNS["halton"].layout.labels(("p", "q"), False, False) == ("sample",)


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol"])
def test_stratified_designs_fill_each_slice_once(method):
    for replicate in range(2):
        slices = np.floor(points(method)[:, replicate, 0] * SIZE).astype(int)
        np.testing.assert_array_equal(np.sort(slices, axis=0), np.tile(np.arange(SIZE), (3, 1)).T)


def test_a_halton_design_is_more_even_than_chance():
    even = qmc.discrepancy(points("halton", 0, 256, samples=256)[:, 0, 0])
    chance = qmc.discrepancy(points("monte-carlo", 0, 256, samples=256)[:, 0, 0])
    assert even < chance / 5


@pytest.mark.parametrize("method", POWERS)
@pytest.mark.parametrize(("samples", "following"), [(3, 4), (1000, 1024), (1025, 2048)])
def test_the_next_legal_size_is_stated(method, samples, following):
    assert DESIGNS[method].size_problem(samples) == sentence(
        "size", least=following // 2, next=following
    )
    assert DESIGNS[method].size_problem(following) is None


@pytest.mark.parametrize("method", [name for name in DRAWN if name not in POWERS])
def test_other_designs_take_any_size_that_is_large_enough(method):
    assert DESIGNS[method].size_problem(1000) is None
    assert DESIGNS[method].size_problem(0) is not None


@pytest.mark.parametrize("method", [n for n in DRAWN if DESIGNS[n].layout is TRAJECTORIES])
@pytest.mark.parametrize("samples", [2, 8, 9, 20])
def test_each_step_of_a_trajectory_changes_one_input_by_the_same_probability(method, samples):
    cube = points(method, 0, samples, samples=samples)
    assert cube.shape == (samples, 2, 4, 3)
    steps = np.diff(cube, axis=2)
    np.testing.assert_array_equal((steps != 0).sum(axis=3), 1)
    np.testing.assert_array_equal((steps != 0).sum(axis=2), 1)
    np.testing.assert_allclose(np.abs(steps[steps != 0]), STEP, rtol=1e-12)
    assert set(np.round(cube.ravel(), 12)) <= {0.005, 0.335, 0.665, 0.995}


def test_optimised_trajectories_lie_farther_apart():
    def spread(method):
        cube = points(method, 0, 8, samples=8, replicates=20).transpose(1, 0, 2, 3)
        return np.mean([np.linalg.norm(a[:, None] - b) for c in cube for a in c for b in c])

    assert spread("morris-optimised") > 1.05 * spread("morris")


def test_the_rows_of_extended_fast_are_those_of_salib():
    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}
    cube = points("fast", 0, 100, samples=100)
    for replicate in range(2):
        rng = np.random.default_rng(replicate_seed(5, replicate))
        theirs = fast_sampler.sample(problem, 100, seed=rng)
        np.testing.assert_array_equal(cube[:, replicate].transpose(1, 0, 2).reshape(-1, 3), theirs)


def test_a_random_balance_design_fills_each_input_evenly_and_mixes_them():
    cube = points("rbd-fast", 0, 1024, samples=1024)[:, 0, 0]
    for column in cube.T:
        assert kstest(column, "uniform").statistic < 2 / 1024
    assert np.abs(np.corrcoef(cube.T) - np.eye(3)).max() < 0.15


@pytest.mark.parametrize(("method", "least"), LEAST)
def test_the_smallest_size_is_stated(method, least):
    assert DESIGNS[method].size_problem(least) is None
    assert DESIGNS[method].size_problem(least - 1) == f"must be between {least} and 1073741824"
