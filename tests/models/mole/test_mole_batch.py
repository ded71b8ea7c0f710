"""Settled responses: the paper's facts, regimes, exponents, and every row an answer."""

import numpy as np
import pytest

from models.mole import MODEL
from models.mole.batch import batch
from models.mole.paper import table
from models.mole.parameters import (
    CHAOTIC,
    NO_IMPACT,
    ON_STOP,
    PERIODIC,
    QUASI_PERIODIC,
    UNDECIDED,
    Params,
    Settings,
)
from models.mole.response.machines import APERIODIC, Machines
from models.mole.response.settling import settle
from models.mole.theory.periods import common_periods
from uq.contract import Status


def compute(settings, *changes):
    x = np.array([Params(**change) for change in changes])
    outputs, status = batch(x, np.zeros(len(x), np.uint64), settings)
    assert np.all(status == Status.OK)
    return outputs


def at(*frequencies, formulation="physical", **settings):
    return compute(
        Settings(formulation=formulation, **settings),
        *({"control_frequency": f} for f in frequencies),
    )


@pytest.mark.parametrize(
    ("frequency", "periods"),
    [(2.5, 1), (5, 1), (10, 1), (8, 2), (3, 3), (6, 3), (12, 3), (7, 7), (9, 9), (13, 13)]
    + [(29.5 / (2 * np.pi), 0), (47 / (2 * np.pi), 0), (8.0001, 0)],
)
def test_common_periods(frequency, periods):
    assert common_periods(frequency, 50.0) == periods


def test_physical_facts():
    o = at(2.5, 5.0, 7.0, 8.0, 13.0)
    assert o["regime"].tolist() == [PERIODIC] * 4 + [NO_IMPACT]
    # Approached from alternating sides, 5 and 8 Hz would read as twice their length.
    assert o["period"].tolist() == [1, 1, 1, 2, 1]
    np.testing.assert_allclose(o["lyapunov_exponent"][[0, 4]], [-1.41, -13.9], atol=0.06)
    np.testing.assert_allclose(o["displacement_range"][1], 28.5e-3, atol=5e-5)
    np.testing.assert_allclose(o["progression_rate"][3], 42.2e-3, atol=5e-5)
    np.testing.assert_allclose(o["peak_contact_force"][3], 252.8, atol=0.05)
    np.testing.assert_allclose(o["impact_work_rate"][3] / 8, 57.8e-3, atol=5e-5)
    np.testing.assert_allclose(o["electrical_power"][3], 28.0, atol=0.05)
    np.testing.assert_allclose(o["efficiency"], o["impact_work_rate"] / o["electrical_power"])
    assert o["impacts_per_period"].tolist() == [2, 1, 1, 1, 0]
    assert np.all(o["progression_rate_error"] == 0)


def test_facts_as_printed():
    o = at(5.0, 7.0, 8.0, 9.0, 13.0, formulation="as-printed")
    assert o["regime"].tolist() == [PERIODIC] * 3 + [NO_IMPACT] * 2
    assert o["period"].tolist() == [2, 1, 1, 1, 1]
    np.testing.assert_allclose(o["displacement_range"][[0, 3]], [32.4e-3, 7.9e-3], atol=5e-5)
    np.testing.assert_allclose(o["progression_rate"][2], 45.9e-3, atol=5e-5)
    np.testing.assert_allclose(o["lyapunov_exponent"][4], -16.4, atol=0.05)


def test_chaos_at_9_hz_in_the_physical_formulation():
    o = at(9.0)
    assert o["regime"] == CHAOTIC and o["period"] == 0
    assert abs(o["lyapunov_exponent"] - 3.7) < 3 * o["lyapunov_exponent_error"] + 0.12
    assert o["impacts_per_period"] > 0.9
    np.testing.assert_allclose(o["progression_rate"], 32.4e-3, atol=5e-4)
    assert 0 < o["progression_rate_error"] < 5e-4
    for name in ("electrical_power", "efficiency", "impact_impulse", "impact_energy"):
        assert 0 < o[f"{name}_error"] < 0.02 * o[name], name
    for name in ("peak_contact_force", "displacement_range"):
        assert 0 < o[f"{name}_error"] < 0.1 * o[name], name


