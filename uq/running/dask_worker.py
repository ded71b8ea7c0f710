"""One dask worker process of a local cluster: ``python -m uq.running.dask_worker FOLDER``.

It starts before the scheduler. Its standard input is a pipe from its parent: through it comes what
`begin_child` takes, or None, and then the address of the scheduler. When the parent ends, for
whatever reason, the pipe closes; then the worker removes their temporary folder and stops.
"""

import asyncio
import os
import shutil
import sys
from multiprocessing.connection import Connection

from uq.running.child import end_with_parent
from uq.running.dask_task import begin_child

_GOODBYE_SECONDS = 2.0


def main(folder: str) -> None:
    """Serve the scheduler until the parent process is gone."""
    parent = Connection(os.dup(0), writable=False)
    try:
        if wanted := parent.recv():
            begin_child(*wanted)
        import distributed  # noqa: F401  (while the scheduler starts)

        address = parent.recv()
    except EOFError:
        shutil.rmtree(folder, ignore_errors=True)
        return
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
