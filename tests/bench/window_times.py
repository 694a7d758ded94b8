"""How soon the window opens and shows a picture, and how long its own frames take while the tracer works.

    make window                                     the default scene, and BART's Kitchen where it is there
    make window ARGS="--seconds 20 robot.aff"       other scenes, for longer
    make first-start                                only starts: with nothing compiled, and with the wheel of kernels

Each scene is opened in a window of its own, in a new process.  The first is opened once more before
that with no kernels compiled.  A frame is timed from when the window begins it until it is on the
screen; beside that stands for how long its thread was at work, which other processes cannot change.
While the tracer works all cores are busy; what other processes had of them meanwhile, the X server and
those that compile among them, is told.  A window that shows no picture, or that draws or traces
nothing where it should, ends the benchmark with exit code 1.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from tests.bench.frame_times import KITCHEN, in_words, machine
from tests.bench.window_server import STATES
from tracer.runtime.kernel_cache import cache_root
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path
from viewer.util.screen import has_display, no_display_reason

ROOT = Path(__file__).resolve().parents[2]
SEEN = ("window", "first picture", "full picture")
COLD, WARM, WHEEL, WHEEL_AGAIN = "cold", "warm", "from the wheel", "the same again"
GOALS = {COLD: 30.0, WARM: 2.0, WHEEL: 4.0, WHEEL_AGAIN: 4.0}  # seconds to the full picture
MEDIAN, HIGH = 20.0, 50.0  # milliseconds a frame, and of the 99th percentile
TRACING = ("tracing", "moving")


class Start(NamedTuple):
    """A start to be timed: of which scene, what is compiled already, where kernels are kept, and what is installed
    besides, if anything."""

    scene: Path
    kernels: str
    cache: Path
    packages: Path | None = None


def measure(start: Start, size: str, seconds: float) -> dict[str, Any]:
    """Open a scene in a window; what the process tells, or RuntimeError in one line where it fails."""
    scene = start.scene
    with tempfile.TemporaryDirectory() as settings:
        environment = os.environ | {"SHADOWCULL_CACHE_DIR": str(start.cache), "SHADOWCULL_CONFIG_DIR": settings}
        if start.packages:
            environment["PYTHONPATH"] = os.pathsep.join([str(start.packages), os.environ.get("PYTHONPATH", "")])
        command = [sys.executable, "-m", "tests.bench.window_server", str(scene.absolute()), size, str(seconds)]
        done = subprocess.run(
            [*command, str(time.time())], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600
        )
    if done.returncode or not done.stdout:
        raise RuntimeError(f"{scene.name}: {(done.stderr.strip().splitlines() or ['the window failed'])[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


def faults_of(result: dict[str, Any], only_start: bool = False) -> list[str]:
    """What shows that the times, or those of the start alone, are not what they are said to be."""
    found = [f"no {what} was seen" for what in SEEN if what not in result["seen"]]
    for state in () if only_start else TRACING:
        found += [] if result["frames"][state] else [f"{state}: the window drew nothing"]
        found += [] if result["traced"][state] else [f"{state}: nothing was traced"]
    return found


def summary(frames: list[list[float]]) -> dict[str, float]:
    """Of a state's frames, in milliseconds."""
    taken, worked = 1e3 * np.array(frames).T
    return {
        "frames": len(taken),
        "median": float(np.median(taken)),
        "high": float(np.percentile(taken, 99)),
        "longest": float(taken.max()),
        "own": float(np.median(worked)),
    }


def _starts(results: list[dict[str, Any]]) -> Table:
    made = Table(
        title="From the start of the process",
        title_justify="left",
        title_style="bold",
        caption="seconds of processors are those of the window's process",
        caption_justify="left",
    )
    made.add_column("scene")
    made.add_column("kernels")
    for what in (*SEEN, "goal", "processors", "load"):
        made.add_column(what if what == "load" else f"{what}, s", justify="right")
    for result in results:
        seen = [f"{result['seen'][what]:.2f}" if what in result["seen"] else "" for what in SEEN]
        rest = (f"{GOALS[result['kernels']]:g}", f"{result['worked']['full picture']:.1f}", f"{result['load']:.1f}")
        made.add_row(Path(result["scene"]).name, result["kernels"], *seen, *rest)
    return made


