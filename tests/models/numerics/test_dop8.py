"""Steps of order 8 abreast, on Euler's rotor, whose motion Jacobi's elliptic functions are."""

import numpy as np
from scipy.special import ellipj

from models.numerics.blocks import LANES, layout
from models.numerics.dop8 import STAGES, combiner, estimator
from models.numerics.jit import kernel

_combine = combiner(3)
_estimate = estimator(3, 2)
_Y, _NEW, _K, _SIZE = layout(3, STAGES)
_WHOLE = 3 * LANES
PARAMETERS = np.linspace(0.0, 0.95, LANES)
DURATIONS = np.linspace(2.0, 5.0, LANES)


@kernel
def _run(steps, h, parameter, w, share, error):
    y, new = w[_Y : _Y + _WHOLE], w[_NEW : _NEW + _WHOLE]
    for _ in range(steps):
        for stage in range(1, STAGES + 1):
            at = y if stage == 1 else new
            k = w[_K + (stage - 1) * _WHOLE : _K + stage * _WHOLE]
            for i in range(LANES):
                sn, cn, dn = at[i], at[LANES + i], at[2 * LANES + i]
                k[i] = h[i] * cn * dn
                k[LANES + i] = -h[i] * sn * dn
                k[2 * LANES + i] = -h[i] * parameter[i] * sn * cn
            _combine(stage, w)
        _estimate(w, share, error)
        y[:] = new


def run(steps, duration=DURATIONS):
    """Return the states at the end, (3, LANES), and the error of the last step by its estimate."""
    w, error = np.full(_SIZE, np.nan), np.full(5 * LANES, np.nan)
    w[_Y : _Y + _WHOLE] = np.repeat([0.0, 1.0, 1.0], LANES)
    _run(steps, duration / steps, PARAMETERS, w, np.ones(2 * LANES), error)
    return w[_Y : _Y + _WHOLE].reshape(3, LANES), error[:LANES]


def test_the_order_is_8_in_every_lane():
    exact = np.array(ellipj(DURATIONS, PARAMETERS)[:3])
    errors = np.array([abs(run(steps)[0] - exact).max(axis=0) for steps in (6, 12)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders > 7.2) & (orders < 10.5))
    assert errors[-1].max() < 1e-6


def test_the_estimate_shrinks_with_the_eighth_power_and_is_no_understatement():
    short = DURATIONS / 12
    exact = np.array(ellipj(short, PARAMETERS)[:2])
    state, coarse = run(1, short)
    _, fine = run(1, short / 2)
    orders = np.log2(coarse / fine)
    assert np.all((orders > 7.2) & (orders < 9.5))
    assert np.all(coarse > abs(state[:2] - exact).max(axis=0))
