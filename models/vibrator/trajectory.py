"""One labelled time history of the vibrator, from its start."""

import math

import numpy as np
from numpy.typing import NDArray

from models.vibrator.batch import batch
from models.vibrator.equations import general, rigid_motion
from models.vibrator.equations.system import system
from models.vibrator.exact import propagator
from models.vibrator.parameters import Params, Settings
from uq.contract import Trajectory

SHORTEST = 10.0  # s
SETTLED = 1.5  # times the synchronisation time
SAMPLES_PER_TURN = 50
SHOWN = ("x", "y", "alpha", "disphasing_angle", "speed_1", "speed_2")

Series = NDArray[np.float64]


def simulate(params: Params, settings: Settings, seed: int = 0) -> Trajectory:
    """Follow one machine from standstill until it runs as its outputs describe.

    That is for ten seconds, longer where it takes more to synchronise, and to the end of the
    longest start simulated where it never does.

    Parameters
    ----------
    params : Params
    settings : Settings
        The tolerance applies whichever propagator is chosen for a batch. The first of the
        `body_points` adds ``point_1_x`` and ``point_1_y``, the next ``point_2_x``, and so on.
    seed : int
        Not used: the vibrator is deterministic.

    Returns
    -------
    Trajectory
        It ends early if the step budget runs out.
    """
    m = system(params, settings.kinematics)
    needed = SETTLED * _synchronisation_time(params, settings)
    duration = min(max(SHORTEST, needed), settings.run_up)
    rigid = m.rigid
    speed = max(rigid.synchronous_speed_1, rigid.synchronous_speed_2)
    count = math.ceil(duration * speed / (2 * np.pi) * SAMPLES_PER_TURN)
    time = np.linspace(0.0, duration, count + 1)
    motion = propagator.propagate(
        m, propagator.start(params, m), duration, settings.tolerance, times=time
    )
    reached = time <= motion.time
    q, v = np.split(motion.samples[reached].T, 2)
    x, y, alpha, psi_1, psi_2 = q[: rigid_motion.DEGREES]

    def displacement(along: float, above: float) -> tuple[Series, Series]:
        """Return the displacement of a point of the body, given its rest position from C."""
        if not m.exact:
            return x - above * alpha, y + along * alpha
        lift, shrink = np.sin(alpha), np.cos(alpha) - 1
        return x + along * shrink - above * lift, y + along * lift + above * shrink

    axis = np.array([math.cos(rigid.working_angle), math.sin(rigid.working_angle)])
    left, right = (
        axis @ displacement(end, 0.0) for end in (-rigid.half_spacing, rigid.half_spacing)
    )
    quantities = {
        "x": ("m", "horizontal displacement of C", x),
        "y": ("m", "vertical displacement of C", y),
        "alpha": ("rad", "rotation of the body", alpha),
        "disphasing_angle": ("rad", "disphasing angle, turns included", psi_1 - psi_2),
        "speed_1": ("rad s-1", "speed of vibrator 1", v[3]),
        "speed_2": ("rad s-1", "speed of vibrator 2", v[4]),
        "displacement_left": ("m", "left deck end along xi", left),
        "displacement_right": ("m", "right deck end along xi", right),
    }
    if len(q) >= general.DEGREES:
        quantities |= {
            "mount_displacement": ("m", "motor set on its mount", q[5]),
            "mount_rotation": ("rad", "rotation on the mount", q[6]),
            "feed_height": ("m", "height of the feed above the deck", q[7]),
        }
    for i, (along, above) in enumerate(settings.body_points, 1):
        moved = displacement(along, above)
        for name, word, series in zip("xy", ("horizontal", "vertical"), moved, strict=True):
            meaning = f"{word} displacement of the body point at ({along:g}, {above:g}) m from C"
            quantities[f"point_{i}_{name}"] = ("m", meaning, series)
    turn = 2 * np.pi / float(np.abs(v[3:5, -SAMPLES_PER_TURN:]).mean())
    return Trajectory(
        time[reached],
        quantities,
        period=turn,
        shown=SHOWN,
        angles=("disphasing_angle",),
    )


def _synchronisation_time(params: Params, settings: Settings) -> float:
    """Return the output of that name; infinite where the motors never synchronise."""
    outputs, _ = batch(np.array([params]), np.zeros(1, np.uint64), settings)
    return float(np.nan_to_num(outputs["synchronisation_time"][0], posinf=np.inf))
