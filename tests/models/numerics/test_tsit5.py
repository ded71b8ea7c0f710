"""Tsitouras' steps on Euler's rotor, whose motion Jacobi's elliptic functions are."""

import numpy as np
import pytest
from scipy.special import ellipj

from models.numerics.blocks import LANES, layout
from models.numerics.jit import kernel
from models.numerics.tsit5 import STAGES, combiner

ROTORS = 4  # in a lane
QUANTITIES = 3 * ROTORS
_combine = combiner(QUANTITIES)
_Y, _NEW, _K, _SIZE = layout(QUANTITIES, STAGES)
_WHOLE = QUANTITIES * LANES
_NEXT = ROTORS * LANES

PARAMETERS = np.linspace(0.0, 0.95, ROTORS * LANES).reshape(ROTORS, LANES)
DURATIONS = np.linspace(2.0, 5.0, LANES)


@kernel
def _run(steps, h, parameter, w):
    y, new = w[_Y : _Y + _WHOLE], w[_NEW : _NEW + _WHOLE]
    for _ in range(steps):
        for stage in range(1, STAGES + 1):
            at = y if stage == 1 else new
            k = w[_K + (stage - 1) * _WHOLE : _K + stage * _WHOLE]
            for i in range(ROTORS * LANES):
                lane = i % LANES
                sn, cn, dn = at[i], at[_NEXT + i], at[2 * _NEXT + i]
                k[i] = h[lane] * cn * dn
                k[_NEXT + i] = -h[lane] * sn * dn
                k[2 * _NEXT + i] = -h[lane] * parameter[i] * sn * cn
            _combine(stage, w)
        y[:] = new


def run(steps, parameter=PARAMETERS, duration=DURATIONS):
    w = np.full(_SIZE, np.nan)
    w[_Y : _Y + _WHOLE] = np.repeat([0.0, 1.0, 1.0], _NEXT)
    _run(steps, duration / steps, parameter.ravel(), w)
    return w[_Y : _Y + _WHOLE].reshape(3, ROTORS, LANES)


def test_the_order_is_5_in_every_lane():
    exact = np.array(ellipj(DURATIONS, PARAMETERS)[:3])
    errors = np.array([abs(run(steps) - exact).max(axis=0) for steps in (20, 40, 80)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 4.6) & (orders < 5.9))
    assert errors[-1].max() < 1e-8


@pytest.mark.parametrize("lane", [0, 7, LANES - 1])
def test_a_lane_does_not_see_its_neighbours(lane):
    expected = run(50)[..., lane]
    for others in (np.nan, np.inf, 1e3, 0.0):
        alone = np.arange(LANES) == lane
        parameter = np.where(alone, PARAMETERS, others)
        duration = np.where(alone, DURATIONS, others)
        np.testing.assert_array_equal(run(50, parameter, duration)[..., lane], expected)


def test_the_parts_of_a_block_do_not_overlap():
    assert (0, _WHOLE, 2 * _WHOLE) == (_Y, _NEW, _K)
    assert _SIZE == (2 + STAGES) * _WHOLE
