"""The fast propagator: sixteen beams at a time, in fixed steps.

Reading order; a module imports only those above it:

    layout          the columns of a state
    recurrence      one mode over one step
    random_motion   the response to a random load at each step
    systems         beams that share a step size
    states          initial states, and states in half steps
    steps           the hot loop: modes, contact force, impact work
    tangents        the tangent flow along a known trajectory
    propagator      many beams over whole forcing periods
    speeds          the velocity along a known trajectory
"""

from models.beam.lanes.layout import CLOCK
from models.beam.lanes.propagator import advance, monodromy
from models.beam.lanes.speeds import speeds
from models.beam.lanes.states import finer, start
from models.beam.lanes.systems import groups

__all__ = ["CLOCK", "advance", "finer", "groups", "monodromy", "speeds", "start"]
