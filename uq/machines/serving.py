"""Server that offers a model by the protocol of UM-Bridge; see `uq.machines.um_bridge`."""

import json
import re
import socket
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from math import isfinite, prod
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from uq.contract import Floats, Model, Status
from uq.errors import InputError, described
from uq.machines.returned import Returned, as_plain
from uq.machines.um_bridge import DESCRIBED, NEVER, VERSION, cut_after
from uq.text.literals import plain_line
from uq.text.numbers import counted

LONGEST = 1_000_000
"""Most bytes of a request's body."""

_SECONDS = 10.0  # for which a request is waited for, from its first byte to its last


class RequestError(Exception):
    """A request that is refused: its HTTP status, a kind of error, and a sentence."""

    def __init__(self, status: int, kind: str, message: str):
        super().__init__(message)
        self.answer = status, {"error": {"type": kind, "message": plain_line(message)}}


def invalid(message: object, status: int = HTTPStatus.BAD_REQUEST) -> RequestError:
    """Return the refusal of an input."""
    return RequestError(status, "InvalidInput", str(message))


def json_server(
    place: Any, family: int, answer: Callable[[str, dict[str, Any]], Any]
) -> ThreadingHTTPServer:
    """Return a server of JSON, not yet serving; it answers an invalid request in one line.

    A page on the web can make a browser send requests to a server on loopback, under a name of its
    own that leads there; so the host, the origin and the type of the content are checked.

    Parameters
    ----------
    place : tuple
        Where it listens: an address of the socket module.
    family : int
        Of the address.
    answer : callable
        ``answer(path, body)`` returns what is sent, with finite numbers; `RequestError` is sent
        with its status, any other exception with status 500.

    Raises
    ------
    OSError
        When it cannot be reached there.
    """

    class Server(ThreadingHTTPServer):
        address_family = family
        request_queue_size = 128

        def handle_error(self, request: Any, client_address: Any) -> None:
            """Say nothing of a client that has left."""

    class Handler(BaseHTTPRequestHandler):
        timeout = _SECONDS

        def do_GET(self) -> None:
            self._answer(False)

        def do_POST(self) -> None:
            self._answer(True)

        def handle_one_request(self) -> None:
            """Handle a request, unless it takes too long to come."""
            with cut_after(_SECONDS, self.connection, socket.SHUT_RD) as self._patience:
                super().handle_one_request()

        def _answer(self, has_body: bool) -> None:
            try:
                self._check_sender(str(place[0]))
                body = self._body() if has_body else {}
                self._patience.cancel()
                code, reply = int(HTTPStatus.OK), answer(self.path.strip("/"), body)
            except RequestError as error:
                code, reply = error.answer
            except Exception as error:
                name = type(error).__name__
                code, reply = RequestError(500, "InternalError", f"{name}: {error}").answer
            self._send(code, reply)

        def _check_sender(self, listening: str) -> None:
            host, origin = self.headers.get("Host"), self.headers.get("Origin")
            if host is None or not _is_this(host, listening):
                raise RequestError(403, "Forbidden", f"Host: {host} is not this server")
            if origin is not None and _site_of(origin) != host:
                raise RequestError(403, "Forbidden", f"Origin: {origin} is another site")

        def _body(self) -> dict[str, Any]:
            if "Transfer-Encoding" in self.headers:
                raise invalid("state the Content-Length; no other transfer is read", 411)
            if (length := self.headers.get("Content-Length")) is None:
                raise invalid("there is no Content-Length", 411)
            if not re.fullmatch("[0-9]{1,18}", length):
                raise invalid(f"Content-Length: {length} is not a number of bytes")
            if int(length) > LONGEST:
                raise invalid(f"longer than {LONGEST} bytes", 413)
            if self.headers.get_content_type() != "application/json":
                raise invalid("the Content-Type must be application/json", 415)
            try:
                content = self.rfile.read(int(length))
            except OSError:
                content = b""
            if len(content) < int(length):
                raise invalid("shorter than its Content-Length", HTTPStatus.REQUEST_TIMEOUT)
            try:
                body = json.loads(content or b"{}", parse_constant=_no_constant)
            except (ValueError, RecursionError) as error:
                raise invalid(f"not valid JSON: {error}") from None
            if not isinstance(body, dict):
                raise invalid("not an object")
            return body

        def send_error(self, code: int, message: Any = None, explain: Any = None) -> None:
            """Answer a request that is not HTTP in JSON too."""
            self.request_version = self.protocol_version  # with a head, as an answer to HTTP 0.9
            self._send(*invalid(message or HTTPStatus(code).phrase, code).answer)

        def _send(self, code: int, reply: Any) -> None:
            data = json.dumps(reply, allow_nan=False).encode()
            self.send_response(code)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            self.send_header("Connection", "close")
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *arguments: Any) -> None:
            pass

    return Server(place, Handler)


def finite(values: Any) -> Any:
    """Return numbers in nested lists, with None for infinity and NaN, as JSON lacks them."""
    if isinstance(values, list | tuple):
        return [finite(value) for value in values]
    return values if isfinite(values) else None


def _is_this(host: str, listening: str) -> bool:
    """Return whether a Host is an address, the name listened at, or the name of this computer."""
    try:
        name = urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return False
    if name in {listening.lower(), "localhost", socket.gethostname().lower()}:
        return True
    try:
        return bool(ip_address(name))
    except ValueError:
        return False


def _site_of(origin: str) -> str:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")


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
                dict(output.exponents),
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
