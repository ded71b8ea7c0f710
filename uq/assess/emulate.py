"""Emulators: regressions of the outputs of a result, refused where they err too much."""

import hashlib
import json
from collections.abc import Sequence
from math import inf, nan, prod
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.assess.fact import Fact
from uq.contract import Floats, Output, cause_name, censored_name
from uq.errors import InputError, choices, nearest
from uq.files.whole_files import whole
from uq.machines.emulator import (
    CENSORED,
    NEVER,
    UNDEFINED,
    VALUE,
    Classifier,
    ElementFit,
    Emulator,
    inputs_of,
    is_written_by_emulate,
    most_likely,
    text_of,
)
from uq.result.elements import flags
from uq.result.result import AnyResult, Result
from uq.stats.regressions import (
    PROCESS,
    Regression,
    ScaledInputs,
    openturns,
    regress,
    scale_of,
    standard_moment,
)
from uq.study.definition import study_from_text
from uq.study.installed_models import SUFFIX, find_model
from uq.study.provenance import __version__
from uq.text.element_names import places
from uq.text.numbers import counted, percent

FEWEST = 40
"""Fewest rows with a value from which a regression is made."""

MOST_ROWS = 1000
"""Largest number of rows that are learnt."""

LARGEST_ERROR = 1 / 3
"""Largest error of an emulator, of the standard deviation of the output."""

_LARGEST_OF_A_ROW = 0.5  # largest error of a row, of the standard deviation of the output
_FLAT = 4.0  # kurtosis of errors below which they look like noise; 3 of a normal law
_MOST_ELEMENTS = 50
_RATIO = 10.0  # of largest to smallest value from which logarithms are fitted


class Refused(Exception):
    """Raised with the reason why an output has no emulator."""


def emulate(
    result: AnyResult, path: str | Path | None = None, outputs: Sequence[str] = ()
) -> Emulator:
    """Fit an emulator to the rows of a result: regressions of its outputs on its inputs.

    For each element, a sparse polynomial chaos expansion and a Gaussian process are compared by
    predictions of each fifth of the rows from the others; the better one is kept. Lives are
    fitted by logarithms, and so are positive outputs that span a factor of ten if they err less.
    Rows that never end, are censored or undefined, and categories, are predicted by regressions of
    their indicators.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        Of plain rows; the first 1000 are learnt, without failed ones.
    path : str or Path, optional
        File to write.
    outputs : sequence of str, optional
        By default those that the study reports.

    Returns
    -------
    Emulator
        Its `refused` has the outputs whose error is too large, with the reason.

    Raises
    ------
    InputError
        When the rows are weighted or nested, no input varies, an output does not exist, OpenTURNS
        is missing, all outputs are refused, or the file is there and not an emulator.

    Examples
    --------
    >>> ds = uq.run("studies/exponential-wear.toml")
    >>> emulator = uq.emulate(ds.isel(row=slice(60)))
    >>> emulator.elements["life"][0].regression.q2 > 0.99
    True
    """
    result = Result.of(result)
    if path is not None:
        _check_file(Path(path))
    result.refuse_if_record("an emulator")
    result.refuse_if_weighted("an emulator")
    if result.is_nested or result.why_no_statistics:
        why = result.why_no_statistics or "belong together in samples"
        raise InputError(f"an emulator needs plain rows; those of this result {why}")
    openturns()
    rows = result.independent
    failed = int(rows.failed.sum())
    rows = rows.take(np.flatnonzero(~rows.failed)[:MOST_ROWS])
    ds = rows.dataset
    names = outputs or rows.shown_outputs(rows.analysis)
    for name in names:
        if name not in rows.outputs:
            allowed = choices(rows.outputs)
            raise InputError(
                f"no such output '{name}'{nearest(name, rows.outputs)} (allowed: {allowed})"
            )
    varying, equal = _inputs(ds)
    if not varying:
        raise InputError("no input varies: there is nothing to learn")
    if len(rows) < FEWEST:
        raise InputError(f"{counted(len(rows), 'row')}: an emulator needs {FEWEST} at least")
    scales = [scale_of(name, values) for name, values in varying.items()]
    x = np.column_stack(list(varying.values()))
    inputs = inputs_of(scales, x)
    elements, refused = dict[str, list[ElementFit]](), dict[str, str]()
    companions = {cause_name(name) for name, output in rows.outputs.items() if output.is_lifetime}
    for name in names:
        if name not in companions:
            try:
                elements[name] = _fits(ds, name, rows.outputs[name], inputs)
            except Refused as refusal:
                refused[name] = str(refusal)
    emulator = Emulator(
        _source(ds, x),
        _parameters(ds, {*varying, *equal}),
        equal,
        _settings(ds),
        scales,
        x.tolist(),
        {name: _declared(rows.outputs[name]) for name in elements},
        {
            str(dim): ds[dim].values.tolist()
            for dim in dict.fromkeys(dim for name in elements for dim in rows.outputs[name].dims)
        },
        elements,
        refused,
        failed,
    )
    if not elements:
        raise InputError(*(f"{name}: no emulator: {why}" for name, why in refused.items()))
    if path is not None:
        with whole(Path(path)) as part:
            part.write_text(text_of(emulator))
    return emulator


