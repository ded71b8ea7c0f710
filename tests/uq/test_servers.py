"""Models on UM-Bridge servers, with its own package as the other side, and ours offered to it."""

import itertools
import json
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from their_server import TheirServer

import uq as package
from models.analytic import EXPONENTIAL_WEAR as WEAR
from models.analytic import ISHIGAMI
from uq.contract import Status
from uq.outside import server, um_bridge
from uq.outside.serving import address_of, server_of

STUDY = """
[study]
name = "own"
model = "{model}"
[design]
method = "monte-carlo"
samples = {samples}
seed = 1
[uncertain.{name}]
distribution = "uniform"
lower = {lower}
upper = {upper}
source = "assumed"
"""

THEIRS = """\
(a, b), (c,) = parameters
if a > 0.9:
    raise ValueError("too much")
return [[a + b + c], [a, 2 * a]]
"""


@pytest.fixture(autouse=True)
def forgetful(monkeypatch):
    """Let every test ask servers anew, for a short time only."""
    server._known.cache_clear()
    monkeypatch.setattr(server, "_SOON", 20.0)


@pytest.fixture
def theirs(folder):
    """Start a server of the other side; return the address of its model."""
    with TheirServer(folder, THEIRS, inputs=(2, 1), outputs=(1, 2)) as one:
        yield one.address


@pytest.fixture
def ours():
    """Return a function that serves a model and returns its address."""
    servers = []

    def serve(model, host="127.0.0.1"):
        one = server_of(model, host, port=0)
        threading.Thread(target=one.serve_forever, daemon=True).start()
        servers.append(one)
        return address_of(host, one.server_address[1], model.name)

    yield serve
    for one in servers:
        one.shutdown()
        one.server_close()


def run_here(address, samples, **options):
    Path("own.toml").write_text(
        STUDY.format(model="m", name="x1", lower=0, upper=1, samples=samples)
    )
    return package.run(package.load_study("own.toml", address), "own.nc", **options)


def run(uq, address, *more, **study):
    Path("own.toml").write_text(STUDY.format(**study))
    return uq("run", "own.toml", "--model", address, "-o", "own.nc", "--quiet", *more)


def test_a_model_of_theirs_is_run(uq, theirs):
    study = {"model": "forward", "name": "x1_1", "lower": 0, "upper": 1, "samples": 30}
    ended = run(uq, theirs, **study)
    assert "ValueError" not in ended.err
    ds = package.open_result("own.nc")
    x = ds["x1_1"].values
    known = x <= 0.9
    assert (ds["status"].values == np.where(known, Status.OK, Status.RAISED)).all()
    assert not known.all() and "with status 500" in ds["status"].attrs["example_raised"]
    assert (ds["y1"].values[known] == x[known]).all()
    assert (ds["y2"].values[known] == np.stack([x, 2 * x], axis=1)[known]).all()
    assert ds.attrs["model_version"] == "UM-Bridge 1"


def test_ours_is_asked_by_their_client(ours):
    umbridge = pytest.importorskip("umbridge")
    address = ours(ISHIGAMI)
    base, name = address.rsplit("/", 1)
    client = umbridge.HTTPModel(base, name)
    assert client.get_input_sizes() == [3] and client.get_output_sizes() == [1]
    x = np.array([[0.3, -0.2, 1.1]])
    (y,) = ISHIGAMI.batch(x, np.zeros(1, np.uint64), ISHIGAMI.settings())[0]["y"]
    assert client(x.tolist()) == [[y]]


def test_ours_keeps_names_units_bounds_and_lives_on_the_way(uq, ours):
    study = {"model": "w", "name": "rate", "lower": 1e-10, "upper": 4e-10, "samples": 20}
    run(uq, ours(WEAR), **study)
    there = package.open_result("own.nc")
    run(uq, "exponential-wear", "--fresh", **study)
    here = package.open_result("own.nc")
    assert (there["life"].values == here["life"].values).all()
    for key in ("units", "kind"):
        assert there["life"].attrs[key] == here["life"].attrs[key]
    assert there["rate"].attrs["units"] == here["rate"].attrs["units"]


