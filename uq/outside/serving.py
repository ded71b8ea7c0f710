"""A model offered to others over HTTP by the protocol of UM-Bridge; see `uq.outside.um_bridge`."""

import io
import json
import re
import socket
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from threading import BoundedSemaphore
from typing import Any

from uq.contract import Model
from uq.errors import described, one_line
from uq.literals import plain_line, shown
from uq.outside.offered import OfferedModel, RefusedError, invalid

_LONGEST = 10_000_000  # bytes of a question
_PART = 65536  # of it, read at once
_QUESTION_SECONDS = 10.0  # for a question to arrive
_MOST_CONNECTIONS = 500  # at once; others are refused
_MOST_CHARACTERS = 200  # of what could not be read, in an answer
_UNREAD_SECONDS = 1.0  # for which the rest of a refused question is read and discarded


def server_of(model: Model, host: str = "127.0.0.1", port: int = 4242) -> ThreadingHTTPServer:
    """Return a server of a model at its default settings, not yet serving.

    Parameters
    ----------
    model : Model
        Its parameters are one vector; each output is a vector, and so is each flag of a censored
        life. The seed of a row is 0, or ``seed`` in ``config``. A life that never ends, and an
        undefined value, is ``null``.
    host : str
        Loopback by default: whoever reaches it can have rows computed. Pages in a browser cannot:
        their requests, and on loopback those addressed to another name, are refused.
    port : int
        0 for any that is free.

    Raises
    ------
    OSError
        When it cannot be reached there.
    """
    family, _, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]

    class Server(_Server):
        address_family = family

    return Server(place, OfferedModel(model), host)


def address_of(host: str, port: int, name: str) -> str:
    """Return the address of a model on a server."""
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/{name}"


def _refuse_constant(name: str) -> float:
    raise invalid(f"the question is not JSON: {name} is no number of JSON")


