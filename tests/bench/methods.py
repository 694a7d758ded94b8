"""All methods side by side: what each saves, takes, holds and gets wrong, scene by scene.

    make methods                                        BART's scenes where they are there, office and courtyard
    make methods ARGS="--frames 4 --size 128 kitchen.aff"
    make methods ARGS="--write"                         into the page of methods, docs/methods.md
    make methods ARGS="--write --size 48 --frames 3 courtyard"   there, the table of this scene alone

Every method has a renderer of its own, and they take turns frame by frame.  Steps, tests and wrong answers are those of
the paper's structure, which counts ray by ray; with more lights than modes have room for, which would take it hours, of
the fast one.  Times are those of the fast one, in seconds of processor on one thread, so that others at work do not
count.  The error is the mean difference to the picture of `none`, as a part of its mean.
Every picture by an exact method must be that of `none`, bit for bit; a run in which one is not ends with exit code 1.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.table import Table

from tests.bench.frame_times import machine
from tests.bench.of_scenes import SCENES
from tracer.compiling.compilation import make_ready, warm_up
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.experiments.experiment import REFERENCE, figures_of
from tracer.frame import Settings
from tracer.method import Method, line_up
from tracer.renderer import Renderer
from tracer.scene.load import load_visible_scene
from tracer.state import open_world
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.numbers import memory
from viewer.util.resources import scene_path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "methods.md"
BEGIN, END = "<!-- measured by make methods -->\n", "<!-- end of what is measured -->\n"
HEADINGS = ("method", "steps", "tests", "time", "preparing", "memory", "wrong", "error")


@dataclass
class Sums:
    """What a method's frames came to."""

    steps: float = 0.0
    tests: float = 0.0
    seconds: float = 0.0
    preparing: float = 0.0
    memory: int = 0
    wrong: int = 0
    due: int = 0
    error: float = 0.0  # summed over the frames
    frames: int = 0
    differ: list[int] = field(default_factory=list)


def measure(path: Path, size: int, frames: int) -> dict[str, Sums]:
    """The sums of every method that is worth a look in a scene, over frames that are spread over its path."""
    scene = load_visible_scene(path, lambda *_: None)
    numbers = [k * max(1, scene.frames - 1) // max(1, frames - 1) for k in range(min(frames, scene.frames))]
    methods = line_up(len(scene.lights))
    sums = {method: Sums() for method in methods}
    counted = "kdtree" if len(scene.lights) <= MAX_CULLED_LIGHTS else "bvh8"
    for accelerator, verify in ((counted, True), ("bvh8", False)):
        settings = Settings(size, size, method=REFERENCE, threads=1, verify=verify, accelerator=accelerator).validated()
        world = open_world(scene, settings)
        renderers = {
            method: Renderer(scene, replace(settings, method=method), world=world, clock=time.process_time)
            for method in methods
        }
        warm_up(None, len(scene.lights), accelerator)  # untimed, as is what methods have of their own
        for method in methods:
            make_ready(method, len(scene.lights), accelerator)
        renderers[REFERENCE].render(scene.frame_time(0))
        for number in numbers:
            truth = np.empty(0)
            for method, renderer in renderers.items():
                frame, of = renderer.render(scene.frame_time(number)), sums[method]
                statistics = frame.statistics
                if method == REFERENCE:
                    truth = frame.color
                elif Method.parse(method).exact and frame.color.tobytes() != truth.tobytes():
                    of.differ.append(number)
                of.error += float(np.abs(frame.color - truth).mean() / max(float(truth.mean()), 1e-9))
                of.frames += 1
                if verify:
                    of.steps += statistics.shadow.traversal_steps + statistics.certificate_steps
                    of.tests += statistics.shadow.intersection_tests + statistics.certificate_tests
                    of.wrong += int(figures_of(statistics)["wrong"])
                    of.due += statistics.shadow.due
                else:
                    of.seconds += statistics.seconds
                    of.preparing += statistics.phases.get("certification", 0.0)
                    of.memory = max(of.memory, renderer.memory_bytes)
    return sums


def rows(sums: dict[str, Sums]) -> Iterator[tuple[str, ...]]:
    """The table's lines: savings and times are parts of those of `none`."""
    none = sums[REFERENCE]
    for method, of in sums.items():
        saved = (f"{1 - a / b:.1%}" if b else "" for a, b in ((of.steps, none.steps), (of.tests, none.tests)))
        inexact = f"{of.wrong / max(1, of.due):.3%}", f"{of.error / max(1, of.frames):.3%}"
        yield (
            method,
            *(("", "") if method == REFERENCE else saved),
            f"{of.seconds / none.seconds:.2f}",
            f"{of.preparing:.2f} s" if of.preparing >= 0.005 else "",
            memory(of.memory) if of.memory else "",
            *(("", "") if Method.parse(method).exact else inexact),
        )


def markdown(name: str, sums: dict[str, Sums]) -> str:
    """The table of a scene for the page of methods."""
    lines = [f"| {' | '.join(HEADINGS)} |", "|---" + "|---:" * (len(HEADINGS) - 1) + "|"]
    lines += [f"| `{method}` | {' | '.join(cells)} |" for method, *cells in rows(sums)]
    return f"**{name}**\n\n" + "\n".join(lines) + "\n"


def with_tables(page: str, tables: list[str]) -> str:
    """The page with these tables in the place of those of the same scenes, or after them; others stay."""
    before, _, rest = page.partition(BEGIN)
    there, _, after = rest.partition(END)
    kept = dict(_sections(there)) | {_scene_of(table): table for table in tables}
    return before + BEGIN + "\n" + "\n".join(f"{table.strip()}\n" for table in kept.values()) + "\n" + END + after


def _sections(text: str) -> list[tuple[str, str]]:
    """Tables with the names of their scenes."""
    parts = re.split(r"^(?=\*\*\w)", text, flags=re.M)
    return [(_scene_of(part), part) for part in parts if part.startswith("**")]


def _scene_of(table: str) -> str:
    return table.partition(",")[0].strip("*").lower()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: BART's if there, office and courtyard")
    parser.add_argument("--frames", type=int, default=8, help="of each scene (default: 8)")
    parser.add_argument("--size", type=int, default=256, help="width and height in pixels (default: 256)")
    parser.add_argument("--json", type=Path, default=Path("build/methods.json"), help="(default: build/methods.json)")
    parser.add_argument("--write", action="store_true", help="write the tables into docs/methods.md")
    options = parser.parse_args()
    paths = [scene_path(name) for name in options.scenes]
    paths = paths or [*(path for path in SCENES if path.exists()), scene_path("office"), scene_path("courtyard")]
    figures, tables, faults = {}, [], []
    for path in paths:
        sums = measure(path, options.size, options.frames)
        name = f"{path.stem}, {options.size} × {options.size}, {max(of.frames for of in sums.values()) // 2} frames"
        table = Table(title=name, title_justify="left", title_style="bold")
        for heading in HEADINGS:
            table.add_column(heading, justify="left" if heading == "method" else "right", no_wrap=True)
        for row in rows(sums):
            table.add_row(*row)
        print_table(table)
        figures[path.stem] = {method: asdict(of) for method, of in sums.items()}
        tables.append(markdown(name[:1].upper() + name[1:], sums))
        faults += [f"{path.stem}: {m} differs from none in frames {of.differ}" for m, of in sums.items() if of.differ]
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps({"machine": machine(), "scenes": figures}, indent=1) + "\n")
    if options.write:
        PAGE.write_text(with_tables(PAGE.read_text(), tables))
    for fault in faults:
        say(f"wrong: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
