"""The protocol of UM-Bridge models [1]_: JSON over HTTP, a connection for each call.

References
----------
.. [1] L. Seelinger, V. Cheng-Seelinger, A. Davis, M. Parno, A. Reinarz, "UM-Bridge: Uncertainty
   quantification and modeling bridge", J. Open Source Softw. 8(83), 4748 (2023).
"""

import http.client
import json
import re
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from math import inf, isfinite
from threading import Timer
from typing import Any
from urllib.parse import SplitResult, urlsplit

from uq.contract import Status
from uq.errors import InputError, one_line
from uq.machines.returned import RowError
from uq.text.literals import read_number

VERSION = 1.0
"""Of the protocol."""

DESCRIBED = "described"
"""Entry of a server's model information with names, units and bounds, which UM-Bridge lacks."""

NEVER = "never"
"""Entry of an answer beside ``output``: which numbers of each vector are null for infinity."""

_LONGEST = 100_000_000  # bytes of an answer
_PART = 1_000_000  # of it, read at once
_PATIENCE = 60.0  # seconds of retries to a server that does not answer
_PAUSES = (0.1, 0.3, 1.0, 3.0)

_OUT_SECONDS = 10.0  # for which others are asked before a server that did not answer

_NO_NUMBER = re.compile(rb"(?<=[\[,:\s])[-+]?(?:inf|nan)(?=[\],}\s])", re.IGNORECASE)

_out = dict[str, float]()  # servers that did not answer, and when
_silent = set[str]()  # servers that have not answered for that time: they are asked only once


class ServerError(Exception):
    """A call that failed, in a sentence."""


def split_address(address: str) -> tuple[str, str]:
    """Return the address of a server and the name of a model on it.

    Raises
    ------
    InputError
        When it is not ``http://HOST:PORT/NAME``.
    """
    try:
        parts: SplitResult = urlsplit(address)
        valid = parts.hostname is not None and parts.port != 0
    except ValueError:
        valid = False
    name = parts.path.strip("/") if valid else ""
    if not valid or not name or "/" in name or parts.query or parts.fragment:
        raise InputError(f"{address}: write it as http://HOST:PORT/NAME")
    return f"{parts.scheme}://{parts.netloc}", name


def call(
    server: str | Sequence[str],
    request: str,
    body: Any = None,
    patience: float | None = None,
    limit: float = inf,
) -> Any:
    """Ask a server and return its answer.

    Parameters
    ----------
    server : str or sequence of str
        ``http://HOST:PORT``; of several, any may answer, and those that lately did not come last.
    request : str
        Its name, such as ``Evaluate``.
    body : object, optional
        What is sent; nothing is asked for by GET.
    patience : float, optional
        Duration of retries if the server does not answer [s], by default a minute. After that, the
        server is asked only once per call until it answers, so that not every row waits.
    limit : float
        How long the call may take [s].

    Raises
    ------
    ServerError, RowError
    """
    began, rounds = time.monotonic(), 0
    until = began + limit
    servers = [server] if isinstance(server, str) else list(server)
    servers.sort(key=lambda address: began < _out.get(address, -inf) + _OUT_SECONDS)
    while True:
        for address in servers:
            try:
                answer = _answer(address, request, body, until)
                _silent.discard(address)
                _out.pop(address, None)
                return answer
            except (OSError, http.client.HTTPException) as error:
                now, reason = time.monotonic(), one_line(error) or type(error).__name__
                if now > until:
                    message = f"{address} did not answer within {limit:g} s"
                    raise RowError(message, Status.TIMED_OUT) from None
                _out[address] = now
        longest = _PATIENCE if patience is None else patience
        if _silent.issuperset(servers) or now - began > longest:
            _silent.update(servers)
            do = "do" if len(servers) > 1 else "does"
            raise ServerError(f"{' and '.join(servers)} {do} not answer: {reason}")
        pause = _PAUSES[min(rounds, len(_PAUSES) - 1)]
        time.sleep(max(min(pause, until - time.monotonic()), 0.0))
        rounds += 1


def _answer(server: str, request: str, body: Any, until: float) -> Any:
    parts = urlsplit(server)
    secure = parts.scheme == "https"
    kind = http.client.HTTPSConnection if secure else http.client.HTTPConnection
    connection = kind(parts.hostname or "", parts.port, timeout=_left(until))
    with closing(connection):
        connection.connect()
        with cut_after(_left(until), connection.sock):
            data = None if body is None else json.dumps(body)
            headers = {"Content-Type": "application/json", "Connection": "close"}
            connection.request("GET" if body is None else "POST", f"/{request}", data, headers)
            response = connection.getresponse()
            text = bytearray()
            while part := response.read1(_PART):
                text += part
                if len(text) > _LONGEST:
                    most = f"{_LONGEST:.0e} bytes"
                    raise ServerError(f"{server} answers {request} with more than {most}")
        _left(until)
        if response.length:
            raise http.client.IncompleteRead(bytes(text), response.length)
    return _read(server, request, response.status, bytes(text))


@contextmanager
def cut_after(
    seconds: float | None, connection: socket.socket, how: int = socket.SHUT_RDWR
) -> Iterator[Timer]:
    """Close a connection after a time limit, even if data still arrives slowly.

    Parameters
    ----------
    seconds : float or None
        None for never.
    connection : socket
    how : int
        Which of its directions are cut.

    Yields
    ------
    Timer
        To be cancelled if the connection is to stay.
    """

    def cut() -> None:
        with suppress(OSError):
            connection.shutdown(how)

    timer = Timer(seconds or 0.0, cut)
    timer.daemon = True
    if seconds:
        timer.start()
    try:
        yield timer
    finally:
        timer.cancel()


def _left(until: float) -> float | None:
    """Return the time that is left for a call [s], None for any.

    Raises
    ------
    TimeoutError
    """
    left = until - time.monotonic()
    if left <= 0:
        raise TimeoutError
    return left if isfinite(left) else None


def _read(server: str, request: str, status: int, text: bytes) -> Any:
    """Return the decoded answer of a server."""
    try:
        answer = json.loads(text, parse_float=read_number)
    except OverflowError as large:
        raise ServerError(f"{server} answers {request}: {large}") from None
    except (ValueError, RecursionError):
        if bare := _NO_NUMBER.search(text):
            raise ServerError(
                f"{server} answers {request}: {bare[0].decode()} is not JSON; return finite"
                ' numbers, or {"error": {"type": ..., "message": ...}} for a row without them'
            ) from None
        excerpt = " ".join(text[:80].decode(errors="replace").split())
        raise ServerError(
            f"{server} answers {request} with status {status} and no JSON ({excerpt}); its own"
            " output may say why"
        ) from None
    if isinstance(answer, dict) and "error" in answer:
        error = answer["error"]
        words = error.get("message") or error.get("type") if isinstance(error, dict) else error
        raise ServerError(f"{server} answers {request}: {' '.join(str(words).split())}")
    if status != http.client.OK:
        raise ServerError(f"{server} answers {request} with status {status}")
    return answer
