"""Machines from outside: whatever is killed, the result is that of an undisturbed run."""

import random
import subprocess
import sys
import time
from contextlib import suppress
from itertools import cycle, islice
from pathlib import Path

import cooling_fmu
import numpy as np
import psutil
import pytest
from own_study import own_study
from their_server import TheirServer

import uq

KILLS = 30
PATIENCE = 300.0
SPREAD = 0.1, 1.2  # seconds from kill to kill: a run takes three to start and compute its rows

FUNCTION = """
import time
import uq

@uq.machine(returns={"y": "1"})
def slow(x1: float = 0.5):
    time.sleep(0.02)
    return {"y": x1**3}
"""

MACHINE = """
[machine]
name = "slow"
command = ["sh", "script.sh"]
template = "slow.sh"
input = "script.sh"
[parameters.x1]
nominal = 0.5
[outputs.y]
file = "y.txt"
pattern = '(.+)'
"""
PROGRAM = "sleep 0.02\necho {x1} > part.txt\nsleep 0.02\nmv part.txt y.txt\n"

SERVER = "time.sleep(0.02)\nreturn [[parameters[0][0] ** 3]]"

FMU = """
[machine]
name = "slow"
fmu = "body.fmu"
step = 0.4
[parameters.x1]
variable = "body.rate"
[outputs.y]
variable = "T"
"""

KINDS = {
    "function": ("slow.py", ("driver", "worker"), lambda x: x**3),
    "program": ("slow.toml", ("driver", "worker", "program"), lambda x: x),
    "server": ("", ("driver", "worker", "server"), lambda x: x**3),
    "fmu": ("body.toml", ("driver", "worker"), lambda x: 300 + 100 * np.exp(-4 * x)),
}
"""Kind -> the model, who is killed, and what a row returns."""


def start(*arguments):
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return psutil.Popen([sys.executable, *arguments], **quiet)


def running(process):
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def started_by(driver):
    """Return the processes of a run: its workers, and the programs that these run."""
    with suppress(psutil.NoSuchProcess):
        workers = driver.children()
        return {
            "driver": [driver],
            "worker": workers,
            "program": [
                process for worker in workers for process in worker.children(recursive=True)
            ],
        }
    return {}


@pytest.fixture
def files(folder):
    """Write a study, a function and a program into an empty folder; return it."""
    texts = {"slow.py": FUNCTION, "slow.toml": MACHINE, "slow.sh": PROGRAM, "body.toml": FMU}
    for name, text in {**texts, "own.toml": own_study("slow", samples=200)}.items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_kills_leave_no_trace(files, kind, injected):
    model, roles, expected = KINDS[kind]
    if kind == "fmu":
        slow = cooling_fmu.SOURCE.replace("int fault", "usleep(2000); int fault")
        cooling_fmu.write("body.fmu", cooling_fmu.compiled(files, slow))
    server = TheirServer(".", SERVER, "slow") if kind == "server" else None
    if server:
        server.start()
        model = server.address
    command = ("-m", "uq", "run", "own.toml", "--model", model, "--quiet", "--workers", "2")
    chance, seen = random.Random(kind), set()
    victims = list(islice(cycle(roles), KILLS))
    chance.shuffle(victims)
    try:
        assert start(*command, "-o", "whole.nc").wait(PATIENCE) == 0
        whole = uq.open_result("whole.nc")
        assert np.allclose(whole["y"], expected(whole["x1"]), rtol=1e-12, atol=0)
        while victims:
            Path("own.nc").unlink(missing_ok=True)
            complete(command, victims, chance, server, seen)
            assert uq.open_result("own.nc").identical(whole)
    finally:
        if server:
            server.kill()
    injected(f"{kind}: driver, worker or what computes a row killed", KILLS)
    assert not [process for process in seen if running(process)]
    assert not list(Path().glob("slow.rows/*"))


def complete(command, victims, chance, server, seen):
    """Complete a run, begun again whenever it is killed; `victims` are taken one by one."""
    driver = start(*command, "-o", "own.nc")
    began = time.monotonic()
    strike = began + chance.uniform(*SPREAD)
    while running(driver) or not Path("own.nc").exists():
        assert time.monotonic() < began + PATIENCE, "waited in vain"
        if not running(driver):
            driver.wait()
            driver = start(*command, "-o", "own.nc")
        children = started_by(driver)
        seen.update(process for some in children.values() for process in some)
        if victims and time.monotonic() > strike:
            targets = [process for process in children.get(victims[-1], ()) if running(process)]
            if victims[-1] == "server":
                server.kill()
                server.start()
            elif targets:
                with suppress(psutil.NoSuchProcess):
                    chance.choice(targets).kill()
            if victims[-1] == "server" or targets:  # else it has not started
                victims.pop()
                strike = time.monotonic() + chance.uniform(*SPREAD)
        time.sleep(0.01)
    assert driver.wait() == 0
