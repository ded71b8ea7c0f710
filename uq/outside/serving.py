"""A model offered to others by the protocol of UM-Bridge; see `uq.outside.um_bridge`."""

import json
import socket
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Lock
from typing import Any

import numpy as np

from uq.contract import Model, Status
from uq.outside.um_bridge import DESCRIBED, VERSION
from uq.wording import counted

_LONGEST = 10_000_000  # bytes of a question


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
    OSError
        When it cannot be reached there.
    """
    place: Any
    family, _, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]

    class Server(ThreadingHTTPServer):
        address_family = family

    return Server(place, _handler(_Offered(model)))


def address_of(host: str, port: int, name: str) -> str:
    """Return the address of a model on a server."""
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/{name}"


class _Offered:
    """What is asked of a model."""

    def __init__(self, model: Model):
        self._settings = model.settings()
        self.model = model.given(self._settings)
        self._one_at_a_time = Lock()
        row = self._row([list(model.nominal.values())], {})
        self._sizes = {name: values.size for name, values in row.items()}

    def _row(self, vectors: Any, config: Any) -> dict[str, Any]:
        x = np.array([np.concatenate([np.asarray(one, float) for one in vectors])])
        if x.shape[1] != len(self.model.parameter_names):
            given, expected = counted(x.shape[1], "input"), len(self.model.parameter_names)
            raise ValueError(f"{given}, expected {expected}")
        seed = np.array([int(config.get("seed", 0))], np.uint64)
        with self._one_at_a_time, np.errstate(all="ignore"):
            outputs, status, *said = self.model.batch(x, seed, self._settings)
        code = Status(int(status[0]))
        if code not in (Status.OK, Status.OUT_OF_BUDGET):
            raise ValueError(said[0].get(0, code.meaning) if said else code.meaning)
        return {name: np.asarray(values)[0] for name, values in outputs.items()}

    def answer(self, what: str, body: Any) -> Any:
        """Return the answer to a question."""
        model = self.model
        if what == "Info":
            return {"protocolVersion": VERSION, "models": [model.name]}
        if body.get("name") != model.name:
            raise LookupError(f"no such model: {body.get('name')} (there: {model.name})")
        if what == "InputSizes":
            return {"inputSizes": [len(model.parameter_names)]}
        if what == "OutputSizes":
            return {"outputSizes": list(self._sizes.values())}
        if what == "ModelInfo":
            return {"support": {"Evaluate": True}, DESCRIBED: self._described()}
        if what == "Evaluate":
            row = self._row(body["input"], body.get("config") or {})
            return {"output": [values.astype(float).ravel().tolist() for values in row.values()]}
        raise LookupError(f"no such question: {what}")

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
                    "unit": one.unit,
                    "bounds": list(one.bounds),
                    "meaning": one.meaning,
                }
                for name, one in declared
            ],
            "outputs": {
                name: {
                    "unit": one.unit,
                    "meaning": one.meaning,
                    "life": one.is_lifetime,
                    "shape": [int(np.prod([len(axes[dim]) for dim in one.dims]))] * bool(one.dims),
                    "may_be_undefined": one.may_be_undefined,
                    "scales": dict(one.scales),
                }
                for name, one in model.outputs.items()
            },
        }


def _handler(offered: _Offered) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._answer({})

        def do_POST(self) -> None:
            length = int(self.headers.get("Content-Length") or 0)
            if length > _LONGEST:
                self._send(413, {"error": {"type": "InvalidInput", "message": "too long"}})
                return
            try:
                body = json.loads(self.rfile.read(length) or b"{}")
                if not isinstance(body, dict):
                    raise ValueError("not an object")
            except ValueError as error:
                self._send(400, {"error": {"type": "InvalidInput", "message": str(error)}})
                return
            self._answer(body)

        def _answer(self, body: Any) -> None:
            try:
                self._send(200, offered.answer(self.path.strip("/"), body))
            except LookupError as error:
                self._send(400, {"error": {"type": "ModelNotFound", "message": str(error)}})
            except (ValueError, TypeError, OverflowError) as error:
                self._send(400, {"error": {"type": "InvalidInput", "message": str(error)}})
            except Exception as error:
                message = f"{type(error).__name__}: {error}"
                self._send(500, {"error": {"type": "InternalError", "message": message}})

        def _send(self, code: int, answer: Any) -> None:
            data = json.dumps(answer).encode()
            self.send_response(code)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *arguments: Any) -> None:
            pass

    return Handler
