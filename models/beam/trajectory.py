"""One labelled time history of the beam, from its initial state at its initial gaps."""

import numpy as np

from models.beam.parameters import Params, Rows, Settings
from models.beam.processes import has_band
from models.beam.start import initial_gaps, initial_state, one_system
from models.beam.structure.modal import beams
from models.beam.structure.random_response import RIGID, filtered
from models.beam.units import newton
from uq.contract import Trajectory

PERIODS = 400
"""Enough for the start to die away at the nominal damping."""


def simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    """Follow one beam over the first 400 periods of the force.

    Parameters
    ----------
    params : Params
    settings : Settings
    seed : int
        Of the realisation of the random force.

    Returns
    -------
    Trajectory
        NaN if the band of a random force has no width.
    """
    p: Rows = Params._make(np.array([value], float) for value in params)
    b = beams(p, settings, np.array([seed], np.uint64))
    propagator, system = one_system(b, settings)
    gaps, state = initial_gaps(p), initial_state(propagator, system, p)
    begin = state.copy()
    record = propagator.advance(system, state, gaps, np.zeros_like(gaps), PERIODS, trace=True)
    speed = propagator.speeds(system, begin, gaps, record.trace)[0] * system.beams.forcing[0]
    x = np.concatenate([p.initial_displacement / p.initial_gap, record.trace[0]])
    time = np.arange(len(x)) / (params.forcing_frequency * (len(x) - 1) / PERIODS)
    force = params.force_amplitude * np.cos(2 * np.pi * params.forcing_frequency * time)
    velocity = np.concatenate([p.initial_velocity, params.initial_gap * speed])
    right, left = (newton(params) * np.maximum(d, 0.0) for d in (x - gaps[0, 0], -x - gaps[0, 1]))
    quantities = {
        "displacement": ("m", "tip displacement", params.initial_gap * x),
        "velocity": ("m s-1", "tip velocity", velocity),
        "contact_force_right": ("N", "force of the right stop on the tip", right),
        "contact_force_left": ("N", "force of the left stop on the tip", left),
        "force": ("N", "harmonic force at the tip", force),
    }
    if params.random_force_level > 0:
        periods = time * params.forcing_frequency
        random = params.initial_gap * filtered(b.load[0], b.forcing[0], RIGID, periods)
        quantities["random_force"] = ("N", "random force at the tip", random)
    if not has_band(p)[0]:
        quantities = {
            name: (unit, meaning, np.nan * x) for name, (unit, meaning, _) in quantities.items()
        }
    right_stop, left_stop = params.initial_gap * gaps[0]
    return Trajectory(
        time,
        quantities,
        period=1 / params.forcing_frequency,
        stops={"displacement": (-float(left_stop), float(right_stop))},
    )
