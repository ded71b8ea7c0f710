"""Models on UM-Bridge servers, with its own package as the other side, and ours offered to it."""

import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from own_machines import run_server, run_server_here
from own_study import own_study
from their_server import TheirServer

import uq as package
from models.analytic import EXPONENTIAL_WEAR as WEAR
from models.analytic import ISHIGAMI
from uq.contract import Status
from uq.machines import server
from uq.machines.serving import address_of, server_of

pytestmark = pytest.mark.usefixtures("forgetful")

THEIRS = """\
(a, b), (c,) = parameters
if a > 0.9:
    raise ValueError("too much")
return [[a + b + c], [a, 2 * a]]
"""


@pytest.fixture
def theirs(folder):
    """Start a server of the other side; return the address of its model."""
    with TheirServer(folder, THEIRS, inputs=(2, 1), outputs=(1, 2)) as running:
        yield running.address


@pytest.fixture
def ours():
    """Return a function that serves a model and returns its address."""
    servers = []

    def serve(model, host="127.0.0.1"):
        http_server = server_of(model, host, port=0)
        threading.Thread(target=http_server.serve_forever, daemon=True).start()
        servers.append(http_server)
        return address_of(host, http_server.server_address[1], model.name)

    yield serve
    for http_server in servers:
        http_server.shutdown()
        http_server.server_close()


def test_a_model_of_theirs_is_run(uq, theirs):
    study = {"name": "x1_1", "lower": 0, "upper": 1, "samples": 30}
    ended = run_server(uq, theirs, **study)
    assert "ValueError" not in ended.err
    ds = package.open_result("own.nc")
    x = ds["x1_1"].values
    is_ok = x <= 0.9
    assert (ds["status"].values == np.where(is_ok, Status.OK, Status.RAISED)).all()
    assert not is_ok.all() and "with status 500" in ds["status"].attrs["example_raised"]
    assert (ds["y1"].values[is_ok] == x[is_ok]).all()
    assert (ds["y2"].values[is_ok] == np.stack([x, 2 * x], axis=1)[is_ok]).all()
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
    study = {"name": "rate", "lower": 1e-10, "upper": 4e-10, "samples": 20}
    run_server(uq, ours(WEAR), **study)
    there = package.open_result("own.nc")
    run_server(uq, "exponential-wear", "--fresh", **study)
    here = package.open_result("own.nc")
    assert (there["life"].values == here["life"].values).all()
    for key in ("units", "kind"):
        assert there["life"].attrs[key] == here["life"].attrs[key]
    assert there["rate"].attrs["units"] == here["rate"].attrs["units"]


@pytest.mark.slow
def test_of_several_servers_one_may_die(uq, folder):
    kept = folder / "asked"
    kept.mkdir()
    body = "open(f'asked/{sys.argv[1]}', 'a').write('.')\ntime.sleep(0.01)\n"
    with (
        TheirServer(folder / "asked", body + "return [[2 * parameters[0][0]]]") as dying,
        TheirServer(folder, body + "return [[2 * parameters[0][0]]]") as other,
    ):
        command = [sys.executable, "-m", "uq", "run", "own.toml", "--quiet", "-o", "own.nc"]
        (folder / "own.toml").write_text(own_study("m", samples=400))
        command += ["--model", f"{dying.address},{other.address}", "--workers", "2"]
        running = subprocess.Popen(command)
        asked = [kept / server.base.rpartition(":")[2] for server in (dying, other)]
        until = time.monotonic() + 60
        while not all(file.exists() and file.stat().st_size > 20 for file in asked):
            assert time.monotonic() < until
            time.sleep(0.01)
        dying.kill()
        assert running.wait(60) == 0
    ds = package.open_result("own.nc")
    assert (ds["status"] == 0).all() and (ds["y"] == 2 * ds["x1"]).all()
    assert 20 < asked[0].stat().st_size < asked[1].stat().st_size


def test_addresses_of_ipv6_serve_and_are_asked(uq, ours):
    try:
        address = ours(ISHIGAMI, "::1")
    except OSError:
        pytest.skip("this computer has no IPv6")
    assert address.startswith("http://[::1]:")
    run_server(uq, address, samples=4)
    assert (package.open_result("own.nc")["status"] == 0).all()


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
    with TheirServer(folder, "return [[1.0 / parameters[0][0]]]") as running:
        ds = run_server_here(running.address, samples=4, workers=0)
    assert (ds["y"] == 1 / ds["x1"]).all()
