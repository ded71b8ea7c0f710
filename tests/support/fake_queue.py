"""A queue on this computer: jobs are real, and a plan says which of them go wrong.

It has the commands of SLURM, PBS and LSF; its folder is in the environment. A plan is a JSON
object: number of a job -> what happens to it.

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
        """Numbers of the jobs that wait or run."""
        return [int(path.name) for path in (self.folder / "alive").iterdir()]

    @property
    def rows(self):
        """What the program of the test wrote for each row that it completed."""
        return [path.read_text().strip() for path in (self.folder / "done").iterdir()]


def _submit(folder, script="/dev/stdin"):
    with (folder / "number").open("r+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        number = int(file.read()) + 1
        file.seek(0)
        file.write(str(number))
    fault = json.loads((folder / "plan.json").read_text()).get(str(number), "")
    if fault in ("refuse", "lose", "late"):
        _note(folder, fault)
    if fault == "refuse":
        sys.exit("sbatch: error: QOSMaxSubmitJobPerUserLimit")
    print(f"Submitted batch job {number}")
    if fault == "lose":
        return
    if fault == "kill-row":
        (folder / "hold" / str(number)).touch()
    job = folder / f"job-{number}.sh"
    job.write_bytes(Path(script).read_bytes())
    command = [sys.executable, __file__, "run", str(job), str(number), fault]
    nowhere = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
    runner = subprocess.Popen(command, start_new_session=True, **nowhere)
    (folder / "alive" / str(number)).write_text(str(runner.pid))


def _run(folder, job, number, fault):
    import psutil

    alive, begun = folder / "alive" / number, folder / "begun" / number
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
        environment = os.environ | {"JOB": number}
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


def _list(folder, *_):
    print("\n".join(path.name for path in (folder / "alive").iterdir()))


def _cancel(folder, *numbers):
    for number in numbers:
        with suppress(OSError, ValueError):
            os.kill(int((folder / "alive" / number).read_text()), signal.SIGTERM)


COMMANDS = {
    **dict.fromkeys(("sbatch", "qsub", "bsub"), _submit),
    **dict.fromkeys(("squeue", "qselect", "bjobs"), _list),
    **dict.fromkeys(("scancel", "qdel", "bkill"), _cancel),
}

if __name__ == "__main__":
    command, *arguments = sys.argv[1:]
    (COMMANDS | {"run": _run})[command](Path(os.environ[FOLDER]), *arguments)
