"""How long each view takes to draw, on one core, beside what tracing a frame takes of all cores.

    make views                                     the default scene, 680 x 494 and 1920 x 1080
    make views ARGS="--sizes 3840x2160 SCENE"

The window draws each new frame while the next one is traced.  So what drawing takes of a core slows tracing by at most
its part of what the cores together do for a frame.  Both are in milliseconds of the processor, as other programs may
run beside.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.settings import Settings
from viewer.state.draw_options import DrawOptions
from viewer.state.views import View, can_draw
from viewer.util.resources import scene_path
from viewer.views import colorize

WARM, FRAMES = 3, 5


def frames_of(path: Path, width: int, height: int) -> tuple[list[Frame], float]:
    """Frames that hold what views need, and the milliseconds of the processor for one that holds nothing more."""
    scene = load_scene(path)
    renderer = Renderer(scene, Settings(width=width, height=height))
    for number in range(WARM):
        renderer.render(scene.frame_time(number))
    began = time.process_time()
    for number in range(WARM, WARM + FRAMES):
        renderer.render(scene.frame_time(number))
    traced = 1e3 * (time.process_time() - began) / FRAMES
    everything = {"verify": True, "record_work": True, "record_lights": True, "record_fates": True}
    renderer.settings = Settings(width=width, height=height, **everything)
    return [renderer.render(scene.frame_time(WARM + FRAMES + number)) for number in range(FRAMES)], traced


def drawn(frames: list[Frame], view: View) -> float:
    """The median milliseconds of the processor that drawing a new frame takes."""
    took = []
    for frame in [frames[0], *frames]:  # kernels are loaded by the first
        new = replace(frame)  # of which nothing has been found yet
        began = time.thread_time()
        colorize(new, DrawOptions(view=view))
        took.append(1e3 * (time.thread_time() - began))
    return float(np.median(took[1:]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="default")
    parser.add_argument("--sizes", default="680x494,1920x1080")
    options = parser.parse_args()
    sizes = [tuple(int(side) for side in size.split("x")) for size in options.sizes.split(",")]
    measured = {(w, h): frames_of(scene_path(options.scene), w, h) for w, h in sizes}
    table = Table("view", *(f"{w} x {h}, ms" for w, h in sizes), *(f"of tracing {w} x {h}" for w, h in sizes))
    table.add_row("tracing, all cores", *(f"{traced:.0f}" for _, traced in measured.values()), *[""] * len(sizes))
    for view in View:
        if not all(can_draw(frames[0], view) for frames, _ in measured.values()):
            continue
        times = [drawn(frames, view) for frames, _ in measured.values()]
        shares = [100.0 * took / traced for took, (_, traced) in zip(times, measured.values(), strict=True)]
        table.add_row(view.value, *(f"{took:.1f}" for took in times), *(f"{share:.1f} %" for share in shares))
    Console(width=100).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
