"""A model offered to others by the protocol of UM-Bridge; see `uq.machines.um_bridge`."""

import socket
from http.server import ThreadingHTTPServer
from math import prod
from threading import Lock
from typing import Any

import numpy as np

from uq.contract import Floats, Model, Status
from uq.errors import InputError, described
from uq.machines.json_requests import RequestError, finite, invalid, json_server
from uq.machines.returned import Returned, as_plain
from uq.machines.um_bridge import DESCRIBED, NEVER, VERSION
from uq.text.numbers import counted


def server_of(model: Model, host: str = "127.0.0.1", port: int = 4242) -> ThreadingHTTPServer:
    """Return a server of a model at its default settings, not yet serving.

    Parameters
    ----------
    model : Model
        Its parameters are one vector; each output is a vector, and so is each flag of a censored
        life. The seed of a row is 0, or ``seed`` in ``config``.
    host : str
        Loopback by default: whoever reaches it can have rows computed.
    port : int
        0 for any that is free.

    Raises
    ------
    InputError
        When its nominal row fails, or nothing can listen there.
    """
    place: Any
    offered = _Offered(model)
    try:
        family, _, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return json_server(place, family, offered.answer)
    except OSError as error:
        raise InputError(f"uq: {host}:{port}: {error.strerror or error}") from None


def address_of(host: str, port: int, name: str) -> str:
    """Return the address of a model on a server."""
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/{name}"


class _Offered:
    """Requests to a model, and their answers."""

    def __init__(self, model: Model):
        self._settings = model.settings()
        self.model = model.given(self._settings)
        self._one_at_a_time = Lock()
        try:
            row = self._row(np.array(list(model.nominal.values()), float), 0)
        except RequestError as error:
            raise InputError(f"model '{model.name}': its nominal row: {error}") from None
        except Exception as error:
            raise InputError(f"model '{model.name}': its nominal row: {described(error)}") from None
        self._sizes = {name: values.size for name, values in row.items()}

    def _row(self, x: Floats, seed: int) -> dict[str, Any]:
        seeds = np.array([seed], np.uint64)
        with self._one_at_a_time, np.errstate(all="ignore"):
            outputs, status, *messages = self.model.batch(x[None], seeds, self._settings)
        code = Status(int(status[0]))
        if code not in (Status.OK, Status.OUT_OF_BUDGET):
            raise invalid(messages[0].get(0, code.meaning) if messages else code.meaning)
        return {name: np.asarray(values, float)[0].ravel() for name, values in outputs.items()}

    def _inputs(self, vectors: Any) -> Floats:
        """Return the inputs of a row, in declared order."""
        names = self.model.parameter_names
        try:
            numbers = [number for vector in vectors for number in vector]
            if not {type(number) for number in numbers} <= {int, float}:
                raise TypeError
            x = np.array(numbers, dtype=float)
        except (TypeError, OverflowError):
            raise invalid("'input' is not a list of lists of numbers") from None
        if len(x) != len(names):
            raise invalid(f"{counted(len(x), 'input')}, expected {len(names)}")
        for name, value in zip(names, x.tolist(), strict=True):
            low, high = self.model.parameter(name).bounds
            if not low <= value <= high:
                raise invalid(f"{name} = {value} is not within {low} to {high}")
        return x

    def answer(self, path: str, body: dict[str, Any]) -> Any:
        """Return the answer to a request.

        Raises
        ------
        RequestError
        """
        model = self.model
        if path == "Info":
            return {"protocolVersion": VERSION, "models": [model.name]}
        if path not in {"InputSizes", "OutputSizes", "ModelInfo", "Evaluate"}:
            raise RequestError(404, "ModelNotFound", f"no such request: {path[:80]}")
        if (name := body.get("name")) != model.name:
            message = f"no such model: {str(name)[:80]} (there: {model.name})"
            raise RequestError(400, "ModelNotFound", message)
        if path == "InputSizes":
            return {"inputSizes": [len(model.parameter_names)]}
        if path == "OutputSizes":
            return {"outputSizes": list(self._sizes.values())}
        if path == "ModelInfo":
            return {"support": {"Evaluate": True}, DESCRIBED: self._described()}
        return self._evaluated(body)

    def _evaluated(self, body: dict[str, Any]) -> dict[str, Any]:
        config = body.get("config") or {}
        seed = config.get("seed", 0) if isinstance(config, dict) else None
        if not isinstance(seed, int) or not 0 <= seed < 2**64:
            raise invalid("'config' must be an object, its 'seed' an integer from 0 to 2^64 - 1")
        row = self._row(self._inputs(body.get("input")), seed)
        never = [np.flatnonzero(np.isposinf(values)).tolist() for values in row.values()]
        return {"output": [finite(values.tolist()) for values in row.values()], NEVER: never}

    def _described(self) -> dict[str, Any]:
        model, axes = self.model, self.model.coordinates(self._settings)
        declared = [(name, model.parameter(name)) for name in model.parameter_names]
        returned = {
            name: Returned(
                output.unit,
                output.meaning,
                output.is_lifetime,
                (prod(len(axes[dim]) for dim in output.dims),) * bool(output.dims),
                output.may_be_undefined,
                dict(output.scales),
            )
            for name, output in model.outputs.items()
        }
        return {
            "version": model.version,
            "random": model.random,
            "columns": list(self._sizes),
            "parameters": [
                {
                    "name": name,
                    "nominal": model.nominal[name],
                    "unit": parameter.unit,
                    "bounds": finite(parameter.bounds),
                    "meaning": parameter.meaning,
                }
                for name, parameter in declared
            ],
            "outputs": as_plain(returned),
        }
