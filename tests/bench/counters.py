"""What counting costs: frames of the tracer as it is beside frames of one that counts no steps and no tests.

    make counters                            BART's Kitchen, or the default scene where it is not there
    make counters ARGS="--frames 40 default"

The sources are copied to a temporary folder, and the lines that count inside the structures' traversal
taken out of the copy; where one of them is not found as it is known here, that ends the run.  Each of
the two has a process and compiled kernels of its own.  They render the same frames in turn, now the one
first and now the other, while the other waits.  Every frame of the two must be the same in each bit, and
the one without counters must have counted nothing; else the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tests.bench import frame_server
from tests.bench.frame_times import KITCHEN, in_words, machine
from tracer.frame import Settings
from tracer.runtime.kernel_cache import cache_root
from tracer.runtime.parallel import thread_count
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path

ROOT = Path(__file__).resolve().parents[2]
WITH, WITHOUT = "with counters", "without"
RAYS = ("primary", "secondary", "shadow")
TIMES: dict[str, Callable[[dict[str, Any]], float]] = {
    "frame": lambda r: r["seconds"],
    "  on all cores": lambda r: r["processor_seconds"],  # other work on the machine hardly shows in this
    "  primary rays": lambda r: r["statistics"]["phases"]["primary"],
    "  shading": lambda r: r["statistics"]["phases"]["shading"],
}


@dataclass(frozen=True)
class Edit:
    """Replace `text` by `instead` in a file, where it occurs exactly `times` times."""

    file: str
    text: str
    times: int
    instead: str = ""


COUNTING = re.compile(r"^ +(?:s\.)?count(?:s|ed)\[(?:STEPS|TESTS)\] \+= .*\n", re.MULTILINE)  # a line that only counts
EDITS = (  # where the kd-tree counts on its way
    Edit("tracer/geometry/kdtree/tree.py", "    steps = 1\n", 1),
    Edit("tracer/geometry/kdtree/tree.py", "        steps += 1\n", 1),
    Edit("tracer/geometry/kdtree/tree.py", "    steps: int\n", 1),
    Edit("tracer/geometry/kdtree/tree.py", "leave, steps, pending)", 1, "leave, pending)"),
)


def copy_without_counters(source: Path, target: Path) -> Path:
    """Copy the folder `tracer` from source to target, without what counts steps and tests; the target.

    Raises ValueError where the sources are not what the edits are made for.
    """
    shutil.copytree(source / "tracer", target / "tracer", ignore=shutil.ignore_patterns("__pycache__"))
    for edit in EDITS:
        path = target / edit.file
        text = path.read_text() if path.exists() else ""
        if text.count(edit.text) != edit.times:
            found = f"{text.count(edit.text)} times instead of {edit.times}"
            raise ValueError(f"the counters cannot be taken out: {edit.file} has {edit.text.strip()!r} {found}")
        path.write_text(text.replace(edit.text, edit.instead))
    for path in sorted((target / "tracer").rglob("*.py")):
        text = COUNTING.sub("", path.read_text())
        if found := re.search(r"counts\[(STEPS|TESTS)\]\s*[-+]?=", text):
            raise ValueError(f"the counters cannot be taken out: {path.relative_to(target)} still has {found[0]}")
        path.write_text(text)
    return target


class Server:
    """A process that renders frames with the tracer of a folder (`tests.bench.frame_server`)."""

    def __init__(self, tree: Path, kernels: Path, scene: Path, settings: Settings) -> None:
        command = [sys.executable, frame_server.__file__, str(tree), str(scene), json.dumps(asdict(settings))]
        environment = os.environ | {"PYTHONPATH": str(tree), "SHADOWCULL_CACHE_DIR": str(kernels)}
        self._process = subprocess.Popen(
            command, env=environment, cwd=tree, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def answer(self) -> dict[str, Any]:
        """The next answer; raises RuntimeError where the process has ended instead."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"the process that renders frames has ended with exit code {self._process.wait()}")
        return json.loads(line)

    def render(self, number: int) -> dict[str, Any]:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{number}\n")
        self._process.stdin.flush()
        return self.answer()

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