def _check_file(path: Path) -> None:
    """Refuse a name that no emulator has, and a file that is something else."""
    if path.suffix != SUFFIX:
        raise InputError(f"{path}: the file of an emulator ends in {SUFFIX}")
    if path.is_file() and not is_written_by_emulate(path):
        raise InputError(f"{path}: is there and not an emulator; choose another place with -o")


def _inputs(ds: xr.Dataset) -> tuple[dict[str, Floats], dict[str, str]]:
    """Return the inputs that vary, and those that equal one of them."""
    varying, equal = dict[str, Floats](), dict[str, str]()
    for name, variable in ds.variables.items():
        if variable.attrs.get("role") != "input":
            continue
        values = np.asarray(variable.values, float)
        same = next((other for other, v in varying.items() if np.array_equal(v, values)), None)
        if same:
            equal[str(name)] = same
        elif len(values) and np.ptp(values) > 0:
            varying[str(name)] = values
    return varying, equal


def _fits(ds: xr.Dataset, name: str, output: Output, inputs: ScaledInputs) -> list[ElementFit]:
    """Return the fits of all elements of an output.

    Raises
    ------
    Refused
    """
    sizes = [ds.sizes[dim] for dim in output.dims]
    if prod(sizes) > _MOST_ELEMENTS:
        raise Refused(f"has {prod(sizes)} elements; {_MOST_ELEMENTS} are the most")
    if output.may_be_between:
        raise Refused("some lives are known within an interval only")
    values = ds[name].values
    flag = censored_name(name)
    censored = ds[flag].values.astype(bool) if flag in ds else np.zeros(values.shape, bool)
    labels = [label for code, label in flags(ds[name]) if code >= 0] if output.is_category else []
    fits = []
    for label, index, _ in places(name, {dim: ds[dim].values for dim in output.dims}):
        at: Any = (slice(None), *index)
        try:
            if output.is_category:
                fits.append(_of_category(values[at], labels, index, inputs))
            else:
                fits.append(_of_number(output, values[at], censored[at], index, inputs))
        except Refused as refusal:
            raise Refused(f"{label}: {refusal}" if sizes else str(refusal)) from None
    return fits


def _of_category(
    codes: NDArray[Any], labels: list[str], index: tuple[int, ...], inputs: ScaledInputs
) -> ElementFit:
    if (codes < 0).any():
        raise Refused("some rows have no label")
    present = np.unique(codes).tolist()
    occurring = [labels[code] for code in present]
    classifier = _classifier(codes, present, occurring, inputs)
    return ElementFit(list(index), False, inf, None, classifier)


def _of_number(
    output: Output,
    values: Floats,
    censored: NDArray[np.bool_],
    index: tuple[int, ...],
    inputs: ScaledInputs,
) -> ElementFit:
    states = [VALUE, NEVER, CENSORED, UNDEFINED]
    state = np.select([censored, np.isposinf(values), np.isnan(values)], [2, 1, 3], 0)
    present = [code for code in range(4) if (state == code).any()]
    rows = np.flatnonzero(state == 0)
    if len(rows) < FEWEST:
        raise Refused(f"{counted(len(rows), 'row')} with a value; {FEWEST} are needed")
    y = values[rows]
    if not np.ptp(y) > 0:
        raise Refused("has the same value in all rows")
    if output.is_lifetime and not y.min() > 0:
        raise Refused("some lives are zero, which have no logarithm")
    candidates = []
    spans = bool(y.min() > 0 and y.max() > _RATIO * y.min())
    for logarithmic in [True] if output.is_lifetime else [False, True][: 1 + spans]:
        t = np.log(y) if logarithmic else y
        regression = regress(inputs, t, rows)
        missed = t - regression.sd * np.array(regression.errors)
        errors = y - np.exp(np.minimum(missed, 690.0)) if logarithmic else y - missed
        candidates.append((float(np.mean(errors**2)), logarithmic, regression))
    _, logarithmic, regression = min(candidates, key=lambda candidate: candidate[0])
    check(regression)
    classifier = None
    if len(present) > 1:
        labels = [states[code] for code in present]
        classifier = _classifier(state, present, labels, inputs)
    horizon = float(values[censored].min()) if censored.any() else inf
    return ElementFit(list(index), logarithmic, horizon, regression, classifier)


