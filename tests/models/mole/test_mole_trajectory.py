"""The labelled time history of the mole."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from models.mole import exact
from models.mole.parameters import FORMULATIONS, Params, Settings
from models.mole.theory.system import mole
from models.mole.trajectory import MOST_SAMPLES, simulate

P = Params(control_frequency=7.0, supply_phase=0.4)


def shown(p, settings):
    history = simulate(p, settings)
    assert {len(series) for _, _, series in history.quantities.values()} == {len(history.time)}
    return history.time, {name: series for name, (_, _, series) in history.quantities.items()}


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_it_shows_four_seconds_from_the_start(formulation):
    time, got = shown(P, Settings(formulation=formulation, tolerance=1e-11))
    assert (time[0], time[-1]) == (0, 4)
    q = mole(P, formulation)
    end = exact.propagate(q, exact.start(P, q), 4.0, 1e-11).state.y
    names = ("displacement", "velocity", "mole_velocity", "current")
    np.testing.assert_allclose([got[name][-1] for name in names], end[:4], rtol=0, atol=1e-6)
    np.testing.assert_array_equal(got["relay"][1:], np.ceil(time[1:] * 14 - 1e-9) % 2)
    assert got["contact_force"].max() > 150
    np.testing.assert_array_equal(got["contact_force"] > 0, got["displacement"] > P.stop_gap)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_capacitor_is_charged_by_the_current(formulation):
    """Kirchhoff's law: the source's voltage, worked out apart, less p is the charge over C."""
    time, got = shown(P, Settings(formulation=formulation, tolerance=1e-12))
    charge = cumulative_simpson(got["current"], x=time, initial=0)
    np.testing.assert_allclose(got["capacitor_voltage"], charge / P.capacitance, atol=0.1)
    open_ = got["relay"] == 0
    assert (np.ptp(got["source_voltage"][open_]) == 0) == (formulation == "physical")


@pytest.mark.parametrize("formulation", ["physical", "paper"])
def test_momentum_comes_from_the_ground_alone(formulation):
    time, got = shown(P, Settings(formulation=formulation, tolerance=1e-11))
    q = mole(P, formulation)
    assert abs(got["bar_friction"]).max() <= q.bar_limit * (1 + 1e-9)
    assert abs(got["mole_friction"]).max() <= q.mole_limit * (1 + 1e-9)
    bar = q.bar_mass * (got["velocity"] + got["mole_velocity"])
    momentum = bar + q.mole_mass * got["mole_velocity"]
    impulse = np.concatenate(
        [[0], np.cumsum(np.diff(time) * (got["mole_friction"][1:] + got["mole_friction"][:-1]) / 2)]
    )
    np.testing.assert_allclose(momentum, -impulse, atol=0.03)
    assert np.ptp(momentum) > 0.4


def test_slow_control_is_shown_for_ten_periods_with_no_more_samples_than_allowed():
    time, _ = shown(Params(control_frequency=0.25), Settings(tolerance=1e-6))
    assert time[-1] == 40
    time, got = shown(Params(contact_stiffness=3.8e6, bar_mass=0.0099), Settings(tolerance=1e-6))
    assert len(time) == MOST_SAMPLES + 1
    assert np.isfinite(got["displacement"]).all()


def test_it_ends_with_the_budget(monkeypatch):
    monkeypatch.setattr("models.mole.exact.propagator.STEPS_PER_RADIAN", 0)
    monkeypatch.setattr("models.mole.exact.propagator._SPARE_STEPS", 50)
    time, got = shown(P, Settings())
    assert 0 < time[-1] < 1
    assert np.isfinite(got["current"]).all()