class _Server(ThreadingHTTPServer):
    """Answers of a model, each connection in a thread, of which there is a largest number."""

    request_queue_size = 128

    def __init__(self, place: Any, offered: OfferedModel, host: str):
        super().__init__(place, _Handler)
        self.offered, self.host = offered, host
        self.on_loopback = ip_address(place[0].partition("%")[0]).is_loopback
        self._free = BoundedSemaphore(_MOST_CONNECTIONS)

    def process_request(self, request: Any, client_address: Any) -> None:
        if not self._free.acquire(blocking=False):
            with suppress(OSError):
                request.settimeout(_UNREAD_SECONDS)
                request.sendall(_BUSY)
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except RuntimeError:  # no thread can be started
            self._free.release()
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Log an error in one line; a connection that broke needs none."""
        error = sys.exception()
        if error is not None and not isinstance(error, OSError):
            print(plain_line(f"{client_address[0]}: {described(error)}"), file=sys.stderr)


class _Arriving(io.RawIOBase):
    """What comes through a connection, until the time for a question is over."""

    def __init__(self, connection: socket.socket):
        self._connection, self._until = connection, time.monotonic() + _QUESTION_SECONDS

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        try:
            self._connection.settimeout(max(self._until - time.monotonic(), 1e-3))
            return self._connection.recv_into(buffer)
        except TimeoutError:
            late = f"the question did not arrive within {_QUESTION_SECONDS:g} s"
            raise RefusedError(HTTPStatus.REQUEST_TIMEOUT, "InvalidInput", late) from None


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    default_request_version = "HTTP/1.0"  # an error without a status line is none
    request_version, requestline, command = default_request_version, "", ""  # until it is read

    def setup(self) -> None:
        super().setup()
        self.rfile.close()
        self.rfile = io.BufferedReader(_Arriving(self.connection))

    def handle_one_request(self) -> None:
        try:
            super().handle_one_request()
        except RefusedError as refused:
            self._send_error(refused)
        except OSError:
            raise
        except Exception as error:
            fault = RefusedError(
                HTTPStatus.INTERNAL_SERVER_ERROR, "InternalError", described(error)
            )
            self._send_error(fault)

    def do_GET(self) -> None:
        self._reply(lambda: {})

    def do_POST(self) -> None:
        self._reply(self._question)

    def _reply(self, question: Callable[[], Any]) -> None:
        """Send the answer to a question."""
        self._refuse_strangers()
        answer = self.server.offered.answer(self.path.strip("/"), question())
        self._send(HTTPStatus.OK, answer)

    def _refuse_strangers(self) -> None:
        """Refuse what a page in a browser asks.

        A page of another site sends its ``Origin``; if its name leads to this computer, its
        ``Host`` is that name.
        """
        if origin := self.headers.get("Origin"):
            said = f"requests of web pages are refused (Origin: {shown(origin)})"
            raise RefusedError(HTTPStatus.FORBIDDEN, "InvalidInput", said)
        hosts = self.headers.get_all("Host", [])
        if len(hosts) > 1 or (not hosts and self.request_version == "HTTP/1.1"):
            raise invalid("one header 'Host' is needed")
        if hosts and self.server.on_loopback and not self._is_here(hosts[0]):
            said = f"this server is not {shown(hosts[0])} (it is at {self.server.host})"
            raise RefusedError(HTTPStatus.MISDIRECTED_REQUEST, "InvalidInput", said)

    def _is_here(self, host: str) -> bool:
        name = re.sub(r":\d*$", "", host.strip()).strip("[]").lower()
        if name in ("localhost", self.server.host.lower()):
            return True
        with suppress(ValueError):
            return ip_address(name).is_loopback
        return False

    def _question(self) -> Any:
        """Return what is asked, as read from JSON."""
        kind = self.headers.get_content_type() if "Content-Type" in self.headers else ""
        if kind not in ("", "application/json"):
            said = f"Content-Type must be application/json, not {shown(kind)}"
            raise RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "InvalidInput", said)
        lengths = self.headers.get_all("Content-Length", [])
        if "Transfer-Encoding" in self.headers or not lengths:
            said = "a question needs its Content-Length"
            raise RefusedError(HTTPStatus.LENGTH_REQUIRED, "InvalidInput", said)
        if len(lengths) > 1 or not re.fullmatch(r"[0-9]{1,18}", lengths[0].strip()):
            raise invalid(f"Content-Length must be one whole number, not {shown(lengths[0])}")
        length = int(lengths[0])
        if length > _LONGEST:
            said = f"a question of {length} bytes is too long; at most {_LONGEST} bytes"
            raise RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "InvalidInput", said)
        text = self.rfile.read(length)
        if len(text) < length:
            raise invalid(f"the question ended after {len(text)} of {length} bytes")
        try:
            return json.loads(text or b"{}", parse_constant=_refuse_constant)
        except RecursionError:
            raise invalid("the question is nested too deeply") from None
        except ValueError as error:
            raise invalid(f"the question is not JSON: {one_line(error)}") from None

    def _send(self, status: HTTPStatus, answer: Any) -> None:
        data = json.dumps(answer, allow_nan=False).encode()
        self.connection.settimeout(_QUESTION_SECONDS)
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(data)))
        self.send_header("Connection", "close")
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(data)

    def _send_error(self, refused: RefusedError) -> None:
        self._send(refused.status, _error(refused))
        self._discard()

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Send why a request cannot be read, as JSON instead of a page."""
        status = HTTPStatus(code)
        sentence = plain_line(message or status.phrase)[:_MOST_CHARACTERS]
        self._send_error(RefusedError(status, "InvalidInput", sentence))

    def _discard(self) -> None:
        """Read what else arrives: closing a connection before could destroy the answer."""
        with suppress(OSError):
            self.connection.shutdown(socket.SHUT_WR)
            until = time.monotonic() + _UNREAD_SECONDS
            for _ in range(10 * _LONGEST // _PART):
                self.connection.settimeout(max(until - time.monotonic(), 0.001))
                if not self.connection.recv(_PART):
                    return

    def log_message(self, *arguments: Any) -> None:
        pass


def _error(refused: RefusedError) -> dict[str, Any]:
    return {"error": {"type": refused.kind, "message": str(refused)}}


_BUSY = (
    f"HTTP/1.0 {HTTPStatus.SERVICE_UNAVAILABLE:d} {HTTPStatus.SERVICE_UNAVAILABLE.phrase}\r\n"
    "Content-Type: application/json\r\n\r\n"
    '{"error": {"type": "InternalError", "message": "too many connections; try again later"}}'
).encode()
