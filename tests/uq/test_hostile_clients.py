"""Requests to a served model: each is answered in one line of JSON, with the right status."""

import json
import socket
import threading
from math import inf, nan

import numpy as np
import pytest
from command_line import strict_json
from own_machines import run_server

import uq as package
from models.analytic import EXPONENTIAL_WEAR as WEAR
from uq.contract import Status
from uq.outside import serving
from uq.outside.serving import address_of, server_of

ASKED = {"name": "exponential-wear", "input": [[1e-9, 1e-4, 1e-20]]}


@pytest.fixture
def served():
    """Serve a model; return its server."""
    server = server_of(WEAR, port=0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def sent(server, request, patience=20.0):
    """Return status and answer of a request, sent as it is."""
    with socket.create_connection(server.server_address[:2], timeout=patience) as connection:
        connection.sendall(request)
        parts = []
        while part := connection.recv(65536):
            parts.append(part)
    head, _, body = b"".join(parts).partition(b"\r\n\r\n")
    assert body.count(b"\n") == 0 and len(body) < 400
    return int(head.split()[1]), strict_json(body.decode())


def posted(body, path="/Evaluate", host="127.0.0.1", more="", length=None, kind="application/json"):
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    lines = [f"POST {path} HTTP/1.1", f"Host: {host}", f"Content-Type: {kind}", more]
    lines.append(f"Content-Length: {len(data) if length is None else length}")
    return "\r\n".join(filter(None, lines)).encode() + b"\r\n\r\n" + data


def given(rate):
    return ASKED | {"input": [[rate, 1e-4, 1e-20]]}


@pytest.mark.parametrize(
    ("request_", "status", "words"),
    [
        (posted(ASKED, length=-1), 400, "Content-Length must be one whole number"),
        (posted(ASKED, length="abc"), 400, "Content-Length must be one whole number"),
        (posted(ASKED, more="Content-Length: 3"), 400, "Content-Length must be one whole number"),
        (posted(ASKED, length=10**9), 413, "too long"),
        (posted(ASKED, length=5), 400, "not JSON"),
        (posted(ASKED, more="Transfer-Encoding: chunked"), 411, "needs its Content-Length"),
        (posted(ASKED, host="evil.example.com"), 421, "this server is not"),
        (posted(ASKED, host="evil.example.com:4242"), 421, "this server is not"),
        (posted(ASKED, more="Origin: http://evil.example.com"), 403, "web pages are refused"),
        (posted(ASKED, more="Origin: null"), 403, "web pages are refused"),
        (posted(ASKED, kind="text/plain"), 415, "must be application/json"),
        (posted(ASKED, path="/Nonsense"), 404, "no such question"),
        (posted(ASKED | {"name": "beam"}), 400, "no such model"),
        (posted(given(nan)), 400, "NaN is no number of JSON"),
        (posted(given(inf)), 400, "Infinity is no number of JSON"),
        (posted(given(10**400)), 400, "must be a number"),
        (posted(given(-1.0)), 400, "must lie within"),
        (posted(given(True)), 400, "must be a number"),
        (posted(given("1e-9")), 400, "must be a number"),
        (posted(ASKED | {"input": [[1.0]]}), 400, "1 number, expected 3"),
        (posted(ASKED | {"input": []}), 400, "0 numbers, expected 3"),
        (posted({"name": "exponential-wear"}), 400, "'input' must be a list"),
        (posted(ASKED | {"input": "abc"}), 400, "'input' must be a list"),
        (posted(ASKED | {"config": [1]}), 400, "'config' must be"),
        (posted(ASKED | {"config": {"seed": 10**30}}), 400, "whole number from 0"),
        (posted(ASKED | {"config": {"seed": -1}}), 400, "whole number from 0"),
        (posted(b"[" * 200_000), 400, "nested too deeply"),
        (posted(b"[1]"), 400, "must be a JSON object"),
        (b"\x16\x03\x01\x00" * 50 + b"\r\n\r\n", 400, "Bad request"),
        (b"OPTIONS /Evaluate HTTP/1.1\r\nHost: x\r\n\r\n", 501, "Unsupported method"),
        (b"GET /Info HTTP/1.1\r\n\r\n", 400, "'Host' is needed"),
    ],
)
def test_a_wrong_request_is_answered_in_one_line(served, capfd, request_, status, words):
    code, answer = sent(served, request_)
    assert code == status and words in answer["error"]["message"]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "host", ["127.0.0.1", "localhost", "LOCALHOST:4242", "[::1]:4242", "127.0.0.1:80"]
)
def test_names_of_this_computer_are_served(served, host):
    code, answer = sent(served, posted(ASKED, host=host))
    assert (code, answer) == (200, {"output": [[1e5]]})


def test_a_life_that_never_ends_is_null_in_json_and_infinite_for_who_asks(uq, served, forgetful):
    assert sent(served, posted(given(0.0))) == (200, {"output": [[None]]})
    address = address_of("127.0.0.1", served.server_address[1], WEAR.name)
    run_server(uq, address, samples=4, name="rate", lower=0.0, upper=1e-313)
    ds = package.open_result("own.nc")
    assert (ds["status"] == Status.OK).all() and np.isposinf(ds["life"]).all()


@pytest.mark.parametrize("part", [b"", b"POST /Evaluate HTTP/1.1\r\nHost: x", posted(ASKED)[:-1]])
def test_a_request_that_does_not_arrive_is_ended(served, monkeypatch, part):
    monkeypatch.setattr(serving, "_QUESTION_SECONDS", 0.2)
    code, answer = sent(served, part)
    assert code == 408 and "did not arrive" in answer["error"]["message"]


def test_slow_connections_are_bounded_and_hold_up_no_other(served, monkeypatch, capfd):
    monkeypatch.setattr(served, "_free", threading.BoundedSemaphore(20))
    slow = [socket.create_connection(served.server_address[:2]) for _ in range(19)]
    try:
        for connection in slow:
            connection.sendall(b"POST")
        assert sent(served, posted(ASKED))[0] == 200
        slow.append(socket.create_connection(served.server_address[:2]))
        until_accepted(served)
        assert sent(served, b"")[0] == 503
    finally:
        for connection in slow:
            connection.close()
    assert capfd.readouterr().err == ""


def until_accepted(server):
    """Wait until no further connection is accepted."""
    while server._free._value:
        threading.Event().wait(0.01)
