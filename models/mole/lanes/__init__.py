"""The fast propagator: sixteen moles abreast.

propagator    n moles, prepared, started and advanced
loop          sixteen lanes, each with its own step: the hot loop
block         the memory of the lanes
rates         their rates of change
modes         guards, and what an event changes
steps         what follows a trial step
rows          how a row enters and leaves a lane
"""

from models.mole.lanes.propagator import System, advance, groups, monodromy, start

__all__ = ["System", "advance", "groups", "monodromy", "start"]
