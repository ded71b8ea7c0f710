"""Impulse and energy of a blow against the balances of momentum and energy."""

import numpy as np
import pytest

from models.mole.batch import batch
from models.mole.parameters import Params, Settings
from models.mole.theory.system import mole
from models.mole.trajectory import simulate

SEVEN = Params(control_frequency=7.0)  # settles within two seconds, and repeats every second


@pytest.fixture(scope="module")
def settled():
    """Return blows per second, outputs, and the fourth second of the motion."""
    outputs, status = batch(np.array([SEVEN]), np.zeros(1, np.uint64), Settings())
    assert not status.any() and outputs["period"] == 1
    time, seen = simulate(SEVEN, Settings(tolerance=1e-10))
    last = time >= 3.0
    motion = {name: values[last] for name, (_, _, values) in seen.items()}
    row = {name: float(values[0]) for name, values in outputs.items()}
    return 7 * row["impacts_per_period"], row, time[last], motion


def forces(motion):
    """Return what else pushes the bar forwards, and the mole backwards, besides friction [N]."""
    q = mole(SEVEN, "physical")
    u = motion["displacement"]
    slope = -2 * q.sharpness * u * q.bar_inductance * np.exp(-q.sharpness * u**2)
    magnetic = 0.5 * motion["current"] ** 2 * slope
    spring = q.spring_stiffness * (u - q.spring_rest)
    return q, magnetic - q.damping * motion["velocity"] - spring


def test_the_impulse_is_what_the_bar_loses(settled):
    blows, outputs, time, motion = settled
    q, others = forces(motion)
    speed = motion["velocity"] + motion["mole_velocity"]
    pushed = np.trapezoid(others - motion["bar_friction"], time)
    lost = pushed - q.bar_mass * (speed[-1] - speed[0])
    assert blows > 5
    np.testing.assert_allclose(blows * outputs["impact_impulse"], lost, rtol=1e-4)


def test_the_energy_is_what_the_mole_takes(settled):
    blows, outputs, time, motion = settled
    q, others = forces(motion)
    x = motion["mole_velocity"]
    braking = motion["mole_friction"] - motion["bar_friction"] + others
    gained = 0.5 * q.mole_mass * (x[-1] ** 2 - x[0] ** 2)
    taken = np.trapezoid(braking * x, time) + gained
    np.testing.assert_allclose(blows * outputs["impact_energy"], taken, rtol=3e-4)


def test_published_in_the_documentation_at_8_hz():
    outputs, _ = batch(np.array([Params()]), np.zeros(1, np.uint64), Settings())
    np.testing.assert_allclose(outputs["impact_impulse"], 0.609, atol=5e-4)
    np.testing.assert_allclose(outputs["impact_energy"], 57.8e-3, atol=5e-5)


def test_without_a_blow_there_is_neither():
    x = np.array([Params(control_frequency=13.0), SEVEN])
    outputs, status = batch(x, np.zeros(2, np.uint64), Settings())
    assert not status.any()
    for name in ("impact_impulse", "impact_energy"):
        assert np.isnan(outputs[name]).tolist() == [True, False]