INFO = {
    "Info": {"protocolVersion": 1.0, "models": ["m"]},
    "InputSizes": {"inputSizes": [1]},
    "OutputSizes": {"outputSizes": [1]},
    "ModelInfo": {"support": {"Evaluate": True}},
}


@pytest.fixture
def hostile():
    """Return a function that serves fixed answers; texts are sent as they are."""
    sockets = []

    def serve(answers):
        one = socket.create_server(("127.0.0.1", 0))
        sockets.append(one)
        counts = dict.fromkeys(answers, 0)

        def handle(connection):
            with connection:
                question = connection.recv(65536).decode(errors="replace")
                what = question.split(" ")[1].strip("/")
                answer = answers[what]
                if callable(answer):
                    answer = answer(counts[what])
                counts[what] += 1
                if not isinstance(answer, str):
                    text = json.dumps(answer)
                    answer = f"HTTP/1.1 200 OK\r\nContent-Length: {len(text)}\r\n\r\n{text}"
                connection.sendall(answer.encode())

        def accept():
            while True:
                try:
                    connection, _ = one.accept()
                    threading.Thread(target=handle, args=(connection,), daemon=True).start()
                except OSError:
                    return

        threading.Thread(target=accept, daemon=True).start()
        return f"http://127.0.0.1:{one.getsockname()[1]}/m"

    yield serve
    for one in sockets:
        one.close()


HTML = "HTTP/1.1 200 OK\r\nContent-Length: 6\r\n\r\n<html>"
WRONG = {
    "<html>": (HTML, "answers Evaluate with status 200 and no JSON (<html>)"),
    "an error": ({"error": {"type": "X", "message": "no mesh"}}, "answers Evaluate: no mesh"),
    "a list": ([1.0], "answers Evaluate without a list of vectors"),
    "text": ({"output": [["a"]]}, "returned 'y' as str"),
    "nan": ({"output": [[float("nan")]]}, "'y' is nan"),
    "null": ({"output": [[None]]}, "returned 'y' as NoneType"),
    "500": ("HTTP/1.1 500 X\r\nContent-Length: 2\r\n\r\n{}", "with status 500"),
}


@pytest.mark.parametrize("what", WRONG)
def test_a_server_that_answers_nonsense_costs_a_status(uq, hostile, what):
    answer, words = WRONG[what]
    good = {"output": [[1.5]]}
    address = hostile(INFO | {"Evaluate": lambda count: good if count % 2 == 0 else answer})
    study = {"model": "m", "name": "x1", "lower": 0, "upper": 1, "samples": 10}
    run(uq, address, "--workers", "0", **study)
    ds = package.open_result("own.nc")
    lost = ds["status"].values != Status.OK
    assert lost.any() and not lost.all()
    said = " ".join(v for k, v in ds["status"].attrs.items() if k.startswith("example"))
    assert words in said
    assert (ds["y"].values[~lost] == 1.5).all()


def test_an_answer_that_comes_twice_is_never_that_of_the_next_row(uq, hostile):
    def twice(count):
        text = json.dumps({"output": [[float(count)]]})
        return 2 * f"HTTP/1.1 200 OK\r\nContent-Length: {len(text)}\r\n\r\n{text}"

    study = {"model": "m", "name": "x1", "lower": 0, "upper": 1, "samples": 10}
    run(uq, hostile(INFO | {"Evaluate": twice}), "--workers", "0", **study)
    y = package.open_result("own.nc")["y"].values
    assert len(np.unique(y)) == 10 and (np.diff(y) == 1).all()


