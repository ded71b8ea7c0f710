"""Rows computed by the jobs of a queueing system: SLURM, PBS or LSF, through dask-jobqueue [1]_.

A job is a dask worker that computes one chunk of rows and ends. Jobs that end, are killed or lost
are replaced while rows are left; dask sends the rows of a job that died to another.

References
----------
.. [1] https://jobqueue.dask.org
"""

import asyncio
import getpass
import re
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from math import ceil
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any

import dask
from dask.utils import parse_bytes
from distributed.diagnostics.plugin import SchedulerPlugin
from distributed.security import Security

from uq.errors import InputError, RunError, one_line
from uq.execution.clusters import client_of
from uq.execution.environment import inherited
from uq.execution.options import Say
from uq.execution.workers import Workers, quiet
from uq.files.interrupts import undone
from uq.machines.queue_table import QueueTable
from uq.machines.row_resources import ROWS_OF_JOB
from uq.result.workload import Workload

if TYPE_CHECKING:
    from dask_jobqueue.core import Job, JobQueueCluster

_LOOK_SECONDS = 15.0  # between looks at the queue, and between tries where it refused jobs
_COMMAND_SECONDS = 60.0
_AT_ONCE = 10  # jobs submitted together
_REFUSALS = 3  # in succession, without any job left
_WASTED = 10  # jobs in succession that ended before they could compute

_LISTINGS = {
    "slurm": ("squeue", "--noheader", "--array", "--format=%i", "--user"),
    "pbs": ("qselect", "-u"),
    "lsf": ("bjobs", "-noheader", "-o", "jobid jobindex", "-u"),
}
"""Commands that print the numbers of the jobs of a user that wait or run, and of their tasks: such
as ``12_3``, ``12 3``, and for PBS only ``12[]``."""

_ARRAYS = {
    "slurm": ("--array=1-{}", "$SLURM_ARRAY_TASK_ID", "{}_{}"),
    "pbs": ("-J 1-{}", "$PBS_ARRAY_INDEX", "{}[{}]"),
    "lsf": ("", "$LSB_JOBINDEX", "{}[{}]"),
}
"""Option that makes a job an array of tasks, the index of a task in it, and the number by which a
task is cancelled. Of LSF, the name of a job says that it is an array."""

_SCHEDULER = {
    "distributed.scheduler.http.routes": [],
    "distributed.scheduler.worker-saturation": 1.0,  # no row waits behind another
}
_SERVER: dict[str, Any] = {
    "scheduler_options": {"dashboard": False, "dashboard_address": ":0"},
    "silence_logs": "critical",
}


@contextmanager
def queued_workers(
    table: QueueTable, jobs: int, workload: Workload, row_limit: float | None, say: Say
) -> Iterator[Workers]:
    """Have rows computed by jobs, which are cancelled in the end.

    Parameters
    ----------
    table : QueueTable
    jobs : int
        At the same time.
    workload, row_limit
        As for `uq.execution.workers.Workers`.
    say : callable
        Called with a line for the user when the queue refuses further jobs.

    Yields
    ------
    Workers

    Raises
    ------
    InputError
        When dask-jobqueue or the commands of the queueing system are missing.
    """
    file = Path(workload.model_reference)
    where = f'{file}: [queue] system = "{table.system}"'
    if " " in str(file):
        raise InputError(f"{file}: the files of a job cannot be in a folder with blanks")
    kind = _kind_of_cluster(table.system, where)
    logs = Path(tempfile.mkdtemp(prefix=f"{workload.model.name}.jobs-", dir=file.parent))  # private
    rows = logs / "rows"
    rows.mkdir()
    death = f"its job died each time: killed, or at its walltime {table.walltime}; see {logs}"
    options = _SERVER | {"log_directory": str(logs), "security": _secured(logs)}
    crew: Workers | None = None
    queue: _Queue | None = None

    def tidy() -> None:
        lost = (crew.given_up if crew is not None else 0) + (queue.wasted if queue else 0)
        shutil.rmtree(rows if lost else logs, ignore_errors=True)

    with ExitStack() as stack:
        stack.enter_context(undone(tidy))  # a cluster makes the folder again when it closes
        stack.enter_context(quiet())
        stack.enter_context(dask.config.set(_SCHEDULER))
        try:
            job = job_options(table, rows) | {"job_name": f"uq-{workload.model.name}"}
            cluster = stack.enter_context(kind(**options, **job))
        except (RuntimeError, ValueError) as error:  # such as of its interface
            raise InputError(f"{where}: {one_line(error)}") from None
        queue = _Queue(cluster, table, jobs, where, say)
        client = stack.enter_context(client_of(cluster))
        crew = Workers(client, workload, row_limit, keep_up=queue.keep_up, death=death)
        stack.enter_context(undone(queue.end))
        yield crew


