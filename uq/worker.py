"""One dask worker process of a local cluster: ``python -m uq.worker ADDRESS FOLDER``.

Its standard input is a pipe from the process that started it. When that process ends, however it
ends, the pipe closes; then the worker removes their temporary folder and stops.
"""

import asyncio
import os
import shutil
import sys
import threading


def main(address: str, folder: str) -> None:
    """Serve the scheduler at `address` until the parent process is gone."""
    threading.Thread(target=_stop_with_parent, args=(folder,), daemon=True).start()
    asyncio.run(_serve(address, folder))


def _stop_with_parent(folder: str) -> None:
    # From the file descriptor: a thread inside sys.stdin would hold its lock for ever.
    while os.read(sys.stdin.fileno(), 1024):
        pass
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)


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
