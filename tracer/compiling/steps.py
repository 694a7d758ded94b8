"""What is compiled, step by step: a tiny scene is rendered phase by phase, and each phase named before its kernels are
made ready.

Steps are grouped into parts, so that processes can compile a part each.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tracer.methods.cache
import tracer.methods.cells  # noqa: F401
from tracer.culling.cells import units_of
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.frame_in_progress import FrameInProgress
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives
from tracer.geometry.queries import Placed, read_batch
from tracer.geometry.rays import INFINITY, MISS
from tracer.geometry.world import STRUCTURES
from tracer.inspect import ray_probe
from tracer.method import DEFAULT_METHOD, Kind, Method
from tracer.methods import certified_lights
from tracer.methods.certified import CertifiedCells
from tracer.methods.certified_lights import CertifiedLights
from tracer.methods.interface import StageTable
from tracer.neighbours.certified.cost_model import CostModel
from tracer.renderer import Renderer
from tracer.runtime.kernels import native_callback
from tracer.scene.animation import Animation
from tracer.scene.crease import creased_normals
from tracer.scene.mesh_options import CREASE
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
from tracer.simd import f32_at, i32_at
from tracer.visibility.budget import COUNTERS as CERTIFYING
from tracer.visibility.budget import Budget

# What is made ready, with about how much of the whole time it takes when compiled.
SHARES = {
    "nearest hits": 0.13,
    "shadow rays": 0.02,
    "the builder": 0.07,
    "primary rays": 0.02,
    "occlusion testing": 0.02,
    "surfaces": 0.03,
    "shading and shadow testing": 0.13,
    "filling": 0.01,
    "mode setting": 0.01,
    "other methods": 0.56,
}

# None compiles what another does, once the parts that it needs are done.
PARTS = {
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
    "methods": ("other methods",),
}
NEEDS = {"methods": ("trees",)}
FOR_A_PICTURE = ("frame", "trees", "queries")

FIRST = ("none", "paper")
"""What a first picture can be traced by: the default method, and the one that stands in for all others till then."""
WARM = (*FIRST, "none+cache+rest", "cells", "certified", "auto")
"""The methods whose kernels the steps make ready."""


# --- steps: each generator names what comes next, and does it when asked for the one after ---------


def picture_steps(lights: int, accelerator: str) -> Iterator[str]:
    """All that a picture needs by one of the `FIRST` methods."""
    yield from _queries(accelerator)
    yield from _smoothing()
    yield from _frame(lights, accelerator)


def _queries(accelerator: str) -> Iterator[str]:
    structure = STRUCTURES[accelerator]
    yield "nearest hits"
    structure.closest.compile()
    yield "shadow rays"
    structure.any_hit.compile()


def _trees(lights: int, accelerator: str) -> Iterator[str]:
    yield from _smoothing()
    _builders(lights, accelerator)


def _smoothing() -> Iterator[str]:
    """What meshes need before there is a tree over them."""
    yield "the builder"
    creased_normals(np.eye(3), np.arange(3)[None], CREASE)


def _frame(lights: int, accelerator: str) -> Iterator[str]:
    yield "the builder"
    renderer = _builders(lights, accelerator)
    frame = renderer.begin(0.0, progressive=True)
    frame.place_objects_and_lights()
    for name, phase in (
        ("primary rays", frame.trace_primary_rays),
        ("occlusion testing", frame.test_occlusion),
        ("surfaces", frame.see_surfaces),
        ("shading and shadow testing", frame.shade),
        ("filling", frame.so_far),
        ("mode setting", frame.set_modes),
    ):
        yield name
        phase()


def _builders(lights: int, accelerator: str) -> Renderer:
    """A renderer, for which trees are built, and what only those of large scenes need, if the structure has any."""
    if (make_ready := getattr(STRUCTURES[accelerator], "make_ready", None)) is not None:
        make_ready()
    return _renderer(lights, accelerator)


def method_steps(lights: int, accelerator: str) -> Iterator[str]:
    """What all other methods that are warmed up have of their own, and what tells what became of a pixel's rays."""
    yield "other methods"
    ray_probe.make_ready()
    frame = _seeing_nothing(_renderer(lights, accelerator, "cells+cache+rest"))
    units_of(frame.first, *(np.zeros(16, kind) for kind in (np.int32, np.float32, np.float32, np.int32)))
    for method in frame.methods:
        StageTable(method.stages(frame, 0, learns=True), verify=False)
    for kernel in (certified_lights.approach, certified_lights.choose):
        kernel.compile()
    frame = _seeing_nothing(_renderer(lights, accelerator, "certified+cache+rest"))
    frame.prepare_culling()
    frame.find_first()
    certified = frame.methods[0]
    assert isinstance(certified, CertifiedCells) and certified.store is not None
    StageTable(certified.stages(frame, 0, learns=True), verify=False)
    store, model, at = certified.store, CostModel(1, 1, 8, 8, True, 1), np.full(1, 0.25, np.float32)
    todo, points = store.gather(np.full(1, -1, np.int32), at, at, model.root_requests)
    store.certify(todo, points, model, store.count, np.zeros((store.threads, CERTIFYING), np.int64))
    none = np.zeros(1, np.int32)
    certified.slack.are_provable(none, at, at, none)
    store.keep_within(0.0, np.zeros(1, np.int32))
    _certify_regions(accelerator)


