"""What benchmarks that render paths of scenes have in common: which scenes, their options, and how they end."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from tracer.compiling.compilation import warm_up
from tracer.frame import Settings
from tracer.geometry.world import ACCELERATORS
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path

BART = Path(__file__).resolve().parents[3] / "shared" / "bart"
SCENES = tuple(BART / name for name in ("kitchen/kitchen.aff", "robot/Robot.aff", "museum/museum5.aff"))


def add_options(parser: argparse.ArgumentParser, frames: int, json_file: str, step: int | None = 1) -> None:
    """Scenes, frames, size, threads, structure, and the file that gets all figures.

    Without a step, frames are spread evenly over the whole path."""
    add = parser.add_argument
    add("scenes", nargs="*", metavar="SCENE", help="default: the default scene, and BART's if there")
    add("--frames", type=int, default=frames, help=f"of each run (default: {frames})")
    add("--step", type=int, default=step, help=f"of the path, from one frame to the next (default: {step or 'evenly'})")
    add("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    add("--threads", type=int, default=0, help="0, the default: one per core")
    add("--accelerator", choices=ACCELERATORS, default="bvh8", help="(default: bvh8)")
    add("--json", type=Path, default=Path(json_file), help=f"(default: {json_file})")


def prepared(options: argparse.Namespace) -> tuple[list[Path], Settings]:
    """The files of the scenes and the settings that all runs share; kernels are ready."""
    paths = [scene_path(name) for name in options.scenes]
    paths = paths or [scene_path(None), *(path for path in SCENES if path.exists())]
    settings = Settings(
        options.size, options.size, method="none", threads=options.threads, accelerator=options.accelerator
    )
    warm_up(accelerator=options.accelerator)
    return paths, settings.validated()


def finish(report: dict[str, Any], table: Table, file: Path, faults: Sequence[str]) -> int:
    """Print the table, write every figure, and name the faults; the exit code."""
    print_table(table)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(report, indent=1) + "\n")
    print(f"all figures in {file}")
    for fault in faults:
        say(f"wrong: {fault}")
    return 1 if faults else 0
