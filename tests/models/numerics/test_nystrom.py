"""Steps in Nystrom's form on equations whose solution is known, and against the plain form."""

import numpy as np
import pytest

from models.numerics.jit import kernel
from models.numerics.nystrom import LANES, STAGES, layout, stepper
from models.numerics.tableaux import DORMAND_PRINCE_8, TSITOURAS_5

DEGREES = 2
AT = layout(DEGREES)
FACTOR = AT.end
SLOPES = AT.end + LANES
RATES = np.linspace(0.2, 1.0, LANES)
DURATION = 3.0


@kernel
def _accelerate(w):
    """The motion p = ln(1 + a t), q = 1/(1 + a t): p'' = -(a q)^2, q'' = -2 p' q'."""
    for i in range(LANES):
        a, h = w[FACTOR + i], w[AT.step + i]
        q, p_rate, q_rate = w[AT.at + LANES + i], w[AT.speed + i], w[AT.speed + LANES + i]
        w[AT.rise + i] = -h * (a * q) ** 2
        w[AT.rise + LANES + i] = -2 * h * p_rate * q_rate


_step_5 = stepper(DEGREES, SLOPES, TSITOURAS_5, _accelerate)
_step_8 = stepper(DEGREES, SLOPES, DORMAND_PRINCE_8, _accelerate)


@kernel
def _run(order_8, steps, w):
    for _ in range(steps):
        if order_8:
            _step_8(w)
        else:
            _step_5(w)


def motion(a, t):
    """Return p, q and their rates."""
    return np.array([np.log1p(a * t), 1 / (1 + a * t), a / (1 + a * t), -a / (1 + a * t) ** 2])


def run(order, steps, rates=RATES, duration=DURATION):
    w = np.full(SLOPES + STAGES * DEGREES * LANES, np.nan)
    with np.errstate(invalid="ignore"):  # neighbours that are not finite
        w[: 2 * DEGREES * LANES] = motion(rates, 0.0).ravel()
    w[AT.step : AT.end] = np.tile(np.broadcast_to(duration / steps, LANES), DEGREES)
    w[FACTOR:SLOPES] = rates
    _run(order == 8, steps, w)
    return w[: 2 * DEGREES * LANES].reshape(2 * DEGREES, LANES)


@pytest.mark.parametrize(("order", "steps"), [(5, (10, 20, 40)), (8, (4, 8, 16))])
def test_the_order_is_that_of_the_method_in_every_lane(order, steps):
    exact = motion(RATES, DURATION)
    errors = np.array([abs(run(order, n) - exact).max(axis=0) for n in steps])
    fast = RATES > 0.5  # the others soon err by rounding only
    orders = np.log2(errors[:-1, fast] / errors[1:, fast])
    assert np.all(orders > order - 0.6)
    assert np.all(orders < order + 1.6)
    assert errors[-1].max() < {5: 1e-7, 8: 1e-9}[order]


@pytest.mark.parametrize(("order", "method"), [(5, TSITOURAS_5), (8, DORMAND_PRINCE_8)])
def test_it_is_the_same_step_as_in_the_plain_form(order, method):
    a, b = method.matrix(), np.array(method.b)
    for i, rate in enumerate(RATES):
        y, slopes = motion(rate, 0.0), np.zeros((len(b), 4))
        for stage in range(len(b)):
            _, q, p_rate, q_rate = y + a[stage] @ slopes
            slopes[stage] = p_rate, q_rate, -((rate * q) ** 2), -2 * p_rate * q_rate
        expected = y + b @ slopes
        np.testing.assert_allclose(run(order, 1, duration=1.0)[:, i], expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("order", [5, 8])
@pytest.mark.parametrize("lane", [0, 7, LANES - 1])
def test_a_lane_does_not_see_its_neighbours(order, lane):
    expected = run(order, 20)[:, lane]
    for others in (np.nan, np.inf, 1e3, 0.0):
        rates = np.where(np.arange(LANES) == lane, RATES, others)
        duration = np.where(np.arange(LANES) == lane, DURATION, others)
        np.testing.assert_array_equal(run(order, 20, rates, duration)[:, lane], expected)
