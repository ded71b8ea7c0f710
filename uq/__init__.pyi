"""What ``import uq`` offers: the one list, read when the package is loaded and by type checkers."""

from . import plots as plots
from .analysis.comparison import compare as compare
from .analysis.convergence import enough as enough
from .analysis.convergence import running_estimates as running_estimates
from .analysis.life_fit import life_fits as life_fits
from .analysis.lifetime import survival as survival
from .analysis.overview import summary as summary
from .analysis.regime_table import regimes as regimes
from .analysis.twin import two_fidelities as two_fidelities
from .drawing.motion_plot import plot_history as plot_history
from .drawing.motion_plot import plot_phase_portrait as plot_phase_portrait
from .drawing.motion_plot import plot_section as plot_section
from .drawing.response_plot import plot_basins as plot_basins
from .drawing.response_plot import plot_bifurcation as plot_bifurcation
from .drawing.response_plot import plot_curve as plot_curve
from .errors import InputError as InputError
from .errors import RunError as RunError
from .exploring.basins import basins as basins
from .exploring.rare_events import rare_event as rare_event
from .exploring.simulation import simulate as simulate
from .indices.dataset import sensitivity as sensitivity
from .provenance import __version__ as __version__
from .rows.elements import labels as labels
from .rows.results import open_result as open_result
from .running.runner import run as run
from .study.definition import load_study as load_study
