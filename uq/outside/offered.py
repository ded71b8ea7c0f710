"""Answers of a model to the questions of UM-Bridge; see `uq.outside.um_bridge`."""

from http import HTTPStatus
from threading import Lock
from typing import Any

import numpy as np

from uq.contract import Model, Status
from uq.errors import described
from uq.inputs.values import parameter_problem
from uq.literals import shown
from uq.outside.um_bridge import DESCRIBED, VERSION
from uq.wording import counted

_QUESTIONS = ("Info", "InputSizes", "OutputSizes", "ModelInfo", "Evaluate")


class RefusedError(Exception):
    """A question that is answered with an error.

    Attributes
    ----------
    status : HTTPStatus
    kind : str
        Of UM-Bridge, such as ``InvalidInput``.
    """

    def __init__(self, status: HTTPStatus, kind: str, sentence: str):
        super().__init__(sentence)
        self.status, self.kind = status, kind


def invalid(sentence: str) -> RefusedError:
    """Return the refusal of an input."""
    return RefusedError(HTTPStatus.BAD_REQUEST, "InvalidInput", sentence)


class OfferedModel:
    """A model at its default settings that answers questions, one row at a time."""

    def __init__(self, model: Model):
        self._settings = model.settings()
        self.model = model.given(self._settings)
        self._one_at_a_time = Lock()
        row = self._row(list(model.nominal.values()), 0)
        self._sizes = {name: np.size(values) for name, values in row.items()}

    def answer(self, question: str, body: Any) -> Any:
        """Return the answer to a question, to be written as JSON.

        Parameters
        ----------
        question : str
            Such as ``Evaluate``.
        body : object
            As read from JSON.

        Raises
        ------
        RefusedError
        """
        model = self.model
        if question not in _QUESTIONS:
            asked = f"no such question: {shown(question)} (there: {', '.join(_QUESTIONS)})"
            raise RefusedError(HTTPStatus.NOT_FOUND, "UnsupportedFeature", asked)
        if question == "Info":
            return {"protocolVersion": VERSION, "models": [model.name]}
        if not isinstance(body, dict):
            raise invalid("the question must be a JSON object")
        if body.get("name") != model.name:
            named = f"no such model: {shown(str(body.get('name')))} (there: {model.name})"
            raise RefusedError(HTTPStatus.BAD_REQUEST, "ModelNotFound", named)
        if question == "InputSizes":
            return {"inputSizes": [len(model.parameter_names)]}
        if question == "OutputSizes":
            return {"outputSizes": list(self._sizes.values())}
        if question == "ModelInfo":
            return {"support": {"Evaluate": True}, DESCRIBED: self._described()}
        row = self._row(self._parameters(body.get("input")), _seed(body.get("config")))
        return {"output": [_numbers(values) for values in row.values()]}

    def _parameters(self, vectors: Any) -> list[float]:
        """Return the parameters of a row, each within its bounds."""
        names = self.model.parameter_names
        if not (isinstance(vectors, list) and all(isinstance(part, list) for part in vectors)):
            raise invalid(f"'input' must be a list with one list of {len(names)} numbers")
        values = [value for part in vectors for value in part]
        if len(values) != len(names):
            raise invalid(f"'input' has {counted(len(values), 'number')}, expected {len(names)}")
        for name, value in zip(names, values, strict=True):
            if problem := parameter_problem(self.model, name, value):
                raise invalid(f"{name} = {shown(value)}: {problem}")
        return list(map(float, values))

    def _row(self, values: list[float], seed: int) -> dict[str, Any]:
        x, seeds = np.array([values]), np.array([seed], np.uint64)
        try:
            with self._one_at_a_time, np.errstate(all="ignore"):
                outputs, status, *messages = self.model.batch(x, seeds, self._settings)
        except Exception as error:
            raise _failed(described(error)) from None
        code = Status(int(status[0]))
        if code not in (Status.OK, Status.OUT_OF_BUDGET):
            raise _failed(messages[0].get(0, code.meaning) if messages else code.meaning)
        for name, output in self.model.outputs.items():
            absent = output.is_absent(outputs[name][0])
            if np.any(absent) and not output.may_be_undefined and not output.is_category:
                raise _failed(output.absence(name, np.asarray(outputs[name][0])[absent].flat[0]))
        return {name: np.asarray(values)[0] for name, values in outputs.items()}

    def _described(self) -> dict[str, Any]:
        model, axes = self.model, self.model.coordinates(self._settings)
        declared = [(name, model.parameter(name)) for name in model.parameter_names]
        return {
            "version": model.version,
            "random": model.random,
            "columns": list(self._sizes),
            "parameters": [
                {
                    "name": name,
                    "nominal": model.nominal[name],
                    "unit": parameter.unit,
                    "bounds": [bound if np.isfinite(bound) else None for bound in parameter.bounds],
                    "meaning": parameter.meaning,
                }
                for name, parameter in declared
            ],
            "outputs": {
                name: {
                    "unit": output.unit,
                    "meaning": output.meaning,
                    "life": output.is_lifetime,
                    "shape": [int(np.prod([len(axes[dim]) for dim in output.dims]))]
                    * bool(output.dims),
                    "may_be_undefined": output.may_be_undefined,
                    "scales": dict(output.scales),
                }
                for name, output in model.outputs.items()
            },
        }


def _seed(config: Any) -> int:
    if not isinstance(config or {}, dict):
        raise invalid("'config' must be a JSON object")
    seed = (config or {}).get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
        raise invalid(f"seed = {shown(seed)} must be a whole number from 0 to 2^64 - 1")
    return seed


def _numbers(values: Any) -> list[float | None]:
    """Return numbers for JSON, which has no infinity: null for a life that never ends."""
    flat = np.asarray(values, dtype=float).ravel().tolist()
    return [number if np.isfinite(number) else None for number in flat]


def _failed(sentence: str) -> RefusedError:
    return RefusedError(
        HTTPStatus.INTERNAL_SERVER_ERROR, "InvalidOutput", " ".join(sentence.split())
    )
