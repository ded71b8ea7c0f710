"""The fast propagator: sixteen beams abreast, in fixed steps.

systems       modes as recurrences, and the size of the step
lines         the random load at each step
tangents      what a small change of the state grows to
propagator    many beams over whole forcing periods: the hot loop
"""

from models.beam.lanes.propagator import (
    CLOCK,
    advance,
    finer,
    groups,
    monodromy,
    refine,
    start,
)

__all__ = ["CLOCK", "advance", "finer", "groups", "monodromy", "refine", "start"]
