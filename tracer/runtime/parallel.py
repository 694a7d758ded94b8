"""Sharing work among threads: kernels run free of the GIL, so plain Python threads are enough.

Workers take the next chunk when they are done with one.  Which worker does which chunk is chance;
whatever a worker adds up must therefore not depend on order (sums of integers, OR of bits).
"""

from __future__ import annotations

import itertools
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

from tracer.scene.model import Cancelled


def thread_count(wanted: int = 0) -> int:
    """`wanted` threads, or as many as this process may use at once for 0."""
    if wanted > 0:
        return wanted
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _pool(threads: int, priority: int) -> ThreadPoolExecutor:
    """Threads that inherit the priority of the first thread that asks for them: each priority has its own."""
    return ThreadPoolExecutor(threads, thread_name_prefix="tracer")


def _priority() -> int:
    """Niceness of the calling thread, where threads have one: on Linux."""
    return os.getpriority(os.PRIO_PROCESS, threading.get_native_id()) if sys.platform.startswith("linux") else 0


def for_each_chunk(
    work: Callable[[int, int], None], chunks: int, threads: int, cancel: Callable[[], bool] | None = None
) -> None:
    """Call work(chunk, worker) for every chunk; raises Cancelled, once all are quiet, when `cancel()` turns true."""
    queue = itertools.count()
    stopped = False

    def run(worker: int) -> None:
        nonlocal stopped
        while not stopped and (chunk := next(queue)) < chunks:
            if cancel is not None and cancel():
                stopped = True
                return
            try:
                work(chunk, worker)
            except BaseException:
                stopped = True  # nobody need go on
                raise

    pool = _pool(threads - 1, _priority()) if threads > 1 else None
    others = [pool.submit(run, worker) for worker in range(1, min(threads, chunks))] if pool else []
    try:
        run(0)
    finally:
        errors = [future.exception() for future in others]
    for error in errors:
        if error is not None:
            raise error
    if stopped:
        raise Cancelled
