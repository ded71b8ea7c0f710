"""Both roads give the same outputs; theory and simulation stand side by side."""

import numpy as np
import pytest

from models.vibrator import MODEL
from models.vibrator.parameters import Params, Settings
from models.vibrator.start import fast
from uq.contract import Status

NOMINAL = np.array(list(MODEL.nominal.values()))


def rows(n, seed=3, **values):
    rng = np.random.default_rng(seed)
    x = np.tile(NOMINAL, (n, 1))
    scattered = ("rated_torque_1", "rated_torque_2", "stiffness_x", "stiffness_y", "unbalance_2")
    for name in scattered:
        x[:, Params._fields.index(name)] *= rng.uniform(0.9, 1.1, n)
    x[:, Params._fields.index("synchronous_speed_1")] *= rng.normal(1, 5e-4, n)
    for name, value in values.items():
        x[:, Params._fields.index(name)] = value
    return x


def compute(x, **settings):
    return MODEL.batch(x, np.zeros(len(x), np.uint64), Settings(**settings))


def test_the_fast_road_leads_where_the_exact_one_does():
    x = rows(4, gravity=[0.0, 9.81, 0.0, 9.81])
    quick, status = compute(x)
    exact, status_too = compute(x, propagator="exact")
    assert (status == Status.OK).all() and (status_too == Status.OK).all()
    tolerances = {"synchronisation_time": 2e-3, "max_excursion": 1e-3, "angular_amplitude": 1e-5}
    for name in MODEL.given(Settings()).outputs:
        if name == "disphasing_angle":
            assert np.abs(quick[name] - exact[name]).max() < 1e-6
        else:
            assert quick[name] == pytest.approx(
                exact[name], rel=tolerances.get(name, 1e-4), nan_ok=True
            ), name


def test_exact_kinematics_hardly_matter():
    x = rows(2)
    small, status = compute(x)
    exact, status_too = compute(x, kinematics="exact")
    assert status.tolist() == status_too.tolist() == [Status.OK, Status.OK]
    assert small["regime"].tolist() == exact["regime"].tolist() == [0, 0]
    off = np.abs(small["disphasing_angle"] - exact["disphasing_angle"])
    assert (off > 1e-9).all() and (off < 1e-4).all()


def test_theory_is_a_close_companion_of_the_simulation():
    out, _ = compute(rows(200))
    simulated, theory = out["disphasing_angle"], out["theory_disphasing_angle"]
    assert np.ptp(simulated) > 0.1
    assert np.corrcoef(simulated, theory)[0, 1] > 0.9999
    assert np.abs(simulated - theory).max() < 2e-3


def test_what_fixed_steps_cannot_follow_goes_the_exact_road(monkeypatch):
    def blown_up(p, settings):
        outcome, status = start_outcomes(p, settings)
        status[:] = Status.NON_FINITE
        return outcome._replace(speed=np.full(len(status), np.nan)), status

    start_outcomes = fast.outcomes
    x = rows(1)
    expected, _ = compute(x, propagator="exact")
    monkeypatch.setattr(fast, "outcomes", blown_up)
    out, status = compute(x)
    assert status[0] == Status.OK
    assert out["speed"][0] == expected["speed"][0]


def test_the_outputs_of_machines_that_never_lock_are_means():
    out, status = compute(rows(2, synchronous_speed_1=[150.0, 145.0]), run_up=8.0)
    assert (status == Status.OK).all()
    for name in ("disphasing_angle", "floquet_multiplier", "theory_disphasing_angle"):
        assert np.isnan(out[name]).all()
    for name in ("angular_amplitude", "stroke_left", "stroke_right", "speed", "power_1"):
        assert np.isfinite(out[name]).all()
    assert np.isinf(out["synchronisation_time"]).all()


@pytest.mark.slow
def test_every_machine_within_the_bounds_ends_with_a_status():
    rng = np.random.default_rng(11)
    x = np.tile(NOMINAL, (2000, 1))
    for j, name in enumerate(Params._fields):
        bounds = MODEL.parameter(name).bounds
        if name != "feed_mass" and np.isfinite(bounds).all():
            x[:, j] = rng.uniform(*bounds, len(x))
    out, status = compute(x)
    is_stated = np.isin(status, [Status.OK, Status.OUT_OF_BUDGET, Status.NON_FINITE])
    assert is_stated.all()
    assert np.mean(status == Status.NON_FINITE) < 0.01
    sound = status != Status.NON_FINITE
    assert (out["regime"][sound] >= 0).all()
    assert np.isfinite(out["speed"][sound]).all()