@pytest.mark.parametrize(
    ("frequency", "formulation", "common"),
    [(8.0, "as-printed", 2), (12.0, "physical", 3), (12.0, "as-printed", 3), (7.0, "physical", 7)],
)
def test_an_exponent_is_the_same_over_twice_the_period(frequency, formulation, common):
    """At 8 and 12 Hz these orbits span an odd number of half mains cycles."""
    once = at(frequency, formulation=formulation)
    twice = at(frequency, formulation=formulation, duration=2 * common)
    assert once["period"] == 1
    np.testing.assert_allclose(once["lyapunov_exponent"], twice["lyapunov_exponent"], rtol=1e-4)


def test_what_sticks_for_good_has_no_freedom():
    """The mole never slips: its velocity is no tangent that lasts."""
    o = at(20.0)
    assert o["progression_rate"] == 0 and o["displacement_range"] > 1e-4
    np.testing.assert_allclose(o["lyapunov_exponent"], -7.688, atol=0.005)


SLOW = {"coil_inductance": 5.0, "resistance": 0.9, "capacitance": 1.9e-6}
"""A current that grows for thousands of control periods."""


@pytest.mark.slow
@pytest.mark.parametrize(("frequency", "rtol"), [(50.0, 1e-3), (47.123, 0.03)])
def test_a_bar_at_rest_has_not_settled_while_the_current_grows(frequency, rtol):
    """Also where averages are those of a window, without a common period."""
    slow = SLOW | {"control_frequency": frequency}
    settled = compute(Settings(), slow)
    reference = compute(Settings(transient=20_000), slow)
    np.testing.assert_allclose(
        settled["electrical_power"], reference["electrical_power"], rtol=rtol
    )
    assert reference["electrical_power"] > 1.6 or frequency != 50.0


def test_a_bar_at_rest_takes_the_power_of_the_current_that_has_grown():
    assert 1.6 < compute(Settings(), SLOW | {"control_frequency": 50.0})["electrical_power"] < 1.63


def test_a_bar_at_rest_has_settled_once_the_current_has():
    """Its place, which it never forgets, does not keep it settling for two minutes."""
    row = Params(control_frequency=8.0001, bar_friction=9.0, mole_friction=7.0)
    machines = Machines.started(Params._make(np.array([row]).T), Settings())
    settle(machines, 0)
    assert APERIODIC <= machines.periods(np.array([0]))[0] < 2 * APERIODIC


@pytest.mark.parametrize("frequency", [8.0, pytest.param(8.3, marks=pytest.mark.slow)])
def test_a_bar_pressed_on_the_stop_rests_there(frequency):
    """With and without a common period; with less friction it hammers on the stop."""
    pressed = {"spring_rest": 0.05, "stop_gap": -0.03, "initial_displacement": -0.0295}
    held = {"bar_friction": 9.0, "mole_friction": 7.0}
    rows = [pressed | held | {"control_frequency": frequency}, pressed]
    o = compute(Settings(transient=200, duration=100), *rows)
    assert o["regime"].tolist() == [ON_STOP, PERIODIC]
    assert o["displacement_range"][0] < 1e-10 and o["peak_contact_force"][0] > 20
    assert o["impacts_per_period"][0] == 0 < o["impacts_per_period"][1]


def test_an_orbit_that_repels_is_no_attractor():
    """Weak chaos at 4 Hz comes within a millionth of where it was."""
    o = at(4.0)
    assert o["regime"] == CHAOTIC and o["period"] == 0
    assert abs(o["lyapunov_exponent"] - 0.49) < 4 * o["lyapunov_exponent_error"]


def test_what_does_not_repeat_is_averaged_over_whole_common_periods():
    """At 9 Hz there are nine control periods in one: 20 batches of 9 for a duration of 1."""
    impacts = at(9.0, duration=1)["impacts_per_period"] * 180
    np.testing.assert_allclose(impacts, np.round(impacts), atol=1e-6)


@pytest.mark.slow
def test_a_long_average_has_steps_enough_and_an_exponent():
    """From 16 starts: the errors stated are those that the exponents have."""
    starts = -0.022 - 1e-4 * np.arange(16)
    o = compute(
        Settings(formulation="as-printed", duration=20_000),
        *({"control_frequency": 2.5, "initial_displacement": u} for u in starts),
    )
    assert np.all(o["regime"] == CHAOTIC)
    exponent, error = o["lyapunov_exponent"], o["lyapunov_exponent_error"]
    assert np.all(abs(exponent - 1.505) < 4 * error)
    stated = np.sqrt(np.mean(error**2))
    assert 0.6 * stated < exponent.std(ddof=1) < 1.7 * stated < 1.7 * 0.01


