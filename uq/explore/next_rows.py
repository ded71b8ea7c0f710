"""Next rows: where a result of few rows gains most, drawn at random so that weights stay right."""

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.errors import InputError
from uq.execution.options import DEFAULTS, RunOptions, ignore
from uq.execution.runner import run_study
from uq.explore.limit_state import find_element
from uq.explore.new_rows import study_behind, with_given_rows
from uq.files.whole_files import check_target, write_result
from uq.learning.importance import own_rows, with_rounds
from uq.machines.emulator import parts_of
from uq.result.result import AnyResult, Result
from uq.result.weights import INDEPENDENT_ROUNDS, MOST, ROUND, WEIGHT
from uq.stats.regressions import FOLDS, process_of, scale_of, scaled
from uq.study.definition import Study
from uq.study.row_sampling import physical

POOL = 8192
"""Rows drawn from the laws of the study, among which the next rows of a part are chosen."""

_MOST_LEARNT = 400
_LEAST = 1e-12
_SEED = 29


class Aim(NamedTuple):
    """What the next rows are for.

    Attributes
    ----------
    output : str
        Element whose variance is to be learnt; "" to fill the space of the inputs.
    near : float or None
        Value of the output near which rows are wanted: the limit of an event.
    """

    output: str = ""
    near: float | None = None


def next_rows(
    result: AnyResult,
    rows: int,
    output: str = "",
    near: float | None = None,
    model: str | None = None,
) -> pd.DataFrame:
    """Propose the rows to compute next.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        Of independent rows, perhaps with earlier next rows.
    rows : int
        Number of rows.
    output : str, optional
        Element of an output, such as ``life[depth=0.00025]``: rows where a Gaussian process of it
        is uncertain. Without it, rows that are far from all others.
    near : float, optional
        Value of the output: rows of which it is uncertain on which side they are.
    model : str, optional
        Where a model that is not installed lives, as for `load_study`.

    Returns
    -------
    pandas.DataFrame
        Uncertain inputs, and the ``weight`` of each row. `uq extend OUT.nc --next N` computes the
        same rows.

    Raises
    ------
    InputError
        When rows of such a result are not independent, or the output has no numbers.

    Notes
    -----
    Rows are drawn at random, from a density a(x) times that of the laws, where a is the variance of
    a Gaussian process, the probability that it errs on the side of the limit, or the volume around
    a row. In the first round, the rows are divided into five parts; for each, a is made from the
    rows of the others, and a fifth of the next rows is drawn. Within a part, rows of the study and
    next rows are weighted by the mixture of their densities (balance heuristic) [1]_. As a does not
    depend on the rows of the part, weighted means have no bias.

    In later rounds, a is made from all rows so far, and half of the next rows are drawn from the
    laws. Weights of earlier rows do not change, and those of the next rows are a mean of 1 whatever
    the earlier rows are, so that weighted means have no bias either.

    References
    ----------
    .. [1] E. Veach, L. J. Guibas, "Optimally combining sampling techniques for Monte Carlo
       rendering", SIGGRAPH 95, 419-428 (1995).
    """
    result = Result.of(result)
    study = _study_of(result, model)
    scores, weights = _proposed(result, study, rows, Aim(output, near))
    x = physical(study, special.ndtr(scores))
    names = study.model.parameter_names
    columns = {name: x[:, names.index(name)] for name in study.uncertain}
    return pd.DataFrame(columns).assign(weight=weights[len(result) :])


def extend_by_next(
    result: Result,
    rows: int,
    aim: Aim,
    path: Path,
    model: str | None = None,
    options: RunOptions = DEFAULTS,
) -> xr.Dataset:
    """Compute the rows of `next_rows`, and write the result with all rows and their weights.

    Parameters
    ----------
    result, rows, aim, model
        As for `next_rows`.
    path : Path
        File to write, another than that of the result.
    options : RunOptions
    """
    if path.exists():
        raise InputError(f"{path}: exists already; choose another output")
    check_target(path, 0)
    study = _study_of(result, model)
    scores, weights = _proposed(result, study, rows, aim)
    seed = np.random.SeedSequence((study.design.seed, _SEED, len(result))).generate_state(1)
    given = with_given_rows(study, scores, "next rows", int(seed[0]))
    part = path.with_name(f"{path.stem}-next-{len(result)}.nc")
    new = run_study(given, part, replace(options, say=ignore))  # hints are for studies of users
    numbers = range(1, _rounds(result) + 1)
    rounds = [result.take(result.dataset[ROUND].values == number) for number in numbers]
    study_rows = own_rows(result).dataset.drop_vars(WEIGHT, errors="ignore")
    combined = with_rounds(
        Result(study_rows),
        [*(earlier.dataset for earlier in rounds), new],
        np.log(weights),
        np.zeros(len(weights), np.int32),
    )
    combined[ROUND].attrs[INDEPENDENT_ROUNDS] = 1
    attrs = {"role": WEIGHT, "units": "1", MOST: float(weights.max() / weights.mean())}
    attrs["long_name"] = "density of the laws over that of the mixture from which rows were drawn"
    combined = combined.assign({WEIGHT: ("row", weights, attrs)})
    write_result(combined, path)
    part.unlink(missing_ok=True)
    return combined


def _rounds(result: Result) -> int:
    """Return the number of rounds of next rows so far."""
    return int(result.dataset[ROUND].values.max()) if result.has_rounds else 0


