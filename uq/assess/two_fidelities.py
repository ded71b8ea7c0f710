"""Estimate from the rows of a result and many more rows of a cheap twin of its model.

The twin is an output that the model can compute alone, the same outputs with settings that make a
row cheap, such as fewer modes, or an emulator of the rows.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from uq.assess.fact import Fact
from uq.assess.failed_rows import failed_share_bounds
from uq.assess.sample import share_of
from uq.assess.statistics.quantiles import SIDES
from uq.contract import Floats, Model
from uq.errors import InputError, first_fault_alone
from uq.machines.emulator import emulator_at, model_of_emulator
from uq.result.element import Element
from uq.result.result import AnyResult, Result
from uq.result.result_file import build_rows
from uq.sampling.named_values import read_settings
from uq.stats import estimate_json
from uq.stats.control_variate import FEWEST, controlled_mean, controlled_share
from uq.stats.estimate import Estimate
from uq.stats.intervals import FEW, mean_interval, share_interval
from uq.stats.moments import moments
from uq.stats.regressions import FOLDS
from uq.study.changes import study_text
from uq.study.definition import Study, study_from_text
from uq.study.evaluate import evaluate
from uq.study.installed_models import find_model
from uq.study.row_sampling import row_block, row_seeds, rows
from uq.text.literals import read_toml, toml

MOST_ROWS = 1_000_000
"""Rows of the twin at most."""

PER_ROW = 100
"""Rows of a cheap output for each row of the result."""

PER_ROW_OF_SETTINGS = 10
"""Rows under other settings for each row of the result: they cost more."""

_BLOCK = 65_536


@dataclass(frozen=True)
class ControlVariateEstimate:
    """An estimate that a twin sharpens.

    Attributes
    ----------
    estimate : Estimate
        By control variates.
    reduction : float
        Variance reduction factor against the plain estimate.
    plain : Estimate
        From the rows of the result alone.
    failed : Estimate, optional
        Ends of the plain interval with the failed rows at best and at worst, where rows failed.
    note : str
        Consequence for the estimate where few rows are hits, or misses.
    """

    estimate: Estimate
    reduction: float
    plain: Estimate
    failed: Estimate | None = None
    note: str = ""


@dataclass(frozen=True)
class TwoFidelities:
    """Estimates by control variates (`two_fidelities`).

    Attributes
    ----------
    twin : str
    rows, cheap_rows : int
        Of the result, and of the twin alone.
    outputs : dict of str to dict
        Element -> estimate (``mean``, ``P(>t)``, ``P(<t)``) -> `ControlVariateEstimate`. An element
        whose tail has no variance has no mean here.
    """

    twin: str
    rows: int
    cheap_rows: int
    outputs: Mapping[str, Mapping[str, ControlVariateEstimate]]


def two_fidelities(
    result: AnyResult, model: str | None = None, emulator: str | Path | None = None
) -> pd.DataFrame:
    """Estimate means and probabilities with the help of a cheap twin of the same model.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a study with ``[analysis] twin``, if no emulator is given.
    model : str, optional
        Where a model that is not installed lives, as for `load_study`.
    emulator : str or Path, optional
        File of `uq.emulate`: the twin. The estimates are unbiased whatever the emulator is worth,
        since it predicts each row from other rows (cross-fitting).

    Returns
    -------
    pandas.DataFrame
        Index: element of an output, and estimate (``mean``, ``P(>t)``, ``P(<t)``). Columns:
        ``value``, ``low``, ``high`` by control variates with the twin; ``plain``, ``plain_low``,
        ``plain_high`` from the rows of the result alone; ``reduction``, the variance of the plain
        estimate over the other's.

    Raises
    ------
    InputError
        When the study names no twin, or the emulator is of other settings or inputs.
    """
    result = Result.of(result)
    lines = {
        (name, label): (*sharpened.estimate.numbers, *sharpened.plain.numbers, sharpened.reduction)
        for name, estimates in with_twin(result, model, emulator).outputs.items()
        for label, sharpened in estimates.items()
    }
    index = pd.MultiIndex.from_tuples(list(lines), names=["output", "estimate"])
    columns = ["value", "low", "high", "plain", "plain_low", "plain_high", "reduction"]
    return pd.DataFrame(list(lines.values()), index=index, columns=columns)


class _Twin(NamedTuple):
    """What is computed beside the rows: a model and settings, for the laws of a study."""

    name: str
    study: Study
    model: Model
    settings: Any
    outputs: tuple[str, ...]
    per_row: int


def with_twin(
    result: Result, model: str | None = None, emulator: str | Path | None = None
) -> TwoFidelities:
    """Return the estimates of `two_fidelities` as records."""
    result.refuse_if_weighted("estimates with a twin")
    twin = _named_twin(result, model) if emulator is None else _emulated(result, Path(emulator))
    here, many = _here(twin, result), _many(twin, len(result))
    parts = 1 if emulator is None else FOLDS
    outputs = [name for name in result.shown_outputs(result.analysis) if name != twin.name]
    by_element = {}
    for element in result.elements(outputs):
        for control, others in zip(here, many, strict=True):
            same = control.name == element.name
            alone = control.output == twin.name and control.place.items() <= element.place.items()
            if same or alone:
                thresholds = result.analysis.thresholds.get(element.output, ())
                estimates = dict(_estimates(element, control, others, thresholds, parts))
                by_element[element.name] = estimates
    return TwoFidelities(
        twin.name,
        len(result),
        len(many[0].values),
        {name: estimates for name, estimates in by_element.items() if estimates},
    )


def _named_twin(result: Result, model: str | None) -> _Twin:
    """Return the twin that the study names."""
    with first_fault_alone():
        study = study_from_text(result.dataset.attrs["study"], "study of this result", model)
    study = study.with_samples(int(result.dataset.attrs["samples"]))
    twin = study.analysis.twin
    if not twin:
        cheap = ", ".join(study.model.cheap) or "none"
        raise InputError(
            "the study names no twin: [analysis] twin = NAME of an output that model"
            f" '{study.model.name}' can compute alone ({cheap}), or a table of settings that make"
            " its rows cheap; or give an emulator of the rows"
        )
    if isinstance(twin, str):
        return _Twin(twin, study, study.model.alone(twin), study.settings, (twin,), PER_ROW)
    settings = read_settings(study.model, asdict(study.settings) | twin)[0]
    outputs = result.shown_outputs(study.analysis)
    return _Twin(toml(twin), study, study.model, settings, outputs, PER_ROW_OF_SETTINGS)


def _emulated(result: Result, path: Path) -> _Twin:
    """Return an emulator as twin: it predicts each row from rows of other parts."""
    emulator = emulator_at(path)
    learnt, here = emulator.source["model"], result.dataset.attrs["model"]
    if learnt != here:
        raise InputError(
            f"{path}: is an emulator of model '{learnt}', and the result is of '{here}'"
        )
    data = read_toml(result.dataset.attrs["study"])
    data.pop("analysis", None)  # it may name outputs without an emulator
    constants = {
        str(name): float(variable)
        for name, variable in result.dataset.data_vars.items()
        if variable.attrs.get("role") == "fixed"
    }
    data["fixed"] = data.get("fixed", {}) | constants  # the nominal values of its own model, too
    with first_fault_alone():
        study = study_from_text(study_text(data), "study of this result", str(path))
    study = study.with_samples(int(result.dataset.attrs["samples"]))
    model = model_of_emulator(emulator, "", find_model, cross_fitted=True)
    shown = result.shown_outputs(result.analysis)
    outputs = tuple(name for name in shown if name in model.outputs)
    if not outputs:
        raise InputError(f"{path}: has none of the outputs that the study reports")
    return _Twin(str(path), study, model, study.settings, outputs, PER_ROW)


def twin_facts(fidelities: TwoFidelities) -> Fact:
    """Return estimates with a twin, and those from the rows of the result alone."""
    outputs = {
        name: {label: _sharpened(label, estimate) for label, estimate in estimates.items()}
        for name, estimates in fidelities.outputs.items()
    }
    return Fact(vars(fidelities) | {"outputs": outputs}, (with_twin,), notes=TWIN_ROWS)


def _sharpened(label: str, sharpened: ControlVariateEstimate) -> Fact:
    by, plain_by = _MEAN if label == "mean" else _SHARE
    plain = Fact(estimate_json.numbers(sharpened.plain), plain_by)
    members: dict[str, Any] = estimate_json.numbers(sharpened.estimate)
    members |= {"plain": plain, "reduction": sharpened.reduction}
    members |= estimate_json.failed(sharpened.failed)
    note = {"note": sharpened.note} if sharpened.note else {}
    return Fact(members | note, by, notes=TWIN_ROWS)


TWIN_ROWS = ("It also uses rows of the twin alone.",)

_MEAN = (controlled_mean,), (moments, mean_interval)
_SHARE = (controlled_share,), (share_of, share_interval)
"""Estimators with the twin, and without."""


def _estimates(
    element: Element, control: Element, many: Element, thresholds: Sequence[float], parts: int
) -> Iterator[tuple[str, ControlVariateEstimate]]:
    present, kept = element.present, ~element.failed
    if present.any() and not (element.never | element.censored).any():
        alone = moments(element.values[present]).mean
        if not alone.reason:
            controlled = controlled_mean(
                element.values,
                present,
                controls=_filled(control),
                many=_filled(many),
                parts=parts,
            )
            yield "mean", ControlVariateEstimate(*controlled, alone)
    for threshold in thresholds:
        if element.unknown_sides(threshold).any() or not kept.any():
            continue
        sides = (element.above(threshold) > 0, element.below(threshold) > 0)
        for sign, hits in zip(SIDES.values(), sides, strict=True):
            controlled = controlled_share(
                hits, kept, control=control.for_thresholds, many=many.for_thresholds
            )
            failed = failed_share_bounds(hits, element.failed)
            note = _note_on_few(int(hits[kept].sum()), int(kept.sum()))
            plain = share_of(hits[kept])
            yield (
                f"P({sign}{threshold!r})",
                ControlVariateEstimate(*controlled, plain, failed, note),
            )


def _note_on_few(hits: int, rows: int) -> str:
    """Return a note where few rows are hits, or misses."""
    rarer = min(hits, rows - hits)
    if rarer >= FEW:
        return ""
    if rarer < FEWEST:
        consequence = f"the twin is not used below {FEWEST}; plain rows give the estimate"
    else:
        consequence = f"below {FEW} the interval is exact, and conservative"
    seen = f"{hits} of {rows} rows" if hits == rarer else f"all but {rarer} rows"
    return f"{seen} are there: {consequence}"


def _filled(control: Element) -> Floats:
    """Return the controls of a mean, (n, 2): the value, and whether there is none."""
    finite = np.isfinite(control.values)
    return np.stack([np.where(finite, control.values, 0.0), ~finite], axis=1)


def _here(twin: _Twin, result: Result) -> list[Element]:
    """Return the twin of the rows of a result."""
    n = len(result)
    x = [np.broadcast_to(result.dataset[name].values, n) for name in twin.model.parameter_names]
    keys = (
        result.dataset[name].values.astype(np.int64) for name in ("replicate", "group", "block")
    )
    return _twin_of(twin, np.stack(x, 1), row_seeds(twin.study.design.seed, *keys))


def _many(twin: _Twin, start: int) -> list[Element]:
    """Return the twin of the rows that come next in the study, independent of all others."""
    study, wanted = twin.study, min(twin.per_row * start, MOST_ROWS)
    per_sample = rows(study) // study.design.samples
    longer = study.with_samples(study.design.samples + -(-wanted // per_sample))
    parts = [
        _twin_of(twin, block.x, block.seed)
        for first in range(start, rows(longer), _BLOCK)
        for block in [row_block(longer, first, min(first + _BLOCK, rows(longer)))]
    ]
    return [_joined(pieces) for pieces in zip(*parts, strict=True)]


def _twin_of(twin: _Twin, x: Floats, seed: NDArray[np.uint64]) -> list[Element]:
    chunk = evaluate(twin.model, twin.settings, x, seed)
    computed = Result(build_rows(twin.model, twin.settings, {}, chunk.columns, chunk.status, {}))
    return list(computed.elements(twin.outputs))


def _joined(pieces: tuple[Element, ...]) -> Element:
    values, censored, failed = (
        np.concatenate([getattr(piece, name) for piece in pieces])
        for name in ("values", "censored", "failed")
    )
    return replace(pieces[0], values=values, censored=censored, failed=failed)