def _kind_of_cluster(system: str, where: str) -> Any:
    """Return the cluster of a queueing system whose commands are installed."""
    on_interrupt = signal.getsignal(signal.SIGINT)
    try:
        import cryptography  # noqa: F401  (makes the certificates)
        import dask_jobqueue
    except ImportError:
        raise InputError(f"{where} needs dask-jobqueue: pip install 'vibrolife[queue]'") from None
    signal.signal(signal.SIGINT, on_interrupt)  # which dask-jobqueue replaces
    kind: Any = getattr(dask_jobqueue, f"{system.upper()}Cluster")
    for command in (kind.job_cls.submit_command, _LISTINGS[system][0]):
        if not shutil.which(command):
            raise InputError(
                f"{where}: '{command}' is not on the PATH; run uq where jobs are submitted, or"
                " here with --workers 0"
            )
    return kind


def _secured(folder: Path) -> Security:
    """Return certificates with which jobs reach this process; whoever reads the folder can, too."""
    made = Security.temporary()
    files = {"key": folder / "key.pem", "cert": folder / "cert.pem"}
    files["key"].write_text(made.tls_worker_key)
    files["cert"].write_text(made.tls_worker_cert)
    roles = {
        f"tls_{role}_{kind}": str(file)
        for role in ("scheduler", "worker", "client")
        for kind, file in files.items()
    }
    return Security(require_encryption=True, tls_ca_file=str(files["cert"]), **roles)


def job_options(table: QueueTable, rows: Path) -> dict[str, Any]:
    """Return the options of a cluster of dask-jobqueue with one worker of one thread per job.

    Parameters
    ----------
    table : QueueTable
    rows : Path
        Folder in which jobs compute their rows.
    """
    cores, nodes = table.cores, table.nodes
    options: dict[str, Any] = {"walltime": table.walltime, "account": table.account or None}
    directives, skipped = list[str](), list[str]()
    if table.system == "pbs":
        memory = ceil(parse_bytes(table.memory) / 2**20)
        options["resource_spec"] = f"select={nodes}:ncpus={cores}:mem={memory}MB"
    elif table.system == "slurm" and nodes > 1:
        directives, skipped = [f"--nodes={nodes}", "--ntasks-per-node=1"], ["-n 1"]
    elif table.system == "lsf":
        hours, minutes, seconds = map(int, table.walltime.split(":"))
        minutes += 60 * hours + ceil(seconds / 60)
        options = {"walltime": str(minutes), "project": options["account"]}
        options["ncpus"] = nodes * cores
        if nodes > 1:
            directives, skipped = [f'-R "span[ptile={cores}]"'], ["span[hosts=1]"]
    return options | {
        "cores": cores,
        "memory": table.memory,
        "processes": 1,
        "nanny": False,
        "queue": table.partition or None,
        "interface": table.interface or None,
        "job_extra_directives": [*directives, *table.directives],
        "job_directives_skip": skipped,
        "job_script_prologue": [
            f"export OMP_NUM_THREADS={cores} PYTHONPATH={quote(inherited()['PYTHONPATH'])}"
            f" {ROWS_OF_JOB}={quote(str(rows))}",
            *table.prologue,
        ],
        # The last of two options counts: cores and memory are those of the program.
        "worker_extra_args": ["--nthreads", "1", "--memory-limit", "0", "--no-dashboard"],
    }


