"""A dask cluster of somebody else, for tests of what a run does with one."""

import contextlib
import logging
import tempfile

import dask
from distributed import LocalCluster


@contextlib.contextmanager
def dask_cluster(workers=1):
    """Yield the address of a scheduler with some workers, in threads of this process."""
    with (
        tempfile.TemporaryDirectory() as folder,
        dask.config.set({"temporary-directory": folder}),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=False,
            protocol="tcp",
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            scheduler_kwargs={"dashboard": False},
            silence_logs=logging.CRITICAL,
        ) as cluster,
    ):
        yield cluster.scheduler_address
