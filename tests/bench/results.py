"""Everything that the pages of results and performance tell in tables, measured anew and written there.

    make results                                   all of it: about an hour and a half on two cores
    make results ARGS="--write"                    into docs/results.md and docs/performance.md as well
    make results ARGS="--only table-1 rays"        only these tables
    make results ARGS="--resume --write"           go on with a run that was stopped
    make results ARGS="--quick"                    small pictures and few frames, to see that all of it works

Every run is a command of its own, one after the other, because they must not disturb each other.  What each wrote, and
on which machine, stays in build/results, or in build/results-quick.  BART's scenes are needed.  Where other work took
the processor, the line below a table says so: figures of time want a quiet machine, counters do not.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.bench import results_tables as tables
from tests.bench.frame_times import machine
from tests.bench.of_scenes import SCENES
from tests.bench.results_tables import Figures
from viewer.util.messages import say

ROOT = Path(__file__).resolve().parents[2]
KITCHEN, ROBOT, MUSEUM = map(str, SCENES)
TABLE_1 = ["--path-frames", "100", "--methods", "none,paper"]
METHODS = ["--path-frames", "100", "--verify", "--methods", "none,paper,cells,certified,certified+cache"]
PATH = ["--frames", "200", "--step", "4"]  # every fourth frame of Kitchen's path, the whole of the others'


def _bench(scene: str, *arguments: str) -> list[str]:
    return ["viewer", "bench", scene, *arguments]


def _quickest(scene: str, accelerator: str, method: str, path: list[str]) -> list[str]:
    return ["tests.bench.quickest", scene, "--accelerator", accelerator, "--method", method, *path]


# Name → module and arguments; each is given the file that it writes.
TIMES = {
    f"{name}-{accelerator}-{method}": _quickest(scene, accelerator, method, PATH)
    for accelerator, method in (("kdtree", "certified"), ("bvh8", "certified"), ("bvh8", "auto"))
    for name, scene in (("kitchen", KITCHEN), ("robot", ROBOT), ("museum", MUSEUM))
}
COMMANDS: dict[str, list[str]] = {
    "kitchen": _bench(KITCHEN, *METHODS),
    "robot": _bench(ROBOT, *METHODS),
    "museum": _bench(MUSEUM, *METHODS),
    "kitchen-one-tree": _bench(KITCHEN, "--accelerator", "kdtree-lazy", *TABLE_1),
    "robot-one-tree": _bench(ROBOT, "--accelerator", "kdtree-lazy", *TABLE_1),
    "embree": ["tests.bench.against_embree"],
    **TIMES,
    "lamps": ["tests.bench.lamps", "--frames", "20"],
    "motion": ["tests.bench.motion"],
}
WINDOWS = ("tests.bench.motion",)  # they need a screen
QUICK = {
    "viewer": ["--path-frames", "3", "--size", "48x48"],
    "tests.bench.against_embree": ["--quick", "--size", "128"],
    "tests.bench.quickest": ["--frames", "3", "--size", "64"],
    "tests.bench.lamps": ["--frames", "1", "--size", "48", "--samples", "4"],
    "tests.bench.motion": ["--bursts", "1"],
}


@dataclass(frozen=True)
class Part:
    """A table of a page, between two marks, and the runs it is made of."""

    page: str
    runs: tuple[str, ...]
    table: Callable[[list[Figures]], str]


def _of_scenes(make: Callable[[dict[str, Figures]], str], *names: str) -> Callable[[list[Figures]], str]:
    return lambda runs: make(dict(zip(names, runs, strict=True)))


PARTS: dict[str, Part] = {
    "table-1": Part("results", ("kitchen", "robot"), _of_scenes(tables.table_1, "kitchen", "robot")),
    "one-tree": Part(
        "results",
        ("kitchen", "robot", "kitchen-one-tree", "robot-one-tree"),
        lambda runs: tables.one_tree(
            dict(zip(("kitchen", "robot"), runs[:2], strict=True)),
            dict(zip(("kitchen", "robot"), runs[2:], strict=True)),
        ),
    ),
    "all-methods": Part(
        "results",
        ("kitchen", "robot", "museum"),
        _of_scenes(tables.all_methods, "kitchen", "robot", "museum"),
    ),
    "times": Part("results", tuple(TIMES), tables.times),
    "rays": Part("performance", ("embree",), lambda runs: tables.rays(runs[0])),
    "frames": Part("performance", ("embree",), lambda runs: tables.frames(runs[0])),
    "lamps": Part("performance", ("lamps",), lambda runs: tables.lamps(runs[0])),
    "motion": Part("performance", ("motion",), lambda runs: tables.motion(runs[0])),
}


def measure(name: str, quick: bool) -> None:
    """Run a command, and keep what it wrote beside what is known of the machine; raises RuntimeError in one line."""
    about, file = machine(), _folder(quick) / "figures.json"
    module, *arguments = COMMANDS[name]
    arguments += QUICK[module] if quick else []
    screen = [sys.executable, "tools/with_screen.py"] if module in WINDOWS else []
    file.parent.mkdir(parents=True, exist_ok=True)
    command = [*screen, sys.executable, "-m", module, *arguments, "--json", str(file)]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL)
    if done.returncode or not file.exists():
        raise RuntimeError(f"{name} ended with {done.returncode}: {' '.join(COMMANDS[name])}")
    kept = {"machine": about, "command": [module, *arguments], "figures": json.loads(file.read_text())}
    _kept(name, quick).write_text(json.dumps(kept) + "\n")
    file.unlink()


def _folder(quick: bool) -> Path:
    """Quick runs are kept apart, so that `--resume --write` never takes them for results."""
    return ROOT / "build" / ("results-quick" if quick else "results")


def _kept(name: str, quick: bool) -> Path:
    """What a run measured, and where."""
    return _folder(quick) / f"{name}-measured.json"


def _about(kept: list[dict[str, Any]]) -> str:
    """One line below a table: when and where it was measured, and what else the machine did."""
    of = [one["machine"] for one in kept]
    days = sorted({about["date"][:10] for about in of})
    loads = [about["load_before"] for about in of if about["load_before"] is not None]
    return (
        f"*Measured {' and '.join(dict.fromkeys((days[0], days[-1])))} on {of[0]['processor']}, {of[0]['cores']} cores"
        + (f", load before {min(loads):.1f} to {max(loads):.1f}" if loads else "")
        + ".*"
    )


def written(page: str, name: str, text: str) -> str:
    """A page with what stands between the marks of a part replaced; raises ValueError where it has no marks."""
    begin, end = f"<!-- make results: {name} -->\n", "<!-- end of what is measured -->\n"
    before, found, rest = page.partition(begin)
    _, closed, after = rest.partition(end)
    if not found or not closed:
        raise ValueError(f"there is no place for {name!r}: it wants the line {begin.strip()!r}")
    return f"{before}{begin}\n{text}\n{end}{after}"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="make results", description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=PARTS, metavar="TABLE", default=list(PARTS), help=", ".join(PARTS))
    parser.add_argument("--resume", action="store_true", help="keep what an earlier run measured")
    parser.add_argument("--write", action="store_true", help="write the tables into the documentation")
    parser.add_argument("--quick", action="store_true", help="small pictures and few frames; never written")
    options = parser.parse_args(arguments)
    if options.quick and options.write:
        parser.error("--write: what --quick measures is no result")
    if missing := [str(path) for path in SCENES if not path.exists()]:
        say(f"BART's scenes are needed: there is no {missing[0]}")
        return 1
    if not options.resume:
        shutil.rmtree(_folder(options.quick), ignore_errors=True)
    wanted = list(dict.fromkeys(run for name in options.only for run in PARTS[name].runs))
    try:
        for number, name in enumerate(wanted):
            if not _kept(name, options.quick).exists():
                say(f"{name}, {number + 1} of {len(wanted)}: {' '.join(COMMANDS[name])}")
                measure(name, options.quick)
        for name in options.only:
            part = PARTS[name]
            kept = [json.loads(_kept(run, options.quick).read_text()) for run in part.runs]
            text = f"{part.table([one['figures'] for one in kept])}\n{_about(kept)}\n"
            print(f"{name}\n\n{text}")
            if options.write:
                page = ROOT / "docs" / f"{part.page}.md"
                page.write_text(written(page.read_text(), name, text))
    except (RuntimeError, ValueError) as error:
        say(str(error))
        return 1
    except KeyboardInterrupt:
        say("stopped; --resume goes on")
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main())