def _seeing_nothing(renderer: Renderer) -> FrameInProgress:
    """A frame that has met nothing, as no ray has been traced."""
    frame = renderer.begin(0.0)
    frame.place_objects_and_lights()  # an object has come to rest: what that darkens is looked for
    frame.buffers.primitive.fill(MISS)
    return frame


def _certify_regions(accelerator: str) -> None:
    """What is certified of more lights than words have room for."""
    settings = Settings(width=4, height=4, method="certified", threads=1, accelerator=accelerator)
    frame = _seeing_nothing(Renderer(tiny_scene(MAX_CULLED_LIGHTS + 1), settings))
    frame.prepare_culling()
    certified = frame.methods[0]
    assert isinstance(certified, CertifiedLights) and certified.store is not None
    StageTable(certified.stages(frame, 0, learns=True), verify=False)
    store = certified.store
    store.wanted[:1] = True
    store.certify(Budget(), 1)
    store.describe(0, np.zeros(3, np.float32), 0)


def render_tiny(method: str, lights: int, accelerator: str) -> None:
    """Render with a method, so that its kernels are there: by as many lights as words hold of each size, or by more,
    as some methods have nothing to do with fewer."""
    many = 15 if lights <= 15 else MAX_CULLED_LIGHTS if lights <= MAX_CULLED_LIGHTS else MAX_CULLED_LIGHTS + 1
    settings = Settings(width=4, height=4, method=method, threads=1, accelerator=accelerator)
    renderer = Renderer(tiny_scene(many), settings)
    for time in (0.0, 1.0):  # what a first frame teaches is asked in the second
        renderer.render(time)


@cache
def kinds_of(*names: str) -> frozenset[Kind]:
    """The methods, and additions, of which methods of these names are made."""
    return frozenset(kind for name in names for kind in Method.parse(name).kinds)


def _renderer(lights: int, accelerator: str, method: str = DEFAULT_METHOD) -> Renderer:
    # As many lights as make a word of that size, no more: each is traced.
    scene = tiny_scene(1 if lights <= 15 else 16)
    return Renderer(scene, Settings(width=4, height=4, method=method, threads=1, accelerator=accelerator))


def tiny_scene(lights: int) -> Scene:
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


# --- parts ---------------------------------------------------------------------------------------


def steps_of(part: str, lights: int, accelerator: str) -> Iterator[str]:
    """The steps of a part, none of which compiles what is another's.

    Changes what structures there are: for a process that does nothing else."""
    structures: dict[str, Any] = STRUCTURES
    if part == "queries":
        return _queries(accelerator)
    if part in ("trees", "methods"):
        queries = dict.fromkeys(("closest", "any_hit"), _Unasked)
        structures[accelerator] = type("Unasked", (structures[accelerator],), queries)
        return (_trees if part == "trees" else method_steps)(lights, accelerator)
    structures[accelerator] = _Nowhere
    return (step for step in _frame(lights, accelerator) if step != "the builder")


@native_callback
def _no_hit(data, batch, first, last, counts):
    """Rays first to last - 1 meet nothing."""
    hits = read_batch(batch)
    t, primitive = f32_at(hits.t), i32_at(hits.primitive)
    for i in range(first, last):
        t[i], primitive[i] = INFINITY, MISS


@native_callback
def _nothing(data, batch, first, last, counts):
    """Nobody asks, as no ray has hit anything."""


class _Nowhere:
    """A structure that no ray meets anything in: frames compile with it as with any other."""

    closest, any_hit = _no_hit, _nothing

    def __init__(
        self, primitives: Primitives, objects: int, progress: Progress | None = None, lazy: bool = False
    ) -> None:
        self._primitives = primitives

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        return np.ones_like(poses.present)

    def built(self) -> None:
        pass

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        primitives = self._primitives
        to_object = poses.to_object.reshape(-1, 12).astype(np.float32)
        arrays = (primitives.triangles, primitives.quadrics, to_object, primitives.object_of)
        return Placed(*arrays, _no_hit.address, _nothing.address, 0, False, np.zeros(6, np.float32))


class _Unasked:
    """A query that is not compiled, as nobody asks it."""

    address = 0
