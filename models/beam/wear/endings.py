"""The end of wear, where contact ends."""

from models.beam.response.response import NO_IMPACT
from models.beam.wear.progress import note_look
from models.numerics.jit import inlined

_EXTINCT = 1e-6  # of the first work-rate: wear ends below it, near the free amplitude


@inlined
def is_extinct(i, life, rate, grown):
    """Return whether contact is too weak for a greater depth ever to be reached.

    A gap that grows towards the free amplitude approaches it like 1/t, not in finite time.
    """
    right = life.initial[i, 0] + life.grown[i, 0] + grown[0]
    left = life.initial[i, 1] + life.grown[i, 1] + grown[1]
    weak = max(rate[0], rate[1]) <= _EXTINCT * life.first[i]
    return weak and life.free_reach[i] < 1.01 * min(right, left)


@inlined
def was_last(i, life, out, now, grown):
    """Return whether wear ended within a step, and no growth to reach is within it."""
    if not is_extinct(i, life, now, grown):
        return False
    for s in range(2):
        for depth in range(life.growths.shape[1]):
            missing = life.growths[i, depth] - life.grown[i, s]
            if not out.reached[i, s, depth] and missing <= grown[s]:
                return False
    return True


@inlined
def has_ended(i, life, nothing):
    """Return whether contact has ended for good."""
    right = life.initial[i, 0] + life.grown[i, 0]
    left = life.initial[i, 1] + life.grown[i, 1]
    silent = life.silence[i] >= life.silent[i] and life.free_reach[i] < min(right, left)
    return silent or is_extinct(i, life, life.rate[i], nothing)


@inlined
def note_end(i, life, out, spacing):
    """Record the end of wear of beam i in its history."""
    life.regime[i] = NO_IMPACT
    for s in range(2):
        life.rate[i, s] = 0.0
    look = int(life.distance[i] / spacing)
    if look < out.history.regime.shape[1]:
        note_look(i, life, out, look, 0.0, 0.0, life.grown[i], life.rate[i])
