"""A ball dropped on a plate, as a plain function."""

from math import inf, sqrt

import uq


@uq.machine(
    returns={
        "time_to_rest": uq.Returned("s", "time until the ball comes to rest", life=True),
        "bounces": uq.Returned("1", "impacts until it rests", may_be_undefined=True),
    }
)
def ball(height: float = 1.0, restitution: float = 0.9, gravity: float = 9.81):
    """Follow a ball from impact to impact, until it would rise by less than a nanometre."""
    if restitution == 1:
        return {"time_to_rest": inf, "bounces": float("nan")}
    time, speed = sqrt(2 * height / gravity), sqrt(2 * height * gravity)
    for bounces in range(1, 1001):
        speed *= restitution
        if speed * speed <= 2 * gravity * 1e-9:
            return {"time_to_rest": time, "bounces": bounces}
        time += 2 * speed / gravity
    return {"time_to_rest": uq.censored(time), "bounces": float("nan")}
