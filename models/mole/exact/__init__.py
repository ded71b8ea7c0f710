"""The exact propagator: one mole at a time, error-controlled from event to event.

Reading order; a module imports only those above it:

    states        states and motions of a mole
    events        the loop over events
    propagator    one mole, started and followed
"""

from models.mole.exact.propagator import propagate, start
from models.mole.exact.states import Motion, State

__all__ = ["Motion", "State", "propagate", "start"]
