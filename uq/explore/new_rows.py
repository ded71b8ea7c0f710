"""New rows in the posterior region, if a result has too few rows there."""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.errors import InputError, RunError, choices
from uq.execution.options import RunOptions
from uq.execution.recomputation import study_here
from uq.execution.runner import carry_out, run_study
from uq.learning.evidence import on_wide_grids
from uq.learning.importance import repetitions_of, with_rounds
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import shared_inputs
from uq.learning.posterior import Posterior, posterior
from uq.learning.posterior_checks import censoring, distrust
from uq.learning.posterior_result import digest
from uq.learning.proposal import Repetition
from uq.result.result import Result
from uq.result.weights import IMPORTANCE, ROUND
from uq.result.workload import workload_of
from uq.sampling.designs import DESIGNS
from uq.study.definition import Study, study_from_text
from uq.study.row_sampling import physical, unit_block
from uq.text.literals import read_toml, toml

_FILE = "new rows"

ENOUGH = 400.0
"""Effective sample size at which sampling stops."""

_SHARE = 4
_FEWEST = 100
_SEED = 23


def with_given_rows(study: Study, scores: Floats, name: str, seed: int) -> Study:
    """Return a study of the same model with given rows.

    Parameters
    ----------
    study : Study
        Not of imported rows.
    scores : ndarray, shape (n, inputs)
        Normal scores of its inputs, in their order.
    name : str
        Of the new study, in messages.
    seed : int
        Seed of the study, from which the seeds of rows of a random model derive.
    """
    names = study.model.parameter_names
    x = physical(study, special.ndtr(scores))
    columns = {input_name: x[:, names.index(input_name)] for input_name in study.uncertain}
    tables = {
        table: entries
        for table, entries in read_toml(study.text).items()
        if table not in ("analysis", "dependence")
    }
    tables["uncertain"] = {
        input_name: _within(columns[input_name])
        if input_name in columns and "times" in entry
        else entry
        for input_name, entry in tables["uncertain"].items()
    }
    tables["design"] = {"method": "imported", "file": _FILE, "seed": seed}
    listed = {
        input_name: " ".join(map(repr, values.tolist())) for input_name, values in columns.items()
    }
    tables["data"] = tables.get("data", {}) | {_FILE: listed}
    text = "\n".join(f"{table} = {toml(entries)}" for table, entries in tables.items())
    return study_from_text(text, name, study.model_reference)


def _within(values: Floats) -> dict[str, Any]:
    """Return a bounding law for values of an input that is a multiple of another input."""
    low, high = float(values.min()), float(values.max())
    return {"distribution": "uniform", "lower": low, "upper": max(high, np.nextafter(low, np.inf))}


