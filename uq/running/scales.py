"""The scales that a machine from outside declares, held to what it returns.

Of two rows, the parameters that should only scale a life are changed and nothing else. Machines of
an installed package are held to it by their tests.
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
from uq.outside.row_by_row import RowByRow
from uq.rows.evaluate import Chunk
from uq.rows.sampling import row_block
from uq.rows.workload import workload_of
from uq.running.isolation import isolated, spec_of
from uq.study.registry import code_of
from uq.study.sources import DISTRIBUTION

if TYPE_CHECKING:
    from uq.study.definition import Study

_FAR = 4.0  # times the value of a parameter, where a bound is farther
_SAME = 1e-9  # relative difference
_EACH = 3  # rows that differ in scale alone


def check_scales(study: "Study", row_limit: float | None = None) -> None:
    """Compute a few rows, if scales are declared; remembered until the machine changes.

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
    scaled = {name: output for name, output in model.outputs.items() if output.scales}
    if not scaled or not isinstance(model.batch, RowByRow):
        return
    first = row_block(study, 0, 1)
    nominal = model.nominal | dict(study.fixed)
    bases = np.array([list(nominal.values()), first.x[0]])
    seed = np.repeat(np.append(np.uint64(0), first.seed), _EACH)
    x = np.concatenate([_scaled_anew(base, model, scaled) for base in bases])
    kept = _kept(study, x, seed)
    if kept.exists():
        return
    with isolated(spec_of(workload_of(study)), row_limit) as batch:
        chunk = batch(x, seed, 0)
    faults = [
        fault for name, one in scaled.items() for fault in _faults(model, name, one, x, chunk)
    ]
    if faults:
        raise InputError(*(f"machine '{model.name}': {fault}" for fault in faults))
    with suppress(OSError):
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.touch()


def _scaled_anew(base: Floats, model: Model, scaled: dict[str, Output]) -> Floats:
    """Return a row, and some with other values of what scales; shape (3, d)."""
    rng, rows = np.random.default_rng(1), np.tile(base, (_EACH, 1))
    for name in dict.fromkeys(name for one in scaled.values() for name in one.scales):
        place = model.parameter_names.index(name)
        least, most = model.parameter(name).bounds
        value = base[place] if base[place] > 0 else model.nominal[name]
        low = least if 0 < least and value / _FAR < least else value / _FAR
        high = min(most, value * _FAR)
        rows[1:, place] = low ** (1 - (share := rng.random(_EACH - 1))) * high**share
    return rows


def _faults(model: Model, name: str, output: Output, x: Floats, chunk: Chunk) -> Iterator[str]:
    """Yield how a life differs from the powers that its output declares."""
    columns = [model.parameter_names.index(one) for one in output.scales]
    factor = np.prod(x[:, columns] ** np.array(list(output.scales.values())), axis=1)
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
            pairs = zip(output.scales, x[row, columns], strict=True)
            at = ", ".join(f"{one} = {value:g}" for one, value in pairs)
            yield (
                f"output '{name}' does not scale as declared: at {at} it is"
                f" {lives[row, place]:.6g}, not {expected[place]:.6g}"
            )
            return


def _differ(lives: Floats, cut: Mask, expected: Floats, only_more: Mask) -> Mask:
    """Return where lives are not as expected; where they, or what is expected, are cut: less."""
    with np.errstate(invalid="ignore"):  # never over never
        same = (lives == expected) | (np.abs(lives / expected - 1) < _SAME)
        too_long = ~same & np.where(cut, lives > expected, lives < expected)
    differs = np.where(cut ^ only_more, too_long, ~same & ~cut & ~only_more)
    return np.asarray(differs & ~np.isnan(lives) & ~np.isnan(expected))


def _kept(study: "Study", x: Floats, seed: NDArray[np.uint64]) -> Path:
    """Return the file that exists once these rows have scaled as declared."""
    from platformdirs import user_cache_path

    numbers = x.tobytes() + seed.tobytes()
    reference = study.model_reference
    key = hashlib.sha256(f"{reference}\n{code_of(reference)}".encode() + numbers).hexdigest()
    return user_cache_path(DISTRIBUTION, appauthor=False) / "scales" / key
