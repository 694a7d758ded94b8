"""How soon a mesh of millions of triangles shows its first picture, in how much memory, and how soon it is given up.

    make large                                             five million triangles, as STL and as PLY
    make large ARGS="--triangles 20000000 --kinds ply"     takes about ten gigabytes

The file is made beside, opened as the window opens it, in a process of its own, and deleted.  The longest time between
two reports is what giving up takes at most.  What was expected is what a scene is refused by
(`tracer.scene.memory_check`).
"""

from __future__ import annotations

import argparse
import gc
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from tests.bench.frame_times import machine
from tests.bench.memory import ROOT, resident
from tests.bench.meshes import bumpy_face, frequency_for
from tests.bench.of_scenes import finish
from viewer.util.messages import say

GB = 1e9
KINDS = ("stl", "ply")


def write_stl(path: Path, frequency: int) -> None:
    """A bumpy sphere as binary STL, a face of the icosahedron after the other."""
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    with path.open("wb") as file:
        file.write(bytes(80) + np.uint32(20 * frequency**2).tobytes())
        for points, faces in _faces(frequency):
            rows = np.zeros(len(faces), row)
            rows["corners"] = points[faces]
            rows.tofile(file)


def write_ply(path: Path, frequency: int) -> None:
    """The same as binary PLY, whose triangles share vertices within each face of the icosahedron."""
    each = (frequency + 1) * (frequency + 2) // 2
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {20 * each}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {20 * frequency**2}\nproperty list uchar int vertex_indices\nend_header\n"
    with path.open("wb") as file:
        file.write(head.encode())
        for points, _ in _faces(frequency):
            points.astype("<f4").tofile(file)
        for number, (_, faces) in enumerate(_faces(frequency)):
            rows = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
            rows["count"], rows["corners"] = 3, faces + number * each
            rows.tofile(file)


def _faces(frequency: int) -> Iterator[tuple[NDArray[np.float32], NDArray[np.int32]]]:
    return (bumpy_face(face, frequency) for face in range(20))


class Reports:
    """What is said on the way: when, and how much memory there was at most until the next."""

    def __init__(self) -> None:
        self._last, self._what = time.perf_counter(), ""
        self.longest, self.longest_in = 0.0, ""
        self.phases: dict[str, list[float]] = {}  # seconds, and bytes at most

    def __call__(self, what: str, fraction: float) -> None:
        now = time.perf_counter()
        gap = now - self._last
        if gap > self.longest:
            self.longest, self.longest_in = gap, self._what
        said = self.phases.setdefault(self._what or what, [0.0, 0.0])
        said[0] += gap
        said[1] = max(said[1], resident("VmHWM"))
        self._last, self._what = now, what


def inspect(path: Path, size: int) -> dict[str, Any]:
    """Open one scene in this process, which should have done nothing before."""
    from tracer.compiling.compilation import warm_up
    from tracer.scene import memory_check
    from tracer.scene.load import load_visible_scene
    from tracer.scene.mesh_options import IN_STUDIO
    from tracer.settings import Settings
    from viewer.services.scene_loader import build

    warm_up(lights=1)
    warm_up(lights=96)
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # forget the most there was
    before, started, reports = resident("VmRSS"), time.perf_counter(), Reports()
    scene = load_visible_scene(path, reports, meshes=IN_STUDIO)
    read, most_reading, as_scene = time.perf_counter(), resident("VmHWM"), resident("VmRSS")
    renderer, _ = build(scene, Settings(width=size, height=size), reports)
    reports("ready", 1.0)
    built, most_building = time.perf_counter(), resident("VmHWM")
    frame = renderer.render(0.0)
    drawn = time.perf_counter()
    renderer.render(0.0)  # what the first has taught
    triangles = memory_check.triangles_of(path) or 0
    return {
        "scene": path.name,
        "megabytes": path.stat().st_size / 1e6,
        "triangles": scene.triangle_count,
        "seen": float(np.isfinite(frame.depth).mean()),
        "read_seconds": read - started,
        "build_seconds": built - read,
        "draw_seconds": drawn - built,
        "longest_between_reports": reports.longest,
        "longest_in": reports.longest_in,
        "most_reading": most_reading - before,
        "expected_reading": memory_check.reading(path),
        "as_scene": as_scene - before,
        "most_building": most_building - before,
        "most": resident("VmHWM") - before,
        "after": resident("VmRSS") - before,
        "expected_showing": (as_scene - before) + memory_check.SHOWING * triangles,
        "phases": {what: [seconds, most - before] for what, (seconds, most) in reports.phases.items()},
    }


def measured(path: Path, size: int) -> dict[str, Any]:
    """`inspect` in a process of its own; raises RuntimeError, in one line, where that fails."""
    command = [sys.executable, "-m", "tests.bench.large_scenes", "--inspect", str(path.absolute()), "--size", str(size)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{path.name}: {(done.stderr.strip().splitlines() or ['it was ended'])[-1]}")
    return json.loads(done.stdout)


def table(results: list[dict[str, Any]]) -> Table:
    made = Table(title="Large scenes", title_justify="left", title_style="bold")
    made.add_column("file")
    for heading in ("triangles", "read, s", "tree, s", "picture, s", "give up, s"):
        made.add_column(heading, justify="right")
    for heading in ("reading, GB", "expected", "scene", "in all", "expected", "after"):
        made.add_column(heading, justify="right")
    for r in results:
        seconds = ("read_seconds", "build_seconds", "draw_seconds", "longest_between_reports")
        sizes = ("most_reading", "expected_reading", "as_scene", "most", "expected_showing", "after")
        row = [r["scene"], f"{r['triangles']:,}", *(f"{r[name]:.1f}" for name in seconds)]
        made.add_row(*row, *(f"{r[name] / GB:.2f}" for name in sizes))
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make large", description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=5_000_000, help="(default: five million)")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS, help="(default: all)")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--folder", type=Path, help="where the files are made meanwhile (default: the system's)")
    parser.add_argument("--json", type=Path, default=Path("out/large.json"), help="(default: out/large.json)")
    parser.add_argument("--inspect", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.inspect:
        print(json.dumps(inspect(options.inspect, options.size)))
        return 0
    report: dict[str, Any] = {"machine": machine(), "scenes": []}
    try:
        for kind in options.kinds:
            with tempfile.TemporaryDirectory(dir=options.folder) as folder:
                path = Path(folder) / f"mesh.{kind}"
                {"stl": write_stl, "ply": write_ply}[kind](path, frequency_for(options.triangles))
                report["scenes"].append(measured(path, options.size))
    except RuntimeError as error:
        say(error)
        return 1
    return finish(report, table(report["scenes"]), options.json, [])


if __name__ == "__main__":
    sys.exit(main())
