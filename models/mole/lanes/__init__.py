"""The fast propagator: sixteen moles at a time.

Reading order; a module imports only those above it:

    block         the memory of the lanes
    rates         their rates of change
    modes         constants and guards of each mode
    events        what an event changes
    steps         decisions after a trial step
    rows          how a row enters and leaves a lane
    strobe        whether the motion repeats, checked once per control period
    loop          each lane with its own step: the hot loop
    propagator    n moles, prepared, started and advanced
"""

from models.mole.lanes.propagator import System, advance, groups, monodromy, start

__all__ = ["System", "advance", "groups", "monodromy", "start"]