def measure(
    trees: dict[str, tuple[Path, Path]], scene: Path, settings: Settings, frames: int, start: int
) -> dict[str, Any]:
    """Successive frames of a scene by the tracers of both trees (name -> sources, kernels), in turn."""
    servers: dict[str, Server] = {}
    results: dict[str, list[dict[str, Any]]] = {name: [] for name in trees}
    try:
        for name, (tree, kernels) in trees.items():
            servers[name] = Server(tree, kernels, scene, settings)
        last = min([start + frames, *(server.answer()["frames"] for server in servers.values())])
        for number in range(start, last):
            for name in list(servers)[:: 1 if number % 2 else -1]:
                results[name].append(servers[name].render(number))
    finally:
        for server in servers.values():
            server.close()
    return {
        "scene": str(scene),
        "size": [settings.width, settings.height],
        "depth": settings.depth,
        "threads": thread_count(settings.threads),
        "frames": [start, last],
        "results": results,
        "faults": faults(results, start),
    }


def faults(results: dict[str, list[dict[str, Any]]], start: int) -> list[str]:
    """What shows that the two did not do the same, or that not just one of them counted."""
    found = [] if results[WITH] else ["no frame was rendered"]
    for number, (counted, uncounted) in enumerate(zip(results[WITH], results[WITHOUT]), start):
        if counted["digest"] != uncounted["digest"]:
            found.append(f"frame {number}: the pictures, or the modes, are not the same")
        for name, result in ((WITH, counted), (WITHOUT, uncounted)):
            work = sum(result["statistics"][r][w] for r in RAYS for w in ("traversal_steps", "intersection_tests"))
            if (work > 0) != (name == WITH):
                found.append(f"frame {number}, {name}: {work} steps and tests were counted")
    return found


def table(result: dict[str, Any]) -> Table:
    """Medians of the frames' times and, with its quartiles, of the ratio of the two times of each frame."""
    (width, height), (first, last) = result["size"], result["frames"]
    made = Table(
        title=f"What counters cost: {Path(result['scene']).name}, frames {first} to {last - 1}, {width} x {height}, "
        f"depth {result['depth']}, {result['threads']} thread{'s' * (result['threads'] != 1)}",
        title_justify="left",
        title_style="bold",
        caption="medians over frames; the ratio is that of each frame's two times, with its quartiles",
        caption_justify="left",
    )
    for heading in ("", f"{WITH}, ms", f"{WITHOUT}, ms", "ratio"):
        made.add_column(heading, justify="right" if heading else "left")
    for name, of in TIMES.items():
        counted, uncounted = (np.array([of(r) for r in result["results"][side]]) for side in (WITH, WITHOUT))
        middle, low, high = np.percentile(counted / uncounted, (50, 25, 75))
        times = (f"{1000 * np.median(seconds):.1f}" for seconds in (counted, uncounted))
        made.add_row(name, *times, f"{middle:.3f}  ({low:.3f} to {high:.3f})")
    return made


def main() -> int:
    options = arguments()
    try:
        return run(options)
    except (ValueError, RuntimeError, OSError) as error:
        say(str(error))
        return 1


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make counters", description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="default: Kitchen, or the default scene")
    parser.add_argument("--frames", type=int, default=24, help="frames by each of the two (default: 24)")
    parser.add_argument("--start", type=int, default=0, help="number of the first frame (default: 0)")
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--depth", type=int, default=10, help="the most bounces (default: 10)")
    parser.add_argument("--threads", type=int, default=0, help="0, the default: one per core")
    parser.add_argument("--json", type=Path, default=Path("out/counters.json"), help="(default: out/counters.json)")
    return parser.parse_args()


def run(options: argparse.Namespace) -> int:
    """Measure, print and write what was measured; the exit code."""
    if options.scene is None and not KITCHEN.exists():
        say(f"Kitchen is not measured, the default scene is: there is no {KITCHEN}")
    scene = scene_path(options.scene or (str(KITCHEN) if KITCHEN.exists() else None)).resolve()
    if not scene.is_file():
        raise ValueError(f"{scene}: no such file")
    settings = Settings(options.size, options.size, options.depth, threads=options.threads).validated()
    about = machine()
    with tempfile.TemporaryDirectory(prefix="shadowcull-counters-") as folder:
        copy = copy_without_counters(ROOT, Path(folder))
        say("compiling the tracer without counters, which takes about a minute")
        trees = {WITH: (ROOT, cache_root()), WITHOUT: (copy, Path(folder) / "kernels")}
        result = measure(trees, scene, settings, options.frames, options.start)
    if result["results"][WITH]:
        print_table(table(result))
    print(in_words(about))
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": about} | result, indent=1) + "\n")
    for fault in result["faults"]:
        say(f"not to be trusted: {fault}")
    return 1 if result["faults"] else 0


if __name__ == "__main__":
    sys.exit(main())
