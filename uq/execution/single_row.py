"""One row of a model, in a separate process if the model may crash."""

from collections.abc import Mapping
from typing import Any

from uq.execution.child import Action, ModelSpec
from uq.execution.isolation import Isolated
from uq.execution.loading import known_reference
from uq.machines.row_by_row import RowByRow
from uq.result.one_row import Row, run_row
from uq.study.installed_models import code_of, model_at

_STDERR = 2


def run_alone(
    reference: str,
    parameters: Mapping[str, float],
    settings: Mapping[str, Any],
    seed: int = 0,
    compiling: Action = lambda: None,
) -> Row:
    """Run a model once; output printed by an external model goes to standard error.

    Parameters
    ----------
    reference : str
        As for `uq.study.installed_models.model_at`.
    parameters, settings, seed
        As for `uq.simulate`.
    compiling : callable
        Called when another process starts to compile.
    """
    reference = known_reference(reference)
    model = model_at(reference)
    if not isinstance(model.batch, RowByRow):
        return run_row(model, parameters, settings, seed)
    spec = ModelSpec(reference, model.version, (), code=code_of(reference))
    with Isolated(spec, None, compiling, prints=_STDERR).running() as batch:
        return run_row(model, parameters, settings, seed, lambda x, seeds: batch(x, seeds, 0))