@pytest.mark.slow
def test_closed_curves_of_the_paper():
    printed = Settings(formulation="as-printed")
    counts = [
        table.closed_curves(Params(control_frequency=speed / (2 * np.pi)), printed)
        for speed in (31.0, 32.8, 47.0)
    ]
    assert counts == [2, 1, 1]


def test_both_orbits_at_47_rad_per_second_as_printed():
    both = table.rows()[-2:]
    o, _ = batch(both, np.zeros(2, np.uint64), Settings(formulation="as-printed"))
    assert o["regime"].tolist() == [QUASI_PERIODIC, UNDECIDED]
    np.testing.assert_allclose(o["progression_rate"], [35.7e-3, 42.7e-3], atol=1e-4)


@pytest.mark.slow
def test_the_exponent_of_the_paper_s_chaos():
    outputs = table.responses("as-printed")
    assert table.CLAIMS[0].control_frequency == 2.5
    assert outputs["regime"][0] == CHAOTIC
    assert outputs["lyapunov_exponent_error"][0] < 0.01
    np.testing.assert_allclose(outputs["lyapunov_exponent"][0], 1.505, atol=0.03)


def test_without_a_common_period_the_start_is_forgotten():
    """Bars let go a tenth of a millimetre apart, averaged over the same control periods."""
    frequency = 29.5 / (2 * np.pi)
    o = compute(
        Settings(duration=40),
        *({"control_frequency": frequency, "initial_displacement": u} for u in (-22e-3, -22.1e-3)),
    )
    assert o["regime"].tolist() == [QUASI_PERIODIC] * 2
    for name in ("progression_rate", "impact_work_rate"):
        np.testing.assert_allclose(o[name][1], o[name][0], rtol=1e-8)


def test_transient_and_duration_are_kept():
    short, long = at(9.0, transient=50, duration=40), at(9.0, transient=50, duration=400)
    assert short["progression_rate_error"] > 1.5 * long["progression_rate_error"]
    settled, cut = at(7.0), at(7.0, transient=70, duration=100)
    assert cut["regime"] == PERIODIC and cut["period"] == 1
    np.testing.assert_allclose(cut["progression_rate"], settled["progression_rate"], rtol=1e-5)
    np.testing.assert_allclose(cut["lyapunov_exponent"], settled["lyapunov_exponent"], rtol=1e-3)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
def test_averages_hardly_depend_on_the_tolerance(tolerance):
    names = ("progression_rate", "impact_work_rate", "electrical_power", "peak_contact_force")
    loose, other = at(5.0, 7.0, 8.0), at(5.0, 7.0, 8.0, tolerance=tolerance)
    for name in names:
        np.testing.assert_allclose(other[name], loose[name], rtol=2e-6)


def over_the_bounds(n, seed):
    rng = np.random.default_rng(seed)
    low, high = np.transpose([MODEL.parameter(name).bounds for name in MODEL.parameter_names])
    return rng.uniform(low, high, (n, len(low)))


def check(n, seed, **settings):
    outputs, status = batch(over_the_bounds(n, seed), np.zeros(n, np.uint64), Settings(**settings))
    assert np.all(np.isin(status, [Status.OK, Status.OUT_OF_BUDGET, Status.NON_FINITE]))
    done = status == Status.OK
    struck = done & (outputs["impacts_per_period"] > 0)
    often = done & (outputs["impacts_per_period"] > 0.2)  # not all blows within one batch
    for name, values in outputs.items():
        blow = name.startswith(("impact_impulse", "impact_energy"))
        least = often if blow and name.endswith("_error") else struck
        assert np.all(np.isfinite(values[least if blow else done])), name
    assert np.all(outputs["regime"][~done] == -1)
    assert np.all(outputs["regime"][done] >= 0)
    return done.mean()


@pytest.mark.parametrize("rows", [6, pytest.param(16, marks=pytest.mark.slow)])
def test_every_row_over_the_bounds_ends(rows):
    assert check(rows, 3) > 0.9


@pytest.mark.slow
def test_20_000_rows_over_the_bounds_end():
    """A tenth of the control periods that rows take by default: many machines, not long averages.

    By default, a row over the bounds takes 40 ms: none has a common period, and most come to rest.
    """
    assert check(20_000, 4, transient=50, duration=20) > 0.9


@pytest.mark.slow
def test_500_rows_over_the_bounds_end_by_default():
    assert check(500, 5) > 0.9
