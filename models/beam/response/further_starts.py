"""Other settled responses of the same beam, from further initial states.

Several stable responses may coexist, and a run shows one of them. Where asked, the response is
settled again from states whose amplitude and angle in the first mode follow a Weyl sequence
(Roberts 2018). They are the same for every beam, up to its scales, and independent of its seed:
without a random force, beams of equal parameters have equal results. The response without contact
is known to be stable where it exists, and needs no start.
"""

import numpy as np

from models.beam.response.response import Response
from models.beam.response.settling import settle
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.numerics.elementary import cos, sin

_WIDEST = 3.0  # largest amplitude of a start over the reach of the tip in the first response
_PLASTIC = 1.324717957244746  # its inverse powers are the steps of the sequence
_TOGETHER = 16  # starts
_SAME = 1e-6  # difference of the work of equal orbits, relative to their sum


def add_other_responses(
    propagator: Propagator,
    system: System,
    gaps: Array,
    first: Response,
    out: Response,
    starts: int,
) -> None:
    """Extend the errors of work-rates to the responses from further starts.

    The error of both sites is at least the largest significant difference of either: the responses
    may be mirror images of each other.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    gaps : ndarray, shape (n, 2)
        In initial gaps; not changed.
    first : Response
        From the start of each beam, in the same steps; not changed.
    out : Response
        Updated in place: the errors.
    starts : int
        Further starts of each beam. None are made under a random force, which leaves one response.
    """
    valid = np.isfinite(first.work).all(axis=1)
    rows = np.flatnonzero(valid & ~system.beams.is_random)
    if not starts or not len(rows):
        return
    can_rest = rows[system.free_reach[rows] < gaps[rows].min(axis=1)]
    rest = first.work[can_rest].max(axis=1, keepdims=True)
    out.error[can_rest] = np.maximum(out.error[can_rest], rest)
    for begin in range(0, starts, _TOGETHER):
        count = min(_TOGETHER, starts - begin)
        at = np.arange(begin + 1, begin + count + 1)
        again = np.repeat(rows, count)
        reach = _WIDEST * (gaps[again] + first.peak[again]).max(axis=1)
        amplitude = reach * np.tile(at / _PLASTIC % 1, len(rows))
        angle = np.tile(2 * np.pi * (at / _PLASTIC**2 % 1), len(rows))
        part = system.take(again)
        speed = amplitude * sin(angle) * part.beams.forcing
        state = propagator.start(part, amplitude * cos(angle), speed)
        other = settle(propagator, part, state, gaps[again])
        beyond = _difference(first.take(again), other).reshape(len(rows), count)
        out.error[rows] = np.maximum(out.error[rows], beyond.max(axis=1)[:, None])


def _difference(first: Response, other: Response) -> Array:
    """Return the largest significant difference of either site's work, shape (n,); 0 if unknown."""
    apart = np.abs(other.work - first.work)
    within = np.hypot(other.error, first.error) + _SAME * first.work.sum(axis=1, keepdims=True)
    return np.where(apart > within, apart, 0.0).max(axis=1)
