"""Compiles all kernels that the tests use, once, on all cores, before the tests begin: else each of pytest's processes
would compile what it meets, one kernel after another.

    python -m tests.compiled
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from tracer.compiling import compilation
from tracer.compiling.compilation import compiled_before, warm_up
from tracer.compiling.processes import only_compile
from tracer.compiling.steps import PARTS, steps_of

# Lights (modes in 32 and in 64 bits), structure, and whether only what pictures need is made ready: of other methods
# hardly any test asks for modes in 64 bits.
VARIANTS = ((1, "bvh8", False), (1, "kdtree", False), (1, "kdtree-lazy", False), (16, "bvh8", True))


class Part(NamedTuple):
    """A part of `tracer.compiling.steps`, or what a method has of its own that several tests render by: each of their
    processes would compile it at the same time."""

    name: str
    lights: int
    accelerator: str

    def compile(self) -> None:
        if self.name in PARTS:
            for _step in steps_of(*self):
                pass
        else:
            compilation.make_ready(*self)


Job = tuple[Part, ...]
"""What one process compiles: it takes seconds to start, and to load what its parts share."""


def job(lights: int, accelerator: str, *names: str) -> Job:
    return tuple(Part(name, lights, accelerator) for name in names)


# Each job after those that it shares kernels with, so that none is compiled twice.  What most waits for comes first,
# then what takes longest, so that no core is idle at the end.
TREES, FRAME, QUERIES = (job(1, "bvh8", name) for name in ("trees", "frame", "queries"))
METHODS = job(1, "bvh8", "methods")
AFTER = {
    TREES: (),
    FRAME: (),
    METHODS: (TREES,),
    QUERIES: (),
    job(1, "bvh8", "lightcuts", "lightcuts-certified"): (TREES, FRAME, QUERIES),
    job(1, "kdtree-lazy", "queries", "trees"): (TREES,),
    job(1, "bvh8", "lightbuffer", "voxels", "lie"): (TREES, FRAME, QUERIES),
    job(16, "bvh8", "frame"): (FRAME,),
    job(1, "kdtree", "queries", "trees"): (TREES,),
}


def main(*parts: str) -> int:
    """Compile everything, or some parts, each given as NAME:LIGHTS:ACCELERATOR."""
    if parts:
        only_compile()
        for part in parts:
            name, lights, accelerator = part.split(":")
            Part(name, int(lights), accelerator).compile()
        os._exit(0)  # without taking everything down piece by piece: that takes a second
    if all(compiled_before(*variant) for variant in VARIANTS):
        return 0
    print("compiling the kernels, once for all tests", flush=True)
    compile_jobs(max(2, os.cpu_count() or 1))
    compilation.compile_in_processes = lambda *arguments: None  # type: ignore[assignment]  # that has been done
    for variant in VARIANTS:
        warm_up(None, *variant)  # loads what the jobs made, compiles what they left, and says that all is there
    return 0


def compile_jobs(slots: int) -> None:
    """Do all jobs, so many at once; one that fails costs time only."""
    waiting, running, ended = list(AFTER), {}, set()
    while waiting or running:
        for job in [job for job in waiting if ended.issuperset(AFTER[job])][: slots - len(running)]:
            waiting.remove(job)
            running[job] = subprocess.Popen(
                [sys.executable, "-m", "tests.compiled", *(":".join(map(str, part)) for part in job)],
                cwd=Path(__file__).parents[1],
                stdin=subprocess.PIPE,  # it ends when this closes, so with this process
                stdout=subprocess.DEVNULL,
            )
        time.sleep(0.05)
        for job in [job for job, process in running.items() if process.poll() is not None]:
            ended.add(job)
            del running[job]


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
