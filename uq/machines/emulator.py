"""An emulator as a machine: outputs predicted by regressions, each row with an error drawn."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import (
    Floats,
    Mask,
    Model,
    Output,
    Parameter,
    Status,
    censored_name,
)
from uq.errors import InputError
from uq.files.whole_files import file_there
from uq.machines.row_by_row import Fields, NoSettings, parameters_of
from uq.sampling.unit_cube import hashed, uniform
from uq.stats.regressions import BEYOND, FOLDS, Predictor, Regression, Scale, ScaledInputs, scaled
from uq.text.numbers import number

FORMAT = 2
_FORMAT, _CHECKSUM = "vibrolife_emulator", "sha256"  # the first members of a file
VALUE, NEVER, CENSORED, UNDEFINED = "value", "never", "censored", "undefined"
"""States of an element of an output in a row."""


class Classifier(NamedTuple):
    """Regressions of the indicators of labels, and how often they err.

    Attributes
    ----------
    labels : list of str
        Those that occur.
    codes : list of int
        Of the labels among all categories.
    regressions : list of Regression
        One for each label; only of the first where there are two, none where there is one.
    confusion : list of list of int
        Rows by label, predicted from the other parts (first index) and true (second).
    """

    labels: list[str]
    codes: list[int]
    regressions: list[Regression]
    confusion: list[list[int]]

    @property
    def error(self) -> float:
        """Share of rows whose label is wrong, predicted from the other parts."""
        counts = np.array(self.confusion)
        return float(1 - np.trace(counts) / counts.sum())

    @property
    def ignorance(self) -> float:
        """Share of rows whose label would be wrong if it were always the most frequent."""
        counts = np.array(self.confusion).sum(axis=0)
        return float(1 - counts.max() / counts.sum())


def most_likely(scores: list[Floats]) -> NDArray[np.int64]:
    """Return the index of the label with the largest indicator, shape (n,); one if of two."""
    both = scores if len(scores) > 1 else [scores[0], 1.0 - scores[0]]
    return np.argmax(both, axis=0)


class ElementFit(NamedTuple):
    """Fits of an element of an output.

    Attributes
    ----------
    place : list of int
        Index along the dimensions of the output.
    logarithmic : bool
    horizon : float
        Smallest time at which a row is censored; infinite if none is.
    regression : Regression or None
        Of the values; None for a category.
    classifier : Classifier or None
        Of the states of rows, or of the categories; None if all rows have values.
    """

    place: list[int]
    logarithmic: bool
    horizon: float
    regression: Regression | None
    classifier: Classifier | None


@dataclass(frozen=True)
class Emulator:
    """An emulator file, parsed.

    Attributes
    ----------
    source : dict of str to str
        What produced its rows: model, title, model_version, study_identity, rows_sha256, and the
        versions of libraries.
    parameters : dict of str to dict
        All parameters of the model, with unit, meaning, symbol, bounds, nominal value (NaN in rows
        of older versions) and value; those whose value varies have none.
    equal : dict of str to str
        Parameters that equal another one in all rows.
    settings : dict
        Settings of the model.
    scales : list of Scale
        Inputs of the regressions.
    x : list of list of float
        Their values in all rows.
    outputs : dict of str to dict
        Attributes of an `Output`.
    coordinates : dict of str to list
    elements : dict of str to list of ElementFit
    refused : dict of str to str
        Outputs without an emulator, and why.
    failed : int
        Number of rows that failed, and are not among those learnt.
    """

    source: Mapping[str, str]
    parameters: Mapping[str, Mapping[str, Any]]
    equal: Mapping[str, str]
    settings: Mapping[str, Any]
    scales: list[Scale]
    x: list[list[float]]
    outputs: Mapping[str, Mapping[str, Any]]
    coordinates: Mapping[str, list[Any]]
    elements: Mapping[str, list[ElementFit]]
    refused: Mapping[str, str] = field(default_factory=dict)
    failed: int = 0

    @cached_property
    def predictors(self) -> dict[str, list[tuple[ElementFit, Predictor | None, list[Predictor]]]]:
        """The fits of each element with their predictions, by output."""
        inputs = inputs_of(self.scales, np.array(self.x))

        def prepared(regression: Regression) -> Predictor:
            return Predictor(regression, inputs)

        return {
            name: [
                (
                    fit,
                    prepared(fit.regression) if fit.regression else None,
                    [prepared(r) for r in fit.classifier.regressions] if fit.classifier else [],
                )
                for fit in fits
            ]
            for name, fits in self.elements.items()
        }


def parts_of(x: Floats) -> NDArray[np.int64]:
    """Return the part of each row, by a hash of its inputs: predictions of a row exclude its part.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Inputs of the regressions.
    """
    return (hashed(x) % np.uint64(FOLDS)).astype(np.int64)


def inputs_of(scales: list[Scale], x: Floats) -> ScaledInputs:
    """Return the inputs of the regressions of an emulator, from their values, shape (n, d)."""
    return ScaledInputs(scaled(scales, x), parts_of(x), tuple(scale.uniform for scale in scales))


@dataclass(frozen=True)
class EmulatedRows:
    """The batch of an emulator; see `uq.contract.Batch`.

    Attributes
    ----------
    emulator : Emulator
    names : tuple of str
        Of all parameters, in order.
    cross_fitted : bool
        Whether rows are predicted without an error, and without the rows of their part: control
        variates that do not know the row they are compared with.
    """

    emulator: Emulator
    names: tuple[str, ...]
    cross_fitted: bool = False

    def __call__(
        self, x: Floats, seed: NDArray[np.uint64], settings: object
    ) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]:
        """Predict rows."""
        emulator = self.emulator
        columns = dict(zip(self.names, x.T, strict=True))
        inputs = np.column_stack([columns[scale.name] for scale in emulator.scales])
        z = scaled(emulator.scales, inputs)
        status, messages = np.zeros(len(x), np.int8), dict[int, str]()
        for i, message in self._faults(columns, z):
            status[i], messages[i] = Status.RAISED, message
        sound = status == Status.OK
        outputs: dict[str, NDArray[Any]] = {}
        for name, fits in emulator.predictors.items():
            output = emulator.outputs[name]
            shape = (len(x), *(len(emulator.coordinates[dim]) for dim in output["dims"]))
            is_category = output["kind"] == "category"
            values = np.full(shape, -1, np.int8) if is_category else np.full(shape, np.nan)
            censored = np.full(shape, False)
            for position, element in enumerate(fits):
                at = (sound, *element[0].place)
                labels, numbers, cut = self._element(
                    element, z[sound], inputs[sound], seed[sound], position
                )
                values[at] = labels if is_category else numbers
                censored[at] = cut
            outputs[name] = values
            if output["kind"] == "lifetime" and output["may_be_censored"]:
                outputs[censored_name(name)] = censored
        return outputs, status, messages

    def _faults(self, columns: Mapping[str, Floats], z: Floats) -> Iterator[tuple[int, str]]:
        """Yield rows that the emulator cannot predict, and why."""
        for name, other in self.emulator.equal.items():
            for i in np.flatnonzero(columns[name] != columns[other]):
                yield (
                    int(i),
                    f"{name} differs from {other}; in the rows of the emulator it does not",
                )
        scales = [] if self.cross_fitted else self.emulator.scales
        for column, scale in zip(z.T, scales, strict=not self.cross_fitted):
            margin = BEYOND * (scale.high - scale.low)
            within = (column >= scale.low - margin) & (column <= scale.high + margin)
            for i in np.flatnonzero(~within):
                value = number(float(columns[scale.name][i]))
                yield int(i), f"{scale.name} = {value} is far outside the rows of the emulator"

    def _element(
        self,
        element: tuple[ElementFit, Predictor | None, list[Predictor]],
        z: Floats,
        inputs: Floats,
        seed: NDArray[np.uint64],
        position: int,
    ) -> tuple[NDArray[np.int64], Floats, Mask]:
        """Return labels, values and which are censored, of an element of an output."""
        fit, predictor, indicators = element
        n, parts = len(z), parts_of(inputs)
        labels, values = np.zeros(n, np.int64), np.full(n, np.nan)
        if indicators and n:
            if self.cross_fitted:
                labels = most_likely([p.cross_fitted(z, parts) for p in indicators])
            else:
                predicted = most_likely([p(z)[0] for p in indicators])
                u = uniform(seed, np.full(n, position + 1))
                labels = _drawn_labels(fit.classifier.confusion, predicted, u)  # type: ignore[union-attr]
        if predictor is None or not n:
            codes = np.array(fit.classifier.codes if fit.classifier else [0])
            return codes[labels], values, np.full(n, False)
        if self.cross_fitted:
            values = predictor.cross_fitted(z, parts)
        else:
            mean, sd = predictor(z)
            errors = predictor.standard_errors
            u = uniform(seed, np.zeros(n, np.int64))  # the same rows for all elements
            values = mean + sd * errors[(u * len(errors)).astype(np.int64)]
        values = np.exp(np.minimum(values, 690.0)) if fit.logarithmic else values
        states = np.array(fit.classifier.labels if fit.classifier else [VALUE])[labels]
        values = np.where(states == NEVER, np.inf, values)
        cut = (states == CENSORED) | ((states == VALUE) & (values > fit.horizon))
        values = np.where(cut, fit.horizon, values)
        return labels, np.where(states == UNDEFINED, np.nan, values), cut


def _drawn_labels(
    confusion: list[list[int]], predicted: NDArray[np.int64], u: Floats
) -> NDArray[np.int64]:
    """Return labels drawn from those that rows of the same predicted label truly have."""
    counts = np.array(confusion, float)
    counts[counts.sum(axis=1) == 0] = np.eye(len(counts))[counts.sum(axis=1) == 0]
    limits = np.cumsum(counts, axis=1) / counts.sum(axis=1, keepdims=True)
    return (u[:, None] >= limits[predicted]).sum(axis=1)


def emulator_at(path: Path) -> Emulator:
    """Return the emulator in a file.

    Raises
    ------
    InputError
        When it is not one, or not as `text_of` wrote it.
    """
    file_there(path)
    try:
        plain = json.loads(path.read_text())
        if plain.pop(_FORMAT) != FORMAT:
            raise InputError(f"{path}: an emulator of another version of vibrolife; make it again")
        if plain.pop(_CHECKSUM) != _checksum(plain):
            raise InputError(f"{path}: was changed since 'uq emulate' wrote it; make it again")
        plain["scales"] = [Scale(*scale) for scale in plain["scales"]]
        plain["elements"] = {
            name: [_fit_of(fit) for fit in fits] for name, fits in plain["elements"].items()
        }
        return Emulator(**plain)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(
            f"{path}: is not an emulator; 'uq emulate RESULT -o NEW.emulator' makes one"
        ) from None


def text_of(emulator: Emulator) -> str:
    """Return the text of the file of an emulator, with a checksum of its content."""
    declared = {field.name: getattr(emulator, field.name) for field in fields(emulator)}
    return json.dumps({_FORMAT: FORMAT, _CHECKSUM: _checksum(declared)} | declared) + "\n"


def is_written_by_emulate(path: Path) -> bool:
    """Whether a file begins as `text_of` writes it, also by another version."""
    try:
        with path.open("rb") as file:
            return file.read(100).startswith(f'{{"{_FORMAT}": '.encode())
    except OSError:
        return False


def _checksum(declared: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(declared).encode()).hexdigest()


def _fit_of(plain: list[Any]) -> ElementFit:
    place, logarithmic, horizon, regression, classifier = plain
    if classifier:
        labels, codes, regressions, confusion = classifier
        classifier = Classifier(labels, codes, [Regression(*r) for r in regressions], confusion)
    regression = Regression(*regression) if regression else None
    return ElementFit(place, logarithmic, horizon, regression, classifier)


def code_of_emulator(path: Path) -> str:
    """Return a hash of an emulator file."""
    file_there(path)
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def emulator_model(path: Path, installed: Callable[[str], Model]) -> Model:
    """Return the model of an emulator file.

    Parameters
    ----------
    path : Path
    installed : callable
        Returns an installed model by its name; raises InputError if there is none.

    Returns
    -------
    Model
        With the parameters and settings of the model whose rows it learnt.

    Raises
    ------
    InputError
        When the file is not an emulator.
    """
    return model_of_emulator(emulator_at(path), code_of_emulator(path), installed)


def model_of_emulator(
    emulator: Emulator, version: str, installed: Callable[[str], Model], cross_fitted: bool = False
) -> Model:
    """Return the model of an emulator; parameters as in `emulator_model` and `EmulatedRows`."""
    try:
        origin = installed(emulator.source["model"])
    except InputError:
        origin = None
    parameters, settings = (
        (origin.parameters, origin.settings)
        if origin and set(origin.parameter_names) == set(emulator.parameters)
        else (parameters_of(_fields_of(emulator)), NoSettings)
    )
    names: tuple[str, ...] = parameters._fields  # type: ignore[attr-defined]

    def refusal(settings: Any, constants: Mapping[str, float]) -> str:
        is_of_origin = origin is not None and isinstance(settings, origin.settings)
        given = origin.choices_of(settings) if origin and is_of_origin else {}
        return _other_settings(emulator, given) or _other_constants(emulator, constants)

    return Model(
        f"{emulator.source['model']}-emulator",
        f"Emulator of {len(emulator.x)} rows of {emulator.source['title']}",
        version,
        parameters,
        settings,
        {name: Output(**_with_tuples(attributes)) for name, attributes in emulator.outputs.items()},
        EmulatedRows(emulator, names, cross_fitted),
        coordinates=lambda settings: emulator.coordinates,
        refusal=refusal,
        random=not cross_fitted,
        dimensions=origin.dimensions if origin else {},
        row_name=("prediction", "predictions"),
        uncertain={
            scale.name: {
                "distribution": "uniform",
                "lower": min(column),
                "upper": max(column),
                "source": "assumed: the range of the rows learnt",
            }
            for scale, column in zip(emulator.scales, zip(*emulator.x, strict=True), strict=True)
        },
    )


def _with_tuples(attributes: Mapping[str, Any]) -> dict[str, Any]:
    return {k: tuple(v) if isinstance(v, list) else v for k, v in attributes.items()}


def _fields_of(emulator: Emulator) -> Fields:
    fields = {}
    for name, declared in emulator.parameters.items():
        words = declared["symbol"], declared["unit"], declared["meaning"]
        parameter = Parameter(*words, tuple(declared["bounds"]), declared["source"])
        fields[name] = parameter, declared["nominal"]
    return fields


def _other_settings(emulator: Emulator, choices: Mapping[str, Any]) -> str:
    for name, given in json.loads(json.dumps(choices)).items():
        if given != (learnt := emulator.settings.get(name)):
            return (
                f"[settings] {name}: the rows of the emulator were computed with {learnt!r}, not"
                f" {given!r}"
            )
    return ""


def _other_constants(emulator: Emulator, constants: Mapping[str, float]) -> str:
    for name, declared in emulator.parameters.items():
        value = declared["value"]
        if value is None:
            if constants.get(name, 0.0) != constants.get(name, 0.0):
                return f"{name}: give its law, or its value in [fixed]: the emulator has none"
            continue
        if name not in constants:
            return f"[uncertain] {name}: does not vary in the rows of the emulator"
        if constants[name] != value:
            given = f"{name} = {constants[name]!r}"
            return f"{given}: the rows of the emulator were computed with {value!r}"
    return ""
