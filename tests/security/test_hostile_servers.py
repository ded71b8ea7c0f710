"""Servers that answer late, twice, endlessly or nonsense cost their rows only."""

import itertools
import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import pytest
from own_machines import run_server, run_server_here

import uq as package
from uq.contract import Status
from uq.machines import um_bridge
from uq.machines.returned import RowError


@pytest.fixture
def hostile():
    """Return a function that serves fixed answers; texts are sent as they are."""
    sockets = []

    def serve(answers):
        listener = socket.create_server(("127.0.0.1", 0))
        sockets.append(listener)
        counts = dict.fromkeys(answers, 0)

        def handle(connection):
            with connection:
                question = connection.recv(65536).decode(errors="replace")
                what = question.split(" ")[1].strip("/")
                answer = answers[what]
                if callable(answer):
                    answer = answer(counts[what])
                counts[what] += 1
                if isinstance(answer, Iterator):  # of parts, each a while after the other
                    with suppress(OSError):
                        for part in answer:
                            connection.sendall(part.encode())
                            time.sleep(0.05)
                    return
                if not isinstance(answer, str):
                    text = json.dumps(answer)
                    answer = f"HTTP/1.1 200 OK\r\nContent-Length: {len(text)}\r\n\r\n{text}"
                connection.sendall(answer.encode())

        def accept():
            while True:
                try:
                    connection, _ = listener.accept()
                    threading.Thread(target=handle, args=(connection,), daemon=True).start()
                except OSError:
                    return

        threading.Thread(target=accept, daemon=True).start()
        return f"http://127.0.0.1:{listener.getsockname()[1]}/m"

    yield serve
    for listener in sockets:
        listener.close()


INFO = {
    "Info": {"protocolVersion": 1.0, "models": ["m"]},
    "InputSizes": {"inputSizes": [1]},
    "OutputSizes": {"outputSizes": [1]},
    "ModelInfo": {"support": {"Evaluate": True}},
}


