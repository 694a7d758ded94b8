"""The processes that `--workers` and `--scheduler` ask for, and what a command says of them."""

from __future__ import annotations

import os
from argparse import Namespace
from contextlib import AbstractContextManager

from viewer.cli.console import Work
from viewer.services.cluster import Cluster, connected, local_cluster


def cluster_of(options: Namespace, tasks: int) -> AbstractContextManager[Cluster]:
    """The processes that the options ask for; no more of this machine than there are tasks."""
    if options.scheduler is not None:
        return connected(options.scheduler)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return local_cluster(min(options.workers or cores, max(tasks, 1)))


class Watch:
    """Says how many processes there are, and when one has died."""

    def __init__(self, cluster: Cluster, work: Work) -> None:
        self._cluster, self._work, self._known = cluster, work, set(cluster.process_ids())

    def look(self) -> None:
        """Note which processes have died since."""
        now = set(self._cluster.process_ids())
        for number in self._known - now:
            self._work.note(f"process {number} has died; another takes its place, and does its task again")
        self._known = now

    def __str__(self) -> str:
        started, size = self._cluster.started(), self._cluster.size()
        if not started:
            return "waiting for workers"
        return f"{started} of {size} workers" if started < size else f"{size} worker{'s' * (size > 1)}"
