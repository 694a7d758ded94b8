"""A picture whose bits are known, traced by whatever kernels the cache holds.

python -m tracer.compiling.trial            prints what `answer` returns
python -m tracer.compiling.trial all        compiles before that what `shadowcull-kernels` holds
"""

from __future__ import annotations

import hashlib
import sys

from tracer.compiling.compilation import warm_up
from tracer.compiling.steps import tiny_scene
from tracer.geometry.accelerators import BVH8, KD_TREE
from tracer.renderer import Renderer
from tracer.settings import Settings

SIDE = 16  # pixels
VARIANTS = ((1, BVH8), (16, BVH8), (1, KD_TREE))
"""Lights and structures whose kernels come with the package: words of both widths, and the paper's tree."""


def answer() -> str:
    """Return the SHA-256 of frames of a tiny scene, by each variant and method: colours, primitives and modes."""
    digest = hashlib.sha256()
    for lights, accelerator in VARIANTS:
        for method in ("paper", "certified"):
            settings = Settings(width=SIDE, height=SIDE, method=method, accelerator=accelerator, threads=1)
            renderer = Renderer(tiny_scene(lights), settings)
            for time in (0.0, 1.0):  # what the first frame teaches is asked in the second
                frame = renderer.render(time)
                for buffer in (frame.color, frame.primitive, frame.modes):
                    digest.update(buffer.tobytes())
    return digest.hexdigest()


if __name__ == "__main__":
    for lights, accelerator in VARIANTS if "all" in sys.argv[1:] else ():
        warm_up(None, lights, accelerator)
    print(answer())
