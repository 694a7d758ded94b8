"""What is culling worth where every light is a lamp?  Methods render the same frames of a path by the same samples.

    make lamps                                          the default scene, and BART's scenes where they are there
    make lamps ARGS="--radius 0.03 0.1 --samples 64 --frames 100 kitchen.aff"

The methods take turns frame by frame, each with a renderer of its own in one world (`tracer.lamp_experiment`).
A speed-up is the time of `none` over that of the method, certificates included; `free` gives the ceiling, what it would
be if shadow rays cost nothing.
Every picture by an exact method must be that of `none`, bit for bit; a run in which one is not ends with exit code 1.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench.frame_times import machine
from tests.bench.of_scenes import add_options, finish, prepared
from tracer.experiments import lamp_experiment
from tracer.experiments.experiment import REFERENCE, with_reference
from tracer.experiments.lamp_experiment import CEILING, run_lamps
from tracer.frame import Frame, Settings
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.runtime.parallel import thread_count
from tracer.scene.load import load_scene
from tracer.state import open_world
from viewer.util.messages import say


def measure(path: Path, settings: Settings, methods: list[str], frames: int, step: int | None) -> dict[str, Any]:
    """Seconds of every frame by `none`, by the methods and by `free`; what was known; and the frames that differ.

    Frames are so many steps apart, or spread evenly over the whole path."""
    scene = load_scene(path)
    world = open_world(scene, settings)
    Renderer(scene, settings, world=world).render(scene.frame_time(0))  # untimed: loads kernels
    path_frames = max(1, scene.frames)
    numbers = [k * step % path_frames if step else k * path_frames // frames for k in range(frames)]
    times = [scene.frame_time(number) for number in numbers]
    pictures: dict[str, bytes] = {}  # of a frame
    differ = []

    def compare(number: int, method: str, frame: Frame) -> None:
        pictures[method] = frame.color.tobytes()
        if len(pictures) == len(with_reference([*methods, CEILING])):
            truth = pictures[REFERENCE]
            exact = [name for name in pictures if Method.parse(name).exact]
            differ.extend((name, numbers[number]) for name in exact if pictures[name] != truth)
            pictures.clear()

    kinds = [(settings.lamp_radius, settings.lamp_samples)]
    *_, results = run_lamps(scene, settings, methods, kinds, times, world=world, on_frame=compare)
    (measured,) = results.runs
    seconds = {name: figures["frame_seconds"] for name, figures in measured.methods.items()}
    rows = {row.method: row for row in lamp_experiment.table(results)}
    return {
        "scene": str(path),
        "size": [settings.width, settings.height],
        "threads": thread_count(settings.threads),
        "accelerator": settings.accelerator,
        "lamp_radius": settings.lamp_radius,
        "lamp_samples": settings.lamp_samples,
        "lights": len(scene.lights),
        "shadow_rays": int(sum(measured.methods[REFERENCE]["shadow_rays_due"])),
        "frames": numbers,
        "seconds": seconds,
        "known": {name: rows[name].known for name in methods},
        "speed_up": {
            name: {"total": rows[name].speed_up, "share": rows[name].share_of_free}
            | quartiles(seconds[REFERENCE], seconds[name])
            for name in [*methods, CEILING]
        },
        "differ": differ,
    }


def quartiles(none: list[float], other: list[float]) -> dict[str, float]:
    """The quartiles, over the frames, of the time of none over another method's."""
    low, median, high = np.percentile(np.array(none) / np.array(other), [25, 50, 75])
    return {"low": float(low), "median": float(median), "high": float(high)}


def table(results: list[dict[str, Any]]) -> Table:
    made = Table(title="speed-up over none: of all frames, and quartiles of the frames", title_justify="left")
    for name in ("lamps", "none, ms", "method", "speed-up", "quartiles", "known", "of free"):
        made.add_column(name, justify="left" if name in ("lamps", "method") else "right")
    for r in results:
        lamps = f"{Path(r['scene']).name}, {r['lamp_samples']} at {r['lamp_radius']}"
        start = [lamps, f"{1e3 * float(np.median(r['seconds'][REFERENCE])):.0f}"]
        for name, found in r["speed_up"].items():
            known = f"{r['known'][name]:.0%}" if name in r["known"] else ""
            spread = " ".join(f"{found[part]:.2f}" for part in ("low", "median", "high"))
            made.add_row(*start, name, f"{found['total']:.2f}", spread, known, f"{found['share']:.0%}")
            start = ["", ""]
    return made


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make lamps", description=__doc__.splitlines()[0])
    add_options(parser, 100, "out/lamps.json", step=None)
    parser.add_argument("--methods", nargs="+", default=["certified"], help="to hold against none (default: certified)")
    parser.add_argument("--radius", nargs="+", type=float, default=[0.03, 0.1], help="of lamps (default: 0.03 0.1)")
    parser.add_argument("--samples", nargs="+", type=int, default=[64], help="of each lamp (default: 64)")
    options = parser.parse_args(arguments)
    paths, settings = prepared(options)
    report: dict[str, Any] = {"machine": machine(), "runs": []}
    for path in paths:
        for radius in options.radius:
            for samples in options.samples:
                lamps = replace(settings, lamp_radius=radius, lamp_samples=samples).validated()
                say(f"{path.name}: radius {radius}, {samples} samples, {options.frames} frames")
                report["runs"].append(measure(path, lamps, options.methods, options.frames, options.step))
    faults = [
        f"{Path(r['scene']).name}: {name} differs in frame {at}" for r in report["runs"] for name, at in r["differ"]
    ]
    return finish(report, table(report["runs"]), options.json, faults)


if __name__ == "__main__":
    sys.exit(main())
