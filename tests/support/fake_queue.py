"""A queue on this computer: jobs are real, and a plan says which of them go wrong.

It has the commands of SLURM, PBS and LSF; its folder is in the environment. The tasks of an array
are numbered like jobs. A plan is a JSON object: number of a job -> what happens to it.

    refuse      it is not accepted
    lose        it is accepted, and never heard of again
    late        it starts after seconds
    kill        it is killed when it starts, before a worker can connect
    kill-row    it is killed in the middle of a row, for which its program waits while there is a
                file ``hold/NUMBER``
"""

import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

FOLDER = "FAKE_QUEUE"
INDICES = ("SLURM_ARRAY_TASK_ID", "PBS_ARRAY_INDEX", "LSB_JOBINDEX")
LATE_SECONDS = 1.0
_POLL_SECONDS = 0.02


class FakeQueue:
    """The queue as a test sees it.

    Parameters
    ----------
    folder : Path
        Empty, for its state; its commands are in ``folder / "bin"``.
    plan : dict of int to str
        Number of a job, from 1 -> fault.
    """

    def __init__(self, folder, plan):
        self.folder = folder
        for name in ("bin", "alive", "begun", "done", "hold"):
            (folder / name).mkdir(parents=True)
        (folder / "plan.json").write_text(json.dumps(plan))
        (folder / "number").write_text("0")
        for command in COMMANDS:
            path = folder / "bin" / command
            path.write_text(f'#!/bin/sh\nexec {sys.executable} -S {__file__} {command} "$@"\n')
            path.chmod(0o755)

    def environment(self, path):
        """Return the variables with which its commands are called."""
        return {FOLDER: str(self.folder), "PATH": f"{self.folder / 'bin'}{os.pathsep}{path}"}

    @property
    def submitted(self):
        """Number of jobs that were submitted, those refused among them."""
        return int((self.folder / "number").read_text())

    @property
    def faults(self):
        """Kind of fault -> how often it came to pass."""
        return Counter((self.folder / "faults.txt").read_text().split())

    @property
    def alive(self):
        """Names of the jobs that wait or run: a number, with an index in an array."""
        return [path.name for path in (self.folder / "alive").iterdir()]

    @property
    def arrays(self):
        """Number of arrays that were submitted."""
        return len({path.name.partition("_")[0] for path in self.folder.glob("job-*_*.sh")})

    @property
    def rows(self):
        """What the program of the test wrote for each row that it completed."""
        return [path.read_text().strip() for path in (self.folder / "done").iterdir()]


_ARRAY = re.compile(rb"^#(?:SBATCH --array=|PBS -J |BSUB -J \S+\[)1-(\d+)", re.MULTILINE)


def _submit(folder, script="/dev/stdin"):
    text = Path(script).read_bytes()
    array = _ARRAY.search(text)
    tasks = int(array[1]) if array else 1
    with (folder / "number").open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        first = int(file.read()) + 1
        file.seek(0)
        file.write(str(first + tasks - 1))
    plan = json.loads((folder / "plan.json").read_text())
    faults = [plan.get(str(first + i), "") for i in range(tasks)]
    for fault in faults:
        if fault in ("refuse", "lose", "late"):
            _note(folder, fault)
    if "refuse" in faults:
        sys.exit("sbatch: error: QOSMaxSubmitJobPerUserLimit")
    print(f"Submitted batch job {first}{'[]' if array else ''}")
    for i, fault in enumerate(faults):
        if fault == "lose":
            continue
        if fault == "kill-row":
            (folder / "hold" / str(first + i)).touch()
        name = f"{first}_{i + 1}" if array else str(first)
        job = folder / f"job-{name}.sh"
        job.write_bytes(text)
        command = [sys.executable, __file__, "run", str(job), str(first + i), fault, name]
        nowhere = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        runner = subprocess.Popen(command, start_new_session=True, **nowhere)
        (folder / "alive" / name).write_text(str(runner.pid))


def _run(folder, job, number, fault, name):
    import psutil

    alive, begun = folder / "alive" / name, folder / "begun" / number
    text, process = Path(job).read_text(), None

    def end(*_):
        with suppress(AttributeError, psutil.NoSuchProcess):
            family = psutil.Process(process.pid).children(recursive=True)
            os.killpg(process.pid, signal.SIGKILL)  # also what it is just starting
            for member in family:
                with suppress(psutil.NoSuchProcess):
                    member.kill()
            process.wait()
        while not alive.exists():  # it has not been written
            time.sleep(_POLL_SECONDS)
        alive.unlink()
        os._exit(0)

    signal.signal(signal.SIGTERM, end)
    if fault == "late":
        time.sleep(LATE_SECONDS)
    output = re.search(r"#[A-Z]+ -o (\S+)", text)[1].replace("%J", number)
    with open(output + f"o{number}" * output.endswith("/"), "wb") as log:
        index = dict.fromkeys(INDICES, name.partition("_")[2])
        environment = os.environ | {"JOB": number} | index
        process = subprocess.Popen(
            ["bash", job], stdout=log, stderr=log, env=environment, start_new_session=True
        )
    if fault == "kill":
        _note(folder, fault)
        end()
    while process.poll() is None:
        if fault == "kill-row" and begun.exists():
            _note(folder, fault)
            end()
        time.sleep(_POLL_SECONDS)
    end()


def _note(folder, fault):
    with (folder / "faults.txt").open("a") as file:
        file.write(f"{fault}\n")


def _listing(written):
    def print_jobs(folder, *_):
        names = [path.name.partition("_") for path in (folder / "alive").iterdir()]
        print("\n".join({written(job, index) for job, _, index in names}))

    return print_jobs


def _cancel(folder, *numbers):
    for number in numbers:
        name = number.replace("[", "_").rstrip("]")
        for path in [folder / "alive" / name, *(folder / "alive").glob(f"{name}_*")]:
            with suppress(OSError, ValueError):
                os.kill(int(path.read_text()), signal.SIGTERM)


COMMANDS = {
    **dict.fromkeys(("sbatch", "qsub", "bsub"), _submit),
    "squeue": _listing(lambda job, index: f"{job}_{index}" if index else job),
    "qselect": _listing(lambda job, index: f"{job}[].here" if index else f"{job}.here"),
    "bjobs": _listing(lambda job, index: f"{job}     {index or 0}"),
    **dict.fromkeys(("scancel", "qdel", "bkill"), _cancel),
}

if __name__ == "__main__":
    command, *arguments = sys.argv[1:]
    (COMMANDS | {"run": _run})[command](Path(os.environ[FOLDER]), *arguments)
