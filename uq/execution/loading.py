"""Load studies and models, run one row, and infer the outputs of functions without declarations.

The nominal row and the first rows of the design are run in a separate process. The inferred outputs
are cached on this computer until the function changes.
"""

import hashlib
import json
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from uq.contract import Model, Status
from uq.errors import InputError, first_fault_alone
from uq.execution.child import Action, ModelSpec
from uq.execution.isolation import Isolated
from uq.execution.options import Say, ignore
from uq.files.whole_files import cache_path
from uq.machines.returned import Returned, as_plain, from_plain, joined
from uq.machines.row_by_row import RowByRow
from uq.result.one_row import Row, run_row
from uq.study.evaluate import RowFailure
from uq.study.installed_models import code_of, located, model_at, with_returns
from uq.study.sources import DISTRIBUTION
from uq.text.numbers import counted, elapsed

if TYPE_CHECKING:
    from uq.study.definition import Study

SEEN = 64
"""Number of rows of a design used to infer the outputs of a function."""

_WORTH_KEEPING = 1.0  # seconds that these rows took
_SLOW = 3.0  # seconds after which a user is told that rows are run

TrialRow = tuple[list[float], int]


def load_study(
    path: str | PathLike[str],
    model: str | None = None,
    say: Say = ignore,
    row_limit: float | None = None,
) -> "Study":
    """Read and check a study file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    model : str, optional
        Use this model instead of the file's: an installed name, ``"package.module:ATTRIBUTE"``,
        or a file ``"mine.py"`` (``"mine.py:NAME"`` where it has several).
    say : callable, optional
        Called with a line for the user if inferring the outputs of the model takes long.
    row_limit : float, optional
        Time limit of a row that is run to infer outputs [s].

    Returns
    -------
    Study

    Raises
    ------
    InputError
        All faults of the file, one line each.

    Examples
    --------
    >>> study = uq.load_study("studies/ishigami.toml")
    >>> study.design.samples, list(study.uncertain)
    (256, ['x1', 'x2', 'x3'])
    """
    from uq.study import definition

    study = _with_outputs(definition.load_study(path, model and located(model)), say, row_limit)
    if isinstance(study.model.batch, RowByRow):
        from uq.execution.scaling_checks import check_scales

        check_scales(study, row_limit)
    return study


def study_of_text(text: str, source: str, model: str | None) -> "Study":
    """Check the text of a study of a result; see `load_study`. Its faults are one line."""
    from uq.study.definition import study_from_text

    reference = model and located(model)
    if reference:
        model_at(reference)  # the faults of a user's own model are listed in full
    with first_fault_alone():
        study = study_from_text(text, source, reference)
    return _with_outputs(study)


def load_model(reference: str) -> Model:
    """Load a model; undeclared outputs of a function are inferred from its nominal row."""
    return model_at(known_reference(reference))


def known_reference(reference: str) -> str:
    """Return a reference, valid in any process, to a model with known outputs."""
    reference = located(reference)
    model = model_at(reference)
    if model.outputs:
        return reference
    nominal = list(model.nominal.values()), 0
    return with_returns(reference, _observed_outputs(reference, [nominal]))


def _with_outputs(study: "Study", say: Say = ignore, limit: float | None = None) -> "Study":
    """Return a study whose model has outputs."""
    if study.model.outputs:
        return study
    from uq.study.definition import study_from_text
    from uq.study.row_sampling import row_block, rows

    first = row_block(study, 0, min(SEEN, rows(study)))
    nominal = study.model.nominal | dict(study.fixed)
    tried = [(list(nominal.values()), 0)]
    tried += zip(first.x.tolist(), first.seed.tolist(), strict=True)
    reference = study.model_reference
    model = with_returns(reference, _observed_outputs(reference, tried, say, limit))
    return study_from_text(study.text, study.path, model)


def _observed_outputs(
    reference: str, tried: list[TrialRow], say: Say = ignore, limit: float | None = None
) -> dict[str, Returned]:
    """Infer the outputs of a function from trial rows, the nominal row first."""
    from uq.study.provenance import __version__

    numbers = np.array([[*row, seed] for row, seed in tried]).tobytes()
    code = f"{__version__}\n{reference}\n{code_of(reference)}"
    key = hashlib.sha256(code.encode() + numbers).hexdigest()
    kept = cache_path(DISTRIBUTION) / "returns" / f"{key}.json"
    with suppress(OSError, ValueError):
        return from_plain(json.loads(kept.read_text()))
    began = time.monotonic()
    outputs = joined(list(_returned(reference, tried, say, limit)))
    if time.monotonic() - began > _WORTH_KEEPING:
        with suppress(OSError):
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(as_plain(outputs)))
    return outputs


def _returned(
    reference: str, tried: list[TrialRow], say: Say, limit: float | None
) -> Iterator[dict[str, Returned]]:
    """Yield the outputs inferred from trial rows; failures after the nominal row are skipped.

    Raises
    ------
    InputError
        When the nominal row fails.
    """
    done, began, announced = 0, time.monotonic(), False

    def waiting() -> None:
        nonlocal announced
        seconds, left = time.monotonic() - began, len(tried) - done
        if seconds < _SLOW or announced:
            return
        announced = True
        more = seconds / done * left if done else 0.0
        about = f": about {elapsed(more)}" if done else ""
        say(
            f"running {counted(left, 'row')}, once, to see what the model returns{about}; 'returns'"
            " in @uq.machine states it"
        )

    process = Isolated(ModelSpec(reference, "", (), probed=True), limit, waiting=waiting)
    with process.running():
        for row, seed in tried:
            outcome = process.ask(row, seed)
            if isinstance(outcome, RowFailure):
                killed = outcome.status is Status.CRASHED
                outcome = "killed its process" if killed else outcome.message
            done += 1
            if not isinstance(outcome, str):
                yield from_plain(outcome)
            elif done == 1:
                raise InputError(f"model '{reference}': its nominal row {outcome}")


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
