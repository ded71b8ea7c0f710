"""Chaos and quasi-periodicity both need evidence; without it a regime is undecided."""

import numpy as np
import pytest

from models.mole.batch import batch
from models.mole.paper.table import rows
from models.mole.parameters import (
    CHAOTIC,
    ON_STOP,
    PERIODIC,
    QUASI_PERIODIC,
    REGIMES,
    UNDECIDED,
    Params,
    Settings,
)
from models.mole.response.verdict import NEAR_ZERO, verdicts

ALONE = Params(control_frequency=29.5 / (2 * np.pi))


def compute(*moles, **settings):
    x = np.array(moles)
    outputs, status = batch(x, np.zeros(len(x), np.uint64), Settings(**settings))
    assert not status.any()
    return outputs


@pytest.mark.parametrize(
    ("exponent", "scatter", "alone", "expected"),
    [
        (0.1, 0.05, True, CHAOTIC),
        (0.1, 0.05, False, CHAOTIC),
        (0.1, 1.0, True, UNDECIDED),
        (-0.1, 0.05, True, QUASI_PERIODIC),  # follows the phases of control and mains
        (-0.1, 0.05, False, UNDECIDED),  # settles to something
        (-0.1, 1.0, True, UNDECIDED),
        (0.1 * NEAR_ZERO, 0.5 * NEAR_ZERO, False, QUASI_PERIODIC),
        (0.1 * NEAR_ZERO, 20 * NEAR_ZERO, False, UNDECIDED),
        (-0.3 * NEAR_ZERO, 0.1 * NEAR_ZERO, False, UNDECIDED),  # settles slowly
    ],
)
def test_each_verdict_needs_evidence(exponent, scatter, alone, expected):
    """Exponent and scatter of a batch are those of a control period."""
    sides = np.tile([1.0, -1.0, -1.0, 1.0], 5)
    growth = 7 * (exponent + scatter * sides)[None]
    regimes = verdicts(growth, np.array([140.0]), np.array([alone]))
    assert regimes.tolist() == [expected]


def test_codes_of_files_written_before_keep_their_meaning():
    assert REGIMES[:4] == ("no-impact", "periodic", "quasi-periodic", "chaotic")
    assert REGIMES[UNDECIDED] == "undecided"
    assert REGIMES[ON_STOP] == "resting-on-stop"


@pytest.mark.slow
def test_a_short_look_at_chaos_is_lengthened():
    """Over 100 control periods nine of ten exponents at 29.5 rad/s hide in their errors."""
    starts = [ALONE._replace(initial_displacement=u) for u in np.linspace(-0.05, 0.005, 16)]
    o = compute(*starts, formulation="as-printed", transient=100, duration=100)
    assert o["regime"].tolist() == [CHAOTIC] * 16
    assert np.all((o["progression_rate"] > 7.6e-3) & (o["progression_rate"] < 8.1e-3))
    assert np.ptp(o["lyapunov_exponent_error"]) > 0  # each for as long as it took


def test_near_a_torus_doubling_a_look_does_not_decide():
    """At 47 rad/s from the second start, as printed: a steeply folded curve."""
    second = Params._make(rows()[-1])
    brief = compute(second, formulation="as-printed", transient=400, duration=40)
    assert brief["regime"].tolist() == [UNDECIDED] and brief["period"].tolist() == [0]


@pytest.mark.slow
def test_a_long_look_decides():
    second = Params._make(rows()[-1])
    long = compute(second, formulation="as-printed", transient=400, duration=12_800)
    assert long["regime"].tolist() == [QUASI_PERIODIC]
    assert abs(long["lyapunov_exponent"] + 0.107) < 3 * long["lyapunov_exponent_error"] < 0.1


@pytest.mark.slow
def test_a_look_does_not_depend_on_its_neighbours():
    some = [ALONE, Params(), ALONE._replace(initial_displacement=-0.03), Params(stop_gap=0.06)]
    settings = {"formulation": "as-printed", "transient": 100, "duration": 20}
    together = compute(*some, **settings)
    for i, row in enumerate(some):
        for name, value in compute(row, **settings).items():
            np.testing.assert_array_equal(value[0], together[name][i], err_msg=name)


def test_weak_chaos_is_neither_quasi_periodic_nor_periodic():
    """At 2.5 Hz and this phase of the mains neighbours part by 0.01 a period, at 0.03 1/s.

    By the event-driven propagator at 1e-13, over 3,000 periods, 9 to 43 % of the instants at which
    the relay closes return to within 1e-6 of one of the last 64. It never stays.
    """
    weak = Params(control_frequency=2.5, supply_phase=2 * np.pi * 5 / 32)
    starts = weak.initial_displacement - 1e-5 * np.arange(16)
    some = [weak._replace(initial_displacement=start) for start in starts]
    o = compute(*some, transient=400, duration=20)
    assert o["regime"].tolist() == [UNDECIDED] * 16


def test_what_repeats_is_still_periodic():
    assert compute(Params(), transient=200)["regime"].tolist() == [PERIODIC]


@pytest.mark.parametrize("phase", [0.0, 1.0])
def test_what_repeats_late_is_found_after_its_averages(phase):
    """At 8 Hz, of period 2 and 4 common periods: not yet repeating after 20 control periods.

    Batches of 2 control periods are not whole periods of the response, and their means scatter.
    """
    o = compute(Params(supply_phase=phase), transient=20, duration=40)
    settled = compute(Params(supply_phase=phase))
    assert o["regime"].tolist() == [PERIODIC] and o["period"] == settled["period"] > 1
    for name in ("progression_rate", "lyapunov_exponent"):
        np.testing.assert_allclose(o[name], settled[name], rtol=1e-5)
    assert o["progression_rate_error"] == 0


def test_what_settles_slowly_is_given_the_time():
    """Over 200 control periods its exponent, -0.04 1/s, is indistinguishable from zero."""
    start = {"initial_displacement": -0.0408007, "initial_velocity": -1.29148}
    slow = Params(**start, supply_phase=2.397224)
    o = compute(slow)
    assert o["regime"].tolist() == [PERIODIC] and o["period"].tolist() == [2]
