"""The motion of one ball, compiled: plain numbers, no names, no units."""

from math import sqrt

from models.numerics.jit import kernel


@kernel
def drop(height, restitution, gravity, smallest_rise, most_bounces):
    """Drop one ball and follow it from impact to impact.

    Returns
    -------
    time : float
        Of the last impact followed [s].
    bounces : int
    at_rest : bool
        False if the budget of bounces ran out first.
    """
    time = sqrt(2 * height / gravity)
    speed = sqrt(2 * height * gravity)
    for bounces in range(1, most_bounces + 1):
        speed *= restitution
        if speed * speed <= 2 * gravity * smallest_rise:
            return time, bounces, True
        time += 2 * speed / gravity
    return time, most_bounces, False
