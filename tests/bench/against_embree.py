"""Ray rates and whole frames side by side with Embree, in one run, with every answer compared.

    make bench                                                Kitchen at 10 views, Robot at 5, 100 frames of each
    make bench ARGS="--quick"                                 a first look
    make bench ARGS="--accelerator kdtree --frames 0 robot.aff --views 3"

Embree is the one that embreex's wheel brings along, called by its C interface: single rays and packets, with and
without its coherent flag, robust off, over one tree of all triangles of the moment.  Its best mode is found anew for
each kind of rays in each view, and is timed tracing alone: packets are filled before the clock starts.  Ours is timed
as the call of a `World`, answers allocated and all.  Any hits are asked of shadow rays, and of those of `any_hit_rays`.
Contestants take turns.  Goals that are missed are printed, and no failure; the exit code is 1 where too many answers
are not those of Embree with robust on, or rays are not those of the frames.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from tests.bench.any_hit_rays import ANY_HITS
from tests.bench.embree import embree_version
from tests.bench.frame_times import KITCHEN, in_words, machine
from tests.bench.frames import whole_frames
from tests.bench.rays import without_quadrics
from tests.bench.report import (
    Goal,
    faults,
    frame_goals,
    frames_table,
    goals_table,
    modes_table,
    ray_goals,
    rays_table,
    to_json,
    views_table,
)
from tests.bench.views import contests
from tracer.frame import Settings
from tracer.geometry.world import ACCELERATORS, World
from tracer.scene.load import load_scene
from tracer.scene.model import Scene, SceneError
from viewer.cli.console import print_table
from viewer.util.messages import say
from viewer.util.resources import scene_path

ROBOT = KITCHEN.parents[1] / "robot" / "Robot.aff"
VIEWS = {KITCHEN: 10, ROBOT: 5}
QUICK = {"views": 1, "rounds": 1, "trials": 1, "frames": 3, "frames_beside": 1}
FULL = {"views": None, "rounds": 7, "trials": 2, "frames": 100, "frames_beside": 10}


def view_times(scene: Scene, views: int) -> list[float]:
    """Evenly spaced along the path, the ends left out."""
    start, end = scene.time_range
    return [start + (i + 0.5) * (end - start) / views for i in range(views)]


def measure(path: Path, options: argparse.Namespace) -> tuple[dict[str, Any], list[Goal], list[str]]:
    """Both contests in one scene, printed; what goes into the JSON, goals, and faults."""
    scene = load_scene(path)
    quadrics = scene.primitive_count - scene.triangle_count
    if quadrics:
        say(f"{path.name}: {quadrics} spheres and cones are left out: the contest is one of triangles")
    scene = without_quadrics(scene)
    before = time.perf_counter()
    world = World(scene, scene.time_range[0], options.accelerator)
    built = time.perf_counter() - before
    rounds, goals, found = options.rounds, [], []
    times = view_times(scene, options.views or VIEWS.get(path, 5))
    for number, moment in enumerate(times):
        say(f"{path.name}: view {number + 1} of {len(times)}, {moment:.2f} s")
        found += contests(world, moment, options.size, rounds, options.trials, number)
    for table in (
        rays_table(path.name, options.size, found),
        rays_table(path.name, options.size, found, ANY_HITS),
        views_table(path.name, found),
        views_table(path.name, found, ANY_HITS),
        modes_table(path.name, found),
    ):
        print_table(table)
    goals += ray_goals(path.name, found)
    frames = []
    settings = Settings(options.size, options.size, options.depth, accelerator=options.accelerator).validated()
    if options.frames:
        beside = min(options.frames_beside, options.frames)
        for frame in whole_frames(world, settings, options.frames, beside, rounds):
            frames.append(frame)
            if frame.embree or len(frames) % 10 == 0:
                say(f"{path.name}: frame {len(frames)} of {options.frames}")
        print_table(frames_table(path.name, frames))
        goals += frame_goals(path.name, frames)
    result = {
        "scene": str(path),
        "triangles": scene.triangle_count,
        "quadrics_left_out": quadrics,
        "build_seconds": built,
        "rays": [contest.to_json() for contest in found],
        "frames": [frame.to_json() for frame in frames],
    }
    return result, goals, faults(path.name, found, frames)


def _options(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="make bench", description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="default: BART's Kitchen and Robot where they are")
    parser.add_argument("--accelerator", choices=ACCELERATORS, default=ACCELERATORS[-1], help="(default: %(default)s)")
    for name, what in (
        ("views", "views per scene (default: 10 of Kitchen, 5 of others)"),
        ("rounds", "turns of each contestant"),
        ("trials", "runs of each of Embree's modes, to find the best"),
        ("frames", "whole frames along the path; 0 for none"),
        ("frames-beside", "how many of them beside Embree"),
    ):
        default = FULL[name.replace("-", "_")]
        parser.add_argument(f"--{name}", type=int, help=what + (f" (default: {default})" if default else ""))
    parser.add_argument("--size", type=int, default=512, help="width and height in pixels (default: 512)")
    parser.add_argument("--depth", type=int, default=10, help="the most bounces (default: 10)")
    parser.add_argument("--quick", action="store_true", help="one view, one round, three frames")
    parser.add_argument("--json", type=Path, default=Path("out/embree.json"), help="(default: out/embree.json)")
    options = parser.parse_args(arguments)
    for name, value in (QUICK if options.quick else FULL).items():
        if getattr(options, name) is None:
            setattr(options, name, value)
        given, least = getattr(options, name), 0 if name.startswith("frames") else 1
        if given is not None and given < least:
            parser.error(f"--{name.replace('_', '-')} is {least} or more")
    if options.size < 1 or options.depth < 0:
        parser.error("--size is 1 or more, --depth 0 or more")
    return options


def main(arguments: list[str] | None = None) -> int:
    options = _options(arguments)
    paths = [scene_path(name) for name in options.scenes] or [path for path in VIEWS if path.exists()]
    if not paths:
        say(f"there is no {KITCHEN}: the default scene stands in")
        paths = [scene_path(None)]
    report: dict[str, Any] = {
        "machine": machine() | {"embree": embree_version()},
        "settings": {name: value for name, value in vars(options).items() if name not in ("scenes", "json")},
        "scenes": [],
    }
    goals: list[Goal] = []
    found: list[str] = []
    try:
        for path in paths:
            result, reached, wrong = measure(path, options)
            report["scenes"].append(result)
            goals += reached
            found += wrong
    except SceneError as error:
        say(str(error))
        return 1
    except KeyboardInterrupt:
        say("stopped")
        return 130
    print_table(goals_table(goals))
    about = report["machine"]
    print(
        f"{in_words(about)}; "
        f"Embree {about['embree']}, numba {about['numba']}, {options.accelerator}; all figures in {options.json}"
    )
    report |= {"goals": to_json(goals), "faults": found}
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(report, indent=1) + "\n")
    for fault in found:
        say(f"not to be trusted: {fault}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
