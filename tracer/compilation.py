"""Compiling, or loading from the cache, every kernel a frame needs, before a scene needs it.

A tiny scene is rendered phase by phase, and each phase named while its kernels are made ready.  Where
none have been compiled before, processes of their own compile them first, a part each, into the
cache: numba compiles one kernel at a time in a process, and holds the GIL for most of it.  One that
fails costs time only, as what the cache lacks is compiled when it is needed.  What a first picture
needs comes first, certificates last.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import chain
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np
from llvmlite.binding import get_host_cpu_name
from numpy.typing import NDArray

from tracer.culling.certified.cost_model import CostModel
from tracer.culling.certified.requests import make_requests
from tracer.culling.certified.store import Budget
from tracer.culling.modes import word_type
from tracer.estimate import Estimate
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives
from tracer.geometry.queries import HIT_PRIMITIVE, HIT_T, Placed
from tracer.geometry.rays import INFINITY, MISS
from tracer.geometry.world import STRUCTURES
from tracer.kernels import cache_folder, entry
from tracer.methods.certified import CertifiedCells
from tracer.methods.interface import StageTable
from tracer.renderer import Renderer
from tracer.scene.animation import Animation
from tracer.scene.model import (
    Camera,
    Light,
    Material,
    Progress,
    Quadrics,
    Scene,
    SceneObject,
    Triangles,
    empty_quadrics,
)
from tracer.settings import Settings
from tracer.shading.screen import to_screen
from tracer.simd import f32_at, i32_at, load_i64

_lock = threading.Lock()
_ready: set[str] = set()
_draws: set[str] = set()  # of which all but certificates is ready

# What is made ready, with about how much of the whole time it takes when compiled.
_SHARES = {
    "nearest hits": 0.19,
    "shadow rays": 0.08,
    "the builder": 0.14,
    "primary rays": 0.03,
    "occlusion testing": 0.03,
    "surfaces": 0.06,
    "shading and shadow testing": 0.21,
    "filling": 0.02,
    "mode setting": 0.01,
    "certificates": 0.23,
}
_USUAL = 70.0  # seconds that all of it takes one process on a usual machine, with all cores busy
_POLL = 0.1  # seconds from one look at a process to the next
_STEP = "next step: "  # before what a process says of itself, since whatever it calls may print too


def warm_up(progress: Progress | None = None, lights: int = 1, accelerator: str = "bvh8") -> None:
    """Make every kernel ready for scenes with so many lights; at once where that has been done before.

    `progress` is told what is being compiled; what it raises (Cancelled) passes through.
    """
    report = progress or (lambda what, fraction: None)
    with _lock:
        name = _variant(lights, accelerator)
        if name in _ready:
            return
        done: set[str] = set()
        kept = compiled_before(lights, accelerator)

        def load(steps: Iterator[str]) -> None:
            for step in steps:
                doing = "loading" if kept or step in done else "compiling"
                report(f"{doing} {step}", sum(_SHARES[s] for s in done))
                done.add(step)

        def load_picture() -> None:
            load(chain(_queries(accelerator), _frame(lights, accelerator)))
            _draws.add(name)

        if not kept:
            with suppress(OSError):
                _compile_beside(report, lights, accelerator, done, load_picture)
        if name not in _draws:
            load_picture()
        load(_certificates(lights, accelerator))
        report("ready", 1.0)
        _ready.add(name)
        with suppress(OSError):
            if any(cache_folder().rglob("*.nbc")):  # else nothing could be kept
                _mark(name).touch()


def can_draw(lights: int = 1, accelerator: str = "bvh8") -> bool:
    """Whether pictures can be traced by any method but those that make certificates, which may not be ready yet."""
    return _variant(lights, accelerator) in _draws


def compiled_before(lights: int = 1, accelerator: str = "bvh8") -> bool:
    """Whether all kernels were compiled once already, on this machine and with these sources: they are loaded only."""
    return _mark(_variant(lights, accelerator)).exists()


def _variant(lights: int, accelerator: str) -> str:
    return f"{accelerator}-{word_type(lights).__name__}"


def _mark(variant: str) -> Path:
    """The file that says that all kernels of a variant are in the cache."""
    return cache_folder() / f"{variant}-{sys.implementation.cache_tag}-{get_host_cpu_name()}.ready"


# --- steps: each generator names what comes next, and does it when asked for the one after ---------


def _queries(accelerator: str) -> Iterator[str]:
    structure = STRUCTURES[accelerator]
    yield "nearest hits"
    structure.closest.compile()
    yield "shadow rays"
    structure.any_hit.compile()


def _trees(lights: int, accelerator: str) -> Iterator[str]:
    yield "the builder"
    _renderer(lights, accelerator)


def _frame(lights: int, accelerator: str) -> Iterator[str]:
    yield "the builder"
    frame = _renderer(lights, accelerator).begin(0.0, progressive=True)
    frame.place_objects_and_lights()
    for name, phase in (
        ("primary rays", frame.trace_primary_rays),
        ("occlusion testing", frame.test_occlusion),
        ("surfaces", frame.see_surfaces),
        ("surfaces", frame.find_first),
        ("shading and shadow testing", frame.shade),
        ("filling", lambda: to_screen(frame.so_far().color.reshape(-1, 3), np.empty((16, 4), np.uint8))),
        ("mode setting", frame.set_modes),
    ):
        yield name
        phase()


def _certificates(lights: int, accelerator: str) -> Iterator[str]:
    """All that is certified, and dropped again."""
    yield "certificates"
    renderer = _renderer(lights, accelerator, "certified+cache+rest")
    frame = renderer.begin(0.0)
    frame.place_objects_and_lights()  # an object has come to rest: what that darkens is looked for
    frame.buffers.primitive.fill(MISS)
    frame.prepare_culling()
    certified = frame.methods[0]
    assert isinstance(certified, CertifiedCells) and certified.store is not None
    StageTable(certified.stages(frame, 0, learns=True), verify=False)
    requests = make_requests(1)
    requests.key[0, 0], requests.u[0, 0], requests.v[0, 0], requests.of[0, 0] = -1, 0.25, 0.25, 1
    certified.store.certify([requests], Budget(), CostModel(1, 1, 8, 8, True, 1), None)
    certified.store.keep_within(0.0, np.zeros(1, np.int32))


def _renderer(lights: int, accelerator: str, method: str = "cells+cache+rest") -> Renderer:
    # As many lights as make a word of that size, no more: each is traced.
    scene = _tiny_scene(1 if lights <= 15 else 16)
    # Methods differ in what their kernels are told; what they take along, and certificates, have kernels more each.
    return Renderer(scene, Settings(width=4, height=4, method=method, threads=1, accelerator=accelerator))


def _tiny_scene(lights: int) -> Scene:
    """A triangle and a sphere that never move, and a triangle that could."""
    corners = np.array([[[-1, -1, 0], [1, -1, 0], [0, 1, 0]]], np.float32)
    normals = np.broadcast_to(np.array([0, 0, 1], np.float32), corners.shape)
    zero = np.zeros(1, np.int32)
    triangles = Triangles(corners, normals, np.zeros((1, 3, 2), np.float32), zero, zero - 1)
    sphere = Quadrics(zero, np.eye(4)[None, :3], np.ones((1, 2), np.float32), zero.astype(np.bool_), zero)
    return Scene(
        path=Path("warm-up"),
        objects=(
            SceneObject("static", triangles, sphere),
            SceneObject("dynamic", triangles, empty_quadrics(), (np.eye(4),)),
        ),
        materials=(Material(),),
        textures=(),
        lights=tuple(Light(f"light {i}", (0.0, 1.0, 5.0)) for i in range(lights)),
        camera=Camera((0.0, 0.0, 5.0), (0.0, 0.0, -1.0)),
        animation=Animation.empty(),
    )


# --- parts, in processes of their own ---------------------------------------------------------------

# None compiles what another does, once the parts that it needs are done.
_PARTS = {
    "frame": (
        "primary rays",
        "occlusion testing",
        "surfaces",
        "shading and shadow testing",
        "filling",
        "mode setting",
    ),
    "trees": ("the builder",),
    "queries": ("nearest hits", "shadow rays"),
    "certificates": ("certificates",),
}
_NEEDS = {"certificates": ("trees",)}
_FOR_A_PICTURE = ("frame", "trees", "queries")


def _compile_beside(
    report: Progress, lights: int, accelerator: str, done: set[str], drawable: Callable[[], None] = lambda: None
) -> None:
    """Compile all parts into the cache, as many at once as there are cores; adds the steps to `done`.

    Calls `drawable` when all that a picture needs is there; what `report` raises ends the processes."""
    told: SimpleQueue[tuple[str, str]] = SimpleQueue()  # a part, and its next step
    slots = max(2, os.cpu_count() or 1)
    estimate = Estimate(_PARTS, _SHARES, slots, _USUAL)
    workers: dict[str, subprocess.Popen] = {}
    readers: list[threading.Thread] = []
    under_way: dict[str, str] = {}
    waiting, ended, drawn = list(_PARTS), set[str](), False
    try:
        while True:
            for part in [part for part in waiting if ended.issuperset(_NEEDS.get(part, ()))]:
                if len(workers) - len(ended) < slots:
                    waiting.remove(part)
                    workers[part] = worker = _worker(part, str(lights), accelerator)
                    readers.append(threading.Thread(target=_pass_on, args=(part, worker, told), daemon=True))
                    readers[-1].start()
            if not drawn and ended.issuperset(_FOR_A_PICTURE):
                drawn = True
                drawable()
            report(_told(under_way, estimate, drawn), estimate.fraction)
            if len(ended) == len(_PARTS):
                return
            try:
                part, step = told.get(timeout=_POLL)
            except Empty:
                if not any(reader.is_alive() for reader in readers) and told.empty():
                    return  # none has said why; what is lacking is compiled when it is needed
                continue
            if part in under_way:
                estimate.end(under_way[part])
                done.add(under_way.pop(part))
            if step:
                under_way[part] = step
                estimate.begin(step)
            else:
                ended.add(part)
    finally:
        for worker in workers.values():
            worker.kill()
            worker.wait()
            assert worker.stdin is not None
            worker.stdin.close()


def _told(under_way: dict[str, str], estimate: Estimate, drawn: bool) -> str:
    """What is being compiled, and for how long still."""
    left, picture = estimate.seconds_left(), estimate.seconds_left(_FOR_A_PICTURE)
    names = ", ".join(under_way.values())
    if left is None or picture is None:
        return names or "starting"
    if drawn:
        return f"{names or 'finishing'}; about {max(round(left), 1)} s left"
    return f"{names}; first picture in about {max(round(picture), 1)} s, all in {max(round(left), 1)} s"


def _pass_on(part: str, worker: subprocess.Popen, told: SimpleQueue[tuple[str, str]]) -> None:
    """Queue each step that a worker names, until the worker ends."""
    assert worker.stdout is not None
    for line in worker.stdout:
        if line.startswith(_STEP):
            told.put((part, line.removeprefix(_STEP).strip()))


def _worker(*arguments: str) -> subprocess.Popen:
    """A process that compiles one part, and names its steps on its standard output."""
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(dict.fromkeys([*filter(None, sys.path), str(Path(__file__).parents[1])])),
        "SHADOWCULL_CACHE_DIR": str(cache_folder().parent),
    }
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "tracer.compilation", *arguments],
        env=environment,
        stdin=subprocess.PIPE,  # nothing is written to it: it closes when this process ends, however that happens
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        encoding="utf-8",
        # Ctrl-C is for the process that asked: POSIX takes the first, Windows the second.
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
    )


def _die_with_parent() -> None:
    os.read(0, 1)
    os._exit(1)


@entry
def _no_hit(data, batch, first, last, counts):
    """Rays first to last - 1 meet nothing."""
    t, primitive = f32_at(load_i64(batch + HIT_T)), i32_at(load_i64(batch + HIT_PRIMITIVE))
    for i in range(first, last):
        t[i], primitive[i] = INFINITY, MISS


@entry
def _nothing(data, batch, first, last, counts):
    """Nobody asks, as no ray has hit anything."""


class _Nowhere:
    """A structure that no ray meets anything in: frames compile with it as with any other."""

    closest, any_hit = _no_hit, _nothing

    def __init__(self, primitives: Primitives, objects: int, progress: Progress | None) -> None:
        self._primitives = primitives

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        primitives = self._primitives
        to_object = poses.to_object.reshape(-1, 12).astype(np.float32)
        arrays = (primitives.triangles, primitives.quadrics, to_object, primitives.object_of)
        return Placed(*arrays, _no_hit.address, _nothing.address, 0, False, np.zeros(6, np.float32))


class _Unasked:
    """A query that is not compiled, as nobody asks it."""

    address = 0


def _steps(part: str, lights: int, accelerator: str) -> Iterator[str]:
    """The steps of a part, none of which compiles what is another's."""
    structures: dict[str, Any] = STRUCTURES
    if part == "queries":
        return _queries(accelerator)
    if part in ("trees", "certificates"):
        queries = dict.fromkeys(("closest", "any_hit"), _Unasked)
        structures[accelerator] = type("Unasked", (structures[accelerator],), queries)
        return (_trees if part == "trees" else _certificates)(lights, accelerator)
    structures[accelerator] = _Nowhere
    return (step for step in _frame(lights, accelerator) if step != "the builder")


def _main(part: str, lights: str, accelerator: str) -> None:
    """Compile a part, and say on standard output which step comes next, and at the end that there is none."""
    threading.Thread(target=_die_with_parent, daemon=True).start()
    for step in _steps(part, int(lights), accelerator):
        print(_STEP + step, flush=True)
    print(_STEP, flush=True)
    os._exit(0)  # without taking everything down piece by piece: that takes a second


if __name__ == "__main__":
    _main(*sys.argv[1:])
