"""A scene of numbers, frames of it, and a renderer that traces nothing; and a small scene as a file."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np

from tracer.culling.fate import CACHED, CANDIDATES, CULLED, DYNAMIC_ONLY, FACES_AWAY, MOVING_SHADOW, TRACED
from tracer.frame import Frame, Settings
from tracer.neighbours.voxels.tell import VoxelStates
from tracer.scene.animation import Animation
from tracer.scene.model import (
    Camera,
    Cancelled,
    Light,
    Material,
    Quadrics,
    Scene,
    SceneObject,
    Triangles,
    empty_quadrics,
)
from tracer.statistics import CutCounts, FrameStatistics, WrongCounts
from tracer.visibility.grid import Grid

TINY_SCENE = """
b 0.3 0.4 0.5
v
from 0 1.5 6
at 0 0.5 0
up 0 1 0
angle 45
hither 0.01
resolution 64 48
l 3 5 4  0.6 0.6 0.6
l -4 4 3  0.4 0.4 0.4
f 0.8 0.3 0.2  0.7 0.2 10 0 1
s 0 0.8 0 0.8
f 0.6 0.6 0.6  0.8 0 1 0 1
p 4
-4 0 -4
-4 0 4
4 0 4
4 0 -4
a 0 4 20
"""


def wall_of_triangles(wide: int, high: int, depths: Iterable[int]) -> str:
    """A scene as an AFF file: grids of triangles, one behind the other."""
    lines = ["v", "from 20 15 40", "at 20 15 0", "up 0 1 0", "angle 40", "hither 0.1", "resolution 8 8", "l 1 9 30",
             "f 1 0 0 1 0 1 0 1"]  # fmt: skip
    for z in depths:
        lines += [f"p 3\n{x} {y} {z}\n{x + 1} {y} {z}\n{x} {y + 1} {z + 0.5}" for x, y in np.ndindex(wide, high)]
    return "\n".join(lines) + "\n"


def triangles(count: int) -> Triangles:
    zero = np.zeros(count, np.int32)
    corners = np.zeros((count, 3, 3), np.float32)
    return Triangles(corners, corners.copy(), np.zeros((count, 3, 2), np.float32), zero, zero - 1)


def make_scene(lights: int = 3, frames: int = 11, path: str = "scene.aff") -> Scene:
    """Four static triangles and a sphere, two triangles that move; time runs from 0 to 10 seconds."""
    sphere = Quadrics(np.zeros(1, np.int32), np.eye(4)[None, :3], np.ones((1, 2), np.float32),
                      np.zeros(1, np.bool_), np.zeros(1, np.int32))  # fmt: skip
    return Scene(
        path=Path(path),
        objects=(
            SceneObject("static", triangles(4), sphere),
            SceneObject("train", triangles(2), empty_quadrics(), (np.eye(4),)),
        ),
        materials=(Material("brick"),),
        textures=(),
        lights=tuple(Light(f"light {i}", (0.0, 5.0, float(i))) for i in range(lights)),
        camera=Camera((0.0, 1.0, 5.0), (0.0, 0.0, -1.0)),
        animation=Animation.empty(),
        time_range=(0.0, 10.0),
        frames=frames,
    )


def make_frame(settings: Settings | None = None, time: float = 0.0, camera: Camera | None = None) -> Frame:
    """A frame whose columns are the scene's seven primitives and one miss; two units away, facing us.

    Where it is to be verified, one answer is wrong at pixel 3, 2 and two at 5, 6, which are 0.1 too dark."""
    settings = settings or Settings(width=16, height=8)
    width, height = settings.width, settings.height
    primitive = np.broadcast_to((np.arange(width) * 8 // width).astype(np.int32), (height, width)).copy()
    primitive[primitive == 7] = -1
    hit = primitive >= 0
    counts = np.bincount(primitive[hit], minlength=7).astype(np.int32)
    #        occlusion   light 0    light 1    light 2
    modes = [0, 1, 2 | 1 << 2 | 2 << 4, 2 | 2 << 2 | 3 << 4 | 1 << 6, 3, 3, 2 | 3 << 2]
    normal = np.zeros((height, width, 3), np.float32)
    normal[hit] = (0, 0, 1)
    color = np.full((height, width, 3), 0.5, np.float32)
    wrong = np.zeros((height, width), np.int32)
    wrong[2:3, 3:4], wrong[6:7, 5:6] = 1, 2
    statistics = FrameStatistics()
    statistics.shadow.due, statistics.shadow.culled = 4 * width * height, width * height
    if settings.verify:
        statistics.shadow.wrong = int(wrong.sum())
        statistics.wrong = WrongCounts(
            int(wrong.sum()), statistics.shadow.due, width * height, int((wrong > 0).sum()), width * height
        )
    return Frame(
        time=time,
        camera=camera or Camera((0.0, 1.0, 5.0), (0.0, 0.0, -1.0)),
        settings=settings,
        color=color,
        depth=np.where(hit, np.float32(2.0), np.float32(np.inf)),
        primitive=primitive,
        normal=normal,
        modes=np.array(modes, np.uint32),
        modes_before=np.array(modes, np.uint32),
        pixel_count=counts,
        highest_count=np.where(np.arange(7) == 3, counts * 2, 0).astype(np.int32),
        lights=3,
        reference=np.where(wrong[..., None] > 0, np.float32(0.6), color) if settings.verify else None,
        wrong=wrong if settings.verify else None,
        saved=wrong if settings.record_work else None,
        cost=wrong + 1 if settings.record_work else None,
        due_rays=2 * wrong if settings.record_work else None,
        statistics=statistics,
    )


def with_certificates(frame: Frame) -> Frame:
    """The frame with cells, 8 pixels wide and some 4, with certificates of each light drawn by lot, and work counted.

    What moves and what is missed has no cell."""
    y, x = np.indices(frame.primitive.shape)
    side = np.where((x // 16 + y // 16) % 2 == 0, 8, 4)
    place = (frame.primitive.astype(np.int64) << 40) + ((y // side) << 22) + ((x // side) << 2) + side // 8
    none = (frame.primitive < 0) | (frame.occlusion_mode == 3)
    known, cells = np.unique(np.where(none, -1, place), return_inverse=True)
    cells = cells.reshape(none.shape).astype(np.int32) - int(known[0] == -1)
    lots = np.random.default_rng(1)
    words = np.zeros(max(1, int(cells.max()) + 1), frame.modes.dtype)  # one where nothing is seen, too
    for light in range(frame.lights):
        words |= lots.integers(0, 4, len(words)).astype(words.dtype) << words.dtype.type(2 + 2 * light)
    certificates = np.where(none, words.dtype.type(0), words[np.maximum(cells, 0)])
    saved = np.where(none, 0, frame.lights + x % 5).astype(np.int32)
    cost = (1 + 2 * (frame.primitive >= 0) + y % 7).astype(np.int32)
    due_rays = np.where((x + y) % 8 == 0, 0, saved + y % 3).astype(np.int32)
    saved = np.minimum(saved, due_rays)
    return replace(frame, cells=cells, certificates=certificates, saved=saved, cost=cost, due_rays=due_rays)


def with_lamps(frame: Frame) -> Frame:
    """The frame with what reaches each pixel from lights of 16, 1 and 64 samples, and what became of the rays, drawn by
    lot."""
    lots, shape = np.random.default_rng(2), (*frame.primitive.shape, frame.lights)
    most = np.resize(np.array([16, 1, 64], np.uint16), frame.lights)
    hit = (frame.primitive >= 0)[..., None]
    asked = np.where(hit, lots.choice([0.0, 0.4, 1.0, 1.0], shape) * most, 0).astype(np.uint16)
    reached = (lots.choice([0.0, 0.3, 0.7, 1.0], shape) * asked).astype(np.uint16)
    answered = lots.choice([CULLED, DYNAMIC_ONLY, DYNAMIC_ONLY | MOVING_SHADOW, CANDIDATES, CACHED, TRACED], shape)
    answered = np.where(lots.random(shape) < 0.1, TRACED | MOVING_SHADOW, answered)
    fates = np.where(hit, np.where(asked > 0, answered, FACES_AWAY), 0).astype(np.uint8)
    return replace(frame, asked=asked, reached=reached, fates=fates)


def with_cuts(frame: Frame) -> Frame:
    """The frame as if shaded by cuts of up to 40 clusters of 100 lights, drawn by lot; of some it is not known."""
    lots, shape = np.random.default_rng(3), frame.primitive.shape
    nodes = lots.integers(-1, 40, shape).astype(np.int32)
    nodes[0, 0] = 40
    statistics = replace(frame.statistics, cuts=CutCounts(100, 7, 70, 0, 40))
    layers = frame.layers | {"cut nodes": nodes, "cut bound": lots.random(shape, np.float32)}
    return replace(frame, layers=layers, statistics=statistics)


def with_voxels(frame: Frame) -> Frame:
    """The frame with 16 x 8 x 8 voxels in the camera's view, before and behind what is seen, in states drawn by lot;
    the third light has none."""
    grid = Grid(-2.0, -0.25, -1.0, 4.0, 16, 8, 8)
    words = np.random.default_rng(4).integers(0, 2, grid.cubes + 1).astype(np.uint32)
    for light in range(frame.lights):
        words |= np.random.default_rng(light).integers(0, 3, len(words)).astype(np.uint32) << np.uint32(2 + 2 * light)
    states = VoxelStates(grid, words, np.arange(frame.lights) != 2)
    return replace(frame, structures=frame.structures | {"voxels": states})


def with_cell_lights(frame: Frame) -> Frame:
    """The frame as if its cells knew which lights they must look at, drawn by lot; of some it is not known."""
    asked = np.random.default_rng(5).integers(-1, frame.lights + 1, frame.primitive.shape).astype(np.int32)
    return replace(frame, layers=frame.layers | {"cell lights": np.where(frame.primitive >= 0, asked, np.int32(-1))})


def with_proofs(frame: Frame) -> Frame:
    """A frame with fates as if the renderer had been asked how far lights may move, and what is regretted, drawn by
    lot."""
    lots, shape, hit = np.random.default_rng(6), frame.primitive.shape, frame.primitive >= 0
    could = (frame.fates == TRACED) & (lots.random(frame.fates.shape) < 0.4)
    layers = frame.layers | {"regret": np.where(hit, could.sum(axis=-1), -1).astype(np.int32)}
    for light in range(frame.lights):
        layers[f"slack {light}"] = np.where(hit, lots.uniform(-0.2, 1.0, shape), -1.0).astype(np.float32)
    return replace(frame, layers=layers)


def with_everything(frame: Frame) -> Frame:
    """The frame with whatever any view shows."""
    return with_proofs(with_cell_lights(with_voxels(with_cuts(with_lamps(with_certificates(frame))))))


def in_part(frame: Frame) -> Frame:
    """The frame while every second column has been shaded: nothing is known of what lights send to the others."""
    shaded = np.indices(frame.primitive.shape)[1] % 2 == 0
    asked, reached = (samples * shaded[..., None].astype(np.uint16) for samples in (frame.asked, frame.reached))
    return replace(frame, asked=asked, reached=reached, shaded=shaded)


def in_cells(frame: Frame) -> Frame:
    """The frame as of a method whose units are cells: odd columns of every primitive have others than even ones."""
    x = np.indices(frame.primitive.shape)[1]
    cells = np.where(frame.primitive < 0, -1, 2 * frame.primitive + x % 2).astype(np.int32)
    words = np.repeat(frame.modes, 2)
    words[1::2] ^= words.dtype.type(5 << 2)  # other shadow modes
    counts = np.bincount(cells[cells >= 0], minlength=len(words)).astype(np.int32)
    highest = np.repeat(frame.highest_count, 2)
    before = np.repeat(frame.modes_before, 2)
    return replace(frame, cells=cells, modes=words, modes_before=before, pixel_count=counts, highest_count=highest)


PATIENCE = 60.0
"""Seconds after which something does not come: threads that trace step back behind all others, on busy machines."""


def until(happens: Callable[[], object]) -> None:
    """Wait for what another thread brings about."""
    end = time.monotonic() + PATIENCE
    while not happens():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.001)


class FakeRenderer:
    """Delivers `make_frame` when `go` is set; says what it was asked, and stops when told to."""

    def __init__(self) -> None:
        self.settings = Settings()
        self.asked: list[tuple[float, Settings]] = []
        self.cancelled: list[float] = []
        self.resets = 0
        self.started = Event()
        self.scene = make_scene()
        self.go = Event()
        self.go.set()
        self.failing: Exception | None = None
        self.pause_after: float | None = None  # the part of a picture after which it waits for `go` once
        self.other: FakeRenderer | None = None
        self.turns: list[str] = []

    def beside(self) -> FakeRenderer:
        self.other = FakeRenderer()
        self.other.go, self.other.turns = self.go, self.turns
        return self.other

    def take_scene(self, other: FakeRenderer) -> None:
        pass

    def take_turn(self, time: float) -> None:
        self.turns.append(self.settings.method)

    def reset_modes(self) -> None:
        self.resets += 1

    def refine(self, time=0.0, camera=None, cancel=None, parts=(16,), samples=1, focus=None) -> Iterator[Frame]:
        for part in parts:
            frame = self.render(time, camera, cancel)
            frame.statistics.part = part / 16
            if self.pause_after == frame.statistics.part:
                self.pause_after = None
                self.go.clear()
            yield frame
        for sample in range(2, samples + 1):
            frame = self.render(time, camera, cancel)
            yield replace(frame, settings=replace(frame.settings, samples=sample))

    def render(self, time: float = 0.0, camera: Camera | None = None, cancel=None) -> Frame:
        self.asked.append((time, self.settings))
        self.started.set()
        while not self.go.wait(0.002):
            if cancel is not None and cancel():
                self.cancelled.append(time)
                raise Cancelled()
        if self.failing is not None:
            raise self.failing
        return make_frame(self.settings, time, camera)


class Clock:
    """What time it is for the whole program, set by hand."""

    now = 100.0
