"""Rows computed by jobs of a queue: whatever becomes of the jobs, the rows are those of this
computer, each computed once.
"""

import gc
import os
import random
import re
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from shutil import rmtree

import dask
import pytest
from fake_queue import FakeQueue
from own_study import own_study

import uq as package
from uq.contract import Status
from uq.errors import InputError, RunError
from uq.execution import queues
from uq.machines.machine_file import content_of
from uq.machines.queue_table import QueueTable

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
interface = "lo"
"""

PROGRAM = """#!/bin/sh
touch "$FAKE_QUEUE/begun/$JOB"
while [ -e "$FAKE_QUEUE/hold/$JOB" ]; do sleep 0.1; done
awk -v load=$1 'BEGIN {printf "life = %.17g", 3 / load}'
echo $1 > "$FAKE_QUEUE/done/$JOB-$2"
"""


def write(folder, machine=MACHINE, samples=10):
    """Write a machine with a queue, and its study."""
    (folder / "machine.toml").write_text(machine)
    (folder / "program").write_text(PROGRAM)
    (folder / "program").chmod(0o755)
    (folder / "own.toml").write_text(own_study("pad", "load", upper=2.0, samples=samples))


@pytest.fixture
def queue_of(folder, monkeypatch):
    """Return a function that starts a queue with a plan, and a machine whose rows it computes."""
    monkeypatch.setattr(queues, "_LOOK_SECONDS", 0.5)

    def start(plan=(), **machine):
        queue = FakeQueue(folder / "queue", dict(plan))
        for name, value in queue.environment(os.environ["PATH"]).items():
            monkeypatch.setenv(name, value)
        write(folder, **machine)
        return queue

    yield start
    gc.collect()  # complaints of what is left belong to this test
    assert not list(folder.glob("pad.rows*"))


def run(output="own.nc", **options):
    return package.run(package.load_study("own.toml", "machine.toml"), output, **options)


def computed_here(queue):
    """Return the result of this computer, whose rows the queue does not count."""
    os.environ["JOB"] = "none"
    return run("here.nc", workers=0)


def random_plan(faults, jobs):
    """Return a plan: a job among the first ones for every fault."""
    numbers = random.Random(1).sample(range(1, jobs + 1), len(faults))
    return dict(zip(numbers, faults, strict=True))


def check(queue, plan, ds):
    """Check that nothing was lost, nothing was computed twice, and the bits are those of here."""
    assert sorted(queue.rows, key=float) == sorted(map(repr, ds["load"].values.tolist()), key=float)
    assert queue.faults == {fault: list(plan.values()).count(fault) for fault in plan.values()}
    lost = sum(count for fault, count in queue.faults.items() if fault != "late")
    assert queue.submitted == len(queue.rows) + lost and not queue.alive
    assert not list(queue.folder.parent.glob("pad.jobs*"))
    assert (ds["status"].values == Status.OK).all()
    assert ds.identical(computed_here(queue))


def test_whatever_becomes_of_jobs_every_row_is_computed_once(queue_of):
    plan = {1: "kill-row", 2: "lose", 3: "late", 4: "kill", 5: "refuse"}
    queue = queue_of(plan, samples=3)
    check(queue, plan, run(workers=3))


@pytest.mark.slow
def test_200_jobs_with_30_faults(queue_of):
    faults = [fault for fault in ("kill-row", "kill", "lose", "late", "refuse") for _ in range(6)]
    plan = random_plan(faults, 200)
    queue = queue_of(plan, samples=176)
    check(queue, plan, run(workers=8))
    assert queue.submitted == 200


@pytest.mark.parametrize("system", ["pbs", "lsf"])
def test_other_queueing_systems_run_jobs(queue_of, system):
    plan = {1: "lose"}
    queue = queue_of(plan, machine=MACHINE.replace("slurm", system), samples=1)
    check(queue, plan, run(workers=1))


ARRAYS = "arrays = true\n"


@pytest.mark.parametrize("system", ["slurm", "pbs", pytest.param("lsf", marks=pytest.mark.slow)])
def test_arrays_run_jobs(queue_of, system):
    plan = {1: "lose", 2: "late", 3: "kill"}
    queue = queue_of(plan, machine=MACHINE.replace("slurm", system) + ARRAYS, samples=3)
    check(queue, plan, run(workers=3))
    assert queue.arrays >= 1


@pytest.mark.slow
def test_arrays_of_200_jobs_with_24_faults(queue_of):
    faults = [fault for fault in ("kill-row", "kill", "lose", "late") for _ in range(6)]
    plan = random_plan(faults, 200)
    queue = queue_of(plan, machine=MACHINE + ARRAYS, samples=182)
    check(queue, plan, run(workers=8))
    assert queue.submitted == 200 and queue.arrays > 20


@pytest.mark.slow
def test_an_array_that_is_refused_is_submitted_again(queue_of):
    queue = queue_of({4: "refuse"}, machine=MACHINE + ARRAYS, samples=6)
    lines = []
    ds = run(workers=3, say=lines.append)
    assert any("'sbatch' refuses more jobs for now" in line for line in lines)
    assert len(queue.rows) == 6 and not queue.alive and ds.identical(computed_here(queue))


def test_the_tasks_of_an_array_are_cancelled_when_the_run_ends(queue_of, folder):
    queue = queue_of({1: "kill-row"}, machine=MACHINE + ARRAYS, samples=3)
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        run(workers=3)
    assert queue.arrays == 1 and not queue.alive


def test_an_interrupted_run_cancels_its_jobs_and_resumes(queue_of, folder):
    queue = queue_of(machine=MACHINE + "rows_per_job = 2\n", samples=4)

    command = ["run", "own.toml", "--model", "machine.toml", "-o", "own.nc", "--workers", "1"]
    process = subprocess.Popen(
        [sys.executable, "-m", "uq", *command], stderr=subprocess.PIPE, text=True
    )
    while not list(folder.glob("own.nc.rows/*.rows")) and process.poll() is None:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, lines = process.communicate(timeout=60)
    assert process.returncode == 130 and "resume" in lines.splitlines()[-1]
    assert not queue.alive and not list(folder.glob("pad.jobs*"))
    reused = []
    ds = run(workers=1, progress=lambda progress: reused.append(progress.reused))
    assert 2 <= reused[0] < 4 and not queue.alive
    assert ds.identical(computed_here(queue))


def test_a_row_whose_jobs_die_is_marked_and_says_so(queue_of, folder):
    queue = queue_of({1: "kill-row"}, samples=2)
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        ds = run(workers=2)
    assert sorted(ds["status"].values) == [Status.OK, Status.CRASHED]
    sentence = ds["status"].attrs["example_crashed"]
    assert "its job died each time: killed, or at its walltime 00:10:00; see" in sentence
    logs = Path(sentence.rpartition("; see ")[2])
    assert "Registered to" in (logs / "uq-pad-1.out").read_text()
    assert logs.stat().st_mode & 0o077 == 0 and not queue.alive
    assert not (logs / "rows").exists()


def test_a_row_that_fails_in_a_job_keeps_its_folder_and_says_where(queue_of, folder):
    queue_of(machine=MACHINE.replace("(", "(2"), samples=2)
    ds = run(workers=2)
    kept = Path(ds["status"].attrs["example_bad_shape"].rpartition("; see ")[2])
    assert kept.parent == folder / "pad.rows" and "life = " in (kept / "stdout.txt").read_text()
    assert not list(folder.glob("pad.jobs*"))
    rmtree(folder / "pad.rows")


WHERE = r'machine.toml: \[queue\] system = "slurm": '


def test_a_queue_that_refuses_all_jobs_ends_the_run(queue_of):
    queue_of(dict.fromkeys(range(1, 9), "refuse"))
    refusal = "'sbatch' refuses jobs: sbatch: error: QOSMaxSubmitJobPerUserLimit$"
    with pytest.raises(RunError, match=WHERE + refusal):
        run(workers=2)


def test_a_queue_that_refuses_further_jobs_is_said_once(queue_of, monkeypatch):
    monkeypatch.setattr(queues, "_LOOK_SECONDS", 0.2)
    queue = queue_of(dict.fromkeys(range(2, 6), "refuse"), samples=2)
    lines = []
    run(workers=2, say=lines.append)
    assert len([line for line in lines if "refuses more jobs for now: sbatch: error" in line]) == 1
    assert len(queue.rows) == 2


def test_a_queue_that_loses_all_jobs_ends_the_run(queue_of, monkeypatch):
    monkeypatch.setattr(queues, "_LOOK_SECONDS", 0.1)
    queue_of(dict.fromkeys(range(1, 31), "lose"))
    wasted = "10 jobs in succession ended before they could compute; their output is in "
    with pytest.raises(RunError, match=WHERE + wasted):
        run(workers=2)


def test_what_is_missing_for_a_queue_is_one_line(queue_of, monkeypatch):
    queue_of()
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "dask_jobqueue", None)
        with pytest.raises(InputError, match=WHERE[:-2] + r" needs .* 'vibrolife\[queue\]'$"):
            run(workers=2)
    monkeypatch.setenv("PATH", "/usr/bin:/bin")
    with pytest.raises(InputError, match=WHERE + "'sbatch' is not on the PATH; run uq where"):
        run(workers=2)


def test_a_network_that_does_not_exist_is_one_line(queue_of, folder):
    queue_of(machine=MACHINE.replace('"lo"', '"ib7"'))
    with pytest.raises(InputError, match=WHERE + ".*'ib7' is not a valid network interface") as no:
        run(workers=2)
    assert len(no.value.lines) == 1 and not list(folder.glob("pad.jobs*"))


MISTAKES = {
    ('"slurm"', '"slrum"'): '[queue] system = "slrum": no such queueing system; did you mean '
    "'slurm'? (allowed: slurm, pbs, lsf)",
    ('"1GB"', '"1"'): '[queue] memory = "1": must be a number with kB, MB, GB or TB',
    ('"1GB"', "1"): "[queue] memory = 1: must be a number with kB, MB, GB or TB",
    ('"00:10:00"', '"10 min"'): '[queue] walltime = "10 min": must be hours, minutes and seconds',
    ('"00:10:00"', "00:10:00"): "[queue] walltime = 00:10:00: must be hours, minutes",
    ('"00:10:00"', '"00:00:00"'): "must be hours, minutes and seconds, in quotes",
    ("cores = 2", "cores = 0"): "[queue] cores = 0: must be at least 1",
    ("cores = 2", "core = 2"): "[queue] core = 2: no such key; did you mean 'cores'?",
    ('walltime = "00:10:00"', ""): "[queue] walltime: is missing",
    ("cores = 2", 'partition = "a\\nb"'): '[queue] partition = "a\\nb": must be one line',
    ("[queue]", "[queues]"): "[queues]: no such table; did you mean 'queue'?",
}


@pytest.mark.parametrize("change", MISTAKES)
def test_a_mistake_in_the_table_is_one_line(folder, uq, change):
    write(folder, MACHINE.replace(*change))
    ended = uq("check", "own.toml", "--model", "machine.toml")
    assert (ended.code, ended.out) == (2, "")
    assert MISTAKES[change] in ended.err and ended.err.count("\n") == 1


def test_where_rows_are_computed_is_no_code_of_the_machine(folder):
    plain, table = MACHINE.split("[queue]")
    path = folder / "machine.toml"
    rest = '[parameters.depth]\nnominal = 1.0\ndirectives = [\n"a"]\n'
    for first, last in ((plain, ""), (plain.strip(), ""), (plain, f"\n\n{rest}")):
        path.write_text(f"{first}\n{last}")
        bare = content_of(path)
        path.write_text(f"{first}\n\n[queue]{table}{last}")
        assert content_of(path) == bare


def test_the_page_shows_every_key():
    page = (Path(package.__file__).parents[1] / "docs" / "clusters.md").read_text()
    table = re.search(r"```toml\n.*?\n(\[queue\].*?)```", page, re.DOTALL)[1]
    keys = tomllib.loads(table.replace("\n# ", "\n"))["queue"]
    assert set(QueueTable.model_validate(keys).model_fields_set) == set(QueueTable.model_fields)


TABLE = QueueTable(
    system="slurm",
    cores=8,
    nodes=2,
    memory="16GB",
    arrays=True,
    walltime="02:00:30",
    account="rods",
    directives=["-X"],
    prologue=["module load mpi"],
)
SCRIPTS = {
    "slurm": [
        "#SBATCH --cpus-per-task=8",
        "#SBATCH --nodes=2",
        "#SBATCH --ntasks-per-node=1",
        "#SBATCH --mem=15G",
        "#SBATCH -t 02:00:30",
        "#SBATCH -A rods",
        "#SBATCH -X",
    ],
    "pbs": [
        "#PBS -l select=2:ncpus=8:mem=15259MB",
        "#PBS -l walltime=02:00:30",
        "#PBS -A rods",
        "#PBS -X",
    ],
    "lsf": [
        "#BSUB -n 16",
        '#BSUB -R "span[ptile=8]"',
        "#BSUB -W 121",
        '#BSUB -P "rods"',
        "#BSUB -X",
    ],
}


@pytest.mark.parametrize("system", SCRIPTS)
def test_a_job_asks_for_cores_and_nodes_and_has_one_row_at_a_time(system):
    from dask_jobqueue.lsf import LSFJob
    from dask_jobqueue.pbs import PBSJob
    from dask_jobqueue.slurm import SLURMJob

    kind = {"slurm": SLURMJob, "pbs": PBSJob, "lsf": LSFJob}[system]
    options = queues.job_options(TABLE.model_copy(update={"system": system}), Path("/rods"))
    script = kind("tcp://here:1", name="a", **options).job_script()
    lines = script.splitlines()
    assert set(SCRIPTS[system]) <= set(lines) and "module load mpi" in lines
    assert "-n 1\n" not in script and "hosts=1" not in script
    assert "--nthreads 1 --memory-limit 0 --no-dashboard" in lines[-1]
    exports = next(line for line in lines if line.startswith("export OMP_NUM_THREADS=8 "))
    assert exports.endswith(" VIBROLIFE_ROWS_OF_JOB=/rods")
