"""Motor torques that follow their characteristic with a delay, tau_e dT/dt + T = T_Kloss."""

import numpy as np
import paper
import pytest
from scipy.integrate import solve_ivp

from models.vibrator import MODEL
from models.vibrator.equations.system import system
from models.vibrator.exact import lag, propagator
from models.vibrator.exact.budgeted import prepare
from models.vibrator.exact.orbit import find_orbit, proposal
from models.vibrator.parameters import Params, Settings

SETTINGS = Settings(run_up=15.0)


def compute(p, settings=SETTINGS):
    columns = np.broadcast_arrays(*np.atleast_1d(*p))
    x = np.stack(columns, axis=1)
    return MODEL.batch(x, np.zeros(len(x), np.uint64), settings)[0]


def rates(t, state, p):
    """Return the printed equations with torques of their own, as states 10 and 11."""
    w, torque = state[8:10], state[10:12]
    share = t / p.ramp_time if t < p.ramp_time else 1.0
    top = share * np.array([p.synchronous_speed_1, p.synchronous_speed_2])
    slip = np.array([p.synchronous_speed_1, p.synchronous_speed_2])
    slip = slip - [p.breakdown_speed_1, p.breakdown_speed_2]
    rated = np.array([p.rated_torque_1, p.rated_torque_2])
    kloss = 2 * p.overload_capacity * rated * slip * (top - w) / (slip**2 + (top - w) ** 2)
    # The rated torques with which the printed motors deliver these torques at these speeds.
    behind = np.array([p.synchronous_speed_1, p.synchronous_speed_2]) - w
    needed = torque * (slip**2 + behind**2) / (2 * p.overload_capacity * slip * behind)
    now = p._replace(rated_torque_1=needed[0], rated_torque_2=needed[1])
    return np.concatenate([paper.rates(t, state[:10], now), (kloss - torque) / p.torque_lag])


@pytest.mark.parametrize("ramp", [0.0, 2.0])
def test_a_start_is_that_of_another_integrator(ramp):
    p = Params(torque_lag=0.05, ramp_time=ramp, rated_torque_2=200.0, damping_ratio=0.05)
    m = system(p)
    start = propagator.start(p, m)
    assert len(start) == 2 * lag.DEGREES
    first = np.concatenate([paper.from_axis(p, np.append(start[:5], start[10:15])), [0.0, 0.0]])
    ways = solve_ivp(rates, (0.0, 0.6), first, "DOP853", rtol=1e-11, atol=1e-12, args=(p,))
    end = propagator.propagate(m, start, 0.6, 1e-12).state
    got = paper.from_axis(p, np.append(end[:5], end[10:15]))
    expected = ways.y[:, -1]
    scale = np.maximum(abs(expected[:10]), 1e-4)
    assert abs(end[13]) > 20
    np.testing.assert_allclose(got / scale, expected[:10] / scale, rtol=0, atol=1e-7)
    np.testing.assert_allclose(end[-2:], expected[10:], rtol=1e-6)
    assert not end[8:10].any()


def orbit_of(p):
    machine = prepare(p, "small", 150_000)
    return find_orbit(machine, proposal(machine), 1e-9)


def test_orbits_tend_to_those_without_lag():
    p = Params(rated_torque_2=200.0, damping_ratio=0.03)
    direct = orbit_of(p)
    lagging = [orbit_of(p._replace(torque_lag=tau)) for tau in (1e-5, 1e-4)]
    angle = direct.measures.disphasing
    off = [abs(orbit.measures.disphasing - angle) for orbit in lagging]
    assert off[0] < 1e-6 and off[1] / off[0] == pytest.approx(10, rel=0.1)
    for orbit in lagging:
        assert orbit.measures.power_1 == pytest.approx(direct.measures.power_1, rel=1e-3)
        assert orbit.multiplier < 1


def test_rows_with_a_lag_have_all_outputs():
    p = Params(torque_lag=0.02, damping_ratio=0.05, ageing_time_1=3.6e7)
    out = compute(p)
    direct = compute(p._replace(torque_lag=0.0))
    assert out["regime"] == direct["regime"] == 0
    np.testing.assert_allclose(out["disphasing_angle"], direct["disphasing_angle"], atol=1e-3)
    name = "time_to_disphasing"
    np.testing.assert_allclose(out[name], direct[name], rtol=1e-2)
    assert out["synchronisation_time"] != direct["synchronisation_time"]
