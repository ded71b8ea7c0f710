"""New rows where the inspections point, if those of a result hardly go there."""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.designs.registry import DESIGNS
from uq.errors import InputError, RunError, choices
from uq.exploring.given_rows import computed, with_given_rows
from uq.learning.importance import repetitions_of, with_rounds
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior, on_wide_grids, posterior, shared_inputs
from uq.learning.repetition import Repetition
from uq.learning.result import digest
from uq.learning.trust import censoring, distrust
from uq.rows.nesting import nesting_of
from uq.rows.sampling import unit_block
from uq.rows.weights import IMPORTANCE, ROUND
from uq.running.again import study_here
from uq.running.options import RunOptions
from uq.study.definition import Study

ENOUGH = 400.0
"""Effective rows after which no more are drawn."""

_SHARE = 4
_FEWEST = 100
_SEED = 23


@dataclass(frozen=True)
class Budget:
    """New rows that may be computed.

    Attributes
    ----------
    rows : int
    options : RunOptions
        How they are computed.
    output : Path or None
        The result beside which they are kept until it is complete; None: in memory.
    model : str or None
        Where the model lives, if it is not installed.
    """

    rows: int
    options: RunOptions
    output: Path | None
    model: str | None


class Enlarged(NamedTuple):
    """The rows of a result with new ones.

    Attributes
    ----------
    rows : xarray.Dataset
    found : Posterior
    kept : list of Path
        Files of the new rows, no longer needed once the posterior is written.
    """

    rows: xr.Dataset
    found: Posterior
    kept: list[Path]


