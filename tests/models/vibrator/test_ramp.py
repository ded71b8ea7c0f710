"""Starts by an inverter: synchronous speeds rise in proportion to time, at equal slip."""

import math
from dataclasses import replace

import numpy as np
import paper
import pytest
from scipy.integrate import solve_ivp

from models.vibrator import MODEL
from models.vibrator.equations import general
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params, Settings

SETTINGS = Settings(run_up=15.0)


def compute(p, settings=SETTINGS):
    columns = np.broadcast_arrays(*np.atleast_1d(*p))
    x = np.stack(columns, axis=1)
    return MODEL.batch(x, np.zeros(len(x), np.uint64), settings)[0]


def rates(t, state, p):
    """Return the printed equations with the synchronous and the breakdown speeds of the moment."""
    share = min(1.0, t / p.ramp_time)
    down = (1 - share) * p.synchronous_speed_1, (1 - share) * p.synchronous_speed_2
    now = p._replace(
        synchronous_speed_1=p.synchronous_speed_1 - down[0],
        synchronous_speed_2=p.synchronous_speed_2 - down[1],
        breakdown_speed_1=p.breakdown_speed_1 - down[0],
        breakdown_speed_2=p.breakdown_speed_2 - down[1],
    )
    return paper.rates(t, state, now)


@pytest.mark.parametrize("duration", [0.6, 1.5])
def test_a_start_is_that_of_another_integrator(duration):
    p = Params(ramp_time=1.0, gravity=9.81, rated_torque_2=200.0, damping_ratio=0.05)
    m = system(p)
    start = propagator.start(p, m)
    first = paper.from_axis(p, start)
    for span in ((0.0, min(1.0, duration)), (1.0, duration)):
        if span[1] > span[0]:
            solution = solve_ivp(rates, span, first, "DOP853", rtol=1e-11, atol=1e-13, args=(p,))
            first = solution.y[:, -1]
    end = paper.from_axis(p, propagator.propagate(m, start, duration, 1e-12).state)
    scale = np.maximum(abs(first), 1e-4)
    assert end[8] > 30
    np.testing.assert_allclose(end / scale, first / scale, rtol=0, atol=1e-7)


def test_the_general_machine_ramps_as_the_rigid_one():
    p = Params(ramp_time=1.0)
    m = system(p)
    rigid = propagator.propagate(m, propagator.start(p, m), 1.5, 1e-11).state
    longer = general.extend(propagator.start(p, m))
    end = propagator.propagate(m, longer, 1.5, 1e-11).state
    np.testing.assert_allclose(end[:5], rigid[:5], rtol=1e-7, atol=1e-9)


def test_the_steady_state_is_that_of_a_direct_start_which_takes_less_long():
    direct, ramped = Params(damping_ratio=0.05), Params(damping_ratio=0.05, ramp_time=4.0)
    settings = replace(SETTINGS, instants=(1.0, 2.0, 6.0))
    a, b = compute(direct, settings), compute(ramped, settings)
    for name in ("disphasing_angle", "speed", "stroke_left"):
        np.testing.assert_allclose(a[name], b[name], rtol=1e-5)
    assert a["regime"] == b["regime"] == 0
    assert b["synchronisation_time"] > a["synchronisation_time"]
    half = b["run_up_speed_1"][0] / direct.synchronous_speed_1
    np.testing.assert_allclose(half[:2], [0.25, 0.5], atol=0.06)
    assert half[2] == pytest.approx(b["speed"][0] / direct.synchronous_speed_1, rel=1e-2)


def test_a_life_does_not_depend_on_how_the_machine_was_started():
    p = Params(ageing_time_1=3.6e7)
    direct, ramped = compute(p), compute(p._replace(ramp_time=2.0))
    times = [out["time_to_disphasing"][0] for out in (direct, ramped)]
    assert math.isfinite(times[0])
    np.testing.assert_allclose(times[1], times[0], rtol=1e-6)
