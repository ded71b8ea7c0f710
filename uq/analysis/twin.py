"""Two fidelities: the rows of a result, and many more of a cheap twin of the same model.

The twin is an output that the model can compute alone, or the same outputs under settings that make
a row cheap, such as fewer modes.
"""

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from uq import json_form
from uq.analysis.control_variate import FEWEST, Controlled, controlled_mean, controlled_share
from uq.analysis.failed_rows import failed_share_bounds
from uq.analysis.statistics.thresholds import event
from uq.errors import InputError
from uq.estimate import Estimate
from uq.exact_shares import FEW
from uq.inputs.values import read_settings
from uq.intervals import share_interval
from uq.literals import toml
from uq.moments import moments
from uq.rows.elements import Element, elements_of, shown_outputs
from uq.rows.evaluate import evaluate
from uq.rows.results import build_rows
from uq.rows.sampling import row_block, row_seeds, rows
from uq.study.definition import Study, study_from_text

MOST_ROWS = 1_000_000
"""Rows of the twin at most."""

PER_ROW = 100
"""Rows of a cheap output for each row of the result."""

PER_ROW_OF_SETTINGS = 10
"""Rows under other settings for each row of the result: they cost more."""

_BLOCK = 65_536
Floats = NDArray[np.float64]


def two_fidelities(ds: xr.Dataset, model: str | None = None) -> pd.DataFrame:
    """Estimate means and probabilities with the help of a cheap twin of the same model.

    Parameters
    ----------
    ds : xarray.Dataset
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
    found = with_twin(ds, model)["outputs"]
    lines = {
        (name, label): {
            **{end: entry[end] for end in ("value", "low", "high")},
            **{_column(end): entry["plain"][end] for end in ("value", "low", "high")},
            "reduction": entry["reduction"],
        }
        for name, estimates in found.items()
        for label, entry in estimates.items()
    }
    index = pd.MultiIndex.from_tuples(list(lines), names=["output", "estimate"])
    return pd.DataFrame(list(lines.values()), index=index)


def _column(end: str) -> str:
    return "plain" if end == "value" else f"plain_{end}"


def with_twin(ds: xr.Dataset, model: str | None = None) -> dict[str, Any]:
    """Return what `two_fidelities` finds as plain data, ready for JSON.

    Returns
    -------
    dict
        ``twin``, ``rows``, ``cheap_rows``, and ``outputs``: element -> estimate -> ``value``,
        ``low``, ``high``, ``plain`` (the same three), ``reduction``, ``note`` where few rows
        tell, and where rows failed ``failed_low`` and ``failed_high``, of the plain rows. An
        element whose tail has no variance has no mean here.
    """
    study = study_from_text(ds.attrs["study"], "study of this result", model)
    if not study.analysis.twin:
        cheap = ", ".join(study.model.cheap) or "none"
        raise InputError(
            "the study names no twin: [analysis] twin = NAME of an output that model"
            f" '{study.model.name}' can compute alone ({cheap}), or a table of settings that make"
            " its rows cheap"
        )
    study = study.with_samples(int(ds.attrs["samples"]))
    here = _twin_of(study, _inputs(ds, study), _seeds(ds, study))
    many = _many(study, ds.sizes["sample"])
    twin = study.analysis.twin
    outputs = [name for name in shown_outputs(ds, study.analysis) if name != twin]
    found = {}
    for element in elements_of(ds, outputs):
        for control, others in zip(here, many, strict=True):
            same = control.name == element.name
            if same or (control.output == twin and control.place.items() <= element.place.items()):
                found[element.name] = dict(_estimates(element, control, others, study))
    return {
        "twin": twin if isinstance(twin, str) else toml(twin),
        "rows": ds.sizes["sample"],
        "cheap_rows": len(many[0].values),
        "outputs": {name: entry for name, entry in found.items() if entry},
    }


def _estimates(
    element: Element, control: Element, many: Element, study: Study
) -> Iterator[tuple[str, dict[str, Any]]]:
    present = element.present
    if present.any() and not (element.never | element.censored).any():
        alone = moments(element.values[present])
        if not alone.mean.reason:
            found = controlled_mean(element.values, present, *map(_filled, (control, many)))
            yield "mean", _entry(found, alone.mean)
    for threshold in study.analysis.thresholds.get(element.output, ()):
        sides = event(element, threshold)
        kept = ~element.failed
        if sides is None or not kept.any():
            continue
        for sign, hits in zip("><", sides, strict=True):
            found = controlled_share(hits, kept, control.for_thresholds, many.for_thresholds)
            plain = Estimate(float(hits[kept].mean()), *share_interval(hits[kept]))
            lost = json_form.failed(failed_share_bounds(hits, element.failed, None))
            few = few_hits(int(hits[kept].sum()), int(kept.sum()))
            yield f"P({sign}{threshold!r})", _entry(found, plain) | lost | few


def few_hits(hits: int, rows: int) -> dict[str, str]:
    """Return a ``note`` on a probability that few rows tell, or nothing."""
    if min(hits, rows - hits) >= FEW:
        return {}
    seen = f"{hits} of {rows} rows" if hits <= rows - hits else f"all but {rows - hits} rows"
    if min(hits, rows - hits) < FEWEST:
        told = f"the twin is not used below {FEWEST}; these are the plain rows"
    else:
        told = f"below {FEW} the interval is exact, and conservative"
    return {"note": f"{seen} lie there: {told}"}


def _entry(found: Controlled, plain: Estimate) -> dict[str, Any]:
    return {
        **json_form.numbers(found.estimate),
        "plain": json_form.numbers(plain),
        "reduction": found.reduction,
    }


def _filled(control: Element) -> Floats:
    """Return what a mean is controlled by, (n, 2): the value, and where there is none."""
    finite = np.isfinite(control.values)
    return np.stack([np.where(finite, control.values, 0.0), ~finite], axis=1)


def _inputs(ds: xr.Dataset, study: Study) -> Floats:
    names = study.model.parameter_names
    return np.stack([np.broadcast_to(ds[name].values, ds.sizes["sample"]) for name in names], 1)


def _seeds(ds: xr.Dataset, study: Study) -> NDArray[np.uint64]:
    keys = (ds[name].values.astype(np.int64) for name in ("replicate", "group", "block"))
    return row_seeds(study.design.seed, *keys)


def _many(study: Study, start: int) -> list[Element]:
    """Return the twin of the rows that would come next in the study: independent of all others."""
    per_row = PER_ROW if isinstance(study.analysis.twin, str) else PER_ROW_OF_SETTINGS
    wanted = min(per_row * start, MOST_ROWS)
    per_sample = rows(study) // study.design.samples
    longer = study.with_samples(study.design.samples + -(-wanted // per_sample))
    parts = [
        _twin_of(longer, some.x, some.seed)
        for first in range(start, rows(longer), _BLOCK)
        for some in [row_block(longer, first, min(first + _BLOCK, rows(longer)))]
    ]
    return [_joined(pieces) for pieces in zip(*parts, strict=True)]


def _twin_of(study: Study, x: Floats, seed: NDArray[np.uint64]) -> list[Element]:
    model, settings, twin = study.model, study.settings, study.analysis.twin
    outputs: tuple[str, ...]
    if isinstance(twin, str):
        model, outputs = model.alone(twin), (twin,)
    else:  # the same outputs, from rows that cost less
        settings = read_settings(model, asdict(settings) | twin)[0]
        outputs = tuple(dict.fromkeys((*study.analysis.outputs, *study.analysis.thresholds)))
    chunk = evaluate(model, settings, x, seed)
    ds = build_rows(model, settings, {}, chunk.columns, chunk.status, {})
    return list(elements_of(ds, outputs))


def _joined(pieces: tuple[Element, ...]) -> Element:
    arrays: dict[str, Any] = {
        name: np.concatenate([getattr(piece, name) for piece in pieces])
        for name in ("values", "censored", "failed")
    }
    return replace(pieces[0], **arrays)
