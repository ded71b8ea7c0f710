"""One vibrator, run repeatedly by the exact propagator within a budget of steps."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.numerics.dop853 import Outcome
from models.vibrator.equations import general
from models.vibrator.equations.system import System, system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params

PSI_1, PSI_2, HEIGHT = 3, 4, 7
"""Indices into the state."""


@dataclass
class Machine:
    """One machine, ready to be run.

    Attributes
    ----------
    params : Params
    system : System
    scales : ndarray
        Scale of each component of the state.
    budget : int
        Steps that may still be tried.
    """

    params: Params
    system: System
    scales: NDArray[np.float64]
    budget: int

    @property
    def is_extended(self) -> bool:
        """Whether the state belongs to `models.vibrator.equations.general`."""
        return self.degrees >= general.DEGREES

    @property
    def degrees(self) -> int:
        """Number of degrees of freedom, half the length of a state."""
        return len(self.scales) // 2

    def rides(self, state: NDArray[np.float64]) -> bool:
        """Whether the feed is in contact with the deck."""
        return not self.is_extended or state[HEIGHT] == 0 == state[self.degrees + HEIGHT]

    def free(self, riding: bool) -> NDArray[np.intp]:
        """Return the components of the state that can vary at fixed psi_1."""
        m = self.system
        rates = [True] * 5 + [bool(m.slides), bool(m.rocks), not riding, True, True]
        rates = rates[: self.degrees]
        places = rates[: general.DEGREES] + [False] * (self.degrees - general.DEGREES)
        places[PSI_1] = False
        return np.flatnonzero(places + rates)

    def run(
        self,
        state: NDArray[np.float64],
        duration: float,
        tolerance: float,
        turns: float = math.inf,
        times: ArrayLike = (),
        begin: float = math.inf,
    ) -> tuple[Outcome, NDArray[np.float64]]:
        """Advance `state` in place by a duration or by turns of vibrator 1; return samples, too.

        The run begins that long after the motors were switched on; by default after any ramp.
        """
        ramp_left = max(self.system.ramp_time - begin, 0.0)
        if ramp_left != self.system.ramp_left:
            self.system = self.system._replace(ramp_left=ramp_left)
        times = np.ascontiguousarray(times, float)
        samples = np.full((len(times), len(state)), np.nan)
        ended = propagator.runner(self.system, self.degrees)(
            self.system,
            state,
            state[PSI_1] + 2 * np.pi * turns,
            float(duration),
            tolerance * self.scales,
            self.budget,
            times,
            samples,
        )
        self.budget -= ended.steps
        return ended, samples


def prepare(params: Params, kinematics: str, budget: int) -> Machine:
    """Return a machine ready to be run.

    Parameters
    ----------
    params : Params
        Each field a float.
    kinematics : {"small", "exact"}
    budget : int
        Steps that may be tried.
    """
    m = system(params, kinematics)
    return Machine(params, m, propagator.scales_of(m, propagator.degrees_of(m)), budget)
