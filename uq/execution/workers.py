"""Dask workers as a run sees them, whoever started them."""

import gc
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

from distributed import Client
from distributed.utils import silence_logging_cmgr

_COUNT_SECONDS = 1.0


class Workers:
    """Workers that are connected, or about to be.

    Attributes
    ----------
    client : distributed.Client
    run : str
        Whose processes compute, as in `uq.execution.dask_task.evaluate_rows`; "" on an existing
        cluster.
    """

    def __init__(
        self,
        client: Client,
        watch: Callable[[int, bool], None] = lambda *_: None,
        run: str = "",
    ) -> None:
        self.client = client
        self.run = run
        self._watch = watch
        self._threads, self._counted = 0, 0.0

    @property
    def connected(self) -> bool:
        """Whether the scheduler can be reached."""
        return bool(self.client.status == "running")

    @property
    def dashboard(self) -> str:
        """Address of the dashboard of an existing cluster, or ""."""
        if self.run:  # nothing is behind the address that dask reports
            return ""
        try:
            return str(self.client.dashboard_link or "")
        except (KeyError, OSError):  # no dashboard, or the scheduler has just gone
            return ""

    @property
    def threads(self) -> int:
        """Tasks that can run at the same time: none until a worker connects.

        They are counted at most once a second, once there are any: the scheduler lists all workers.
        """
        if not self.connected:
            return 0
        if not self._threads or time.monotonic() > self._counted + _COUNT_SECONDS:
            try:
                self._threads = sum(self.client.nthreads().values())
            except OSError:  # the scheduler has just gone
                return 0
            self._counted = time.monotonic()
        return self._threads

    def watch(self, progress: bool = False) -> None:
        """See whether there are workers; to be called regularly.

        Parameters
        ----------
        progress : bool
            Whether a worker has delivered something since the last call.

        Raises
        ------
        RunError
            When no workers are to be expected.
        """
        self._watch(self.threads, progress)


@contextmanager
def quiet() -> Iterator[None]:
    """Keep the log of dask off the terminal: workers that come and go do not matter to the user."""
    log = logging.getLogger("asyncio")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        with ExitStack() as stack:
            for logger in ("distributed", "distributed.client", "distributed.gc"):
                stack.enter_context(silence_logging_cmgr(logging.CRITICAL, logger))
            yield
    finally:
        gc.collect()  # after an interruption: objects never awaited complain when collected
        log.setLevel(level)
