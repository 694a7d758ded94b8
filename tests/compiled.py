"""Compiles all kernels that the tests use, once, on all cores, before the tests begin: else each of pytest's processes
would compile what it meets, one kernel after another.

    python -m tests.compiled
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import NamedTuple

from tracer import compilation
from tracer.compilation import compiled_before, warm_up
from tracer.compile_beside import _die_with_parent

# Lights (modes in 32 and in 64 bits) and structure.
VARIANTS = ((1, "bvh8"), (1, "kdtree"), (16, "bvh8"), (16, "kdtree"), (1, "kdtree-lazy"))
# What several tests render by, and each of their processes would compile at the same time.
METHODS = ("lightcuts", "lightcuts-certified", "lightbuffer", "voxels", "lie")


class Part(NamedTuple):
    """What a process of its own compiles: a part of `tracer.compile_beside`, or what a method has of its own."""

    name: str
    lights: int
    accelerator: str


# Each part after those that it shares kernels with, so that none is compiled twice; what most waits for comes first.
TREES, FRAME, QUERIES = (Part(name, 1, "bvh8") for name in ("trees", "frame", "queries"))
CERTIFICATES = Part("certificates", 1, "bvh8")
AFTER = {
    TREES: (),
    FRAME: (),
    CERTIFICATES: (TREES,),
    Part("certificates", 16, "bvh8"): (CERTIFICATES,),
    QUERIES: (),
    Part("queries", 1, "kdtree"): (),
    Part("queries", 1, "kdtree-lazy"): (),
    **{Part(method, 1, "bvh8"): (TREES, FRAME, QUERIES) for method in METHODS},
    Part("frame", 16, "bvh8"): (FRAME,),
    Part("trees", 1, "kdtree"): (TREES,),
    Part("trees", 1, "kdtree-lazy"): (TREES,),
}


def main(method: str = "", lights: str = "1", accelerator: str = "bvh8") -> int:
    """Compile everything, or what a method has of its own."""
    if method:
        threading.Thread(target=_die_with_parent, daemon=True).start()
        compilation.make_ready(method, int(lights), accelerator)
        os._exit(0)  # without taking everything down piece by piece: that takes a second
    if all(compiled_before(*variant) for variant in VARIANTS):
        return 0
    print("compiling the kernels, once for all tests", flush=True)
    compile_parts(max(2, os.cpu_count() or 1))
    compilation.compile_beside = lambda *arguments: None  # type: ignore[assignment]  # that has been done
    for variant in VARIANTS:
        warm_up(None, *variant)  # loads what the parts made, compiles what they left, and says that all is there
    return 0


def compile_parts(slots: int) -> None:
    """Compile all parts into the cache, so many at once; one that fails costs time only."""
    waiting, running, ended = list(AFTER), {}, set()
    while waiting or running:
        for part in [part for part in waiting if ended.issuperset(AFTER[part])][: slots - len(running)]:
            waiting.remove(part)
            running[part] = subprocess.Popen(
                [sys.executable, "-m", _module(part), *map(str, part)],
                cwd=Path(__file__).parents[1],
                stdin=subprocess.PIPE,  # it ends when this closes, so with this process
                stdout=subprocess.DEVNULL,
            )
        time.sleep(0.05)
        for part in [part for part, process in running.items() if process.poll() is not None]:
            ended.add(part)
            del running[part]


def _module(part: Part) -> str:
    return "tests.compiled" if part.name in METHODS else "tracer.compile_beside"


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
