"""Motors are locked only on a stable orbit."""

import numpy as np
import pytest
from test_start import fleet

from models.vibrator.parameters import Settings
from models.vibrator.start import exact, fast
from models.vibrator.start.regimes import ASYNCHRONOUS, LOCKED_0

SLIPPING = fleet(
    2, shaft_distance=0.1, stiffness_x=2.07e6, support_offset=0.0, damping_ratio=0.03,
    synchronous_speed_2=[156.9, 157.0],
)  # fmt: skip
"""Hardly coupled: the first turns past in 100 s."""


@pytest.mark.parametrize("road", [fast, exact])
def test_motors_that_slip_slowly_are_not_locked(road):
    out, _ = road.outcomes(SLIPPING, Settings(run_up=10.0))
    assert out.regime.tolist() == [ASYNCHRONOUS, LOCKED_0]
    assert np.isinf(out.synchronisation_time[0]) and np.isnan(out.disphasing[0])
    assert out.multiplier[1] < 1


@pytest.mark.parametrize("road", [fast, exact])
def test_an_unstable_synchronous_motion_is_not_locked(road):
    out, _ = road.outcomes(fleet(damping_ratio=0.0), Settings(run_up=5.0))
    assert out.regime[0] == ASYNCHRONOUS
    assert np.isnan(out.multiplier[0]) and np.isinf(out.synchronisation_time[0])
