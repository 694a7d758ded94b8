"""Processes that share work through Dask: of this machine, started for it alone, or those of a scheduler that runs.

Processes of this machine have one thread each, listen to this machine only, take work from nobody without the keys that
were made for them, and end with the process that started them, however that ends.
"""

from __future__ import annotations

import logging
import os
import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

from tracer.runtime.kernel_cache import cache_root

NEEDS_DASK = "Dask is not installed; install shadowcull[sweep] (pip install distributed pyarrow cryptography)"
CONNECT = 10.0  # seconds to wait for a scheduler's answer
_QUIET = ("distributed", "tornado", "asyncio")


def check_dask() -> None:
    """Raise ValueError, in one line, where what a cluster or its results need is not installed."""
    try:
        import cryptography
        import distributed
        import pyarrow.parquet
    except ImportError as error:
        raise ValueError(f"{NEEDS_DASK} ({error})") from None
    del cryptography, distributed, pyarrow


def in_one_line(error: BaseException) -> str:
    """Return an exception as one line; its kind is named unless the message speaks for itself."""
    text = " ".join(str(error).split())
    return text if text and isinstance(error, ValueError | OSError) else f"{type(error).__name__}: {text}"


class Cluster:
    """A client of processes that work; `local` are those of this machine, or None."""

    def __init__(self, client: Any, local: Any = None, workers: int = 0) -> None:
        self.client, self._local, self._workers = client, local, workers

    @property
    def is_local(self) -> bool:
        """Whether the processes were started for this work."""
        return self._local is not None

    def size(self) -> int:
        """How many processes there are, or will be as soon as they have started."""
        return self._workers if self.is_local else self.started()

    def started(self) -> int:
        """How many processes can work now."""
        return len(self.client.scheduler_info(n_workers=-1)["workers"])

    def process_ids(self) -> list[int]:
        """Of the processes of this machine, those that run now."""
        found = [nanny.pid for nanny in self._local.workers.values()] if self.is_local else []
        return [number for number in found if number is not None]

    def kill(self) -> None:
        """End the processes of this machine at once; what they do is lost."""
        if not self.is_local:
            return
        for nanny in list(self._local.workers.values()):
            number = nanny.pid
            if number is not None:
                with suppress(ProcessLookupError):
                    os.kill(number, getattr(signal, "SIGKILL", signal.SIGTERM))  # Windows ends it by either


@contextmanager
def local_cluster(workers: int) -> Iterator[Cluster]:
    """So many processes of this machine, which start while the caller goes on."""
    import dask
    from distributed import Client, LocalCluster, Security

    with ExitStack() as stack:
        stack.enter_context(dask.config.set(_settings()))
        stack.enter_context(_silence())
        with _interrupts_blocked():  # what starts here, and all processes that it starts, know no Ctrl-C
            cluster = LocalCluster(
                n_workers=0,
                threads_per_worker=1,
                host="127.0.0.1",
                protocol="tls://",
                security=Security.temporary(),
                dashboard_address="127.0.0.1:0",  # with None it would be port 8787
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
                memory_limit=0,
            )
            client = Client(cluster, set_as_default=False)
            cluster.scale(workers)
        found = Cluster(client, cluster, workers)
        try:
            yield found
        finally:
            found.kill()
            with suppress(Exception):  # it has lost its workers, which is what was wanted
                client.close(timeout=2)
            with suppress(Exception):
                cluster.close(timeout=10)


@contextmanager
def connected(address: str) -> Iterator[Cluster]:
    """The processes of a scheduler; raises OSError, in one line, where it does not answer.

    Keys for `tls://` are Dask's to know (its files, or DASK_DISTRIBUTED__COMM__TLS__...)."""
    import dask
    from distributed import Client

    with dask.config.set({"distributed.admin.large-graph-warning-threshold": "10GB"}), _silence():
        try:
            client = Client(address, timeout=CONNECT, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise OSError(f"--scheduler {address}: no Dask scheduler answers there: {in_one_line(error)}") from None
        try:
            yield Cluster(client)
        finally:
            with suppress(Exception):
                client.close(timeout=2)


def _settings() -> dict[str, Any]:
    """How Dask behaves; everything of a user's own that is not named here still holds."""
    return {
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
        "distributed.admin.large-graph-warning-threshold": "10GB",  # scenes are part of the graph
        "distributed.scheduler.rootish-taskgroup": 1_000_000,  # scenes are few: tasks are handed out one by one
        "distributed.scheduler.rootish-taskgroup-dependencies": 1_000_000,
        "distributed.worker.daemon": True,
        "distributed.nanny.pre-spawn-environ": {
            "SHADOWCULL_CACHE_DIR": str(cache_root()),
            "OMP_NUM_THREADS": "1",
            "MKL_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        },
    }


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Ctrl-C reaches all processes of a terminal.  A mask is inherited by every thread and process that is started
    meanwhile, and by those that they start later."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _silence() -> Iterator[None]:
    """Dask's own log would stand between lines for people: what matters comes as exceptions."""
    loggers = [logging.getLogger(name) for name in _QUIET]
    before = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, before):
            logger.setLevel(level)
