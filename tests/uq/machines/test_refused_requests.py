"""What a server of ours answers to requests that it must not compute."""

import json
import socket
import subprocess
import sys
import threading

import pytest

import uq.machines.serving
from models.analytic import EXPONENTIAL_WEAR as WEAR
from uq.machines.serving import server_of

FAILING = """
import uq
@uq.machine(returns={{"y": "1"}})
def failing(x1: float = 0.0):
    raise {}
"""
PRINTING = """
import uq
@uq.machine(returns={"y": "1"})
def printing(x1: float = 0.0):
    if x1:
        print("x" * 100_000)
    return {"y": x1}
"""
OK = {"name": "exponential-wear", "input": [[1e-9, 1e-4, 0]]}


@pytest.fixture
def sent(monkeypatch):
    """Return a function that sends bytes to a server and returns status and answer."""
    monkeypatch.setattr(uq.machines.serving, "_SECONDS", 0.3)
    server = server_of(WEAR, port=0)
    threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()

    def send(data):
        with socket.create_connection(server.server_address[:2], timeout=5) as connection:
            connection.sendall(data)
            reply = b"".join(iter(lambda: connection.recv(65536), b""))
        head, _, body = reply.partition(b"\r\n\r\n")
        assert b"\n" not in body
        return int(head.split()[1]), json.loads(body, parse_constant=pytest.fail)

    yield send
    server.shutdown()
    server.server_close()


def post(body, length=None, host="127.0.0.1", kind="application/json", more=""):
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    size = len(data) if length is None else length
    head = f"POST /Evaluate HTTP/1.1\r\nHost: {host}\r\nContent-Type: {kind}\r\n{more}"
    return f"{head}Content-Length: {size}\r\n\r\n".encode() + data


def question(text):
    return b'{"name": "exponential-wear", "input": ' + text + b"}"


REFUSED = {
    "a name that leads here": (post(OK, host="evil.example"), 403, "not this server"),
    "another site": (post(OK, more="Origin: http://evil.example\r\n"), 403, "another site"),
    "no site": (post(OK, more="Origin: http://[\r\n"), 403, "another site"),
    "a form": (post(OK, kind="text/plain"), 415, "application/json"),
    "negative length": (post(OK, length=-1), 400, "not a number of bytes"),
    "length in words": (post(OK, length="abc"), 400, "not a number of bytes"),
    "too long": (post(OK, length=1_000_001), 413, "longer than"),
    "cut short": (post(OK, length=5), 400, "not valid JSON"),
    "never complete": (post(OK, length=5000), 408, "shorter than"),
    "no length": (b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\n\r\n", 411, "Content-Length"),
    "in chunks": (post(OK, more="Transfer-Encoding: chunked\r\n"), 411, "Content-Length"),
    "no host": (b"POST /Evaluate HTTP/1.1\r\nContent-Length: 0\r\n\r\n", 403, "not this server"),
    "no HTTP": (b"\x16\x03\x01\x00" * 50 + b"\r\n\r\n", 400, "Bad request"),
    "another method": (b"OPTIONS / HTTP/1.1\r\nHost: x\r\n\r\n", 501, "OPTIONS"),
    "no number": (post(question(b"[[NaN, 1e-4, 0]]")), 400, "NaN is not a number"),
    "infinite": (post(question(b"[[1e999, 1e-4, 0]]")), 400, "rate = inf is not within"),
    "out of bounds": (post(question(b"[[-1, 1e-4, 0]]")), 400, "rate = -1.0 is not within"),
    "too few": (post(question(b"[[1]]")), 400, "1 input, expected 3"),
    "a word": (post(question(b'"abc"')), 400, "'input' is not a list"),
    "true": (post(question(b"[[true, 1e-4, 0]]")), 400, "'input' is not a list"),
    "text": (post(question(b'[["1", 1e-4, 0]]')), 400, "'input' is not a list"),
    "null": (post(question(b"[[null, 1e-4, 0]]")), 400, "'input' is not a list"),
    "no input": (post({"name": WEAR.name}), 400, "'input' is not a list"),
    "deep": (post(b"[" * 200_000), 400, "not valid JSON"),
    "a list": (post(b"[1]"), 400, "not an object"),
    "config of a wrong kind": (post(OK | {"config": [1]}), 400, "'config' must be"),
    "large seed": (post(OK | {"config": {"seed": 10**30}}), 400, "'config' must be"),
    "another model": (post(OK | {"name": "beam"}), 400, "no such model: beam"),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_a_request_that_is_wrong_is_refused_in_one_line(sent, kind):
    data, status, words = REFUSED[kind]
    code, answer = sent(data)
    assert code == status
    assert words in answer["error"]["message"]


def test_a_life_that_never_ends_is_null_and_named_beside(sent):
    code, answer = sent(post(OK | {"input": [[0.0, 1e-4, 0.0]]}))
    assert code == 200
    assert answer == {"output": [[None]], "never": [[0]]}
    assert sent(post(OK, host="localhost:80", more="Origin: http://localhost:80\r\n"))[0] == 200


@pytest.mark.parametrize("raised", ["OSError(28, 'No space left on device')", "SystemExit(3)"])
def test_a_model_whose_nominal_row_fails_is_not_served(uq, write_function, raised):
    file = write_function(FAILING.format(raised))
    ended = uq("serve", file, "--port", 0)
    assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith("model 'failing': its nominal row: ")


@pytest.mark.slow
def test_a_row_prints_after_the_reader_of_the_address_has_left(folder, write_function):
    file = write_function(PRINTING)
    served = [sys.executable, "-m", "uq", "serve", file, "--port", "0"]
    with subprocess.Popen(served, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        host, port = process.stdout.readline().decode().split("/")[2].split(":")
        process.stdout.close()
        with socket.create_connection((host, int(port)), timeout=20) as connection:
            connection.sendall(post({"name": "printing", "input": [[0.5]]}))
            reply = b"".join(iter(lambda: connection.recv(65536), b""))
        process.terminate()
    assert b'{"output": [[0.5]]' in reply
