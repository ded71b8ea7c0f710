"""n rigid machines, prepared for the lanes, and their initial states."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.equations.rigid import Rigid
from models.vibrator.equations.rigid_motion import initial_state
from models.vibrator.equations.system import rigid_machines
from models.vibrator.equations.time_scales import fastest_rates
from models.vibrator.lanes.packed import Array, pack
from models.vibrator.parameters import Params, Rows, Settings


class Machines(NamedTuple):
    """n rigid machines, prepared.

    Attributes
    ----------
    p : Params
    rigid : Rigid
    constants : ndarray, shape (n, CONSTANTS)
        See `models.vibrator.lanes.packed.pack`.
    fastest : ndarray, shape (n,)
        See `models.vibrator.equations.time_scales.fastest_rates`.
    synchronous_speed : ndarray, shape (n, 2)
        [rad s-1]
    """

    p: Rows
    rigid: Rigid
    constants: Array
    fastest: Array
    synchronous_speed: Array

    def take(self, rows: Any) -> "Machines":
        """Return some of the machines."""
        return Machines(
            Params._make(field[rows] for field in self.p),
            Rigid._make(field[rows] for field in self.rigid),
            self.constants[rows],
            self.fastest[rows],
            self.synchronous_speed[rows],
        )


def is_rigid(p: Rows, settings: Settings) -> NDArray[np.bool_]:
    """Return which machines lanes can follow at speed: motors bolted to the body, no feed."""
    rigid = np.isinf(p.mount_stiffness) & np.isinf(p.mount_rotational_stiffness)
    rigid &= (p.feed_mass == 0) & (p.torque_lag == 0)
    return rigid & (settings.kinematics == "small")


def follows(p: Rows, settings: Settings) -> NDArray[np.bool_]:
    """Return which machines lanes can follow from the start: rigid ones, switched on directly."""
    return is_rigid(p, settings) & (p.ramp_time == 0)


def prepared(p: Rows) -> Machines:
    """Prepare n machines that lanes can follow, each field of p of shape (n,)."""
    m = rigid_machines(p)
    speeds = np.stack([p.synchronous_speed_1, p.synchronous_speed_2], axis=1)
    return Machines(p, m, pack(m), fastest_rates(m), speeds)


def groups(p: Rows, settings: Settings) -> Iterator[tuple[NDArray[np.intp], Machines]]:
    """Prepare the machines that lanes can follow, all in one group."""
    rows = np.flatnonzero(follows(p, settings))
    yield rows, prepared(Params._make(field[rows] for field in p))


def start(machines: Machines) -> Array:
    """Return n machines at rest, shape (n, 10), at their initial phases."""
    return initial_state(machines.p)