def check(regression: Regression) -> None:
    """Refuse a regression that errs too much, or whose output jumps.

    A jump leaves few large errors on its two sides, noise many small ones.
    """
    error = (1 - regression.q2) ** 0.5 if regression.q2 < 1 else 0.0
    if error > LARGEST_ERROR:
        raise Refused(
            f"its error is {percent(error)} of the standard deviation of the output; a third is the"
            " most"
        )
    z = np.array(regression.errors)
    largest = float(np.abs(z).max() / z.std()) * error if z.std() else 0.0
    if largest > _LARGEST_OF_A_ROW and standard_moment(z, 4) > _FLAT:
        raise Refused(
            f"a row is missed by {percent(largest)} of the standard deviation of the output, the"
            f" others by {percent(error)}: the output jumps, or is too steep for these rows"
        )


def _classifier(
    codes: NDArray[np.int64], numbers: list[int], labels: list[str], inputs: ScaledInputs
) -> Classifier:
    """Return a classifier of rows by codes, of which `numbers` occur, with their labels.

    Raises
    ------
    Refused
        When it errs too often.
    """
    count, rows = len(labels), np.arange(len(codes))
    codes = np.searchsorted(numbers, codes)
    regressions, scores = list[Regression](), list[Floats]()
    for code in range(count if count > 2 else count - 1):
        indicator = 1.0 * (codes == code)
        regression = regress(inputs, indicator, rows, (PROCESS,))
        regressions.append(regression)
        scores.append(indicator - regression.sd * np.array(regression.errors))
    if not scores:
        return Classifier(labels, numbers, [], [[len(codes)]])
    predicted = most_likely(scores)
    confusion = np.zeros((count, count), int)
    np.add.at(confusion, (predicted, codes), 1)
    classifier = Classifier(labels, numbers, regressions, confusion.tolist())
    if classifier.error > LARGEST_ERROR * classifier.ignorance:
        raise Refused(
            f"{percent(classifier.error)} of rows would get the wrong label of"
            f" {', '.join(labels)}; always the most frequent one, {percent(classifier.ignorance)}"
        )
    return classifier


def _source(ds: xr.Dataset, x: Floats) -> dict[str, str]:
    from openturns import __version__ as openturns_version

    names = ("model", "title", "model_version", "study_identity")
    return {name: str(ds.attrs[name]) for name in names} | {
        "rows_sha256": hashlib.sha256(x.tobytes()).hexdigest(),
        "vibrolife": __version__,
        "openturns": openturns_version,
    }


def _parameters(ds: xr.Dataset, varying: set[str]) -> dict[str, dict[str, Any]]:
    """Return the declarations of all parameters, with the values of those that do not vary."""
    parameters = {}
    for name, variable in ds.variables.items():
        attrs = variable.attrs
        if attrs.get("role") not in ("input", "fixed"):
            continue
        values = np.ravel(variable.values).astype(float)
        bounds = attrs.get("admissible", (-inf, inf))
        parameters[str(name)] = {
            "symbol": attrs["symbol"],
            "unit": attrs["units"],
            "meaning": attrs["long_name"],
            "source": attrs["source"],
            "bounds": [float(bound) for bound in bounds],
            "value": None if name in varying else float(values[0]),
            "nominal": float(attrs.get("nominal", nan)),
        }
    return parameters


def _settings(ds: xr.Dataset) -> dict[str, Any]:
    """Return the settings of a model that is installed here; none if it is not."""
    try:
        find_model(str(ds.attrs["model"]))
    except InputError:
        return {}
    study = study_from_text(ds.attrs["study"], "study of this result")
    plain: dict[str, Any] = json.loads(json.dumps(study.model.choices_of(study.settings)))
    return plain


def _declared(output: Output) -> dict[str, Any]:
    """Return the attributes of an emulated output: its errors are those of the emulator."""
    kept = "unit", "meaning", "kind", "dims", "may_be_undefined", "categories", "success"
    attributes = {field: getattr(output, field) for field in kept}
    return attributes | {"may_be_censored": bool(output.has_censored_flag)}


def emulator_facts(emulator: Emulator) -> Fact:
    """Return what each emulator is, its error, and which outputs are refused."""
    outputs = {
        name: Fact(_numbers(fits), (regress,)) for name, fits in emulator.elements.items()
    } | {
        name: Fact({"kind": None, "q2": None, "error_sd": None, "refused": why}, (check,))
        for name, why in emulator.refused.items()
    }
    members = {"rows": len(emulator.x), "failed": emulator.failed, "outputs": outputs}
    return Fact(members, (emulate,))


def _numbers(fits: list[ElementFit]) -> dict[str, Any]:
    """Return the numbers of an output: of the worst of its elements."""
    regressions = [fit.regression for fit in fits if fit.regression]
    worst = min(regressions, key=lambda regression: regression.q2, default=None)
    wrong = [fit.classifier.error for fit in fits if fit.classifier]
    numbers: dict[str, Any] = {
        "kind": worst.kind if worst else "classifier",
        "q2": worst.q2 if worst else None,
        "error_sd": worst.error_sd if worst else None,
        "refused": False,
    }
    if any(fit.logarithmic for fit in fits):
        numbers["logarithm"] = True
    return numbers | ({"misclassified": max(wrong)} if wrong else {})
