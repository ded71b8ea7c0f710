"""The velocity of the tip along a trace is that of its state, not a difference of samples."""

import numpy as np
import pytest

from models.beam import MODEL, exact, lanes
from models.beam.explore import phase_portrait
from models.beam.parameters import Params, Settings
from models.beam.start import initial_gaps, initial_state
from models.beam.structure.modal import beams

SHARP = {"forcing_frequency": 32.3591}  # differences of 200 samples are 12 % off
RANDOM = {"random_force_level": 1e-3, "random_force_low": 5.0, "random_force_high": 100.0}
FINE = 12_800  # samples per period


def motion(propagator, steps, periods, values):
    """Return displacement and speed at each step, shape (periods * steps,)."""
    p = Params(*np.array([list((MODEL.nominal | values).values())]).T)
    settings = Settings(steps_per_period=steps)
    ((_, system),) = propagator.groups(beams(p, settings), settings)
    state, gaps = initial_state(propagator, system, p), initial_gaps(p)
    begin, still = state.copy(), np.zeros_like(gaps)
    trace = propagator.advance(system, state, gaps, still, periods, trace=True).trace
    return trace[0], propagator.speeds(system, begin, gaps, trace)[0]


@pytest.mark.parametrize("values", [SHARP, RANDOM])
def test_the_exact_speed_is_the_limit_of_differences(values):
    x, v = motion(exact, FINE, 2, values)
    limit = np.gradient(x, 2 * np.pi / FINE)
    assert np.abs(v - limit)[1:-1].max() < 3e-4 * np.abs(v).max()
    few = motion(exact, 200, 2, values)[1]
    np.testing.assert_allclose(few, v[FINE // 200 - 1 :: FINE // 200], rtol=0, atol=1e-9)


@pytest.mark.parametrize("values", [SHARP, pytest.param(RANDOM, marks=pytest.mark.slow)])
def test_the_speed_of_the_steps_is_the_exact_one_up_to_their_error(values):
    _, v = motion(exact, 400, 4, values)
    assert np.abs(motion(lanes, 400, 4, values)[1] - v).max() < 0.01 * np.abs(v).max()


def test_speeds_continue_those_of_an_earlier_call():
    p = Params(*np.array([list((MODEL.nominal | RANDOM).values())]).T)
    ((_, system),) = lanes.groups(beams(p, Settings()), Settings())
    state, gaps = initial_state(lanes, system, p), initial_gaps(p)
    begin = state.copy()
    parts = []
    for periods in (3, 2):
        here = state.copy()
        trace = lanes.advance(system, state, gaps, 0 * gaps, periods, trace=True).trace
        parts.append((trace, lanes.speeds(system, here, gaps, trace)))
    whole = np.concatenate([trace for trace, _ in parts], axis=1)
    speed = lanes.speeds(system, begin, gaps, whole)
    apart = np.abs(np.concatenate([speed for _, speed in parts], axis=1) - speed)
    assert apart.max() < 1e-3 * np.abs(speed).max()


@pytest.mark.parametrize("propagator", ["exact", "fast"])
def test_a_trajectory_has_the_velocity_of_its_state(propagator):
    start = {"initial_displacement": 2e-4, "initial_velocity": 0.05}
    p = Params(**(MODEL.nominal | SHARP | start))
    settings = Settings(propagator=propagator, steps_per_period=200)
    _, quantities = MODEL.simulate(p, settings)
    velocity = quantities["velocity"][2]
    assert velocity[0] == 0.05
    to_speed = p.initial_gap * 2 * np.pi * p.forcing_frequency
    _, v = motion(exact, 200, 2, SHARP | start)
    assert np.abs(velocity[1:401] - to_speed * v).max() < 0.02 * to_speed * np.abs(v).max()


def test_a_phase_portrait_has_the_velocity_of_its_state():
    """On an orbit, the derivative of the Fourier series through 200 samples is a check."""
    p = Params(**(MODEL.nominal | SHARP))
    ds = phase_portrait(p, Settings(propagator="exact", steps_per_period=200), [2.5e-4])
    x, v = ds["displacement"].values[0], ds["velocity"].values[0]
    order = 2j * np.pi * p.forcing_frequency * np.fft.rfftfreq(len(x), 1 / len(x))
    series = np.fft.irfft(order * np.fft.rfft(x), len(x))
    assert len(x) == 200 and ds["phase"][0] == 0
    assert np.abs(v - series).max() < 0.001 * np.abs(v).max()
