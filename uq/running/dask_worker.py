"""One dask worker process of a local cluster: ``python -m uq.running.dask_worker FOLDER``.

It starts before the scheduler: the child that will compute its rows starts at once, and the address
of the scheduler comes through its standard input, a pipe from its parent. When the parent ends, for
whatever reason, the pipe closes; then the worker removes their temporary folder and stops.
"""

import asyncio
import os
import pickle
import shutil
import sys
from pathlib import Path

from uq.running.child import end_with_parent
from uq.running.dask_task import begin_child

WANTED = "wanted"
"""File in the folder: the model and the time limit of its rows, as `begin_child` takes them."""

_GOODBYE_SECONDS = 2.0


def main(folder: str) -> None:
    """Serve the scheduler until the parent process is gone."""
    wanted = Path(folder) / WANTED
    if wanted.exists():
        begin_child(*pickle.loads(wanted.read_bytes()))
    import distributed  # noqa: F401  (while the scheduler starts)

    address = os.read(0, 1024).decode()
    guard = end_with_parent(lambda: shutil.rmtree(folder, ignore_errors=True))
    try:
        asyncio.run(_serve(address, folder))
    finally:  # the scheduler lives in the parent: if it is gone, the folder must be removed
        guard.join(_GOODBYE_SECONDS)


async def _serve(address: str, folder: str) -> None:
    from distributed import Worker

    worker = Worker(
        address,
        host="127.0.0.1",
        nthreads=1,
        memory_limit=0,
        dashboard=False,
        local_directory=folder,
    )
    async with worker:
        await worker.finished()


if __name__ == "__main__":
    main(*sys.argv[1:])