def _frames(result: dict[str, Any]) -> Table:
    made = Table(
        title=f"{Path(result['scene']).name}: the window's frames, {result['size']}, {result['kernels']}",
        title_justify="left",
        title_style="bold",
        caption=f"goals while tracing: median {MEDIAN:g} ms, 99th percentile {HIGH:g} ms",
        caption_justify="left",
    )
    made.add_column("while")
    for heading in ("frames", "traced", "median, ms", "99 %, ms", "longest, ms", "own thread, ms", "others, cores"):
        made.add_column(heading, justify="right")
    for state in STATES[1:-1]:
        if result["frames"][state]:
            s = summary(result["frames"][state])
            times = [f"{s[name]:.1f}" for name in ("median", "high", "longest", "own")]
            others = f"{result['others'].get(state, float('nan')):.2f}"
            made.add_row(state, str(s["frames"]), str(result["traced"][state]), *times, others)
    return made


def _from_wheel(scene: Path, folder: Path) -> list[Start]:
    """The first and the second start with the newest wheel of kernels, unpacked into a folder; none without one."""
    wheels = sorted((ROOT / "dist").glob("shadowcull_kernels-*.whl"), key=lambda path: path.stat().st_mtime)
    if not wheels:
        say("no wheel of kernels is timed: make kernel-wheel builds one")
        return []
    zipfile.ZipFile(wheels[-1]).extractall(folder / "packages")
    return [Start(scene, kernels, folder / "cache", folder / "packages") for kernels in (WHEEL, WHEEL_AGAIN)]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make window", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: the default scene, and Kitchen if there")
    parser.add_argument("--seconds", type=float, default=8.0, help="of each thing that goes on (default: 8)")
    parser.add_argument("--size", default="1280x800", help="of the window (default: 1280x800)")
    parser.add_argument("--first-start", action="store_true", help="only start, without kernels and with their wheel")
    parser.add_argument("--no-cold", action="store_true", help="do not start with no kernels compiled")
    parser.add_argument("--no-rehearsal", action="store_true", help="do not open an untimed window first")
    parser.add_argument("--json", type=Path, default=Path("out/window.json"), help="(default: out/window.json)")
    options = parser.parse_args(arguments)
    if not has_display():
        say(f"no window can be timed: {no_display_reason()}")
        return 1
    scenes = [scene_path(name) for name in options.scenes] or [scene_path(None), *([KITCHEN] * KITCHEN.exists())]
    report: dict[str, Any] = {"machine": machine(), "windows": []}
    try:
        with tempfile.TemporaryDirectory() as empty:
            starts = [] if options.no_cold else [Start(scenes[0], COLD, Path(empty, "cold"))]
            if options.first_start:
                starts += _from_wheel(scenes[0], Path(empty))
            else:
                starts += [Start(scene, WARM, cache_root()) for scene in scenes]
            if not options.no_rehearsal:  # kernels, and the shaders of Mesa's own cache
                measure(Start(scenes[0], WARM, cache_root()), options.size, 0.5)
            for start in starts:
                result = measure(start, options.size, 0.5 if options.first_start else options.seconds)
                about = {"scene": str(start.scene), "kernels": start.kernels, "size": options.size}
                report["windows"].append(about | result | {"faults": faults_of(about | result, options.first_start)})
    except RuntimeError as error:
        say(error)
        return 1
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(report, indent=1) + "\n")
    whole = [result for result in report["windows"] if not result["faults"]]
    for result in whole if not options.first_start else []:
        print_table(_frames(result))
    print_table(_starts(whole))
    print(f"{in_words(report['machine'])}; all in {options.json}")
    faults = [f"{Path(r['scene']).name}: {fault}" for r in report["windows"] for fault in r["faults"]]
    for fault in faults:
        say(f"not to be trusted: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
