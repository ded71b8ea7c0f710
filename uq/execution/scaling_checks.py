"""Check the scaling exponents declared by an external machine against returned lives.

In a few rows, only the parameters declared to scale a life are changed, over the full range of
their laws. Machines of an installed package are checked by their tests.
"""

import hashlib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Model, Output, Status, censored_name
from uq.errors import InputError
from uq.execution.isolation import Isolated, spec_of
from uq.files.whole_files import cache_path
from uq.machines.row_by_row import RowByRow
from uq.result.workload import workload_of
from uq.sampling.truncation import ppf_within
from uq.study.evaluate import Chunk
from uq.study.installed_models import code_of
from uq.study.row_sampling import row_block
from uq.study.sources import DISTRIBUTION

if TYPE_CHECKING:
    from uq.study.definition import Study

_ENDS = np.array([1e-6, 1 - 1e-6])
"""Probabilities of the quantiles used as the ends of an input law."""

_FAR = 4.0  # times the value of a parameter without a law, where a bound is farther
_SAME = 1e-9  # relative difference
_EACH = 4  # rows that differ in scale alone


def check_scales(study: "Study", row_limit: float | None = None) -> None:
    """Check the declared scaling exponents with a few rows; repeated only if the machine changes.

    Parameters
    ----------
    study : Study
    row_limit : float, optional
        Time limit of a row [s].

    Raises
    ------
    InputError
        When a life does not scale as declared.
    """
    model = study.model
    scaled = {name: output for name, output in model.outputs.items() if output.exponents}
    if not scaled or not isinstance(model.batch, RowByRow):
        return
    first = row_block(study, 0, 1)
    nominal = np.array(list((model.nominal | dict(study.fixed)).values()))
    bases = [nominal, first.x[0], *_at_ends(study, first.x[0])]
    seed = np.repeat(np.append(np.zeros(1, np.uint64), np.repeat(first.seed, 3)), _EACH)
    x = np.concatenate([_scaled_anew(base, study, scaled) for base in bases])
    kept = _kept(study, x, seed)
    if kept.exists():
        return
    with Isolated(spec_of(workload_of(study)), row_limit).running() as batch:
        chunk = batch(x, seed, 0)
    faults = [
        fault for name, output in scaled.items() for fault in _faults(model, name, output, x, chunk)
    ]
    if faults:
        raise InputError(*(f"machine '{model.name}': {fault}" for fault in faults))
    with suppress(OSError):
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.touch()


def _at_ends(study: "Study", row: Floats) -> Floats:
    """Return two rows, all inputs at the lower or at the upper ends of their laws, (2, d)."""
    rows = np.tile(row, (2, 1))
    for place, name in enumerate(study.model.parameter_names):
        if (ends := _ends_of_law(study, name)) is not None:
            rows[:, place] = ends
    return rows


def _ends_of_law(study: "Study", name: str) -> Floats | None:
    """Return the ends of the law of a parameter, shape (2,); None without a law of its own."""
    law = study.uncertain.get(study.tied[name].equals if name in study.tied else name)
    if law is None or law.times is not None:
        return None
    return ppf_within(law, _ENDS, study.bounds(name))


def _scaled_anew(base: Floats, study: "Study", scaled: dict[str, Output]) -> Floats:
    """Return the base row and rows with changed scaling parameters, shape (4, d)."""
    rng, rows = np.random.default_rng(1), np.tile(base, (_EACH, 1))
    model = study.model
    for name in dict.fromkeys(name for output in scaled.values() for name in output.exponents):
        place = model.parameter_names.index(name)
        least, most = model.parameter(name).bounds
        value = base[place] if base[place] > 0 else model.nominal[name]
        low = least if 0 < least and value / _FAR < least else value / _FAR
        high = min(most, value * _FAR)
        if (ends := _ends_of_law(study, name)) is not None and ends[0] > 0:
            low, high = ends
        inside = low * (high / low) ** rng.random(_EACH - 3)
        rows[1:, place] = [low, *inside, high]
    return rows


def _faults(model: Model, name: str, output: Output, x: Floats, chunk: Chunk) -> Iterator[str]:
    """Yield deviations of a life from its declared power law."""
    columns = [model.parameter_names.index(parameter) for parameter in output.exponents]
    factor = np.prod(x[:, columns] ** np.array(list(output.exponents.values())), axis=1)
    lives = chunk.columns[name].reshape(len(x), -1)
    cut = chunk.columns[censored_name(name)].reshape(lives.shape).astype(bool)
    sound = chunk.status == Status.OK
    for row in range(len(x)):
        first = row - row % _EACH
        expected = lives[first] * (factor[row] / factor[first])
        if not (sound[row] and sound[first]):
            continue
        wrong = _differ(lives[row], cut[row], expected, cut[first])
        if wrong.any():
            place = int(np.argmax(wrong))
            pairs = zip(output.exponents, x[row, columns], strict=True)
            at = ", ".join(f"{parameter} = {value:g}" for parameter, value in pairs)
            yield (
                f"output '{name}' does not scale as declared: at {at} it is"
                f" {lives[row, place]:.6g}, not {expected[place]:.6g}"
            )
            return


def _differ(lives: Floats, cut: Mask, expected: Floats, only_more: Mask) -> Mask:
    """Return the mask of lives that contradict the expected ones, allowing for censoring."""
    with np.errstate(invalid="ignore"):  # never over never
        same = (lives == expected) | (np.abs(lives / expected - 1) < _SAME)
        too_long = ~same & np.where(cut, lives > expected, lives < expected)
    differs = np.where(cut ^ only_more, too_long, ~same & ~cut & ~only_more)
    return np.asarray(differs & ~np.isnan(lives) & ~np.isnan(expected))


def _kept(study: "Study", x: Floats, seed: NDArray[np.uint64]) -> Path:
    """Return the path of the file that marks a passed check of these rows."""
    numbers = x.tobytes() + seed.tobytes()
    reference = study.model_reference
    key = hashlib.sha256(f"{reference}\n{code_of(reference)}".encode() + numbers).hexdigest()
    return cache_path(DISTRIBUTION) / "scales" / key
