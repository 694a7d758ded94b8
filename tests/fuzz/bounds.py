"""No kernel reads or writes past the end of what it was given, for any input: kernels compiled with checks of every
index, on arrays between forbidden pages (`tests.fuzz.guarded`), which catch what goes by addresses.

Run as `python -m tests.fuzz.bounds --seconds 600 --seed 0`.  Cases run in a process of their own, which says which one
it is at before it begins; one that ends the process, or in which a check fails, is a fault, and the next goes on.  The
number of a case makes the same case again.

With `--poison`, nothing reads memory whose life has ended: each case is done twice.  The second time whatever is freed
is filled with other bytes at once, and the pages of numpy's arrays stay forbidden to the end.  What is traced must be
the same, bit for bit.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

import tracer
from tests.fuzz import readers
from tests.fuzz.guarded import MEMORY
from tests.fuzz.seeds import seeds, write_beside
from tests.tracing.nasty_worlds import NastyWalk, flattened_walk, nasty_walk, with_lamps
from tests.tracing.worlds import affine, moved, quadrics, scene
from tracer.geometry.world import ACCELERATORS, World
from tracer.method import Method, additions, bases
from tracer.scene.load import load_scene
from tracer.scene.model import CONE, SPHERE, Camera, SceneError

ROOT = Path(__file__).resolve().parents[2]
CHECKED = ROOT / ".cache" / "kernels-checked"
EXTREMES = np.array([0, -0.0, 1, -1, 1e-45, 1e-38, 1e9, -1e9, 1e19, 3e38, -3e38, np.inf, -np.inf, np.nan], np.float32)
SETTLED = "settled"
POISON = {"MALLOC_PERTURB_": "165", "SHADOWCULL_TESTS_KEEP_PAGES": "1"}  # glibc's own, and that of `guarded`
TOGETHER = 40  # cases of a process, where each is done twice


# --- cases: what is made first, and what is then done with it on guarded arrays -----------------------


def _damaged_file(rng: np.random.Generator, number: int) -> Callable[[], list[np.ndarray] | None]:
    """What is left of a file that somebody has damaged, traced."""
    files = seeds()
    with tempfile.TemporaryDirectory() as folder:
        write_beside(Path(folder))
        name, data = readers.case(number, files)
        (Path(folder) / name).write_bytes(data)
        try:
            read = load_scene(Path(folder) / name)
        except SceneError:
            return lambda: None
    return lambda: readers.trace(read)


def _walk(rng: np.random.Generator, number: int) -> Callable[[], list[np.ndarray] | None]:
    """A nasty scene by any method, seen from its own cameras and from where no camera belongs."""
    kind = rng.integers(4)
    walk = flattened_walk(number) if kind == 0 else nasty_walk(number, lights=int(rng.choice([0, 0, 1, 20, 40])))
    seen = with_lamps(walk) if kind == 1 else walk
    return lambda: _render(rng, seen)


def _render(rng: np.random.Generator, walk: NastyWalk) -> list[np.ndarray]:
    settings = tracer.Settings(
        width=int(rng.integers(1, 60)),
        height=int(rng.integers(1, 60)),
        depth=int(rng.integers(0, 6)),
        method=_method(rng, len(walk.scene.lights)),
        modes=bool(rng.random() < 0.3),
        verify=bool(rng.random() < 0.3),
        samples=int(rng.choice([1, 1, 3])),
        threads=int(rng.integers(1, 4)),
        accelerator=str(rng.choice(ACCELERATORS)),
        record_lights=bool(rng.random() < 0.3),
        record_work=bool(rng.random() < 0.3),
        certificates=int(rng.choice([0, 10, 100_000])),
        certificate_memory=float(rng.choice([0.0, 0.01, 256.0])),
    )
    renderer, traced = tracer.Renderer(walk.scene, settings), []
    for when, camera in walk.frames:
        if rng.random() < 0.3:
            camera = _odd(rng, camera)
        if rng.random() < 0.2:
            renderer.settings = replace(settings, width=int(rng.integers(1, 60)), method=_method(rng, 40))
        for frame in renderer.refine(when, camera) if rng.random() < 0.3 else [renderer.render(when, camera)]:
            traced += [frame.color.copy(), frame.primitive.copy()]
    return traced


def _method(rng: np.random.Generator, lights: int) -> str:
    names = [kind.name for kind in bases(measures=True)]
    name = str(rng.choice(names))
    more = [kind.name for kind in additions(name, measures=True) if rng.random() < 0.2]
    return str(Method.parse("+".join([name, *more])))


def _odd(rng: np.random.Generator, camera: Camera) -> Camera:
    """A camera on a surface, far away, or with hardly any angle."""
    scale = float(rng.choice([0.0, 1e-6, 1.0, 1e6, 1e9]))
    position = tuple(float(v) for v in np.multiply(camera.position, scale))
    return replace(camera, position=position, angle=float(rng.choice([1e-3, 1.0, 90.0, 179.0])))


def _rays(rng: np.random.Generator, number: int) -> Callable[[], list[np.ndarray] | None]:
    """Any rays, infinite and none at all, through triangles, spheres and cones of any size."""
    count = int(rng.choice([1, 2, 7, 100, 3000]))
    corners = rng.normal(size=(count, 3, 3)) * np.exp(rng.uniform(-12, 12, (count, 1, 1)))
    wild = rng.random(corners.shape) < 0.02
    corners[wild] = np.clip(rng.choice(EXTREMES[np.isfinite(EXTREMES)], wild.sum()), -1e9, 1e9)
    kinds = [
        (int(rng.choice([SPHERE, CONE])), affine(float(np.exp(rng.uniform(-9, 9))), rng.normal(size=3)), (1.0, 0.3))
        for _ in range(int(rng.integers(0, 20)))
    ]
    body = moved("body", corners[: count // 2 + 1], np.diag([1.5, 1.5, 1.5, 1.0]))
    whole, accelerator = scene(corners, quadrics(kinds), [body]), str(rng.choice(ACCELERATORS))
    n = int(rng.choice([1, 5, 16, 127, 129, 1000]))
    origins, directions = rng.normal(size=(n, 3)) * 3, rng.normal(size=(n, 3))
    if rng.random() < 0.5:
        origins[:], directions[:, 2] = origins[0], 1.0  # which go together
    odd = rng.random((n, 3)) < rng.choice([0.0, 0.01, 0.3])
    origins[odd] = rng.choice(EXTREMES, odd.sum())
    directions[np.roll(odd, 1, 0)] = rng.choice(EXTREMES, odd.sum())
    far = np.abs(np.nan_to_num(EXTREMES, posinf=np.inf))
    t = np.sort(np.where(rng.random((n, 2)) < 0.1, rng.choice(far, (n, 2)), rng.uniform(0, 9, (n, 2))), axis=1)

    def ask() -> list[np.ndarray]:
        world, rays = World(whole, accelerator=accelerator), tracer.RayBatch(origins, directions, t[:, 0], t[:, 1])
        hits = world.closest_hits(rays, threads=1)
        return [hits.t, hits.primitive, world.any_hits(rays, threads=1), world.occluders(rays, threads=1)]

    return ask


CASES = (_damaged_file, _walk, _rays, _walk)


def attempt(number: int) -> str:
    """Do a case, its arrays guarded at their ends or beginnings; returns a digest of what it traced, raises what went
    wrong."""
    rng, digest = np.random.default_rng(number), hashlib.sha256()
    with np.errstate(all="ignore"):
        work = CASES[number % len(CASES)](rng, number)
        with MEMORY.used(at_end=number % 8 < 6):
            for traced in work() or ():
                digest.update(np.ascontiguousarray(traced).tobytes())
    return digest.hexdigest()


# --- processes -------------------------------------------------------------------------------------


def _go_on(number: int, end: int, until: float) -> None:
    """Run cases up to the end, each named before it begins, until the time is up; ends with the first at fault."""
    unraised: list[str] = []
    sys.unraisablehook = lambda e: unraised.append(f"{e.exc_type.__name__}: {e.exc_value}")  # within kernels
    while time.time() < until and number < end:
        print(number, flush=True)
        digest = ""
        try:
            digest = attempt(number)
        except Exception:
            unraised.append(traceback.format_exc())
        if unraised:
            print("fault", *unraised, flush=True)
            os._exit(1)
        print(SETTLED, digest, flush=True)
        number += 1


def run(seconds: float, seed: int) -> int:
    """Run cases for some seconds; how many were at fault."""
    environment = os.environ | {
        "NUMBA_BOUNDSCHECK": "1",
        "SHADOWCULL_CACHE_DIR": str(CHECKED),
        "PYTHONFAULTHANDLER": "1",
    }
    subprocess.run([sys.executable, "-m", "tests.compiled"], cwd=ROOT, env=environment, check=True)
    number, faults, until = seed, 0, time.time() + seconds
    while time.time() < until:
        child = subprocess.run(
            [sys.executable, "-m", "tests.fuzz.bounds", "--from", str(number), "--until", str(until)],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
        )
        lines = child.stdout.splitlines()
        named = [int(line) for line in lines if line.isdecimal()]
        number = named[-1] if named else number
        if child.returncode:
            faults += 1
            print(f"case {number}: exit code {child.returncode}", *lines[lines.index(str(number)) + 1 :], sep="\n")
            print(child.stderr[-3000:], flush=True)
        number += 1
    print(f"cases {seed} to {number - 1}: {faults} at fault")
    return faults


def run_poisoned(seconds: float, seed: int) -> int:
    """Do cases twice for some seconds, the second time with memory that is poisoned as it is freed; how many differ."""
    number, differ, until = seed, 0, time.time() + seconds
    while time.time() < until:
        told = []
        for more in ({}, POISON):
            command = [sys.executable, "-m", "tests.fuzz.bounds", "--from", str(number), "--count", str(TOGETHER)]
            command += ["--until", "inf"]
            done = subprocess.run(command, cwd=ROOT, env=os.environ | more, capture_output=True, text=True)
            told.append([line for line in done.stdout.splitlines() if line.startswith(SETTLED)])
        clean, poisoned = told
        both = min(len(clean), len(poisoned))
        for k in range(both):
            if clean[k] != poisoned[k]:
                differ += 1
                print(f"case {number + k} traces something else where memory is poisoned", flush=True)
        number += both
        if both < TOGETHER:  # the next case ended a process, with or without poison
            differ += 1
            print(f"case {number}: ended after {len(clean)} cases, poisoned after {len(poisoned)}", flush=True)
            number += 1
    print(f"cases {seed} to {number - 1}, poisoned: {differ} differ")
    return differ


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--from", type=int, dest="first", help=argparse.SUPPRESS)
    parser.add_argument("--until", type=float, help=argparse.SUPPRESS)
    parser.add_argument("--count", type=int, default=1 << 62, help=argparse.SUPPRESS)
    parser.add_argument("--poison", action="store_true", help="each case twice: what was freed must not be read")
    options = parser.parse_args()
    if options.first is not None:
        _go_on(options.first, options.first + options.count, options.until)
        return 0
    if options.poison:
        return 1 if run_poisoned(options.seconds, options.seed) else 0
    return 1 if run(options.seconds, options.seed) else 0


if __name__ == "__main__":
    sys.exit(main())
