"""Frame times with and without culling, side by side, and what they are times of.

    make frames                                      the default scene, and BART's Kitchen where it is there
    make frames ARGS="--frames 20 robot.aff"         other scenes, more frames

Both methods render the same frames of the scene's own path, alternating frame by frame so that
whatever else the machine does falls on both.  A first frame of each, untimed, takes compiling and
cold caches out of the figures.  While it times it checks: every frame must show the same
primitives by both methods, shadow rays due must agree, `none` must cull nothing, and the times of
a frame's phases must add up to the frame's; a run that fails a check ends with exit code 1.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
import time
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tracer.compiling.compilation import warm_up
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.runtime.parallel import thread_count
from tracer.scene.load import load_scene
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path

METHODS = ("none", "paper")
KITCHEN = Path(__file__).resolve().parents[3] / "shared" / "bart" / "kitchen" / "kitchen.aff"
LEAST_COVERAGE = 0.9  # of a frame's time that its phases account for


def machine() -> dict[str, Any]:
    """What the figures depend on."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": models[0] if models else platform.processor(),
        "cores": thread_count(),
        "system": platform.platform(),
        "python": platform.python_version(),
        "numpy": version("numpy"),
        "numba": version("numba"),
        "load_before": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def in_words(about: dict[str, Any]) -> str:
    """What `machine` tells of the processor, and of what else it did."""
    return f"{about['processor']}, {about['cores']} cores, load {about['load_before']:.1f} before"


def measure(path: Path, settings: Settings, frames: int, start: int) -> dict[str, Any]:
    """Times and counters of `frames` frames by each method; `faults` says what was not as it must be."""
    began = time.perf_counter()
    scene = load_scene(path)
    loaded = time.perf_counter()
    renderers = {method: Renderer(scene, replace(settings, method=method)) for method in METHODS}
    built = time.perf_counter()
    last = min(start + frames, scene.frames) if scene.frames > 1 else start + frames
    results: dict[str, Any] = {method: [] for method in METHODS}
    found: list[str] = []
    for renderer in renderers.values():
        renderer.render(scene.frame_time(start))
        renderer.reset_modes()
    for number in range(start, last):
        moment = scene.frame_time(min(number, scene.frames - 1))
        rendered = {}
        for method in METHODS if number % 2 else METHODS[::-1]:
            before = time.perf_counter()
            rendered[method] = renderers[method].render(moment)
            results[method].append(_record(rendered[method], time.perf_counter() - before))
        none, paper = rendered["none"], rendered["paper"]
        faults = faults_of_work(none, paper) + _faults_of_phases(none) + _faults_of_phases(paper)
        found += [f"frame {number}: {fault}" for fault in faults]
    return {
        "scene": str(path),
        "size": [settings.width, settings.height],
        "depth": settings.depth,
        "threads": thread_count(settings.threads),
        "frames": [start, last],
        "load_seconds": loaded - began,
        "build_seconds": (built - loaded) / len(METHODS),
        "methods": results,
        "faults": found,
    }


def _record(frame: Frame, seconds: float) -> dict[str, Any]:
    return {"seconds": seconds} | frame.statistics.to_dict() | {"frame_seconds": frame.statistics.seconds}


def faults_of_work(none: Frame, paper: Frame) -> list[str]:
    """What shows that the times are not times of the same work, done right."""
    found = []
    if not np.array_equal(none.primitive, paper.primitive):
        found.append("the methods see different primitives")
    if none.statistics.shadow.due != paper.statistics.shadow.due:
        found.append("the methods have different shadow rays due")
    if none.statistics.shadow.culled or none.statistics.shadow.dynamic_only:
        found.append("method none culled")
    for frame in (none, paper):
        shadow = frame.statistics.shadow
        if shadow.rays + shadow.culled != shadow.due:
            found.append(f"method {frame.settings.method}: shadow rays traced and culled are not those due")
    return found


def _faults_of_phases(frame: Frame) -> list[str]:
    statistics = frame.statistics
    if LEAST_COVERAGE * statistics.seconds <= sum(statistics.phases.values()) <= 1.001 * statistics.seconds:
        return []
    return [f"method {frame.settings.method}: the phases do not add up to the frame"]


