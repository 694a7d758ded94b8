"""The processes that `--workers` and `--scheduler` ask for, and what a command says of them."""

from __future__ import annotations

import os
import time
from argparse import Namespace
from contextlib import AbstractContextManager

from tracer.experiments.cluster import Cluster, connected, local_cluster
from viewer.cli.arguments import Parser, count
from viewer.cli.console import Work


def add_processes(parser: Parser) -> None:
    """Add who does the work: processes of this machine, or those of a cluster."""
    add = parser.add_mutually_exclusive_group().add_argument
    add("--workers", type=count(1, 1024), metavar="N", help="so many processes of this machine, with one thread each")
    help_ = "the workers of a Dask scheduler that runs there, such as tcp://10.0.0.1:8786"
    add("--scheduler", metavar="ADDRESS", help=help_)


def cluster_of(options: Namespace, tasks: int) -> AbstractContextManager[Cluster]:
    """Start the processes that the options ask for; no more of this machine than there are tasks."""
    if options.scheduler is not None:
        return connected(options.scheduler)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return local_cluster(min(options.workers or cores, max(tasks, 1)))


class Watch:
    """Says how many processes there are, and when one has died, as they were when it last looked: once a second."""

    EVERY = 1.0

    def __init__(self, cluster: Cluster, work: Work) -> None:
        self._cluster, self._work, self._known = cluster, work, set(cluster.process_ids())
        self._started, self._next = 0, 0.0

    def look(self, at_once: bool = False) -> None:
        """Note which processes have died since."""
        if time.monotonic() < self._next and not at_once:
            return
        self._next, self._started = time.monotonic() + self.EVERY, self._cluster.started()
        now = set(self._cluster.process_ids())
        for number in self._known - now:
            self._work.note(f"process {number} has died; another takes its place, and does its task again")
        self._known = now

    def __str__(self) -> str:
        started = self._started
        size = self._cluster.size() if self._cluster.is_local else started
        if not started:
            return "waiting for workers"
        return f"{started} of {size} workers" if started < size else f"{size} worker{'s' * (size > 1)}"
