"""Estimate from the rows of a result and many more rows of a cheap twin of its model.

The twin is an output that the model can compute alone, or the same outputs with settings that make
a row cheap, such as fewer modes.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from uq.assess.fact import Fact
from uq.assess.failed_rows import failed_share_bounds
from uq.assess.sample import share_of
from uq.assess.statistics.quantiles import SIDES
from uq.contract import Floats
from uq.errors import InputError, first_fault_alone
from uq.result.element import Element
from uq.result.result import AnyResult, Result
from uq.result.result_file import build_rows
from uq.sampling.named_values import read_settings
from uq.stats import estimate_json
from uq.stats.control_variate import FEWEST, controlled_mean, controlled_share
from uq.stats.estimate import Estimate
from uq.stats.intervals import FEW, mean_interval, share_interval
from uq.stats.moments import moments
from uq.study.definition import Study, study_from_text
from uq.study.evaluate import evaluate
from uq.study.row_sampling import row_block, row_seeds, rows
from uq.text.literals import toml

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


def two_fidelities(result: AnyResult, model: str | None = None) -> pd.DataFrame:
    """Estimate means and probabilities with the help of a cheap twin of the same model.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result of a study with ``[analysis] twin``.
    model : str, optional
        Where a model that is not installed lives, as for `load_study`.

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
        When the study names no twin.
    """
    result = Result.of(result)
    lines = {
        (name, label): (*sharpened.estimate.numbers, *sharpened.plain.numbers, sharpened.reduction)
        for name, estimates in with_twin(result, model).outputs.items()
        for label, sharpened in estimates.items()
    }
    index = pd.MultiIndex.from_tuples(list(lines), names=["output", "estimate"])
    columns = ["value", "low", "high", "plain", "plain_low", "plain_high", "reduction"]
    return pd.DataFrame(list(lines.values()), index=index, columns=columns)


def with_twin(result: Result, model: str | None = None) -> TwoFidelities:
    """Return the estimates of `two_fidelities` as records."""
    result.refuse_if_weighted("estimates with a twin")
    with first_fault_alone():
        study = study_from_text(result.dataset.attrs["study"], "study of this result", model)
    twin = study.analysis.twin
    if not twin:
        cheap = ", ".join(study.model.cheap) or "none"
        raise InputError(
            "the study names no twin: [analysis] twin = NAME of an output that model"
            f" '{study.model.name}' can compute alone ({cheap}), or a table of settings that make"
            " its rows cheap"
        )
    study = study.with_samples(int(result.dataset.attrs["samples"]))
    here, many = _here(study, result), _many(study, len(result))
    outputs = [name for name in result.shown_outputs(study.analysis) if name != twin]
    by_element = {}
    for element in result.elements(outputs):
        for control, others in zip(here, many, strict=True):
            same = control.name == element.name
            if same or (control.output == twin and control.place.items() <= element.place.items()):
                by_element[element.name] = dict(_estimates(element, control, others, study))
    return TwoFidelities(
        twin if isinstance(twin, str) else toml(twin),
        len(result),
        len(many[0].values),
        {name: estimates for name, estimates in by_element.items() if estimates},
    )


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
    element: Element, control: Element, many: Element, study: Study
) -> Iterator[tuple[str, ControlVariateEstimate]]:
    present, kept = element.present, ~element.failed
    if present.any() and not (element.never | element.censored).any():
        alone = moments(element.values[present]).mean
        if not alone.reason:
            controlled = controlled_mean(
                element.values, present, controls=_filled(control), many=_filled(many)
            )
            yield "mean", ControlVariateEstimate(*controlled, alone)
    for threshold in study.analysis.thresholds.get(element.output, ()):
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


def _here(study: Study, result: Result) -> list[Element]:
    """Return the twin of the rows of a result."""
    n = len(result)
    x = [np.broadcast_to(result.dataset[name].values, n) for name in study.model.parameter_names]
    keys = (
        result.dataset[name].values.astype(np.int64) for name in ("replicate", "group", "block")
    )
    return _twin_of(study, np.stack(x, 1), row_seeds(study.design.seed, *keys))


def _many(study: Study, start: int) -> list[Element]:
    """Return the twin of the rows that come next in the study, independent of all others."""
    per_row = PER_ROW if isinstance(study.analysis.twin, str) else PER_ROW_OF_SETTINGS
    wanted = min(per_row * start, MOST_ROWS)
    per_sample = rows(study) // study.design.samples
    longer = study.with_samples(study.design.samples + -(-wanted // per_sample))
    parts = [
        _twin_of(longer, block.x, block.seed)
        for first in range(start, rows(longer), _BLOCK)
        for block in [row_block(longer, first, min(first + _BLOCK, rows(longer)))]
    ]
    return [_joined(pieces) for pieces in zip(*parts, strict=True)]


def _twin_of(study: Study, x: Floats, seed: NDArray[np.uint64]) -> list[Element]:
    model, settings, twin = study.model, study.settings, study.analysis.twin
    if isinstance(twin, str):
        model = model.alone(twin)
    else:  # the same outputs, from rows that cost less
        settings = read_settings(model, asdict(settings) | twin)[0]
    chunk = evaluate(model, settings, x, seed)
    computed = Result(build_rows(model, settings, {}, chunk.columns, chunk.status, {}))
    outputs = (twin,) if isinstance(twin, str) else computed.shown_outputs(study.analysis)
    return list(computed.elements(outputs))


def _joined(pieces: tuple[Element, ...]) -> Element:
    values, censored, failed = (
        np.concatenate([getattr(piece, name) for piece in pieces])
        for name in ("values", "censored", "failed")
    )
    return replace(pieces[0], values=values, censored=censored, failed=failed)