def table(result: dict[str, Any]) -> Table:
    """Medians, with the quartiles, of all frames of each method, and what the paper's saves."""
    width, height = result["size"]
    first, last = result["frames"]
    made = Table(
        title=f"{Path(result['scene']).name}, frames {first} to {last - 1}, {width} x {height}, "
        f"depth {result['depth']}, {result['threads']} threads",
        title_justify="left",
        title_style="bold",
        caption=f"loaded in {result['load_seconds']:.2f} s, trees built in {result['build_seconds']:.2f} s; "
        "medians, times with their quartiles",
        caption_justify="left",
    )
    made.add_column("")
    for method in METHODS:
        made.add_column(method, justify="right")
    made.add_column("saved", justify="right")
    rows: tuple[tuple[str, tuple[str, ...], float, str], ...] = (
        ("frame, ms", ("seconds",), 1000.0, ".1f"),
        ("  primary rays, ms", ("phases", "primary"), 1000.0, ".1f"),
        ("  occlusion testing, ms", ("phases", "occlusion testing"), 1000.0, ".1f"),
        ("  shading, ms", ("phases", "shading"), 1000.0, ".1f"),
        ("shadow rays due", ("shadow", "due"), 1.0, ",.0f"),
        ("shadow rays culled", ("shadow", "culled"), 1.0, ",.0f"),
        ("asking moving objects alone", ("shadow", "dynamic_only"), 1.0, ",.0f"),
        ("shadow traversal steps", ("shadow", "traversal_steps"), 1.0, ",.0f"),
        ("shadow intersection tests", ("shadow", "intersection_tests"), 1.0, ",.0f"),
        ("occlusion tests", ("occlusion_tests",), 1.0, ",.0f"),
    )
    for name, keys, scale, form in rows:
        quartiles = [np.percentile([_at(r, keys) * scale for r in result["methods"][m]], (50, 25, 75)) for m in METHODS]
        spread = name.endswith("ms")
        cells = [f"{q[0]:{form}}" + (f"  ({q[1]:{form}} to {q[2]:{form}})" if spread else "") for q in quartiles]
        saves = name.startswith(("frame", "  shading", "shadow traversal", "shadow intersection"))
        made.add_row(name, *cells, f"{1.0 - quartiles[1][0] / quartiles[0][0]:+.1%}" if saves else "")
    return made


def _at(record: Any, keys: tuple[str, ...]) -> float:
    for key in keys:
        record = record[key]
    return float(record)


def main() -> int:
    parser = argparse.ArgumentParser(prog="make frames", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: the default scene, and Kitchen if there")
    parser.add_argument("--frames", type=int, default=8, help="frames per scene and method (default: 8)")
    parser.add_argument("--start", type=int, default=0, help="number of the first frame (default: 0)")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--depth", type=int, default=10, help="the most bounces (default: 10)")
    parser.add_argument("--threads", type=int, default=0, help="0, the default: one per core")
    parser.add_argument("--json", type=Path, default=Path("out/bench.json"), help="(default: out/bench.json)")
    options = parser.parse_args()
    names = options.scenes or [None, *([str(KITCHEN)] if KITCHEN.exists() else [])]
    if not options.scenes and not KITCHEN.exists():
        say(f"Kitchen is not measured: there is no {KITCHEN}")
    settings = Settings(options.size, options.size, options.depth, threads=options.threads).validated()

    report: dict[str, Any] = {"machine": machine(), "scenes": []}
    began = time.perf_counter()
    for lights in (1, 16):  # words of 32 and of 64 bits
        warm_up(lights=lights)
    report["warm_up_seconds"] = time.perf_counter() - began
    for name in names:
        result = measure(scene_path(name), settings, options.frames, options.start)
        report["scenes"].append(result)
        print_table(table(result))
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(report, indent=1) + "\n")
    about = report["machine"]
    print(f"{in_words(about)}; numba {about['numba']}")
    print(f"kernels ready in {report['warm_up_seconds']:.1f} s; all figures in {options.json}")
    faults = [f"{Path(r['scene']).name}: {fault}" for r in report["scenes"] for fault in r["faults"]]
    for fault in faults:
        say(f"not to be trusted: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
