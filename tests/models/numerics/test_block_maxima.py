"""Growth of largest values with time."""

import numpy as np
import pytest

from models.numerics.block_maxima import maximum_and_growth

BLOCKS, LENGTH = 20, 50


@pytest.mark.parametrize(
    ("quantile", "least"),
    [
        (lambda p: -np.log(-np.log(p)), 0.95),  # a shape of zero: as much for each factor
        (lambda p: 1 - np.sqrt(1 - p), 0.0),  # bounded: less
    ],
)
def test_largest_values_grow_no_more_than_before(quantile, least):
    rng = np.random.default_rng(7)
    blocks = rng.uniform(size=(4000, BLOCKS)) ** (1 / LENGTH)  # the largest of LENGTH
    longer = rng.uniform(size=4000) ** (1 / (LENGTH * BLOCKS * (BLOCKS - 1)))
    largest, growth = maximum_and_growth(quantile(blocks))
    later = np.maximum(largest, quantile(longer)) - largest
    assert least * growth.mean() < later.mean() < 1.05 * growth.mean()


def test_a_value_that_all_blocks_reach_does_not_grow():
    assert maximum_and_growth(np.full((2, BLOCKS), 3.0))[1].tolist() == [0.0, 0.0]