@pytest.mark.slow
def test_of_several_servers_one_may_die(uq, folder):
    kept = folder / "asked"
    kept.mkdir()
    body = "open(f'asked/{sys.argv[1]}', 'a').write('.')\ntime.sleep(0.01)\n"
    with (
        TheirServer(folder / "asked", body + "return [[2 * parameters[0][0]]]") as one,
        TheirServer(folder, body + "return [[2 * parameters[0][0]]]") as other,
    ):
        command = [sys.executable, "-m", "uq", "run", "own.toml", "--quiet", "-o", "own.nc"]
        study = {"model": "m", "name": "x1", "lower": 0, "upper": 1, "samples": 400}
        (folder / "own.toml").write_text(STUDY.format(**study))
        command += ["--model", f"{one.address},{other.address}", "--workers", "2"]
        running = subprocess.Popen(command)
        asked = [kept / server.base.rpartition(":")[2] for server in (one, other)]
        until = time.monotonic() + 60
        while not all(file.exists() and file.stat().st_size > 20 for file in asked):
            assert time.monotonic() < until
            time.sleep(0.01)
        one.kill()
        assert running.wait(60) == 0
    ds = package.open_result("own.nc")
    assert (ds["status"] == 0).all() and (ds["y"] == 2 * ds["x1"]).all()
    assert 20 < asked[0].stat().st_size < asked[1].stat().st_size


def test_servers_of_different_models_are_refused(uq, hostile):
    first, other = hostile(INFO), hostile(INFO | {"OutputSizes": {"outputSizes": [2]}})
    ended = uq("models", f"{first},{other}")
    assert ended.code == 2 and ended.err == f"{other}: describes itself otherwise than {first}\n"


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
    ds = run_here(address, samples=40, workers=0)
    assert time.monotonic() - began < 10  # not a second for each row
    assert (ds["status"].values == Status.RAISED).sum() == 37
    assert "does not answer" in ds["status"].attrs["example_raised"]


def test_a_server_that_answers_late_costs_its_row(uq, hostile):
    calls = itertools.count()

    def late(count):
        time.sleep(30.0 if next(calls) == 2 else 0.0)
        return {"output": [[1.0]]}

    began = time.monotonic()
    ds = run_here(hostile(INFO | {"Evaluate": late}), samples=4, row_limit=0.5)
    assert (ds["status"].values == Status.TIMED_OUT).sum() == 1
    assert "did not answer within 0.5 s" in ds["status"].attrs["example_timed_out"]
    assert time.monotonic() - began < 10


def test_addresses_of_ipv6_serve_and_are_asked(uq, ours):
    try:
        address = ours(ISHIGAMI, "::1")
    except OSError:
        pytest.skip("this computer has no IPv6")
    assert address.startswith("http://[::1]:")
    study = {"model": "i", "name": "x1", "lower": 0, "upper": 1, "samples": 4}
    run(uq, address, **study)
    assert (package.open_result("own.nc")["status"] == 0).all()


def test_an_endless_answer_is_not_read(monkeypatch, hostile):
    monkeypatch.setattr(um_bridge, "_LONGEST", 1000)
    base = hostile({"Evaluate": {"output": [[0.0] * 1000]}}).rsplit("/", 1)[0]
    with pytest.raises(um_bridge.ServerError, match=r"with more than 1e\+03 bytes"):
        um_bridge.call(base, "Evaluate", {})


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("http://127.0.0.1:1", "write it as http://HOST:PORT/NAME"),
        ("http://127.0.0.1:x/y", "write it as http://HOST:PORT/NAME"),
        ("http://127.0.0.1:1/m", "does not answer"),
    ],
)
def test_a_wrong_address_is_one_line(uq, monkeypatch, address, words):
    monkeypatch.setattr(server, "_SOON", 0.0)
    ended = uq("models", address)
    assert ended.code == 2 and words in ended.err and ended.err.count("\n") == 1


def test_a_model_without_a_value_at_zero_is_run(uq, folder):
    with TheirServer(folder, "return [[1.0 / parameters[0][0]]]") as one:
        ds = run_here(one.address, samples=4, workers=0)
    assert (ds["y"] == 1 / ds["x1"]).all()


def test_a_model_that_is_not_there_is_one_line(uq, hostile):
    address = hostile(INFO).replace("/m", "/n")
    assert "no such model (there: m)" in uq("models", address).err
