"""Rows of a study: the stated laws, the stated order, the same bits however they are cut."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy_counterparts import of_scipy
from study_text import study_text

from uq.sampling.designs import DESIGNS
from uq.sampling.unit_cube import splitmix64
from uq.study.definition import study_from_text
from uq.study.row_sampling import group_size, row_block, rows

MIXED: dict[str, dict[str, Any]] = {
    "study": {"model": "exponential-wear"},
    "uncertain": {
        "x1": None,
        "x2": None,
        "x3": None,
        "depth": {"distribution": "gamma", "shape": 2.0, "scale": 1e-4},
        "rate": {"distribution": "lognormal", "mean": 1e-10, "cv": 0.5},
    },
}


DRAWN = [name for name, design in DESIGNS.items() if design.draw is not None]


def a_study(method="monte-carlo", **design):
    return study_from_text(study_text({"design": {"method": method, **design}}))


def wear(method="monte-carlo", **design):
    return study_from_text(study_text(MIXED | {"design": {"method": method, **design}}))


def same(block, other):
    return all(a.tobytes() == b.tobytes() for a, b in zip(block, other, strict=True))


def test_rows_are_counted_with_replicates_and_blocks():
    assert rows(a_study(samples=10, replicates=3)) == 30
    saltelli = a_study("saltelli", samples=8, replicates=3)
    assert (rows(saltelli), group_size(saltelli)) == (8 * 3 * 5, 5)
    second = a_study("saltelli", samples=8, replicates=3, second_order=True)
    assert (rows(second), group_size(second)) == (8 * 3 * 8, 8)


def test_types_and_shapes():
    block = row_block(wear(), 3, 10)
    assert (block.x.shape, block.x.dtype) == ((7, 3), np.float64)
    assert block.x.flags.c_contiguous
    assert [part.dtype for part in block[1:]] == [np.uint64, np.int32, np.int64, np.int16]
    assert row_block(wear(), 5, 5).x.shape == (0, 3)
    assert row_block(wear(), 0, 0).x.shape == (0, 3)


def test_columns_follow_the_model_and_the_rest_is_fixed():
    study = wear("sobol", samples=1024)
    x = row_block(study, 0, 1024).x
    rate, depth, threshold = x.T
    assert rate.mean() == pytest.approx(1e-10, rel=1e-3)
    assert depth.mean() == pytest.approx(2e-4, rel=1e-3)
    assert set(threshold) == {study.model.nominal["threshold"]}
    fixed = study_from_text(study.text + "\nfixed = {threshold = 0.25}")
    assert set(row_block(fixed, 0, 9).x[:, 2]) == {0.25}


def test_the_order_is_base_point_then_replicate_then_block():
    block = row_block(a_study("saltelli", samples=4, replicates=2), 0, 40)
    numbers = (block.group * 2 + block.replicate) * 5 + block.block
    np.testing.assert_array_equal(numbers, np.arange(40))
    assert (block.group.max(), block.replicate.max(), block.block.max()) == (3, 1, 4)


def test_a_group_exchanges_one_input_at_a_time():
    a, ab_1, ab_2, ab_3, b = row_block(a_study("saltelli", samples=4), 0, 5).x
    for i, mixed in enumerate([ab_1, ab_2, ab_3]):
        np.testing.assert_array_equal(mixed, np.where(np.arange(3) == i, b, a))


@settings(max_examples=40)
@given(
    method=st.sampled_from(DRAWN),
    replicates=st.integers(1, 3),
    second_order=st.booleans(),
    cuts=st.lists(st.integers(0, 10**6), max_size=5),
)
def test_any_chunking_gives_the_same_bits(method, replicates, second_order, cuts):
    crossed = DESIGNS[method].crossed
    samples = max(16, DESIGNS[method].least)
    study = wear(
        method, samples=samples, replicates=replicates, second_order=second_order and crossed
    )
    n = rows(study)
    edges = [0, *sorted(cut % (n + 1) for cut in cuts), n]
    parts = [row_block(study, i, j) for i, j in zip(edges, edges[1:], strict=False)]
    joined = [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]
    assert same(joined, row_block(study, 0, n))


@pytest.mark.parametrize("name", ["lognormal", "truncated-normal", "gamma", "weibull", "beta"])
def test_one_row_at_a_time_gives_the_bits_of_all_at_once(name):
    arguments = {
        "lognormal": {"mean": 1e-10, "cv": 0.5},
        "truncated-normal": {"mean": 1e-10, "sd": 1e-10, "lower": 0.0, "upper": 1e-9},
        "gamma": {"shape": 2.5, "scale": 1e-10},
        "weibull": {"shape": 1.5, "scale": 1e-10},
        "beta": {"alpha": 2.0, "beta": 3.0, "lower": 0.0, "upper": 1e-9},
    }[name]
    study = study_from_text(
        f"""
        study = {{name = "one", model = "exponential-wear"}}
        design = {{method = "monte-carlo", samples = 64}}
        [uncertain.rate]
        distribution = "{name}"
        """
        + "\n".join(f"{key} = {value!r}" for key, value in arguments.items())
    )
    singly = np.concatenate([row_block(study, i, i + 1).x for i in range(64)])
    assert singly.tobytes() == row_block(study, 0, 64).x.tobytes()


@pytest.mark.parametrize("method", [name for name in DESIGNS if DESIGNS[name].append_only])
def test_more_samples_leave_the_first_rows_as_they_are(method):
    study = wear(method, samples=16, replicates=3)
    assert same(row_block(study.with_samples(64), 0, rows(study)), row_block(study, 0, rows(study)))


def test_rows_far_away_cost_no_memory_for_those_before():
    study = wear(samples=2**30)
    block = row_block(study, 2**30 - 3, 2**30)
    assert list(block.group) == [2**30 - 3, 2**30 - 2, 2**30 - 1]
    assert same(block, row_block(study.with_samples(2**30), 2**30 - 3, 2**30))


@pytest.mark.parametrize("name", ["depth", "rate"])
def test_a_sobol_design_realises_the_stated_law(name):
    study = wear("sobol", samples=1024)
    x = row_block(study, 0, 1024).x[:, study.model.parameter_names.index(name)]
    distance = stats.kstest(x, of_scipy(study.uncertain[name]).cdf).statistic
    # One point in each slice of probability 1/1024, so the distance cannot be larger.
    assert distance <= 1 / 1024 + 1e-6


def test_inputs_are_independent():
    x = row_block(a_study(samples=20_000), 0, 20_000).x
    assert np.abs(np.corrcoef(x.T) - np.eye(3)).max() < 5 / np.sqrt(20_000)


def test_rows_of_several_replicates_fill_the_law_together():
    study = wear("latin-hypercube", samples=50, replicates=4)
    block = row_block(study, 0, 200)
    for replicate in range(4):
        x = block.x[block.replicate == replicate, 0]
        assert stats.kstest(x, of_scipy(study.uncertain["rate"]).cdf).statistic <= 1 / 50 + 1e-6


def test_the_seed_hash_issplitmix64():
    # First outputs of the reference generator started at 1234567.
    reference = [6457827717110365317, 3203168211198807973, 9817491932198370423]
    states = np.uint64(1234567) + np.arange(3, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    assert splitmix64(states).tolist() == reference


def test_row_seeds_are_distinct_and_depend_on_the_study():
    study = a_study("saltelli", samples=256, replicates=4)
    seeds, other = (row_block(s, 0, 5120).seed for s in (study, a_study("saltelli", seed=8)))
    assert len(np.unique(seeds)) == 5120
    assert not np.intersect1d(seeds, other).size
    bits = np.unpackbits(seeds.view(np.uint8)).mean()
    assert bits == pytest.approx(0.5, abs=5 * 0.5 / np.sqrt(5120 * 64))
