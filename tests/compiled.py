"""Compiles all kernels that the tests use, once, on all cores, before the tests begin: else each of pytest's processes
would compile what it meets, one kernel after another.

    python -m tests.compiled
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tracer.compilation import compiled_before

# Lights (modes in 32 and in 64 bits) and structure.  The two of a line have nothing in common, and the second line
# only what the first has not.
VARIANTS = (((1, "bvh8"), (16, "kdtree")), ((1, "kdtree"), (16, "bvh8")))
WARM_UP = "import sys; from tracer import compilation; compilation.warm_up(None, int(sys.argv[1]), sys.argv[2])"


def main() -> int:
    if not all(compiled_before(*variant) for together in VARIANTS for variant in together):
        print("compiling the kernels, once for all tests", flush=True)
    for together in VARIANTS:
        missing = [variant for variant in together if not compiled_before(*variant)]
        commands = [[sys.executable, "-c", WARM_UP, str(lights), accelerator] for lights, accelerator in missing]
        processes = [subprocess.Popen(command, cwd=Path(__file__).parents[1]) for command in commands]
        codes = [process.wait() for process in processes]
        if any(codes):
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
