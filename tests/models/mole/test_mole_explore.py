"""Time histories, Poincare sections and bifurcation diagrams of the mole."""

from math import tau

import numpy as np
import pytest
from scipy.stats import norm

from models.mole import exact
from models.mole.batch import batch
from models.mole.explore import best_frequency, bifurcation_diagram, history, poincare_section
from models.mole.parameters import FORMULATIONS, Params, Settings
from models.mole.theory.system import mole

STATES = ("displacement", "velocity", "mole_velocity", "current", "voltage")
SETTINGS = Settings(tolerance=1e-10)


def labelled(ds):
    named = [*ds.data_vars.values(), *ds.coords.values()]
    return all({"units", "long_name"} <= set(variable.attrs) for variable in named)


def outputs(params, settings):
    return {
        name: values[0] for name, values in batch(np.array([params]), None, settings)[0].items()
    }


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_history_is_that_of_the_exact_propagator(formulation):
    p, settings = Params(supply_phase=0.3), Settings(formulation=formulation, tolerance=1e-11)
    ds = history(p, settings, 0.4, 0.7, points=301)
    assert labelled(ds)
    np.testing.assert_allclose(ds["time"], np.linspace(0.4, 0.7, 301))
    q = mole(p, formulation)
    for place in (0, 137, 300):
        time = float(ds["time"][place])
        end = exact.propagate(q, exact.start(p, q), time, 1e-11).state.y
        names = ("displacement", "velocity", "mole_velocity", "current")
        state = [ds[name].values[place] for name in names]
        np.testing.assert_allclose(state, end[:4], atol=1e-7)
        assert ds["mole_displacement"].values[place] == pytest.approx(end[5], abs=1e-8)


def test_a_stretch_that_ends_before_it_begins_is_refused():
    with pytest.raises(ValueError, match="must have 0 <= begin < end: begin = 2.0, end = 1.0"):
        history(Params(), SETTINGS, 2.0, 1.0)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_section_holds_the_states_of_the_exact_propagator_as_the_relay_closes(formulation):
    p, settings = Params(supply_phase=0.3), Settings(formulation=formulation, tolerance=1e-11)
    ds = poincare_section(p, settings, periods=3, dropped=2)
    assert labelled(ds)
    assert ds["period"].values.tolist() == [3, 4, 5]
    q = mole(p, formulation)
    state, highest = exact.start(p, q), []
    for k in range(1, 6):
        motion = exact.propagate(q, state, k / p.control_frequency, 1e-11)
        state = motion.state
        highest.append(motion.highest)
    section_state = [ds[name].values[-1] for name in STATES[:4]]
    np.testing.assert_allclose(section_state, state.y[:4], atol=1e-6)
    # The exact propagator stops just before the relay closes.
    jump = np.sin(tau * 50 * 5 / 8 + 0.3) if formulation == "physical" else 0.0
    assert ds["voltage"].values[-1] == pytest.approx(state.y[4] + 82.02 * jump, abs=1e-4)
    force = p.contact_stiffness * np.maximum(np.array(highest) - p.stop_gap, 0)
    np.testing.assert_allclose(ds["peak_contact_force"], force[2:], atol=1e-2)


def test_a_period_one_response_is_one_point_once_in_a_common_period():
    p = Params(control_frequency=8.0, bar_friction=0.295)
    often = poincare_section(p, SETTINGS, periods=16, dropped=400)
    seldom = poincare_section(p, SETTINGS, periods=4, dropped=400, common=True)
    assert seldom["period"].values.tolist() == [402, 404, 406, 408]
    np.testing.assert_allclose(
        seldom["displacement"], often["displacement"].sel(period=seldom["period"]), atol=1e-9
    )
    # Four control periods, two common ones.
    assert len(np.unique(often["velocity"].round(4))) == 4
    assert len(np.unique(seldom["velocity"].round(4))) == 2


def test_without_a_common_period_there_is_no_such_section():
    p = Params(control_frequency=47 / tau)
    with pytest.raises(ValueError, match="have no common period within 40 control periods"):
        poincare_section(p, SETTINGS, periods=1, dropped=0, common=True)


