"""Speeds and disphasing angle at given instants of a run-up, compared with trajectories."""

import numpy as np
import pytest

from models.vibrator import MODEL
from models.vibrator.parameters import Params, Settings
from models.vibrator.trajectory import simulate
from uq.contract import Status

OUTPUTS = {"run_up_angle": "disphasing_angle", "run_up_speed_1": "speed_1"}
OUTPUTS |= {"run_up_speed_2": "speed_2"}
RUN_UP = 6.0
WEAK = {"rated_torque_1": 40.0, "rated_torque_2": 40.0, "stiffness_x": 2.07e6}


def rows(*changes):
    return np.array([Params(**values) for values in changes])


def compute(x, **settings):
    return MODEL.batch(x, np.zeros(len(x), np.uint64), Settings(run_up=RUN_UP, **settings))


# It locks; it starts with other phases; it is captured; one motor never keeps up.
MACHINES = rows(
    {}, {"initial_phase_1": 2.0, "initial_phase_2": -1.0}, WEAK, {"synchronous_speed_2": 120.0}
)


@pytest.fixture(scope="module")
def trajectories():
    return [simulate(Params(*x), Settings(run_up=RUN_UP, tolerance=1e-10)) for x in MACHINES]


@pytest.mark.parametrize(
    ("settings", "off"),
    [({}, 3e-5), ({"steps_per_turn": 20}, 3e-7), ({"propagator": "exact"}, 3e-6)],
    ids=["order 5", "order 8", "exact"],
)
def test_they_are_those_of_the_trajectory(trajectories, settings, off):
    """Up to the start of the search for the orbit, after it, in the last second, and at its end."""
    time = trajectories[0].time
    at = [3, len(time) // 50, len(time) // 3, len(time) * 2 // 3, len(time) - 9, len(time) - 1]
    outputs, status = compute(MACHINES, instants=tuple(time[at].tolist()), **settings)
    assert (status == Status.OK).all()
    assert outputs["regime"].tolist() == [0, 0, 3, 4]
    for i, trajectory in enumerate(trajectories):
        for name, quantity in OUTPUTS.items():
            expected = np.interp(time[at], trajectory.time, trajectory.quantities[quantity][2])
            apart = outputs[name][i] - expected
            if name == "run_up_angle":
                assert (np.abs(outputs[name]) <= np.pi).all()
                apart = np.angle(np.exp(1j * apart))
            scale = 1.0 if name == "run_up_angle" else 157.0
            assert np.abs(apart).max() < off * scale, (i, name)


@pytest.mark.parametrize("propagator", ["fast", "exact"])
def test_one_instant_does_not_depend_on_the_others(propagator):
    instants = (0.3, 0.300001, 2.0, 5.5)
    every, _ = compute(MACHINES[:2], instants=instants, propagator=propagator)
    for k, instant in enumerate(instants):
        alone, _ = compute(MACHINES[:2], instants=(instant,), propagator=propagator)
        for name in OUTPUTS:
            assert alone[name][:, 0] == pytest.approx(every[name][:, k], abs=1e-4), name


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"instants": (2.0, 1.0)}, "increasing"),
        ({"instants": (2.0, 20.0), "run_up": 10.0}, "beyond the run_up"),
    ],
)
def test_instants_that_make_no_sense_are_refused(settings, why):
    with pytest.raises(ValueError, match=why):
        Settings(**settings)
