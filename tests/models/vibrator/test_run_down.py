"""Run-down: the energy goes where it can, both propagators agree, and excursions are bounded."""

from dataclasses import replace

import lagrange
import numpy as np
import pytest
from scipy.integrate import simpson

from models.vibrator import MODEL
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params, Settings

PHASES = (0.0, 1.0, 2.5, 4.0)
SETTINGS = Settings(run_up=15.0, run_down_phases=PHASES)
DAMPED = Params(damping_ratio=0.07)


def compute(p, settings=SETTINGS):
    columns = np.broadcast_arrays(*np.atleast_1d(*p))
    x = np.stack(columns, axis=1)
    return MODEL.batch(x, np.zeros(len(x), np.uint64), settings)[0]


def test_energy_goes_into_bearings_and_dampers_alone():
    """The machine of the lanes, switched off, loses what they take, to 1e-6."""
    p = DAMPED
    m = system(p)
    rigid = m.rigid._replace(torque_1=0.0, torque_2=0.0)
    state = rigid_motion.initial_state(Params._make(np.array([v]) for v in p))[0]
    state[8:] = 60.0, 58.0
    times = np.linspace(0.0, 40.0, 160_001)
    samples = propagator.propagate(m._replace(rigid=rigid), state, 40.0, 1e-11, times=times).samples
    q, v = np.zeros((2, 7)), np.zeros((2, 7))
    q[:, :5], v[:, :5] = samples[[0, -1], :5], samples[[0, -1], 5:]
    energy = lagrange.mechanics(False).energy
    first, last = (float(energy(lagrange.values(p), 0.0, 0.0, q[i], v[i])) for i in (0, 1))
    vx, vy, va, w_1, w_2 = samples[:, 5:].T
    loss = p.bearing_constant_1 * p.unbalance_1 * abs(w_1) * w_1**2
    loss += p.bearing_constant_2 * p.unbalance_2 * abs(w_2) * w_2**2
    b_x, b_y = rigid.damping_x, rigid.damping_y
    loss += b_x * (vx + p.support_offset * va) ** 2
    loss += b_y * (vy**2 + p.support_half_spacing**2 * va**2)
    assert abs(samples[:, :2]).max() > 5e-3 and max(w_1[-1], w_2[-1]) < 12  # through resonance
    assert first - last == pytest.approx(simpson(loss, x=times), rel=1e-6)


@pytest.mark.parametrize(
    "p", [DAMPED, DAMPED._replace(support_imbalance=0.3, bearing_constant_2=3e-4, gravity=9.81)]
)
def test_both_propagators_agree(p):
    fast = compute(p)
    exact = compute(p, replace(SETTINGS, propagator="exact"))
    name = "run_down_excursion"
    np.testing.assert_allclose(fast[name], exact[name], rtol=2e-4)
    if not p.gravity:  # from turning to swinging, the time depends on the last digits
        np.testing.assert_allclose(fast["run_down_time"], exact["run_down_time"], rtol=1e-5)
    assert len(set(fast[name][0].tolist())) == len(PHASES)
    one_phase = compute(p, replace(SETTINGS, run_down_phases=PHASES[2:3]))
    np.testing.assert_array_equal(one_phase[name][0], fast[name][0, 2:3])


@pytest.mark.parametrize("chosen", ["fast", "exact"])
def test_a_run_down_ends_as_by_an_integrator_of_its_own(chosen):
    """By an integrator written from the equations alone, with DOP853 of scipy at 1e-11."""
    p = Params(damping_ratio=0.2, bearing_constant_1=5e-4, bearing_constant_2=5e-4)
    settings = replace(SETTINGS, run_down_phases=(0.0,), propagator=chosen)
    soft = p._replace(stiffness_x=2e5, stiffness_y=2e5, support_offset=0.0)
    softer = p._replace(stiffness_x=6e4, stiffness_y=6.9e4, support_offset=0.0)
    times = [compute(case, settings)["run_down_time"].item() for case in (p, soft, softer)]
    np.testing.assert_allclose(times, [14.7010, 12.2400, 19.872], rtol=2e-5)
    out = compute(softer, settings)
    assert out["run_down_excursion"] == pytest.approx(6.91e-3, rel=1e-3)  # 9.5 mm three seconds on
    cut = compute(softer, replace(settings, run_down=10.0))
    assert cut["run_down_time_censored"].all() and cut["run_down_time"] == 10.0
    assert 0 < cut["run_down_excursion"] < out["run_down_excursion"]


def test_excursions_are_within_the_energy_of_the_vibrators_at_resonance():
    """A <= w_n sqrt(sum(J_zr + m e^2)/k), w_n the highest resonance and k the softest spring."""
    rng = np.random.default_rng(5)
    n = 24
    p = Params(
        stiffness_x=rng.uniform(5e5, 1e6, n),
        stiffness_y=rng.uniform(1e6, 2.5e6, n),
        damping_ratio=rng.uniform(0.0, 0.1, n),
        bearing_constant_1=rng.uniform(0, 3e-4, n),
        support_offset=0.0,
    )
    out = compute(p)
    locked = out["regime"] <= 1
    inertia = 2 * (p.rotor_inertia + p.unbalance_1**2 / p.unbalanced_mass)
    modes = np.stack([p.stiffness_y / 2200, p.stiffness_y * p.support_half_spacing**2 / 2667])
    bound = np.sqrt(modes.max(axis=0) * inertia / p.stiffness_x)
    assert locked.sum() > n / 2
    assert (out["run_down_excursion"][locked] < bound[locked, None]).all()
    assert np.isnan(out["run_down_excursion"][~locked]).all()
    assert np.isnan(out["run_down_time"][~locked]).all()


def test_a_run_down_by_friction_alone_takes_the_time_of_its_closed_form():
    """On a heavy body w' = -rho m e w^2/(J_zr + m e^2): T = (1/w_rest - 1/w)/that rate."""
    p = Params(
        body_mass=6e4, body_inertia=8e4, stiffness_x=2e4, stiffness_y=6.9e4, damping_ratio=0.05
    )
    out = compute(p)
    inertia = p.rotor_inertia + p.unbalance_1**2 / p.unbalanced_mass
    rate = p.bearing_constant_1 * p.unbalance_1 / inertia
    rest = 0.05 * p.synchronous_speed_1
    expected = (1 / rest - 1 / out["speed"][0]) / rate
    np.testing.assert_allclose(out["run_down_time"], expected, rtol=2e-2)


def test_what_takes_too_long_is_censored_and_nothing_is_asked_by_default():
    frictionless = Params(bearing_constant_1=0.0, bearing_constant_2=0.0)
    out = compute(frictionless, replace(SETTINGS, run_down=50.0))
    assert out["run_down_time_censored"].all() and (out["run_down_time"] == 50.0).all()
    assert not any(name.startswith("run_down") for name in compute(Params(), Settings()))


def test_machines_with_feed_and_mounts_run_down_too():
    p = DAMPED._replace(feed_mass=50.0, throw_coefficient=0.8)
    out = compute(p, replace(SETTINGS, run_down_phases=(0.0,)))
    empty = compute(DAMPED, replace(SETTINGS, run_down_phases=(0.0,)))
    for name in ("run_down_excursion", "run_down_time"):
        np.testing.assert_allclose(out[name], empty[name], rtol=0.3)