def _study_of(result: Result, model: str | None) -> Study:
    """Return the study of a result whose rows are independent and have no other weights.

    Raises
    ------
    InputError
    """
    if not result.has_next_rows:
        result.refuse_if_weighted("next rows")
    if not result.has_independent_samples or result.is_nested or result.design.imported:
        raise InputError(
            "next rows: need independent rows drawn from laws, not those of a"
            f" '{result.design_name}' design"
        )
    study_rows = own_rows(result)
    return study_behind(study_rows, int(study_rows.dataset.attrs["samples"]), model)


def _proposed(result: Result, study: Study, rows: int, aim: Aim) -> tuple[Floats, Floats]:
    """Return the normal scores of the next rows, and the weights of all rows, new ones last.

    Returns
    -------
    scores : ndarray, shape (rows, d)
    weights : ndarray, shape (len(result) + rows,)
    """
    if not FOLDS <= rows <= POOL // 8:
        raise InputError(f"next rows: {rows} must be between {FOLDS} and {POOL // 8}")
    if aim.near is not None and not np.isfinite(aim.near):
        raise InputError(f"next rows: near {aim.near}: must be finite")
    if aim.output:
        find_element(study, aim.output)
    names, is_first = list(study.uncertain), not _rounds(result)
    values = np.column_stack([result.dataset[name].values for name in names]).astype(float)
    scales = [scale_of(name, column) for name, column in zip(names, values.T, strict=True)]
    columns = [study.model.parameter_names.index(name) for name in names]
    rng = np.random.default_rng((study.design.seed, _SEED, len(result)))

    z = scaled(scales, values)
    part = parts_of(values) if is_first else np.ones(len(result), int)
    weights = np.ones(len(result)) if is_first else result.dataset[WEIGHT].values
    scores, new_weights = list[Floats](), list[Floats]()
    for k in range(FOLDS if is_first else 1):
        inside = part == k
        count = len(range(k, rows, FOLDS)) if is_first else rows
        pool = rng.standard_normal((POOL, len(names)))
        x = physical(study, special.ndtr(pool))[:, columns]
        at = np.vstack([scaled(scales, x), z[inside]])
        density = _density(_gain(result, z, np.flatnonzero(~inside), at, aim), count)
        if not is_first:
            density = (1 + density) / 2
        chosen = _drawn(density[:POOL], count, rng)
        scores.append(pool[chosen])
        total = inside.sum() + count
        mixture = (inside.sum() + count * density) / total
        weights[inside] = 1 / mixture[POOL:]
        new_weights.append(1 / mixture[chosen])
    return np.vstack(scores), np.concatenate([weights, *new_weights])


def _density(gain: Floats, count: int) -> Floats:
    """Return a gain as density over that of the laws, bounded so that no row is drawn twice.

    Parameters
    ----------
    gain : ndarray, shape (n,)
        The first `POOL` at points drawn from the laws.
    count : int
        Number of these to draw.
    """
    largest = np.sort(gain[:POOL])[::-1][:count]
    rest = gain[:POOL].sum() - np.cumsum(largest) + largest
    bounds = rest / (count - np.arange(count))
    bounded = np.minimum(gain, bounds[np.argmax(bounds >= largest)])
    return bounded / bounded[:POOL].mean()


def _drawn(density: Floats, count: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Draw points, each with a probability in proportion to its density: systematic sampling."""
    order = rng.permutation(len(density))
    ends = np.cumsum(density[order]) * (count / len(density))
    return order[np.searchsorted(ends[:-1], rng.random() + np.arange(count))]


def _gain(result: Result, z: Floats, learnt: NDArray[np.intp], at: Floats, aim: Aim) -> Floats:
    """Return how much rows are worth, up to a factor, shape (n,).

    Parameters
    ----------
    result : Result
    z : ndarray, shape (len(result), d)
        Scaled inputs of its rows.
    learnt : ndarray of int
        Rows that may be used.
    at : ndarray, shape (n, d)
        Scaled inputs of the rows in question.
    aim : Aim
    """
    if not aim.output:
        from scipy.spatial import cKDTree

        return np.asarray(cKDTree(z[learnt]).query(at)[0] ** z.shape[1]) + _LEAST
    (element,) = result.named_elements(aim.output)
    values = element.for_thresholds
    usable = np.isfinite(values[learnt]) & ~element.failed[learnt]
    kept = learnt[usable][-_MOST_LEARNT:]
    needed = 2 * z.shape[1] + 10
    if len(kept) < needed:
        part = "four fifths of " if len(learnt) < len(result) else ""
        raise InputError(
            f"next rows: too few rows: '{aim.output}' has a value in {len(kept)} of those to learn"
            f" from, {part}{len(result)}, and {needed} are needed"
        )
    if not np.ptp(values[kept]) > 0:
        raise InputError(f"next rows: '{aim.output}' has the same value in all rows to learn from")
    logarithmic = element.is_lifetime and values[kept].min() > 0
    if logarithmic and aim.near is not None and not aim.near > 0:
        raise InputError(f"next rows: {aim.near:g} is no life")
    y = np.log(values[kept]) if logarithmic else values[kept]
    _, predict = process_of(z[kept], y)
    mean, error = predict(at)
    if aim.near is None:
        return error**2
    limit = np.log(aim.near) if logarithmic else aim.near
    return np.asarray(special.ndtr(-np.abs(mean - limit) / error) + _LEAST)
