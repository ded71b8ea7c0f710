"""The fast propagator: thirty-two moles at a time.

Reading order; a module imports only those above it:

    block         the memory of the lanes
    expand        the motion as a Taylor series
    modes         constants and guards of each mode
    events        what an event changes
    looks         how far a series reaches, and whether a guard falls through zero
    locate        where it does
    move          the state at the end of a step
    rows          how a row enters and leaves a lane
    strobe        whether the motion repeats, checked once per control period
    loop          each lane with its own step: the hot loop
    propagator    n moles, prepared, started and advanced
"""

from models.mole.lanes.propagator import System, advance, groups, monodromy, resume, start

__all__ = ["System", "advance", "groups", "monodromy", "resume", "start"]
