"""A root is found to its tolerance, with no more values than Brent's method on smooth functions."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ndtr

from uq.stats.quantile_functions import root


class Counted:
    """A function that counts its calls."""

    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, x):
        self.calls += 1
        return float(self.function(x))


def test_probabilities_are_inverted_as_fast_as_by_brent():
    rng, our_calls, brent = np.random.default_rng(1), 0, 0
    for p in rng.uniform(0.001, 0.999, 200):
        scatter, middle = rng.uniform(0.05, 2), 3 * rng.normal()
        function = Counted(lambda x, p=p, s=scatter, m=middle: ndtr((x - m) / s) - p)
        ends = middle - 4 * scatter, middle + 4.3 * scatter
        zero = root(function, ends[::-1], 1e-12)
        our_calls, function.calls = our_calls + function.calls, 0
        assert abs(zero - brentq(function, *ends, xtol=1e-12)) < 2e-12
        brent += function.calls
    assert our_calls < brent


@pytest.mark.parametrize(
    ("function", "ends", "expected"),
    [
        (lambda x: np.sign(x - 0.3), (0.0, 1.0), 0.3),  # a jump
        (lambda x: (x - 1) ** 3, (-4.0, 9.0), 1.0),  # a flat place
        (lambda x: 1e-3 * (x > 0.5) - 1e-300 * (x <= 0.5), (0.0, 1.0), 0.5),
        (lambda x: np.inf if x > 2 else x - 1.5, (0.0, 8.0), 1.5),
        (lambda x: x, (0.0, 1.0), 0.0),
        (lambda x: x - 1, (0.0, 1.0), 1.0),
    ],
)
def test_what_is_not_smooth_takes_hardly_longer_than_bisection(function, ends, expected):
    counted = Counted(function)
    assert abs(root(counted, ends, 1e-9) - expected) < 1e-9
    assert counted.calls < 50


def test_a_function_of_one_sign_has_no_root():
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: x**2 + 1, (-1.0, 1.0), 1e-9)
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: np.nan, (-1.0, 1.0), 1e-9)
