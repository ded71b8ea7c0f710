"""Lives of beams whose wear follows known laws: smooth, with a jump, with noise, or ending."""

import numpy as np
import pytest
from laws import Law, lives

from models.beam.response.response import APERIODIC


def test_smooth_laws_are_integrated_in_few_steps_and_within_the_stated_errors():
    """Rates 4 x_1 and 3 x_2^2 make lives ln(1 + g)/4 and g/(1 + g)/3 of the growth g."""
    growths = np.array([0.5, 1.0])
    law = Law(lambda gaps: np.stack([4 * gaps[:, 0], 3 * gaps[:, 1] ** 2], axis=1))
    wear = lives(law, growths)
    expected = np.stack([np.log1p(growths) / 4, growths / (1 + growths) / 3])
    assert wear.time[0] == pytest.approx(expected, rel=3e-3)
    assert (np.abs(wear.time[0] - expected) <= wear.error[0]).all()
    assert (wear.error[0] < 0.02 * expected).all()
    assert law.periods < 700


@pytest.mark.parametrize("at", [0.13, 0.37, 0.6, 0.93])
@pytest.mark.parametrize("accuracy", [0.1, 0.01])
def test_a_jump_of_the_rate_is_located_as_accurately_as_asked(at, accuracy):
    law = Law(lambda gaps: np.where(gaps - 1 < at, 1.0, 4.0))
    wear = lives(law, [1.0], accuracy=accuracy)
    expected = at + (1 - at) / 4
    off = np.abs(wear.time[0, :, 0] - expected)
    assert (off <= wear.error[0, :, 0]).all()
    assert (wear.error[0, :, 0] <= accuracy * expected).all()
    assert law.periods < 2000


def test_lives_in_noise_lie_within_their_errors():
    law = Law(lambda gaps: 2.0 * gaps, noise=0.5)
    mean = np.exp(0.5**2 / 2)
    wear = lives(law, [1.0], n=64, regime=APERIODIC)
    off = np.abs(wear.time[:, :, 0] - np.log(2) / (2 * mean))
    assert np.mean(off <= wear.error[:, :, 0]) > 0.9
    assert np.median(wear.error[:, :, 0]) < 0.1 * np.log(2) / (2 * mean)
    assert (wear.history.regime[:, :16] == APERIODIC).all()


def test_a_gap_that_grows_beyond_the_tip_s_reach_never_grows_further():
    law = Law(lambda gaps: np.maximum(0.0, 1.55 - gaps.max(axis=1, keepdims=True)) + 0 * gaps)
    wear = lives(law, [0.2, 0.4, 1.0])
    expected = np.log(0.55 / (0.55 - np.array([0.2, 0.4])))
    assert wear.time[0, 0, :2] == pytest.approx(expected, rel=0.02)
    assert np.isposinf(wear.time[0, :, 2]).all() and not wear.reached[0, :, 2].any()
    assert wear.ended[0]