def test_two_starts_of_the_paper_lead_to_two_closed_curves():
    """Figure 11: 47 rad/s, 37 cycles dropped; its progression is the mean advance."""
    p = Params(control_frequency=47 / tau)
    settings = Settings(formulation="as-printed")
    ds = poincare_section(
        p, settings, periods=60, dropped=37, starts=[(-0.022, 0.0), (-0.045, -1.0)]
    )
    assert labelled(ds)
    assert ds["displacement"].dims == ("start", "period")
    rates = ds["advance"].mean("period") * p.control_frequency
    np.testing.assert_allclose(rates, [0.0357, 0.0427], atol=3e-4)
    alone = poincare_section(
        p._replace(initial_displacement=-0.045, initial_velocity=-1.0), settings, 60, 37
    )
    np.testing.assert_array_equal(alone["velocity"], ds["velocity"][1])


def test_points_that_a_run_does_not_reach_are_unknown(monkeypatch):
    monkeypatch.setattr("models.mole.lanes.propagator.BUDGET", 2000)
    ds = poincare_section(Params(), SETTINGS, periods=40, dropped=0)
    is_reached = np.isfinite(ds["displacement"].values)
    assert is_reached[0]
    assert not is_reached[-1]
    assert (np.diff(is_reached.astype(int)) <= 0).all()


def test_a_diagram_shows_each_frequency_as_if_alone():
    p = Params(initial_velocity=0.1)
    frequencies = [5.0, 7.0, 13.0]
    ds = bifurcation_diagram(frequencies, p, SETTINGS, dropped=50, kept=8)
    assert ds["displacement"].dims == ("control_frequency", "period")
    assert ds["control_frequency"].values.tolist() == frequencies
    assert ds["period"].values.tolist() == list(range(51, 59))
    for frequency in frequencies:
        mine = p._replace(control_frequency=frequency)
        here = ds.sel(control_frequency=frequency)
        alone = poincare_section(mine, SETTINGS, 8, 50)
        for name in (*STATES, "peak_contact_force", "impacts", "advance"):
            np.testing.assert_array_equal(here[name], alone[name])
        expected = outputs(mine, SETTINGS)
        assert here["progression_rate"] == expected["progression_rate"]
    assert ds["regime"].values.tolist() == ["periodic", "periodic", "no-impact"]
    assert (ds["impacts"].sel(control_frequency=13.0) == 0).all()
    assert (ds["peak_contact_force"].sel(control_frequency=5.0) > 0).any()


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: history(Params(), Settings(), 0.0, 1.0, points=0), "points must be positive: 0"),
        (lambda: poincare_section(Params(), Settings(), -1, 0), "periods must be positive: -1"),
        (lambda: poincare_section(Params(), Settings(), 8, -5), "dropped must not be negative: -5"),
        (
            lambda: poincare_section(Params(), Settings(), 8, 0, starts=(-0.02, 0.0)),
            r"starts must be pairs \(displacement, velocity\)",
        ),
        (
            lambda: bifurcation_diagram([8.0, -3.0], Params(), Settings(), 0, 1),
            "control frequencies must be positive: -3 Hz",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(call, says):
    with pytest.raises(ValueError, match=says):
        call()


def test_intervals_of_a_low_quantile_cover_it_and_the_loss_too():
    """Normal rates at three frequencies: the true quantiles are known."""
    rng = np.random.default_rng(6)
    at = np.repeat([7.0, 7.5, 8.0], 200)
    means, sds = np.array([0.030, 0.040, 0.045]), np.array([0.004, 0.003, 0.010])
    truth = means + sds * norm.ppf(0.1)
    inside, losses, best, slow = [], [], [], []
    for _ in range(200):
        rates = np.concatenate([rng.normal(m, s, 200) for m, s in zip(means, sds, strict=True)])
        ds = best_frequency(at, rates)
        inside.append((ds.lower <= truth) & (truth <= ds.upper))
        losses.append(bool(ds.loss_lower <= truth[1] - truth[2] <= ds.loss_upper))
        best.append(float(ds.best))
        slow.append(bool(ds.may_be_best[0]))
    assert 0.94 <= np.mean(inside) <= 0.99 and np.mean(losses) >= 0.95
    assert np.mean(np.equal(best, 7.5)) > 0.9 and np.mean(slow) < 0.05
    with pytest.raises(ValueError, match="no mole at 9.0 Hz"):
        best_frequency(at, rates, fixed=9.0)
