"""Probabilistic lifetime and sensitivity studies: from a study file to a result.

What is named here is loaded when it is first used, so that ``import uq`` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from uq.attraction import basins
    from uq.comparison import compare
    from uq.convergence import enough, running_estimates
    from uq.elements import labels
    from uq.indices import sensitivity
    from uq.life_fit import life_fits
    from uq.lifetime import survival
    from uq.motion_plot import plot_history, plot_phase_portrait, plot_section
    from uq.overview import summary
    from uq.regime_table import regimes
    from uq.reliability import rare_event
    from uq.response_plot import plot_basins, plot_bifurcation, plot_curve
    from uq.results import open_result
    from uq.runner import run
    from uq.simulation import simulate
    from uq.study import load_study
    from uq.twin import two_fidelities

__all__ = [
    "basins",
    "compare",
    "enough",
    "labels",
    "life_fits",
    "load_study",
    "open_result",
    "plot_basins",
    "plot_bifurcation",
    "plot_curve",
    "plot_history",
    "plot_phase_portrait",
    "plot_section",
    "rare_event",
    "regimes",
    "run",
    "running_estimates",
    "sensitivity",
    "simulate",
    "summary",
    "survival",
    "two_fidelities",
]

_MODULES = {
    "basins": "attraction",
    "compare": "comparison",
    "enough": "convergence",
    "labels": "elements",
    "life_fits": "life_fit",
    "load_study": "study",
    "open_result": "results",
    "plot_basins": "response_plot",
    "plot_bifurcation": "response_plot",
    "plot_curve": "response_plot",
    "plot_history": "motion_plot",
    "plot_phase_portrait": "motion_plot",
    "plot_section": "motion_plot",
    "rare_event": "reliability",
    "regimes": "regime_table",
    "run": "runner",
    "running_estimates": "convergence",
    "sensitivity": "indices",
    "simulate": "simulation",
    "summary": "overview",
    "survival": "lifetime",
    "two_fidelities": "twin",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'uq' has no attribute '{name}'")
    return getattr(import_module(f"uq.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
