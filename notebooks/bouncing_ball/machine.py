"""The ball as the platform sees it: parameters, settings, outputs, and two functions."""

from dataclasses import dataclass
from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from bouncing_ball.kernel import drop
from uq.contract import Model, Output, Parameter, Setting, Status, Trajectory

REGIMES = ("comes-to-rest", "bounces-for-ever")


class Params(NamedTuple):
    """Physical inputs: each a float with its symbol, unit, meaning, bounds and source."""

    height: Annotated[
        float, Parameter("h", "m", "height of the drop", (0.001, 1000.0), "assumed")
    ] = 1.0
    restitution: Annotated[
        float,
        Parameter("e", "1", "speed after an impact over that before", (0.0, 1.0), "assumed: steel"),
    ] = 0.9
    gravity: Annotated[
        float, Parameter("g", "m s-2", "acceleration of free fall", (0.1, 100.0), "standard")
    ] = 9.81


@dataclass(frozen=True)
class Settings:
    """Numerical choices: never random, never physical."""

    smallest_rise: Annotated[
        float, Setting("a ball that would rise less is at rest", "m", bounds=(1e-15, 1e-3))
    ] = 1e-9
    most_bounces: Annotated[int, Setting("budget of one row", bounds=(1, 10_000_000))] = 1000


OUTPUTS = {
    "time_to_rest": Output("s", "time until the ball comes to rest", "lifetime"),
    "bounces": Output("1", "impacts until the ball comes to rest", may_be_undefined=True),
    "regime": Output("1", "how the motion ends", "category", categories=REGIMES),
}


def batch(x, seed, settings):
    """Compute n balls: row i of all results depends only on x[i], seed[i] and settings.

    Parameters
    ----------
    x : ndarray, shape (n, 3)
        The parameters, in declared order.
    seed : ndarray, shape (n,)
        Not used: nothing is random here.
    settings : Settings

    Returns
    -------
    outputs : dict of str to ndarray, shape (n,)
    status : ndarray of int8, shape (n,)
    """
    n = len(x)
    time, bounces = np.full(n, np.inf), np.full(n, np.nan)
    censored = np.zeros(n, bool)
    regime = np.full(n, REGIMES.index("bounces-for-ever"), np.int8)
    status = np.full(n, Status.OK, np.int8)
    for i, (height, restitution, gravity) in enumerate(x):
        if restitution == 1:
            continue  # known without computing: never at rest, which is no failure
        found = drop(height, restitution, gravity, settings.smallest_rise, settings.most_bounces)
        time[i], count, at_rest = found
        regime[i] = REGIMES.index("comes-to-rest")
        if at_rest:
            bounces[i] = count
        else:  # all we know is that it takes longer
            status[i], censored[i] = Status.OUT_OF_BUDGET, True
    outputs = {"time_to_rest": time, "time_to_rest_censored": censored, "bounces": bounces}
    return outputs | {"regime": regime}, status


def simulate(params, settings, seed=0):
    """Return the time history of one ball, until it comes to rest or the budget of bounces ends.

    Parameters
    ----------
    params : Params
    settings : Settings
    seed : int
        Not used.

    Returns
    -------
    Trajectory
    """
    g = params.gravity
    # Extended backwards, the fall is half of a flight that began before the start.
    start, speed = -sqrt(2 * params.height / g), sqrt(2 * params.height * g)
    time, height, velocity = [], [], []
    for _ in range(settings.most_bounces + 1):
        duration = 2 * speed / g
        since = np.linspace(0.0, duration, 50)
        time.append(start + since)
        height.append(speed * since - g * since**2 / 2)
        velocity.append(speed - g * since)
        start, speed = start + duration, params.restitution * speed
        if speed**2 <= 2 * g * settings.smallest_rise:
            break
    t, y, v = (np.concatenate(parts) for parts in (time, height, velocity))
    seen = t >= 0
    return Trajectory(
        t[seen],
        {
            "height": ("m", "height above the plate", y[seen]),
            "velocity": ("m s-1", "velocity, upwards", v[seen]),
        },
    )


MODEL = Model(
    name="bouncing-ball",
    title="A ball dropped on a plate",
    version="1",
    parameters=Params,
    settings=Settings,
    outputs=OUTPUTS,
    batch=batch,
    simulate=simulate,
)
