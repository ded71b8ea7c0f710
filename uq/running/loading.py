"""Studies and models, with functions that do not declare what they return run to find out.

The nominal row and the first rows of the design are run, in a process of their own; what they
return is remembered on this computer until the function changes.
"""

import hashlib
import json
import time
from collections.abc import Iterator
from contextlib import suppress
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from uq.contract import Model
from uq.errors import InputError
from uq.outside.returned import Returned, as_plain, from_plain, joined
from uq.outside.row_by_row import RowByRow
from uq.running.environment import started
from uq.running.options import Say, ignore
from uq.study.registry import code_of, find_model, located, with_returns
from uq.study.sources import DISTRIBUTION
from uq.wording import duration

if TYPE_CHECKING:
    from uq.study.definition import Study

SEEN = 64
"""Rows of a design that show what a function returns."""

_WORTH_KEEPING = 1.0  # seconds that these rows took
_SLOW = 3.0  # seconds after which a user is told that rows are run

Row = tuple[list[float], int]


def load_study(path: str | PathLike[str], model: str | None = None, say: Say = ignore) -> "Study":
    """Read and check a study file.

    Parameters
    ----------
    path : path-like
        A TOML file.
    model : str, optional
        Use this model instead of the file's: an installed name, ``"package.module:ATTRIBUTE"``,
        or a file ``"mine.py"`` (``"mine.py:NAME"`` where it has several).
    say : callable, optional
        Called with a line for the user if it takes long to find out what the model returns.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        Everything that is wrong with the file, one line per fault.

    Examples
    --------
    >>> study = uq.load_study("studies/ishigami.toml")
    >>> study.design.samples, list(study.uncertain)
    (256, ['x1', 'x2', 'x3'])
    """
    from uq.study import definition

    study = _known(definition.load_study(path, model and located(model)), say)
    if isinstance(study.model.batch, RowByRow):
        from uq.running.scales import check_scales

        check_scales(study)
    return study


def study_of_text(text: str, source: str, model: str | None) -> "Study":
    """Check the text of a study of a result; see `load_study`."""
    from uq.study.definition import study_from_text

    return _known(study_from_text(text, source, model and located(model)))


def load_model(reference: str) -> Model:
    """Return a model; what a function returns that does not declare it, by its nominal row."""
    reference = located(reference)
    model = find_model(reference)
    if model.outputs:
        return model
    nominal = list(model.nominal.values()), 0
    return find_model(with_returns(reference, _found(reference, [nominal])))


def _known(study: "Study", say: Say = ignore) -> "Study":
    """Return a study whose model has outputs."""
    if study.model.outputs:
        return study
    from uq.rows.sampling import row_block, rows
    from uq.study.definition import study_from_text

    first = row_block(study, 0, min(SEEN, rows(study)))
    nominal = study.model.nominal | dict(study.fixed)
    tried = [(list(nominal.values()), 0)]
    tried += zip(first.x.tolist(), first.seed.tolist(), strict=True)
    reference = study.model_reference
    known = with_returns(reference, _found(reference, tried, say))
    return study_from_text(study.text, study.path, known)


def _found(reference: str, tried: list[Row], say: Say = ignore) -> dict[str, Returned]:
    """Return what a function returns, from the rows tried, the nominal one first."""
    from platformdirs import user_cache_path

    numbers = np.array([[*row, seed] for row, seed in tried]).tobytes()
    key = hashlib.sha256(f"{reference}\n{code_of(reference)}".encode() + numbers).hexdigest()
    kept = user_cache_path(DISTRIBUTION, appauthor=False) / "returns" / f"{key}.json"
    with suppress(OSError, ValueError):
        return from_plain(json.loads(kept.read_text()))
    began = time.monotonic()
    found = joined(list(_returned(reference, tried, say)))
    if time.monotonic() - began > _WORTH_KEEPING:
        with suppress(OSError):
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(as_plain(found)))
    return found


def _returned(reference: str, tried: list[Row], say: Say) -> Iterator[dict[str, Returned]]:
    """Yield what rows return; a later one that fails is passed over, as in a run it has a status.

    Raises
    ------
    InputError
        When the nominal row fails.
    """
    from uq.running import probe

    todo = iter(enumerate(tried))
    left = len(tried)
    began, told = time.monotonic(), False
    while left:
        for i, said, value in _in_process(reference, todo):
            left = len(tried) - i - 1
            seconds = time.monotonic() - began
            if seconds > _SLOW and left and not told:
                told = True
                more = seconds / (i + 1) * left
                say(
                    f"running {left} more rows, once, to see what the model returns: about"
                    f" {duration(more) or f'{more:.0f} s'}; 'returns' in @uq.machine states it"
                )
            if said == probe.REFUSED:
                raise value
            if said == probe.RETURNED:
                yield from_plain(value)
            elif i == 0:
                raise InputError(f"model '{reference}': its nominal row {value}")


def _in_process(reference: str, todo: Iterator[tuple[int, Row]]) -> Iterator[tuple[int, str, Any]]:
    """Yield the number of each row and what it did, until one kills the process."""
    from uq.running import probe

    process, connection = started("uq.running.probe")
    try:
        connection.send(reference)
        for i, row in todo:
            try:
                connection.send(row)
                said, value = connection.recv()
            except (EOFError, OSError):
                yield i, probe.RAISED, "killed its process"
                return
            yield i, said, value
    finally:
        connection.close()
        process.kill()
        process.communicate()
