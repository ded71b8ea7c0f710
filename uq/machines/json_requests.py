"""Requests with JSON over HTTP: an invalid one is answered in one line, never computed."""

import json
import re
import socket
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from math import isfinite
from typing import Any
from urllib.parse import urlsplit

from uq.machines.um_bridge import cut_after
from uq.text.literals import plain_line

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
    """Return numbers in nested lists with None for those that JSON has no number for."""
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
