"""Probabilistic lifetime and sensitivity studies: from a study file to a result.

What is named here is loaded when it is first used, so that ``import uq`` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from uq.analysis.comparison import compare
    from uq.analysis.convergence import enough, running_estimates
    from uq.analysis.life_fit import life_fits
    from uq.analysis.lifetime import survival
    from uq.analysis.overview import summary
    from uq.analysis.regime_table import regimes
    from uq.analysis.twin import two_fidelities
    from uq.drawing.motion_plot import plot_history, plot_phase_portrait, plot_section
    from uq.drawing.response_plot import plot_basins, plot_bifurcation, plot_curve
    from uq.indices.dataset import sensitivity
    from uq.rows.elements import labels
    from uq.rows.results import open_result
    from uq.running.attraction import basins
    from uq.running.reliability import rare_event
    from uq.running.runner import run
    from uq.running.simulation import simulate
    from uq.study.definition import load_study

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
    "basins": "running.attraction",
    "compare": "analysis.comparison",
    "enough": "analysis.convergence",
    "labels": "rows.elements",
    "life_fits": "analysis.life_fit",
    "load_study": "study.definition",
    "open_result": "rows.results",
    "plot_basins": "drawing.response_plot",
    "plot_bifurcation": "drawing.response_plot",
    "plot_curve": "drawing.response_plot",
    "plot_history": "drawing.motion_plot",
    "plot_phase_portrait": "drawing.motion_plot",
    "plot_section": "drawing.motion_plot",
    "rare_event": "running.reliability",
    "regimes": "analysis.regime_table",
    "run": "running.runner",
    "running_estimates": "analysis.convergence",
    "sensitivity": "indices.dataset",
    "simulate": "running.simulation",
    "summary": "analysis.overview",
    "survival": "analysis.lifetime",
    "two_fidelities": "analysis.twin",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'uq' has no attribute '{name}'")
    return getattr(import_module(f"uq.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