@dataclass(frozen=True)
class Budget:
    """Budget of new rows.

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


def enlarged(
    study_rows: Result,
    updated: Posterior,
    inspections: Sequence[Inspection],
    model_cv: float,
    budget: Budget,
) -> tuple[Result, Posterior, list[Path]]:
    """Draw new rows in rounds until they represent the posterior.

    Parameters
    ----------
    study_rows : Result
        A result.
    updated : Posterior
        The posterior of its rows.
    inspections : sequence of Inspection
    model_cv : float
    budget : Budget

    Returns
    -------
    rows : Result
        The rows including new ones.
    updated : Posterior
    kept : list of Path
        Files of the new rows, no longer needed once the posterior is written.

    Raises
    ------
    InputError
        When new rows of such a result cannot be drawn.
    RunError
        When the budget is spent before that.

    Notes
    -----
    Adaptive importance sampling in independent repetitions, whose scatter gives all confidence
    intervals. Each repetition starts with its part of the rows (`repetitions_of`). In each round it
    draws its part from a mixture of Student laws around its previous rows, with tempered weights. A
    row has as weight the prior density over the mixture of the prior and all proposals of its
    repetition [1]_. Once these rows represent the posterior, the new ones are dropped: further
    rounds are drawn from a final mixture around all of them, with weights against this mixture and
    the prior. The likelihood may be discontinuous. An integrated input keeps its law. With several
    inspected units, the mixture covers the rows of each.

    References
    ----------
    .. [1] J.-M. Cornuet, J.-M. Marin, A. Mira, C. P. Robert, "Adaptive multiple importance
       sampling", Scand. J. Stat. 39, 798-812 (2012).
    """
    rounds = _Rounds(study_rows, updated, inspections, model_cv, budget)
    seeking = rounds.repetitions
    settled = rounds.settled(seeking, *rounds.until_enough(seeking, study_rows, updated))
    return *rounds.until_enough(settled, study_rows, updated), rounds.kept


class _Rounds:
    """Rounds of new rows of a study, within a budget.

    Attributes
    ----------
    repetitions : list of Repetition
        Repetitions that start with the rows of the study.
    kept : list of Path
        Files of the rounds so far.
    """

    def __init__(
        self,
        study_rows: Result,
        updated: Posterior,
        inspections: Sequence[Inspection],
        model_cv: float,
        budget: Budget,
    ):
        self._study = _study_of(study_rows, updated, budget.model)
        n, repetition_of = len(study_rows), repetitions_of(study_rows)
        count = len(np.unique(repetition_of))
        step = count * study_rows.nesting.units
        self._each = -(-max(n // _SHARE, _FEWEST) // step) * step
        if budget.rows < self._each:
            raise InputError(f"rows = {budget.rows}: a round of new rows takes {self._each}")
        scores, part = special.ndtri(unit_block(self._study, 0, n)), self._each // count
        self.repetitions = [Repetition(scores[repetition_of == r], part) for r in range(count)]
        self._study_rows, self._inspections, self._cv = study_rows, inspections, model_cv
        self._budget, self._name = budget, _digest(study_rows, inspections, model_cv)
        self._number = 0
        self.kept: list[Path] = []

    def until_enough(
        self, repetitions: Sequence[Repetition], rows: Result, updated: Posterior
    ) -> tuple[Result, Posterior]:
        """Add rounds to the rows of the study until they represent the posterior."""
        rounds, repetition_of, why = list[xr.Dataset](), repetitions_of(rows), distrust(updated)
        while why or min(weights.effective for weights in updated.weights) < ENOUGH:
            if (self._number + 1) * self._each > self._budget.rows:
                if not why:
                    break
                why = why if rounds else "all were needed to find where to draw; allow more"
                raise RunError(f"after {self._number * self._each} new rows: {why}")
            columns, count = _columns(self._study, updated), len(repetitions)
            log_likelihoods = _log_likelihoods(updated, repetition_of, count)
            scores = [
                repetition.drawn(log_likelihoods[r], columns, self._rng(r))
                for r, repetition in enumerate(repetitions)
            ]
            rounds.append(self._computed(np.concatenate(scores)))
            new = np.repeat(np.arange(count, dtype=repetition_of.dtype), self._each // count)
            repetition_of = np.append(repetition_of, new)
            log_importance = np.empty(len(repetition_of))
            for r, repetition in enumerate(repetitions):
                log_importance[repetition_of == r] = repetition.log_importance
            rows = Result(with_rounds(self._study_rows, rounds, log_importance, repetition_of))
            updated = posterior(rows, self._inspections, self._cv)
            if censored := censoring(updated):
                raise RunError(censored)
            why = distrust(updated)
        return rows, updated

    def settled(
        self, repetitions: Sequence[Repetition], rows: Result, updated: Posterior
    ) -> list[Repetition]:
        """Return repetitions without new rows, with a final proposal around all rows so far."""
        columns, count = _columns(self._study, updated), len(repetitions)
        log_likelihoods = _log_likelihoods(updated, rows.dataset["replicate"].values, count)
        return Repetition.settled(repetitions, log_likelihoods, columns, self._rng(count))

    def _rng(self, part: int) -> np.random.Generator:
        return np.random.default_rng((self._study.design.seed, _SEED, self._number, part))

    def _computed(self, scores: Floats) -> xr.Dataset:
        """Compute the next round; its rows are kept beside the result until it is complete."""
        self._number += 1
        number, output = self._number, self._budget.output
        path = output and output.with_name(f"{output.stem}-{self._name}-round-{number}.nc")
        seed = np.random.SeedSequence((self._study.design.seed, _SEED, number)).generate_state(1)
        given = with_given_rows(self._study, scores, f"round {number}", int(seed[0]))
        if path is None:
            return carry_out(workload_of(given), self._budget.options)
        self.kept.append(path)
        return run_study(given, path, self._budget.options)


def why_no_new_rows(study_rows: Result, updated: Posterior) -> str:
    """Return why new rows of a result cannot be drawn, or ""."""
    method, place = study_rows.design_name, study_rows.nesting
    design = DESIGNS[method]
    if not design.nests:
        able = " or ".join(f"'{name}'" for name, candidate in DESIGNS.items() if candidate.nests)
        return f"the design is '{method}', not {able}"
    if not design.independent and int(study_rows.dataset.attrs["replicates"]) == 1:
        return f"a '{method}' design shows errors only by replicates: set [design] replicates = 8"
    if place.repeats > 1:
        return f"each unit has {place.repeats} repeats, not one"
    if place.units > 1 and (shared := shared_inputs(study_rows, updated.scale)):
        return f"units share {choices(shared)}, and may share only what scales lives"
    if taken := [name for name in (IMPORTANCE, ROUND) if name in study_rows.dataset.variables]:
        return f"the model has a '{taken[0]}', which is what a variable of new rows is called"
    return ""


def _study_of(study_rows: Result, updated: Posterior, model: str | None) -> Study:
    """Return the study of a result, if more rows can be drawn from its laws."""
    if why := why_no_new_rows(study_rows, updated):
        raise InputError(
            f"new rows cannot be drawn: {why}; run the study with more samples, or with a law that"
            " allows for what was found"
        )
    samples = study_rows.nesting.samples // int(study_rows.dataset.attrs["replicates"])
    return study_behind(study_rows, samples, model)


def study_behind(study_rows: Result, samples: int, model: str | None) -> Study:
    """Return the study of rows, with a number of samples, if its model is still the same.

    Raises
    ------
    InputError
    """
    attrs = study_rows.dataset.attrs
    recorded = attrs["study"], attrs["study_identity"], attrs["model_version"]
    study, change = study_here(*recorded, samples, "result", model)
    if change:
        raise InputError(f"the result was computed with another model ({change}): run it again")
    return study


def _columns(study: Study, updated: Posterior) -> NDArray[np.intp]:
    """Return the inputs drawn from the proposal: all but the integrated one."""
    integrated = updated.scale.name if updated.scale else ""
    names = list(study.uncertain)
    return np.array([i for i, name in enumerate(names) if name != integrated], dtype=np.intp)


def _log_likelihoods(
    updated: Posterior, repetition_of: NDArray[np.integer], count: int
) -> list[list[Floats]]:
    """Return the log-likelihood of the rows of each repetition, for each inspected unit.

    The likelihood is conditional on all other inspections.
    """
    of_units = updated.likelihoods
    evidence, log_likelihoods = on_wide_grids(updated.evidence, of_units), []
    for unit, (grid, rest) in enumerate(zip(evidence.grids, evidence.rest, strict=True)):
        joint = rest[of_units.world[of_units.blocks[unit]]]
        joint = joint + of_units.log_likelihood(unit, grid.values)
        counted, log_before = special.logsumexp(joint, axis=1), of_units.log_before(unit)
        finite = np.isfinite(log_before)
        counted = counted - np.where(finite, log_before, 0.0)
        log_likelihoods.append(np.where(finite, counted, -np.inf))
    return [[log[repetition_of == r] for log in log_likelihoods] for r in range(count)]


def _digest(study_rows: Result, inspections: Sequence[Inspection], model_cv: float) -> str:
    """Return a short digest of all inputs that determine the new rows."""
    asked = [digest(inspection) for inspection in inspections]
    key = repr(
        (study_rows.dataset.attrs["study_identity"], len(study_rows), asked, float(model_cv))
    )
    return sha256(key.encode()).hexdigest()[:8]
