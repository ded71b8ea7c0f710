"""Settled responses: the paper's facts, regimes, exponents, and every row an answer."""

import numpy as np
import pytest

from models.mole import MODEL
from models.mole.batch import batch
from models.mole.parameters import CHAOTIC, NO_IMPACT, PERIODIC, QUASI_PERIODIC, Params, Settings
from models.mole.periods import common_periods
from models.mole.table import rows as claims
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


def test_both_orbits_at_47_rad_per_second_as_printed():
    both = claims()[-2:]
    o, _ = batch(both, np.zeros(2, np.uint64), Settings(formulation="as-printed"))
    assert o["regime"].tolist() == [QUASI_PERIODIC] * 2
    np.testing.assert_allclose(o["progression_rate"], [35.7e-3, 42.7e-3], atol=1e-4)


@pytest.mark.slow
def test_the_exponent_of_the_paper_s_chaos():
    o = at(2.5, formulation="as-printed", duration=6000)
    assert o["regime"] == CHAOTIC
    assert o["lyapunov_exponent_error"] < 0.02
    np.testing.assert_allclose(o["lyapunov_exponent"], 1.505, atol=0.03)


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
    one, other = at(5.0, 7.0, 8.0), at(5.0, 7.0, 8.0, tolerance=tolerance)
    for name in names:
        np.testing.assert_allclose(other[name], one[name], rtol=2e-6)


def over_the_bounds(n, seed):
    rng = np.random.default_rng(seed)
    low, high = np.transpose([MODEL.parameter(name).bounds for name in MODEL.parameter_names])
    return rng.uniform(low, high, (n, len(low)))


def check(n, seed):
    outputs, status = batch(over_the_bounds(n, seed), np.zeros(n, np.uint64), Settings())
    assert np.all(np.isin(status, [Status.OK, Status.OUT_OF_BUDGET, Status.NON_FINITE]))
    done = status == Status.OK
    for name, values in outputs.items():
        assert np.all(np.isfinite(values[done])), name
    assert np.all(outputs["regime"][~done] == -1)
    assert np.all(outputs["regime"][done] >= 0)
    return done.mean()


def test_every_row_over_the_bounds_ends():
    assert check(64, 3) > 0.9


@pytest.mark.slow
def test_20_000_rows_over_the_bounds_end():
    assert check(20_000, 4) > 0.9
