"""Labelled data of the beam for notebooks: histories, phase portraits, diagrams and branches.

Reading order; a module imports only those above it:

    sweeps          settled responses of many beams, independent or in a sweep
    labels          units and names of the results
    settled         work-rates and phase portraits at constant gaps
    diagram         bifurcation diagrams over the forcing frequency
    history         one life: gaps, work-rates and regimes
    lyapunov        the largest Lyapunov exponent
    orbit_labels    units and names of periodic orbits
    branches        periodic orbits followed over frequency, gap and wear

They include Figures 3 to 6 of Knudsen & Massih 2002 and the bifurcation diagram of their journal
paper. Basins of attraction, of this model or any other, come from ``uq.basins``.
"""

from models.beam.explore.branches import continue_orbit, follow_wear
from models.beam.explore.diagram import bifurcation_diagram
from models.beam.explore.history import wear_history
from models.beam.explore.lyapunov import lyapunov_exponent
from models.beam.explore.settled import phase_portrait, work_rate_against_gap

__all__ = [
    "bifurcation_diagram",
    "continue_orbit",
    "follow_wear",
    "lyapunov_exponent",
    "phase_portrait",
    "wear_history",
    "work_rate_against_gap",
]
