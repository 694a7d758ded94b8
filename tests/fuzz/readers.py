"""Reads damaged files, and traces what is left of them: a scene, or one clear line, and nothing else.

Saved pictures and studies are damaged field by field.

Run as `python -m tests.fuzz.readers --seconds 60 --seed 0`, it damages seed after seed until the time is up, and keeps
files that fail in `build/fuzz`.  The number of a case, which is printed, damages the same file in the same way again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path

import numpy as np

import tracer
from tests.fuzz import fields
from tests.fuzz.damage import damaged
from tests.fuzz.seeds import seeds, write_beside
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import Scene, SceneError

SLOW = 20.0  # seconds that no small file may take
KEPT = Path("build") / "fuzz"


class Fault(AssertionError):
    """A file did something that no file may do."""


def case(number: int, files: dict[str, bytes]) -> tuple[str, bytes]:
    """The name and the content of a damaged file."""
    rng = np.random.default_rng(number)
    name = list(files)[number % len(files)]
    return name, damaged(files[name], rng)


def attempt(path: Path) -> Scene | None:
    """Read a file and trace a few pixels of it by both structures; None if it was refused.  Raises Fault."""
    said, started = StringIO(), time.perf_counter()
    try:
        with warnings.catch_warnings(), redirect_stderr(said):
            warnings.simplefilter("error", RuntimeWarning)
            scene = _traced(path)
    except SceneError as error:
        scene = None
        if not str(error).startswith(str(path.parent)) or not str(error).isprintable():
            raise Fault(f"an error that names no file, or not in one line: {error!r}") from None
    except Exception as error:
        raise Fault(f"{type(error).__name__}: {error}") from error
    if said.getvalue():
        raise Fault(f"words on standard error: {said.getvalue()[:200]!r}")
    if time.perf_counter() - started > SLOW:
        raise Fault(f"it took {time.perf_counter() - started:.0f} s")
    return scene


def attempt_fields(folder: Path, number: int) -> bool:
    """Read a saved picture or a study with changed fields; whether it was not refused.  Raises Fault."""
    said, started = StringIO(), time.perf_counter()
    try:
        with warnings.catch_warnings(), redirect_stderr(said):
            warnings.simplefilter("error")
            refused = fields.read_changed(folder, np.random.default_rng(number))
    except Exception as error:
        raise Fault(f"{type(error).__name__}: {error}") from error
    if refused and (not refused.startswith(str(folder)) or "\n" in refused or "Errno" in refused):
        raise Fault(f"an error that names no file, or not in one line: {refused[:200]!r}")
    if said.getvalue() or time.perf_counter() - started > SLOW:
        raise Fault(f"after {time.perf_counter() - started:.0f} s, words on standard error: {said.getvalue()[:200]!r}")
    return not refused


def _traced(path: Path) -> Scene:
    scene = load_scene(path)
    scene_info(scene)
    trace(scene)
    return scene


def trace(scene: Scene) -> None:
    """Trace a few pixels of a scene by both structures."""
    if scene.primitive_count and len(scene.lights) < 16:  # more need kernels of their own
        start, end = scene.time_range
        for accelerator in ("bvh8", "kdtree"):
            settings = tracer.Settings(8, 8, 3, "certified", threads=1, accelerator=accelerator)
            renderer = tracer.Renderer(scene, settings)
            for moment in (start, (start + end) / 2):
                renderer.render(moment)


def run(seconds: float, seed: int) -> int:
    """Read damaged files for some seconds; how many were at fault."""
    files, faults, number, read, kept = seeds(), 0, seed, 0, 0
    until = time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as folder:
        write_beside(Path(folder))
        while time.monotonic() < until:
            name, data = case(number, files)
            path = Path(folder) / name
            path.write_bytes(data)
            KEPT.mkdir(parents=True, exist_ok=True)
            (KEPT / f"last{path.suffix}").write_bytes(data)  # should it end the process
            try:
                read += attempt(path) is not None
            except Fault as fault:
                faults += 1
                (KEPT / f"{number}{path.suffix}").write_bytes(data)
                print(f"case {number} ({name}): {fault}", flush=True)
            try:
                kept += attempt_fields(Path(folder), number)
            except Fault as fault:
                faults += 1
                print(f"case {number} (fields): {fault}", flush=True)
            number += 1
    print(f"cases {seed} to {number - 1}: {read} files, {kept} pictures and studies, {faults} at fault, others refused")
    return faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    return 1 if run(options.seconds, options.seed) else 0


if __name__ == "__main__":
    sys.exit(main())
