"""Long builds: they report their progress, can be stopped, and share their work among threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tracer.runtime.parallel import for_each_chunk
from tracer.scene.model import Progress

CANCELLED, DONE = 0, 1  # entries of a build's `control` (2,) int64: set to stop it; how much it has done
CHUNK = 1 << 12  # blocks or triangles that a thread takes at a time
LONG = 5000  # primitives; what has fewer is built in no time
T = TypeVar("T")


def watched(
    build: Callable[[NDArray[np.int64]], T], what: str, primitives: int, work: float, progress: Progress | None
) -> T:
    """Return build(control); meanwhile `progress` is told what is done and the fraction of `work` done so far.

    What `progress` raises stops the build and passes through.  A build over few primitives is not watched."""
    control = np.zeros(2, np.int64)
    if progress is None or primitives < LONG:
        return build(control)
    with ThreadPoolExecutor(1, thread_name_prefix="build") as builder:
        result = builder.submit(build, control)
        try:
            while not result.done():
                progress(what, min(0.99, control[DONE] / work))
                wait([result], 0.05)
        finally:
            control[CANCELLED] = 1
    return result.result()


def in_chunks(work: Callable[[int, int], None], count: int, control: NDArray[np.int64], threads: int) -> None:
    """Call work(first, last) for chunks of the numbers below count, in threads, until control[CANCELLED] is set."""

    def one(chunk: int, worker: int) -> None:
        work(chunk * CHUNK, min(count, (chunk + 1) * CHUNK))

    for_each_chunk(one, -(-count // CHUNK), threads, lambda: bool(control[CANCELLED]))
