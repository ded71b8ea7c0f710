"""Lives at ever slower wear, extrapolated to the limit of slow wear with an error."""

import numpy as np
import pytest

from models.beam.wear.extrapolation import extrapolate, extrapolate_smooth

PACES = np.array([1.0, 2.0, 4.0, 8.0, 16.0])


@pytest.mark.parametrize("order", [1.0, 2 / 3])
def test_lives_with_one_power_law_of_error_are_extrapolated_to_its_limit(order):
    times = (1.0 + 0.2 * PACES**-order)[:, None]
    time, error = extrapolate(times)
    assert time == pytest.approx([1.0], abs=1e-9)
    assert error == pytest.approx(times[-1] - 1.0)


def test_four_lives_suffice_where_they_approach_their_limit_evenly():
    times = np.stack([1.0 + 0.2 / PACES[:4], [1.0, 1.1, 1.0, 1.05], [1.0, 1.001, 1.0, 1.001]], 1)
    time, error = extrapolate_smooth(times)
    assert time == pytest.approx([1.0, 1.05, 1.001], abs=1e-9)
    assert error == pytest.approx([0.2 / 8, 0.4, 0.004])


def test_lives_scattered_about_the_true_one_are_averaged_and_keep_their_error():
    rng = np.random.default_rng(11)
    times = 1.0 + 0.05 * rng.standard_normal((5, 4000)) / np.sqrt(PACES[:, None])
    time, error = extrapolate(times)
    assert np.median(np.abs(time - 1.0)) < 1.2 * np.median(np.abs(times[-1] - 1.0))
    assert 0.9 < np.mean(np.abs(time - 1.0) <= error) < 0.99


def test_lives_that_change_ever_more_are_far_from_their_limit():
    _, error = extrapolate(np.array([[1.00], [1.00], [1.00], [0.99], [0.96]]))
    assert error[0] == pytest.approx(0.24)


def test_a_life_far_from_all_faster_ones_is_left_as_it_is():
    time, error = extrapolate(np.array([[9.0], [9.0], [9.0], [9.0], [1.0]]))
    assert time[0] == 1.0
    assert error[0] > 1.0