def enlarged(
    own: xr.Dataset,
    found: Posterior,
    inspections: Sequence[Inspection],
    model_cv: float,
    budget: Budget,
) -> Enlarged:
    """Draw new rows, in rounds, until they represent what the inspections leave.

    Parameters
    ----------
    own : xarray.Dataset
        A result.
    found : Posterior
        What the inspections leave of it.
    inspections : sequence of Inspection
    model_cv : float
    budget : Budget

    Returns
    -------
    Enlarged

    Raises
    ------
    InputError
        When new rows of such a result cannot be drawn.
    RunError
        When the budget is spent before that.

    Notes
    -----
    Adaptive importance sampling in independent repetitions, whose scatter gives the intervals of
    all that is read from the rows. Each begins with its part of the rows (`repetitions_of`) and
    draws its part of each round from a mixture of Student laws around its own rows so far, weighted
    with as much of the likelihood as they bear. A row of any round counts by the density of the
    laws over that of the mixture of all that its repetition has drawn [1]_. The likelihood may
    jump. An integrated input keeps its law. Of several units, the mixture is that around the rows
    of each.

    References
    ----------
    .. [1] J.-M. Cornuet, J.-M. Marin, A. Mira, C. P. Robert, "Adaptive multiple importance
       sampling", Scand. J. Stat. 39, 798-812 (2012).
    """
    study = _study_of(own, found, budget.model)
    n, of = own.sizes["sample"], repetitions_of(own)
    count = len(np.unique(of))
    step = count * nesting_of(own).units
    each = -(-max(n // _SHARE, _FEWEST) // step) * step
    if budget.rows < each:
        raise InputError(f"rows = {budget.rows}: a round of new rows takes {each}")
    name = _digest(own, inspections, model_cv)
    scores = special.ndtri(unit_block(study, 0, n))
    repetitions = [Repetition(scores[of == r], each // count) for r in range(count)]
    rows, rounds, kept = own, list[xr.Dataset](), list[Path]()
    why = distrust(found)
    while why or min(one.effective for one in found.weights) < ENOUGH:
        if (len(rounds) + 1) * each > budget.rows:
            if not why:
                break
            raise RunError(f"after {len(rounds) * each} new rows: {why}")
        likelihoods, columns = _log_likelihoods(found), _columns(study, found)
        new = [
            one.drawn([log[of == r] for log in likelihoods], columns, _rng(study, len(rounds), r))
            for r, one in enumerate(repetitions)
        ]
        number = len(rounds) + 1
        path = budget.output and budget.output.with_name(
            f"{budget.output.stem}-{name}-round-{number}.nc"
        )
        seed = int(np.random.SeedSequence((study.design.seed, _SEED, number)).generate_state(1)[0])
        given = with_given_rows(study, np.concatenate(new), f"round {number}", seed)
        rounds.append(computed(given, path, budget.options))
        kept += [path] if path else []
        of = np.append(of, np.repeat(np.arange(count, dtype=of.dtype), each // count))
        log_importance = np.empty(len(of))
        for r, one in enumerate(repetitions):
            log_importance[of == r] = one.log_importance
        rows = with_rounds(own, rounds, log_importance, of)
        found = posterior(rows, inspections, model_cv)
        if censored := censoring(found):
            raise RunError(censored)
        why = distrust(found)
    return Enlarged(rows, found, kept)


def why_no_new_rows(own: xr.Dataset, found: Posterior) -> str:
    """Return why new rows of a result cannot be drawn, or ""."""
    method, place = own.attrs["design"], nesting_of(own)
    design = DESIGNS[method]
    if not design.nests:
        able = " or ".join(f"'{name}'" for name, one in DESIGNS.items() if one.nests)
        return f"the design is '{method}', not {able}"
    if not design.independent and int(own.attrs["replicates"]) == 1:
        return f"a '{method}' design shows errors only by replicates: set [design] replicates = 8"
    if place.repeats > 1:
        return f"each unit has {place.repeats} repeats, not one"
    if place.units > 1 and (shared := shared_inputs(own, found.scale)):
        return f"units share {choices(shared)}, and may share only what scales lives"
    if taken := [name for name in (IMPORTANCE, ROUND) if name in own.variables]:
        return f"the model has a '{taken[0]}', which is what a variable of new rows is called"
    return ""


def _study_of(own: xr.Dataset, found: Posterior, model: str | None) -> Study:
    """Return the study of a result, if more rows can be drawn from its laws."""
    if why := why_no_new_rows(own, found):
        raise InputError(
            f"new rows cannot be drawn: {why}; run the study with more samples, or with a law that"
            " allows for what was found"
        )
    attrs = own.attrs
    recorded = attrs["study"], attrs["study_identity"], attrs["model_version"]
    samples = nesting_of(own).samples // int(attrs["replicates"])
    study, change = study_here(*recorded, samples, "result", model)
    if change:
        raise InputError(f"the result was computed with another model ({change}): run it again")
    return study


def _columns(study: Study, found: Posterior) -> NDArray[np.intp]:
    """Return the inputs to draw from a law of their own: all but the integrated one."""
    integrated = found.scale.name if found.scale else ""
    names = list(study.uncertain)
    return np.array([i for i, name in enumerate(names) if name != integrated], dtype=np.intp)


def _log_likelihoods(found: Posterior) -> list[Floats]:
    """Return the likelihood of each row as each inspected unit, given all other inspections."""
    grids, evidence = on_wide_grids(found)
    likelihoods = []
    for unit, (grid, rest) in enumerate(zip(grids, evidence.rest, strict=True)):
        block = found.likelihoods.blocks[unit]
        joint = rest[found.world[block]] + found.likelihoods.of(unit, grid.values)
        counted, log_before = special.logsumexp(joint, axis=1), found.likelihoods.log_before(unit)
        known = np.isfinite(log_before)
        likelihoods.append(np.where(known, counted - np.where(known, log_before, 0.0), -np.inf))
    return likelihoods


def _rng(study: Study, number: int, repetition: int) -> np.random.Generator:
    return np.random.default_rng((study.design.seed, _SEED, number, repetition))


def _digest(own: xr.Dataset, inspections: Sequence[Inspection], model_cv: float) -> str:
    """Return what new rows depend on, in short."""
    asked = [digest(one) for one in inspections]
    what = repr((own.attrs["study_identity"], own.sizes["sample"], asked, float(model_cv)))
    return sha256(what.encode()).hexdigest()[:8]
