"""The exact propagator: from event to event, one beam at a time.

Reading order; a module imports only those above it:

    phases          free flight and contact, where the stop's spring couples the modes
    within_phase    motion within one of them
    tip_bounds      how long the tip is certain to stay away from a stop
    events          where contacts begin, turn and end
    one_beam        one beam over whole forcing periods
    tuning          one beam at any forcing frequency
    passage         one trajectory with its tangents
    systems         beams with their phases
    propagator      many beams over whole forcing periods
"""

from models.beam.exact.one_beam import CLOCK
from models.beam.exact.propagator import advance, monodromy, speeds, start
from models.beam.exact.systems import finer, groups

__all__ = ["CLOCK", "advance", "finer", "groups", "monodromy", "speeds", "start"]
