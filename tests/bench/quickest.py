"""Is `auto` ever slower than `none`?  Both render the same frames, side by side; windows of fifty frames are compared.

    make quickest                                       the default scene, and BART's scenes where they are there
    make quickest ARGS="--frames 150 --accelerator kdtree kitchen.aff"

The methods take turns frame by frame, in alternating order, each with a world of its own; the first frame of a third
renderer, untimed, takes loading and cold caches out of the figures.  Every picture by `auto` must be that of `none`,
bit for bit; a run in which one is not ends with exit code 1.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench.frame_times import machine
from tests.bench.of_scenes import add_options, finish, prepared
from tracer.frame import Settings
from tracer.renderer import Renderer
from tracer.runtime.parallel import thread_count
from tracer.scene.load import load_scene
from viewer.util.messages import say

METHODS = ("none", "auto")
WINDOW = 50  # frames
ALLOWED = 1.03  # of none's time, over any window


def measure(path: Path, settings: Settings, frames: int, step: int, method: str = METHODS[1]) -> dict[str, Any]:
    """Seconds of every frame by `none` and another method, by the clock and of processors; what it decided, and
    the frames whose pictures differ."""
    scene = load_scene(path)
    methods = (METHODS[0], method)
    renderers = {name: Renderer(scene, replace(settings, method=name)) for name in methods}
    Renderer(scene, settings, world=renderers[METHODS[0]].world).render(scene.frame_time(0))
    seconds: dict[str, list[float]] = {name: [] for name in methods}
    processor: dict[str, list[float]] = {name: [] for name in methods}
    culled, differ, decisions = 0, [], []
    numbers = [k * step % max(1, scene.frames) for k in range(frames)]
    for k, number in enumerate(numbers):
        rendered = {}
        for name in methods if k % 2 else methods[::-1]:
            before, began = time.perf_counter(), time.process_time()
            rendered[name] = renderers[name].render(scene.frame_time(number))
            seconds[name].append(time.perf_counter() - before)
            processor[name].append(time.process_time() - began)
        if rendered[method].color.tobytes() != rendered[METHODS[0]].color.tobytes():
            differ.append(number)
        statistics = rendered[method].statistics
        culled += statistics.shadow.culled > 0
        if not decisions or decisions[-1][1] != statistics.decision:
            decisions.append((k, statistics.decision))
    return {
        "scene": str(path),
        "size": [settings.width, settings.height],
        "threads": thread_count(settings.threads),
        "accelerator": settings.accelerator,
        "method": method,
        "frames": numbers,
        "seconds": seconds,
        "processor_seconds": processor,
        "processor": ratios(processor[METHODS[0]], processor[method]),
        "frames_looked_up": culled,
        "decisions": decisions,
        "differ": differ,
    } | ratios(seconds[METHODS[0]], seconds[method])


def ratios(none: list[float], other: list[float]) -> dict[str, float]:
    """The time of another method over that of none: of all frames, in the worst window of fifty, and in the best."""
    sums = [np.convolve(times, np.ones(min(WINDOW, len(times))), "valid") for times in (none, other)]
    each = sums[1] / sums[0]
    return {"total": sum(other) / sum(none), "worst": float(each.max()), "best": float(each.min())}


def table(results: list[dict[str, Any]]) -> Table:
    made = Table(title=f"time of the method over that of none; windows of {WINDOW} frames", title_justify="left")
    for name in (
        "scene",
        "structure",
        "method",
        "frames",
        "none, ms",
        "all frames",
        "worst",
        "best",
        "CPU",
        "looked up",
    ):
        made.add_column(name, justify="left" if name in ("scene", "structure", "method") else "right")
    for r in results:
        median = 1e3 * float(np.median(r["seconds"][METHODS[0]]))
        figures = [f"{r[name]:.3f}" for name in ("total", "worst", "best")]
        made.add_row(
            Path(r["scene"]).name, r["accelerator"], r["method"], str(len(r["frames"])), f"{median:.1f}", *figures,
            f"{r['processor']['total']:.3f} ({r['processor']['worst']:.3f})", str(r["frames_looked_up"]),
        )  # fmt: skip
    return made


def main() -> int:
    parser = argparse.ArgumentParser(prog="make quickest", description=__doc__.splitlines()[0])
    add_options(parser, 150, "out/quickest.json")
    parser.add_argument("--method", default=METHODS[1], help="to hold against none (default: auto)")
    options = parser.parse_args()
    paths, settings = prepared(options)
    report: dict[str, Any] = {"machine": machine(), "scenes": []}
    for path in paths:
        result = measure(path, settings, options.frames, options.step, options.method)
        report["scenes"].append(result)
        say(f"{path.name}: {result['total']:.3f} in all, {result['worst']:.3f} at worst; {result['decisions'][-1][1]}")
    for r in report["scenes"]:
        if r["worst"] > ALLOWED:
            say(f"{Path(r['scene']).name}: {r['worst']:.3f} of none's time over some {WINDOW} frames")
    faults = [f"{Path(r['scene']).name}: frames {r['differ']} differ" for r in report["scenes"] if r["differ"]]
    return finish(report, table(report["scenes"]), options.json, faults)


if __name__ == "__main__":
    sys.exit(main())
