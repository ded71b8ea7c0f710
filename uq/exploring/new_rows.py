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
from uq.errors import InputError, RunError
from uq.learning.evidence import wide
from uq.learning.importance import with_rounds
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior, posterior
from uq.learning.proposal import Proposal, fitted, log_importance, tempered
from uq.learning.result import digest
from uq.learning.trust import censoring, distrust
from uq.literals import read_toml, toml
from uq.rows.nesting import is_nested
from uq.rows.sampling import physical, unit_block
from uq.rows.workload import workload_of
from uq.running.again import study_here
from uq.running.options import RunOptions
from uq.running.runner import carry_out, run_study
from uq.study.definition import Study, study_from_text

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
        A Monte Carlo result with one unit in each sample.
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
    Adaptive importance sampling: each round is drawn from a mixture of Student laws around the rows
    so far, weighted with as much of the likelihood as they bear. A row of any round counts by the
    density of the laws over that of the mixture of all that was drawn [1]_. The likelihood may
    jump. An integrated input keeps its law.

    References
    ----------
    .. [1] J.-M. Cornuet, J.-M. Marin, A. Mira, C. P. Robert, "Adaptive multiple importance
       sampling", Scand. J. Stat. 39, 798-812 (2012).
    """
    study = _study_of(own, budget.model)
    n, inputs = own.sizes["sample"], len(study.uncertain)
    each = max(n // _SHARE, _FEWEST)
    if budget.rows < each:
        raise InputError(f"rows = {budget.rows}: a round of new rows takes {each}")
    name = _digest(own, inspections, model_cv)
    scores = special.ndtri(unit_block(study, 0, n))
    rows, rounds, kept = own, list[xr.Dataset](), list[Path]()
    proposals: list[Proposal] = []
    counts = np.zeros(n)
    why = distrust(found)
    while why or min(one.effective for one in found.weights) < ENOUGH:
        if (len(rounds) + 1) * each > budget.rows:
            if not why:
                break
            raise RunError(f"after {len(rounds) * each} new rows: {why}")
        rng = np.random.default_rng((study.design.seed, _SEED, len(rounds)))
        weights = tempered(counts, _log_likelihood(found) - counts)
        proposals.append(fitted(scores, weights, _columns(study, found), rng))
        new = proposals[-1].drawn(each, inputs, rng)
        path = budget.output and budget.output.with_name(
            f"{budget.output.stem}-{name}-round-{len(proposals)}.nc"
        )
        rounds.append(_computed(_study_at(study, new, len(proposals)), path, budget.options))
        kept += [path] if path else []
        scores = np.concatenate([scores, new])
        counts = log_importance(proposals, n, each, scores)
        rows = with_rounds(own, rounds, counts)
        found = posterior(rows, inspections, model_cv)
        if censored := censoring(found):
            raise RunError(censored)
        why = distrust(found)
    return Enlarged(rows, found, kept)


def can_be_drawn(own: xr.Dataset) -> bool:
    """Whether new rows of a result can be drawn, as far as its design goes."""
    plain = own.attrs["design"] == "monte-carlo" and int(own.attrs["replicates"]) == 1
    return plain and not is_nested(own)


def _study_of(own: xr.Dataset, model: str | None) -> Study:
    """Return the study of a result, if more rows can be drawn from its laws."""
    remedy = "run it with more samples, or with a law that allows for what was found"
    if not can_be_drawn(own):
        raise InputError(
            "new rows can be drawn only for a 'monte-carlo' design without replicates, and where a"
            f" sample has one unit and one repeat: {remedy}"
        )
    attrs = own.attrs
    recorded = attrs["study"], attrs["study_identity"], attrs["model_version"]
    study, change = study_here(*recorded, own.sizes["sample"], "result", model)
    if change:
        raise InputError(f"the result was computed with another model ({change}): run it again")
    if any(law.times is not None for law in study.uncertain.values()):
        raise InputError(f"new rows cannot be drawn where a law has 'times': {remedy}")
    return study


def _columns(study: Study, found: Posterior) -> NDArray[np.intp]:
    """Return the inputs to draw from a law of their own: all but the integrated one."""
    integrated = found.scale.name if found.scale else ""
    names = list(study.uncertain)
    return np.array([i for i, name in enumerate(names) if name != integrated], dtype=np.intp)


def _log_likelihood(found: Posterior) -> Floats:
    """Return that of all inspections, times what rows count, were the one unit each of the rows."""
    quantiles = found.scale.quantiles if found.scale else None
    grid = wide(found.evidence.grids[0], quantiles)
    joint = found.likelihoods.of(0, grid.values) + grid.log_share
    return np.asarray(special.logsumexp(joint, axis=1))


def _study_at(study: Study, scores: Floats, number: int) -> Study:
    """Return a study with given rows."""
    names = study.model.parameter_names
    x = physical(study, special.ndtr(scores))
    columns = {
        name: " ".join(map(repr, x[:, names.index(name)].tolist())) for name in study.uncertain
    }
    tables = {
        name: table
        for name, table in read_toml(study.text).items()
        if name not in ("analysis", "dependence")
    }
    seed = int(np.random.SeedSequence((study.design.seed, _SEED, number)).generate_state(1)[0])
    tables["design"] = {"method": "imported", "file": "new rows", "seed": seed}
    tables["data"] = tables.get("data", {}) | {"new rows": columns}
    text = "\n".join(f"{name} = {toml(table)}" for name, table in tables.items())
    return study_from_text(text, f"round {number}", study.model_reference)


def _computed(study: Study, path: Path | None, options: RunOptions) -> xr.Dataset:
    if path is None:
        return carry_out(workload_of(study), options)
    return run_study(study, path, options)


def _digest(own: xr.Dataset, inspections: Sequence[Inspection], model_cv: float) -> str:
    """Return what new rows depend on, in short."""
    asked = [digest(one) for one in inspections]
    what = repr((own.attrs["study_identity"], own.sizes["sample"], asked, float(model_cv)))
    return sha256(what.encode()).hexdigest()[:8]
