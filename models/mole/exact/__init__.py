"""The exact propagator: one mole at a time, error-controlled from event to event.

states        what a mole's future depends on, and how it moved
propagator    one mole, started and followed
events        the loop over events
"""

from models.mole.exact.propagator import propagate, start
from models.mole.exact.states import Motion, State

__all__ = ["Motion", "State", "propagate", "start"]
