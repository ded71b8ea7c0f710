"""A study or a result, updated with inspections."""

from collections.abc import Sequence
from math import ceil
from pathlib import Path

import xarray as xr

from uq.errors import InputError, RunError
from uq.execution.loading import load_study
from uq.execution.options import RunOptions
from uq.execution.runner import output_path, run_study
from uq.explore.new_rows import Budget, enlarged, why_no_new_rows
from uq.files.whole_files import check_target, write_result
from uq.learning.importance import own_rows
from uq.learning.inspections import MOST_CV, Given, Inspection, all_of, of_record, read
from uq.learning.observables import as_named, observables_of
from uq.learning.posterior import posterior
from uq.learning.posterior_checks import censoring, distrust
from uq.learning.posterior_result import as_result, inspections_of, prior_of
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.result.weights import MODEL_ERROR, has_next_rows, has_weights
from uq.sampling.levels import SHARED
from uq.study.definition import Study
from uq.study.row_sampling import rows_per_sample

_HINT = "; or update the result with --rows N, which computes up to N new rows there"


def update(
    source: xr.Dataset | Study | str | Path,
    inspections: Given,
    output: str | Path | None = None,
    *,
    rows: int | None = None,
    model_error: float | None = None,
    life: str | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    model: str | None = None,
) -> xr.Dataset:
    """Update a study or a result with inspections (Bayesian inference).

    Parameters
    ----------
    source : xarray.Dataset, Study or path-like
        A result, or its file; a study, or its file (TOML), which is run first. A result of
        `update` is updated with all its inspections and the new ones.
    inspections : path-like, or sequence of dict
        A CSV file with the columns ``unit``, ``output``, ``kind``, and those of ``time`` (in the
        unit of the life), ``value``, ``sd``, ``cv``, ``detection_50`` and ``detection_90`` that are
        needed; a TOML file with tables ``[[inspection]]`` of these entries; or the tables
        themselves. Or lives from the field, of `import_lives` or its file: each row is a unit.
    output : path-like, optional
        Where to write the posterior; by default it is not written.
    rows : int, optional
        Number of rows: of a study, instead of its own; of a result, new ones that may be computed
        if its own cannot represent the posterior (`uq.explore.new_rows.enlarged`).
    model_error : float, optional
        Coefficient of variation of the model error: lognormal with ``cv`` and detection curves,
        normal with ``sd`` and exact limits; default 0, or the value of an earlier update.
    life : str, optional
        Lifetime that lives from the field are of; by default that of the same name, or the only
        one.
    workers, scheduler
        As in `uq.run`.
    model : str, optional
        Where the model lives, if it is not installed.

    Returns
    -------
    xarray.Dataset
        A result with a ``weight`` of each row; every reader of results takes it. See
        `uq.learning.posterior_result.as_result`.

    Raises
    ------
    InputError
        One line for each mistake in the inspections; when a measurement has been used before.
    RunError
        When the rows cannot represent the posterior; the message states the required number.

    Notes
    -----
    A sample is a world: one draw of the shared inputs. Each inspected unit uses separate units of
    each sample. The mean of their likelihoods is an unbiased estimate of the likelihood of the
    unit, and the product over units is the weight of the world [1]_. An input that only scales
    lives is integrated instead of sampled. Weights are Pareto-smoothed [2]_. Outputs other than
    lives are assumed not to depend on an input that scales lives.

    References
    ----------
    .. [1] C. Andrieu, G. O. Roberts, "The pseudo-marginal approach for efficient Monte Carlo
       computations", Ann. Stat. 37, 697-725 (2009).
    .. [2] A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
       sampling", J. Mach. Learn. Res. 25, 72 (2024).

    Examples
    --------
    >>> seen = [{"unit": "A", "output": "life", "kind": "measured", "value": 8e5, "cv": 0.1}]
    >>> posterior = uq.update("studies/exponential-wear.toml", seen)
    >>> table = uq.summary(uq.as_unit(posterior, "A"))
    >>> bool(6e5 < table.loc["life", "q0.5"] < 1e6)
    True
    """
    new = read(inspections)
    if output is not None:
        check_target(Path(output), 0)
    options = RunOptions(workers, scheduler)
    ds, budget = prior(source, rows, options, output, model)
    return learn(Result(ds), new, output, model_error, budget, life)


def prior(
    source: xr.Dataset | Study | str | Path,
    rows: int | None,
    options: RunOptions,
    output: str | Path | None = None,
    model: str | None = None,
) -> tuple[xr.Dataset, Budget | None]:
    """Return the result to update, and the new rows allowed; a study is run first."""
    if not isinstance(source, Study) and (isinstance(source, xr.Dataset) or not is_study(source)):
        ds = source if isinstance(source, xr.Dataset) else open_result(source)
        kept = None if output is None else Path(output)
        return ds, None if rows is None else Budget(rows, options, kept, model)
    study = source if isinstance(source, Study) else load_study(source, model)
    if rows is not None:
        study = study.with_samples(samples_for(study, rows))
    return run_study(study, output_path(study), options), None


def is_study(path: str | Path) -> bool:
    """Whether a path is the file of a study, not of a result."""
    return Path(path).suffix.lower() == ".toml"


def samples_for(study: Study, rows: int) -> int:
    """Return the smallest number of samples for a study with at least `rows` rows."""
    return ceil(rows / rows_per_sample(study))


def learn(
    opened: Result,
    new: Sequence[Inspection] | Result,
    output: str | Path | None,
    model_error: float | None,
    budget: Budget | None = None,
    life: str | None = None,
) -> xr.Dataset:
    """Return the posterior of a result as a result, and write it.

    New are inspections, or lives from the field of a lifetime.
    """
    if isinstance(new, Result):
        name = opened.lifetime_like(new, life, "--life").name
        if SHARED not in opened.levels_that_vary():
            raise InputError(
                f"{new.file}: units share no uncertain input, so that recorded lives teach nothing"
                " of other units; set level = 'shared' of what they have in common"
            )
        new = of_record(new, name)
    if why := opened.why_no_statistics:
        raise InputError(f"uq update: the rows of a '{opened.design_name}' design {why}")
    if output is not None and Path(output).is_file():
        _check_that_it_is_a_posterior(Path(output))
    observables = observables_of(prior_of(opened))
    inspections = all_of(
        inspections_of(opened), [as_named(observables, inspection) for inspection in new]
    )
    cv = float(opened.dataset.attrs.get(MODEL_ERROR, 0.0)) if model_error is None else model_error
    if not 0 <= cv < MOST_CV:
        raise InputError(f"model error = {cv:g}: must be a coefficient of variation, such as 0.1")
    rows = own_rows(prior_of(opened)).independent
    updated, kept, new_rows = posterior(rows, inspections, cv), list[Path](), 0
    if why := censoring(updated):
        raise RunError(why)
    if why := distrust(updated):
        if budget is None:
            raise RunError(why + ("" if why_no_new_rows(rows, updated) else _HINT))
        rows, updated, kept = enlarged(rows, updated, inspections, cv, budget)
        new_rows = budget.rows
    result = as_result(rows, updated, inspections, cv, new_rows)
    if output is not None:
        write_result(result, Path(output))
    for path in kept:
        path.unlink(missing_ok=True)
    return result


def _check_that_it_is_a_posterior(path: Path) -> None:
    """Refuse to overwrite a computed result: only it can be extended and verified."""
    remedy = "choose another output"
    ds = open_result(path, remedy)
    if not has_weights(ds) or has_next_rows(ds):
        raise InputError(f"{path}: has rows that no inspections have weighted; {remedy}")
