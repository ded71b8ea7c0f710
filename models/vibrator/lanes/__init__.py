"""The fast propagator: sixteen rigid machines at a time, in steps of fixed length.

Reading order; a module imports only those above it:

    packed         constants and states of machines in lanes
    machines       n machines, prepared and started
    dynamics       their accelerations, with the fewest operations
    steps          steps of fixed length, of order 5 and 8
    derivatives    how the accelerations change with the state
    notes          what is recorded of a step
    fixed_steps    n machines advanced: the hot loop
    following      n machines followed step by step
    tangents       a revolution with its derivatives with respect to the start
    chords         Newton's method with derivatives that are kept
    multiplier     the largest Floquet multiplier of an orbit
    orbit          the synchronous motion as a periodic orbit, by Newton's method

It is a `models.numerics.propagator.Propagator`.
"""

from models.vibrator.lanes.fixed_steps import advance
from models.vibrator.lanes.machines import Machines, groups, start
from models.vibrator.lanes.tangents import monodromy

__all__ = ["Machines", "advance", "groups", "monodromy", "start"]