class _Queue(SchedulerPlugin):
    """The jobs of a run: submitted, watched and cancelled.

    Parameters
    ----------
    cluster : dask_jobqueue.JobQueueCluster
        With a scheduler to which the jobs connect; it starts none itself.
    table : QueueTable
    most : int
        Jobs at the same time.
    where : str
        The table of the machine file, for messages.
    say : callable
        Called with a line for the user.

    Attributes
    ----------
    wasted : int
        Jobs in succession that ended before they could compute.
    """

    def __init__(
        self, cluster: "JobQueueCluster", table: QueueTable, most: int, where: str, say: Say
    ) -> None:
        self._cluster, self._say = cluster, say
        self._job_class, self._options = cluster.new_spec["cls"], cluster.new_spec["options"]
        self._table, self._most, self._where = table, most, where
        # That wait or run, by the name of their worker, with the index of the task in an array.
        self._jobs: dict[str, tuple[Job, str]] = {}
        self._names: dict[str, str] = {}  # of workers, by address
        self._connected, self._ended = set[str](), set[str]()
        self._number = self.wasted = self._refusals = 0
        self._told = False  # that the queue refuses further jobs
        self._look = self._submit = 0.0  # times of the next ones
        self._submitting = asyncio.Lock()
        scheduler: Any = cluster.scheduler
        scheduler.add_plugin(self, name=f"uq-{id(self)}")

    def add_worker(self, scheduler: Any, worker: str) -> None:
        """Note that the worker of a job has connected."""
        name = self._names[worker] = str(scheduler.workers[worker].name)
        self._connected.add(name)
        self.wasted = 0

    def remove_worker(self, scheduler: Any, worker: str, **how: Any) -> None:
        """Note that the worker of a job has left or died."""
        self._ended.add(self._names.pop(worker, ""))

    def keep_up(self, wanted: int) -> None:
        """Replace jobs that have ended, as many as are wanted.

        Raises
        ------
        RunError
            When the queue refuses jobs, or all end before they compute.
        """
        self._drop([name for name in self._jobs if name in self._ended])
        now = time.monotonic()
        if now >= self._look:
            self._look = now + _LOOK_SECONDS
            self._drop_lost()
        missing = min(min(wanted, self._most) - len(self._jobs), _AT_ONCE)
        if missing > 0 and now >= self._submit:
            self._add(missing)

    def _drop_lost(self) -> None:
        """Drop jobs that have not connected and are not in the queue any more."""
        waiting = [name for name in self._jobs if name not in self._connected]
        if not waiting:
            return
        listed = self._run(*_LISTINGS[self._table.system], getpass.getuser())
        if listed is None:  # the queue does not answer: nothing is known about its jobs
            return
        pairs = re.findall(r"^\s*(\d+)(?:[_[ ]+0*(\d*))?", listed, re.MULTILINE)
        numbers = {pair for job, index in pairs for pair in ((job, index), (job, ""))}
        by_task = self._table.system != "pbs"
        jobs = {name: (job.job_id, index * by_task) for name, (job, index) in self._jobs.items()}
        lost = [name for name in waiting if jobs[name] not in numbers]
        lost = [name for name in lost if name not in self._connected]  # meanwhile
        self._drop(lost)
        self.wasted += len(lost)
        if self.wasted >= _WASTED:
            raise RunError(
                f"{self._where}: {self.wasted} jobs in succession ended before they could compute;"
                f" their output is in {self._options['log_directory']}"
            )

    def _add(self, count: int) -> None:
        """Submit jobs, or an array of them."""
        size = count if self._table.arrays else 1
        new = {}
        for _ in range(0, count, size):
            self._number += 1
            name = f"{self._cluster.name}-{self._number}"
            options = self._options if size == 1 else self._options | self._of_array(name, size)
            job = self._job_class(self._cluster.scheduler_address, name=name, **options)
            tasks = {f"{name}-{i}": (job, str(i)) for i in range(1, size + 1)}
            new[job] = tasks if size > 1 else {name: (job, "")}
            self._jobs |= new[job]
        outcomes = self._cluster.sync(self._submitted, list(new))
        refused = [pair for pair in zip(new, outcomes, strict=True) if pair[1]]
        for job, _ in refused:
            for name in new[job]:
                del self._jobs[name]
        if not refused:
            self._refusals = 0
            return
        self._submit = time.monotonic() + _LOOK_SECONDS
        first = self._number == len(refused)
        command, reason = self._job_class.submit_command, _reason(refused[0][1])
        if self._jobs:
            if not self._told:
                self._say(f"{self._where}: '{command}' refuses more jobs for now: {reason}")
            self._told = True
            return
        self._refusals += 1
        if first or self._refusals >= _REFUSALS:
            raise RunError(f"{self._where}: '{command}' refuses jobs: {reason}")

    def _of_array(self, name: str, size: int) -> dict[str, Any]:
        """Return the options of a job that is an array of tasks, each with a worker of its own."""
        directive, index, _ = _ARRAYS[self._table.system]
        options = self._options
        return {
            "job_name": options["job_name"] + ("" if directive else f"[1-{size}]"),
            "job_extra_directives": [
                *([directive.format(size)] if directive else []),
                *options["job_extra_directives"],
            ],
            "worker_extra_args": [*options["worker_extra_args"], "--name", f"{name}-{index}"],
        }

    async def _submitted(self, jobs: "list[Job]") -> list[BaseException | None]:
        """Submit jobs; return what each of them failed with."""
        async with self._submitting:
            return await asyncio.gather(*(job.start() for job in jobs), return_exceptions=True)

    def end(self) -> None:
        """Cancel all jobs."""
        if self._jobs:
            self._cluster.sync(self._submitted, [])  # waits for those under way
            self._drop(list(self._jobs))

    def _drop(self, names: list[str]) -> None:
        """Cancel jobs, also those that seem to have ended."""
        jobs = [self._jobs.pop(name) for name in names]
        task = _ARRAYS[self._table.system][2]
        if numbers := [
            task.format(job.job_id, index) if index else job.job_id
            for job, index in jobs
            if job.job_id
        ]:
            self._run(self._job_class.cancel_command, *numbers)

    def _run(self, *command: str) -> str | None:
        """Return the output of a command of the queueing system, or None if it failed."""
        try:
            ended = subprocess.run(
                command, capture_output=True, text=True, timeout=_COMMAND_SECONDS
            )
        except (OSError, subprocess.TimeoutExpired):
            return None
        return None if ended.returncode and _NO_JOBS not in ended.stderr else ended.stdout


_NO_JOBS = "No unfinished job"  # of LSF, which calls it an error


def _reason(error: BaseException) -> str:
    """Return the last line that a refusing command wrote."""
    written = str(error).rpartition("stderr:")[2].strip().splitlines()
    return written[-1].strip() if written else one_line(error)
