"""Which rows of a random model share a seed."""

import numpy as np
import pytest
from computed import computed
from noisy_studies import noisy

from uq.sampling.designs import DESIGNS
from uq.study.row_sampling import group_size, row_block, rows

DRAWN = [name for name, design in DESIGNS.items() if design.draw is not None]
GROUPED = ["saltelli", "shapley", "morris", "morris-optimised", "fast"]


def seeds_of(study):
    """Return the seeds of a study's rows, by replicate, group and the name of the block."""
    block = row_block(study, 0, rows(study))
    labels = computed(study)["block"].attrs["flag_meanings"].split()
    seeds = {}
    for replicate, group, place, seed in zip(
        block.replicate, block.group, block.block, block.seed, strict=True
    ):
        seeds[int(replicate), int(group), labels[place]] = int(seed)
    return seeds


@pytest.mark.parametrize("second_order", [False, True])
def test_a_shares_its_seed_with_the_rows_mixed_into_it_and_b_with_the_rest(second_order):
    study = noisy(samples=4, replicates=2, second_order=second_order)
    seeds = seeds_of(study)
    blocks = {label for _, _, label in seeds}
    assert blocks == {"A", "AB_x1", "AB_x2", "B", "noise"} | (
        {"BA_x1", "BA_x2"} if second_order else set()
    )
    assert group_size(study) == len(blocks)
    distinct = set()
    for replicate in range(2):
        for group in range(4):
            seed_by_label = {label: seeds[replicate, group, label] for label in blocks}
            for label, seed in seed_by_label.items():
                assert seed == seed_by_label["A" if label.startswith("A") else "B"]
            distinct |= set(seed_by_label.values())
    assert len(distinct) == 2 * 2 * 4


def test_the_noise_block_has_the_inputs_of_a():
    ds = computed(noisy(samples=8, replicates=1, second_order=True))
    x = np.stack([ds["x1"].values, ds["x2"].values], axis=-1).reshape(8, 7, 2)
    np.testing.assert_array_equal(x[:, 0], x[:, 6])
    y = ds["y"].values.reshape(8, 7)
    assert (y[:, 0] != y[:, 6]).all()


@pytest.mark.parametrize("method", ["shapley", "morris", "morris-optimised"])
def test_the_rows_of_a_path_share_a_seed(method):
    seeds = seeds_of(noisy(method, 8, 2))
    by_path = {}
    for (replicate, group, _), seed in seeds.items():
        by_path.setdefault((replicate, group), set()).add(seed)
    assert all(len(seeds_of_path) == 1 for seeds_of_path in by_path.values())
    assert len(set.union(*by_path.values())) == len(by_path) == 16


def test_the_points_of_a_curve_share_a_seed():
    by_curve = {}
    for (replicate, _, curve), seed in seeds_of(noisy("fast", 65, 2)).items():
        by_curve.setdefault((replicate, curve), set()).add(seed)
    assert all(len(seeds_of_curve) == 1 for seeds_of_curve in by_curve.values())
    assert len(set.union(*by_curve.values())) == len(by_curve) == 4


@pytest.mark.parametrize("method", DRAWN)
def test_deterministic_models_keep_their_rows_their_seeds_and_their_identity(method):
    samples = max(16, DESIGNS[method].least)
    random, plain = (noisy(method, samples, 2, model) for model in ("NOISY", "PLAIN"))
    block, other = (row_block(study, 0, rows(study)) for study in (random, plain))
    assert len(np.unique(other.seed)) == len(other.seed)
    grouped = method in GROUPED
    assert (len(block.seed) != len(other.seed) or (block.seed != other.seed).any()) == grouped
    # Nothing else than the rule tells these two apart.
    named = with_name(random, plain)
    assert (named.identity != plain.identity) == grouped


def with_name(study, other):
    from dataclasses import replace

    return replace(study, model=replace(study.model, name=other.model.name))


def test_plain_rows_of_a_random_model_are_what_they_were():
    # A and B, of which plain statistics are made, keep their seeds.
    random, plain = (noisy(samples=16, model=model) for model in ("NOISY", "PLAIN"))
    rows_of_random, other = (row_block(study, 0, rows(study)) for study in (random, plain))
    for label, block in (("A", 0), ("B", 3)):
        mine, old = (
            rows_of_model.seed[rows_of_model.block == block]
            for rows_of_model in (rows_of_random, other)
        )
        np.testing.assert_array_equal(mine, old, err_msg=label)


def test_a_study_is_random_unless_what_is_random_is_off():
    assert noisy(model="SOMETIMES").random
    assert noisy(model="SOMETIMES", fixed={"x2": 0.5}).random
    off = noisy(model="SOMETIMES", fixed={"x2": 0.0})
    assert not off.random and group_size(off) == 3


@pytest.mark.parametrize("method", GROUPED)
def test_any_chunking_gives_the_same_bits(method):
    study = noisy(method, max(8, DESIGNS[method].least), 2)
    whole, n = row_block(study, 0, rows(study)), rows(study)
    edges = [0, 1, n // 3, n // 3 + 4, n - 3, n]
    parts = [row_block(study, i, j) for i, j in zip(edges, edges[1:], strict=False)]
    for column, pieces in zip(whole, zip(*parts, strict=True), strict=True):
        assert column.tobytes() == np.concatenate(pieces).tobytes()


@pytest.mark.parametrize("method", [name for name in GROUPED if DESIGNS[name].append_only])
def test_more_samples_leave_the_first_rows_of_a_random_model_as_they_are(method):
    study = noisy(method, 16, 3)
    longer = row_block(study.with_samples(64), 0, rows(study))
    for column, other in zip(longer, row_block(study, 0, rows(study)), strict=True):
        np.testing.assert_array_equal(column, other)
