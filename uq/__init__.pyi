"""What ``import uq`` offers: the one list, read when the package is loaded and by type checkers."""

from . import plots as plots
from .analysis.comparison import compare as compare
from .analysis.convergence import enough as enough
from .analysis.convergence import running_estimates as running_estimates
from .analysis.fit_table import life_fits as life_fits
from .analysis.fleet import fleet as fleet
from .analysis.level_table import levels as levels
from .analysis.lifetime import survival as survival
from .analysis.overview import summary as summary
from .analysis.regime_table import regimes as regimes
from .analysis.twin import two_fidelities as two_fidelities
from .analysis.what_if import what_if as what_if
from .conclusions.answer import answer as answer
from .errors import InputError as InputError
from .errors import RunError as RunError
from .exploring.basins import basins as basins
from .exploring.rare_events import rare_event as rare_event
from .exploring.row_again import row as row
from .exploring.simulation import simulate as simulate
from .indices.dataset import sensitivity as sensitivity
from .provenance import __version__ as __version__
from .rows.elements import labels as labels
from .rows.results import open_result as open_result
from .running.runner import run as run
from .study.definition import load_study as load_study
from .tracing.tracing import trace as trace
