"""How much memory scenes and frames take beyond the interpreter and its libraries, and how fast trees are built.

    make memory                                 Kitchen where it is there, else the default scene; a million triangles
    make memory ARGS="--triangles 200000"       a smaller mesh

Each scene is measured in a process of its own: first what is resident once everything is imported and
all kernels are loaded, then with the scene, its trees and a renderer that has rendered some frames, and
the most there was meanwhile.  The mesh is read from a file, as a user's would be.
"""

from __future__ import annotations

import argparse
import gc
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench.frame_times import KITCHEN, machine
from tests.bench.meshes import bumpy_sphere, frequency_for
from tests.bench.of_scenes import finish
from tracer.scene.load import check_scene_file
from tracer.scene.model import SceneError
from viewer.util.messages import say
from viewer.util.resources import scene_path

ROOT = Path(__file__).resolve().parents[2]
MB = 1e6
SCENE_GOAL, MESH_GOAL = 400.0, 1500.0  # MB: resident for Kitchen, and at most for a million triangles
BUILD_GOAL = 1.0  # seconds for a million triangles
FRAMES = 4


def resident(field: str) -> int:
    """Bytes that /proc/self/status tells of this process: VmRSS is now, VmHWM the most there was."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(field + ":"):
            return 1024 * int(line.split()[1])
    raise RuntimeError(f"the system does not tell {field}")


def inspect(path: Path, size: int) -> dict[str, Any]:
    """Measure one scene in this process, which should have done nothing before."""
    import tracer
    from tracer.compiling.compilation import warm_up

    warm_up()
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # forget the most there was
    before, started = resident("VmRSS"), time.perf_counter()
    scene = tracer.load_scene(path)
    loaded = time.perf_counter()
    world = tracer.World(scene, scene.time_range[0], "bvh8")
    built = time.perf_counter()
    peak = resident("VmHWM")
    renderer = tracer.Renderer(scene, tracer.Settings(width=size, height=size), world=world)
    for number in range(FRAMES):
        frame = renderer.render(scene.frame_time(min(number, scene.frames - 1)))
    after = resident("VmRSS")
    return {
        "scene": str(path),
        "triangles": scene.triangle_count,
        "size": size,
        "seen": float(np.isfinite(frame.depth).mean()),
        "load_seconds": loaded - started,
        "build_seconds": built - loaded,
        "libraries": before,
        "resident": after - before,
        "peak_of_build": peak - before,
        "peak": resident("VmHWM") - before,
    }


def measured(path: Path, size: int) -> dict[str, Any]:
    """`inspect` in a process of its own; raises RuntimeError or SceneError, in one line, where that fails."""
    check_scene_file(path)  # before a process takes its time to start
    command = [sys.executable, "-m", "tests.bench.memory", str(path.absolute()), "--inspect", "--size", str(size)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{path.name}: {(done.stderr.strip().splitlines() or ['it was ended'])[-1]}")
    return json.loads(done.stdout)


def write_mesh(path: Path, triangles: int) -> None:
    """A bumpy sphere as binary STL."""
    corners = bumpy_sphere(frequency_for(triangles))
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    records = np.zeros(len(corners), kind)
    records["corners"] = corners
    with path.open("wb") as file:
        file.write(bytes(80) + np.uint32(len(corners)).tobytes())
        records.tofile(file)


def table(results: list[dict[str, Any]]) -> Table:
    made = Table(
        title="Memory beyond the interpreter and its libraries", title_justify="left", title_style="bold",
        caption=f"goals: {SCENE_GOAL:g} MB resident for Kitchen; at most {MESH_GOAL:g} MB for a million triangles, "
        f"and {BUILD_GOAL:g} s to build them", caption_justify="left",
    )  # fmt: skip
    made.add_column("scene")
    for heading in ("triangles", "libraries, MB", "resident, MB", "most, MB", "read, s", "built, s", "s a million"):
        made.add_column(heading, justify="right")
    for r in results:
        sizes = [f"{r[name] / MB:,.0f}" for name in ("libraries", "resident", "peak")]
        rate = f"{1e6 * r['build_seconds'] / r['triangles']:.2f}"
        times = (f"{r['load_seconds']:.2f}", f"{r['build_seconds']:.2f}", rate)
        made.add_row(Path(r["scene"]).name, f"{r['triangles']:,}", *sizes, *times)
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make memory", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: Kitchen if there, else the default scene")
    parser.add_argument("--triangles", type=int, default=1_000_000, help="of the mesh (default: a million); 0: none")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--json", type=Path, default=Path("out/memory.json"), help="(default: out/memory.json)")
    parser.add_argument("--inspect", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.inspect:
        print(json.dumps(inspect(Path(options.scenes[0]), options.size)))
        return 0
    scenes = [scene_path(name) for name in options.scenes] or [KITCHEN if KITCHEN.exists() else scene_path(None)]
    report: dict[str, Any] = {"machine": machine(), "scenes": []}
    try:
        with tempfile.TemporaryDirectory() as folder:
            if options.triangles:
                mesh = Path(folder) / "mesh.stl"
                write_mesh(mesh, options.triangles)
                scenes.append(mesh)
            report["scenes"] = [measured(scene, options.size) for scene in scenes]
    except (RuntimeError, SceneError) as error:
        say(error)
        return 1
    return finish(report, table(report["scenes"]), options.json, [])


if __name__ == "__main__":
    sys.exit(main())