HEAD = "HTTP/1.1 200 OK\r\n\r\n"
HTML = HEAD + "<html>"
WRONG = {
    "<html>": (HTML, "answers Evaluate with status 200 and no JSON (<html>)"),
    "inf": (HEAD + '{"output": [[inf]]}', "inf is not JSON; return finite numbers, or"),
    "an error": ({"error": {"type": "X", "message": "no mesh"}}, "answers Evaluate: no mesh"),
    "a list": ([1.0], "answers Evaluate without a list of vectors"),
    "text": ({"output": [["a"]]}, "returned 'y' as str"),
    "nan": ({"output": [[float("nan")]]}, "'y' is nan"),
    "too large": (
        HEAD + '{"output": [[1e400]]}',
        "answers Evaluate: 1e400 is too large for a number",
    ),
    "null": ({"output": [[None]]}, "returned 'y' as NoneType"),
    "500": ("HTTP/1.1 500 X\r\nContent-Length: 2\r\n\r\n{}", "with status 500"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_server_that_answers_nonsense_costs_a_status(uq, hostile, what):
    answer, words = WRONG[what]
    good = {"output": [[1.5]]}
    address = hostile(INFO | {"Evaluate": lambda count: good if count % 2 == 0 else answer})
    run_server(uq, address, "--workers", "0")
    ds = package.open_result("own.nc")
    lost = ds["status"].values != Status.OK
    assert lost.any() and not lost.all()
    sentence = " ".join(v for k, v in ds["status"].attrs.items() if k.startswith("example"))
    assert words in sentence
    assert (ds["y"].values[~lost] == 1.5).all()


def test_a_server_that_fails_at_zero_is_given_other_values(uq, hostile):
    address = hostile(INFO | {"Evaluate": WRONG["500"][0]})
    at_zero, elsewhere = (
        " ".join(uq("simulate", address, *more).out.split()) for more in ((), ("--set", "x1=1"))
    )
    assert "so all inputs are 0: give others, --set x1=1" in at_zero
    assert "with status 500" in elsewhere and "all inputs are 0" not in elsewhere


def test_an_answer_that_comes_twice_is_never_that_of_the_next_row(uq, hostile):
    def twice(count):
        text = json.dumps({"output": [[float(count)]]})
        return 2 * f"HTTP/1.1 200 OK\r\nContent-Length: {len(text)}\r\n\r\n{text}"

    run_server(uq, hostile(INFO | {"Evaluate": twice}), "--workers", "0")
    y = package.open_result("own.nc")["y"].values
    assert len(np.unique(y)) == 10 and (np.diff(y) == 1).all()


def test_servers_of_different_models_are_refused(uq, hostile):
    first, other = hostile(INFO), hostile(INFO | {"OutputSizes": {"outputSizes": [2]}})
    ended = uq("models", f"{first},{other}")
    assert ended.code == 2 and ended.err == f"{other}: is a different model than {first}\n"


def test_a_server_that_is_restarted_loses_no_row(monkeypatch, hostile):
    monkeypatch.setattr(um_bridge, "_PAUSES", (0.01,))
    answers = {"Evaluate": lambda count: "" if count < 3 else {"output": [[2.0]]}}
    base = hostile(answers).rsplit("/", 1)[0]
    assert um_bridge.call(base, "Evaluate", {}) == {"output": [[2.0]]}


def test_a_server_that_does_not_return_is_waited_for_once(uq, monkeypatch, hostile):
    monkeypatch.setattr(um_bridge, "_PATIENCE", 1.0)
    monkeypatch.setattr(um_bridge, "_silent", set())
    address = hostile(INFO | {"Evaluate": lambda count: {"output": [[2.0]]} if count < 3 else ""})
    began = time.monotonic()
    ds = run_server_here(address, samples=40, workers=0)
    assert time.monotonic() - began < 10  # not a second for each row
    assert (ds["status"].values == Status.RAISED).sum() == 37
    assert "does not answer" in ds["status"].attrs["example_raised"]


def test_a_server_that_answers_late_costs_its_row(uq, hostile):
    calls = itertools.count()

    def late(count):
        time.sleep(30.0 if next(calls) == 2 else 0.0)
        return {"output": [[1.0]]}

    began = time.monotonic()
    ds = run_server_here(hostile(INFO | {"Evaluate": late}), samples=4, row_limit=0.5)
    assert (ds["status"].values == Status.TIMED_OUT).sum() == 1
    assert "did not answer within 0.5 s" in ds["status"].attrs["example_timed_out"]
    assert time.monotonic() - began < 10


SLOWLY = {
    "bytes of a head": lambda: iter("HTTP/1.1 200 OK\r\n" + 100 * "x"),
    "lines of a head": lambda: itertools.chain(
        ["HTTP/1.1 200 OK\r\n"], itertools.repeat("a: b\r\n")
    ),
    "promises": lambda: itertools.repeat("HTTP/1.1 100 Continue\r\n\r\n"),
    "bytes of an answer": lambda: itertools.chain([HEAD], itertools.repeat("1")),
}


@pytest.mark.parametrize("what", SLOWLY)
def test_an_answer_that_comes_byte_by_byte_is_waited_for_no_longer(hostile, what):
    base = hostile({"Evaluate": lambda count: SLOWLY[what]()}).rsplit("/", 1)[0]
    began = time.monotonic()
    with pytest.raises(RowError, match="did not answer within 0.3 s") as caught:
        um_bridge.call(base, "Evaluate", {}, limit=0.3)
    assert caught.value.status == Status.TIMED_OUT
    assert time.monotonic() - began < 4  # it never ends, or after five seconds


def test_an_endless_answer_is_not_read(monkeypatch, hostile):
    monkeypatch.setattr(um_bridge, "_LONGEST", 1000)
    base = hostile({"Evaluate": {"output": [[0.0] * 1000]}}).rsplit("/", 1)[0]
    with pytest.raises(um_bridge.ServerError, match=r"with more than 1e\+03 bytes"):
        um_bridge.call(base, "Evaluate", {})


def test_a_model_that_is_not_there_is_one_line(uq, hostile):
    address = hostile(INFO).replace("/m", "/n")
    assert "no such model (there: m)" in uq("models", address).err
