"""How soon a scene shows its first picture, and its first close-up, by each structure: what is built before rays come
against what is built where they arrive.

    make first                                  Kitchen where it is there, else the default scene; two million triangles
    make first ARGS="--triangles 200000"        a smaller mesh
    make first ARGS="--triangles 1000000,5000000 --structures bvh8,bvh8:lazy"

Each picture is the first of a process of its own.  Its time counts from the scene in memory to the picture, on one
thread, in seconds of the processor, as other programs may run beside; `none` traces it.  The close-up shows about a
hundredth of the way to the first surface in the middle of the picture.
"""

from __future__ import annotations

import argparse
import gc
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench.frame_times import KITCHEN, machine
from tests.bench.memory import MB, ROOT, resident, write_mesh
from tests.bench.of_scenes import finish
from tracer.geometry.accelerators import ACCELERATORS, BVH8
from viewer.util.messages import say
from viewer.util.resources import scene_path

PICTURES = ("whole", "close-up")
LAZY_BVH8 = f"{BVH8}:lazy"  # of a large scene, what no ray has reached waits
STRUCTURES = (*ACCELERATORS, LAZY_BVH8)
NEAR = 0.01  # of the way to the surface is left


def closer(scene: Any, size: int) -> Any:
    """The scene's camera, moved towards what the middle of its picture shows."""
    import tracer

    settings = tracer.Settings(width=size, height=size, depth=0, method="none")
    frame = tracer.Renderer(scene, settings).render(scene.time_range[0])
    depth = frame.depth[size // 2, size // 2]
    if not np.isfinite(depth):
        depth = frame.depth[np.isfinite(frame.depth)].min(initial=1.0)
    camera = scene.camera_at(scene.time_range[0])
    way = np.array(camera.direction) / np.linalg.norm(camera.direction)
    return replace(camera, position=tuple((np.array(camera.position) + (1.0 - NEAR) * float(depth) * way).tolist()))


def inspect(path: Path, size: int, structure: str, picture: str) -> dict[str, Any]:
    """Make one picture in this process, which should have done nothing before."""
    import tracer
    from tracer.compiling.compilation import warm_up

    accelerator, lazy = structure.removesuffix(":lazy"), structure == LAZY_BVH8
    scene = tracer.load_scene(path)
    camera = closer(scene, 64) if picture == "close-up" else None
    warm_up(lights=len(scene.lights), accelerator=accelerator, picture_only=True)
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # forget the most there was
    before, started, watch = resident("VmRSS"), time.process_time(), time.perf_counter()
    world = tracer.World(scene, scene.time_range[0], accelerator, lazy=lazy)
    built = time.process_time() - started
    settings = tracer.Settings(width=size, height=size, method="none", threads=1, accelerator=accelerator)
    renderer = tracer.Renderer(scene, settings, world=world)
    frame = renderer.render(scene.time_range[0], camera)
    took, watched = time.process_time() - started, time.perf_counter() - watch
    started = time.process_time()
    renderer.render(scene.time_range[0], camera)
    told = frame.statistics.built
    return {
        "scene": path.name,
        "triangles": scene.triangle_count,
        "accelerator": structure,
        "picture": picture,
        "before_rays": built,
        "first": took,
        "first_watched": watched,
        "second": time.process_time() - started,
        "resident": resident("VmRSS") - before,
        "peak": resident("VmHWM") - before,
        "built": None if told is None else told.share,
    }


def measured(path: Path, size: int, structure: str, picture: str) -> dict[str, Any]:
    """`inspect` in a process of its own; raises RuntimeError, in one line, where that fails."""
    command = [sys.executable, "-m", "tests.bench.first_pictures", str(path.absolute()), "--size", str(size)]
    command += ["--inspect", structure, picture]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{path.name}: {(done.stderr.strip().splitlines() or ['it was ended'])[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


def table(results: list[dict[str, Any]]) -> Table:
    made = Table(title="First pictures, in seconds of one processor", title_justify="left", title_style="bold")
    made.caption = "ready: before the first ray; second: the same picture again; MB beyond the scene, and the most"
    for heading in ("scene", "picture", "structure"):
        made.add_column(heading, no_wrap=True)
    for heading in ("ready", "first", "second", "built", "MB", "most MB"):
        made.add_column(heading, justify="right")
    for r in results:
        times = (f"{r[name]:.2f}" for name in ("before_rays", "first", "second"))
        built = "all" if r["built"] is None else f"{r['built']:.0%}"
        sizes = (f"{r[name] / MB:,.0f}" for name in ("resident", "peak"))
        made.add_row(Path(r["scene"]).stem, r["picture"], r["accelerator"], *times, built, *sizes)
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make first", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: Kitchen if there, else the default scene")
    parser.add_argument(
        "--triangles", default="2000000", help="of the mesh, or of several (default: two million); 0: none"
    )
    parser.add_argument("--structures", default=",".join(STRUCTURES), help="(default: %(default)s)")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--json", type=Path, default=Path("out/first.json"), help="(default: out/first.json)")
    parser.add_argument("--inspect", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.inspect:
        print(json.dumps(inspect(Path(options.scenes[0]), options.size, *options.inspect)))
        return 0
    scenes = [scene_path(name) for name in options.scenes] or [KITCHEN if KITCHEN.exists() else scene_path(None)]
    report: dict[str, Any] = {"machine": machine(), "pictures": []}
    try:
        with tempfile.TemporaryDirectory() as folder:
            for triangles in (int(number) for number in options.triangles.split(",")):
                if triangles:
                    scenes.append(Path(folder) / f"mesh-{triangles}.stl")
                    write_mesh(scenes[-1], triangles)
            report["pictures"] = [
                measured(scene, options.size, structure, picture)
                for scene in scenes
                for picture in PICTURES
                for structure in options.structures.split(",")
            ]
    except RuntimeError as error:
        say(error)
        return 1
    return finish(report, table(report["pictures"]), options.json, [])


if __name__ == "__main__":
    sys.exit(main())
