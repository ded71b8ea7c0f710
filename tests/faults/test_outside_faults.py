"""Machines from outside: whatever is killed, the result is that of an undisturbed run."""

import random
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import cooling_fmu
import psutil
import pytest
from their_server import TheirServer

import uq

KILLS = 10
PATIENCE = 300.0

STUDY = """
[study]
name = "own"
model = "slow"
[design]
method = "monte-carlo"
samples = 300
seed = 1
[uncertain.x{one}]
distribution = "uniform"
lower = 0.0
upper = 1.0
source = "assumed"
"""

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
MODELS = {"function": "slow.py", "program": "slow.toml", "server": "", "fmu": "body.toml"}

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


def start(*arguments):
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    return psutil.Popen([sys.executable, *arguments], **quiet)


def running(process):
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def descendants(process):
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


@pytest.fixture
def files(folder):
    """Write a study, a function and a program into an empty folder; return it."""
    texts = {"slow.py": FUNCTION, "slow.toml": MACHINE, "slow.sh": PROGRAM, "body.toml": FMU}
    for name, text in {**texts, "own.toml": STUDY.format(one=1)}.items():
        (folder / name).write_text(text)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("kind", MODELS)
def test_kills_leave_no_trace(files, kind):
    chance = random.Random(kind)
    if kind == "fmu":
        slow = cooling_fmu.SOURCE.replace("int fault", "usleep(4000); int fault")
        cooling_fmu.write("body.fmu", cooling_fmu.compiled(files, slow))
    server = TheirServer(".", SERVER, "slow") if kind == "server" else None
    if server:
        server.start()
    model = server.address if server else MODELS[kind]
    command = ("-m", "uq", "run", "own.toml", "--model", model, "--quiet", "--workers", "2")
    try:
        whole = start(*command, "-o", "whole.nc")
        assert whole.wait(PATIENCE) == 0
        killed, began = [], time.monotonic()
        driver = start(*command, "-o", "own.nc")
        while not Path("own.nc").exists() or running(driver):
            assert time.monotonic() < began + PATIENCE, "waited in vain"
            if not running(driver):
                driver.wait()
                driver = start(*command, "-o", "own.nc")
            time.sleep(chance.uniform(0.5, 1.5))
            below = descendants(driver)
            other = [psutil.Process(server.process.pid)] if server else []
            targets = [one for one in (driver, *below, *other) if running(one)]
            if len(killed) < KILLS and targets:
                one = chance.choice(targets)
                killed.append(one)
                with suppress(psutil.NoSuchProcess):
                    one.kill()
                if one in other:
                    server.kill()
                    server.start()
        assert driver.wait() == 0 and len(killed) >= KILLS // 2
        time.sleep(1.0)
        assert not [one for one in below if running(one)]
    finally:
        if server:
            server.kill()
    assert uq.open_result("own.nc").identical(uq.open_result("whole.nc"))
    assert sorted(one.name for one in Path().glob("slow.rows/*")) == []
