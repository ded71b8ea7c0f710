"""Rows computed by jobs of a queue: whatever becomes of the jobs, the rows are those of this
computer, each computed once.
"""

import os
import random

import pytest
from fake_slurm import FakeSlurm
from own_study import own_study

import uq as package
from uq.contract import Status
from uq.execution import queues

pytest.importorskip("dask_jobqueue")

MACHINE = """
[machine]
name = "pad"
command = ["./program", "{load}", "{seed}"]
[parameters.load]
nominal = 1.0
[outputs.life]
unit = "s"
life = true
pattern = 'life = (\\S+)'
[queue]
system = "slurm"
cores = 2
memory = "1GB"
walltime = "00:10:00"
"""

PROGRAM = """#!/bin/sh
touch "$FAKE_SLURM/begun/$SLURM_JOB_ID"
sleep 0.3
awk -v load=$1 'BEGIN {printf "life = %.17g", 3 / load}'
echo $1 > "$FAKE_SLURM/done/$SLURM_JOB_ID-$2"
"""


@pytest.fixture
def slurm(folder, monkeypatch):
    """Return a function that starts a queue with a plan, and a machine whose rows it computes."""
    monkeypatch.setattr(queues, "_LOOK_SECONDS", 1.0)

    def start(plan=(), machine=MACHINE, samples=10, program=PROGRAM):
        queue = FakeSlurm(folder / "slurm", dict(plan))
        for name, value in queue.environment(os.environ["PATH"]).items():
            monkeypatch.setenv(name, value)
        (folder / "machine.toml").write_text(machine)
        (folder / "program").write_text(program)
        (folder / "program").chmod(0o755)
        text = own_study("pad", "load", upper=2.0, samples=samples)
        (folder / "own.toml").write_text(text)
        return queue

    return start


def run(output="own.nc", **options):
    return package.run(package.load_study("own.toml", "machine.toml"), output, **options)


def computed_here(queue):
    """Return the result of this computer, whose rows the queue does not count."""
    os.environ["SLURM_JOB_ID"] = "none"
    return run("here.nc", workers=0)


def random_plan(faults, jobs):
    """Return a plan: a job among the first ones for every fault."""
    numbers = random.Random(1).sample(range(1, jobs + 1), len(faults))
    return dict(zip(numbers, faults, strict=True))


def check(queue, plan, ds):
    """Check that nothing was lost, nothing was computed twice, and the bits are those of here."""
    assert sorted(queue.rows, key=float) == sorted(map(repr, ds["load"].values.tolist()), key=float)
    assert queue.faults == {fault: list(plan.values()).count(fault) for fault in plan.values()}
    assert not queue.alive
    assert (ds["status"].values == Status.OK).all()
    assert ds.identical(computed_here(queue))


def test_whatever_becomes_of_jobs_every_row_is_computed_once(slurm):
    plan = {1: "kill-row", 2: "lose", 3: "late", 5: "kill", 6: "refuse"}
    queue = slurm(plan, samples=7)
    check(queue, plan, run(workers=4))


@pytest.mark.slow
def test_200_jobs_with_30_faults(slurm):
    faults = [fault for fault in ("kill-row", "kill", "lose", "late", "refuse") for _ in range(6)]
    plan = random_plan(faults, 200)
    queue = slurm(plan, samples=176)
    check(queue, plan, run(workers=8))
    assert queue.submitted == 200
