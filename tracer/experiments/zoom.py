"""The zoom test: does a shadow that can only be seen from near appear when one comes near?  (§2.6, Figure 4)

A primitive that was seen whole from afar is culled by what its few pixels met then.  A camera goes
straight towards it, so that it covers more and more pixels; once they are more than `zoom_factor`
times those of its last examination it is examined anew, and what was wrong until then should
vanish.  The same way is gone once for each factor, every time with modes that start afresh.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.experiments.runner import Run
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.renderer import Renderer
from tracer.scene.arrays import Vector, vector
from tracer.scene.model import Camera, Cancelled, Scene

STILL_FRAMES = 3
METHOD = "paper"  # whose zoom factor is tested
"""Frames at the start, before the camera moves, for the modes to settle."""

NEAREST = 1e-3
"""Least part of the distance at the start to end at: nearer, the pixels of float32 coordinates are no longer even."""


@dataclass(frozen=True)
class Aim:
    """Where a zoom test starts: a camera, at `time` seconds, that looks at `target`, a point of `primitive`."""

    primitive: int
    time: float
    camera: Camera
    target: Vector

    @property
    def distance(self) -> float:
        return math.dist(self.camera.position, self.target)

    def after(self, steps: int, ratio: float) -> Camera:
        """The camera after so many steps, each to `ratio` (0 to 1) of the distance before."""
        way = np.subtract(self.camera.position, self.target) * ratio**steps
        return replace(self.camera, position=vector(np.add(self.target, way)))


@dataclass(frozen=True)
class Change:
    """A mode that is another than a frame before: the occlusion mode, or with `light` a light's shadow mode."""

    light: int | None
    before: str
    after: str


@dataclass(frozen=True)
class Step:
    """A frame on the way, as the frame leaves things: `pixels` that the primitive covers and those of its last
    examination (`highest`), its occlusion mode, its shadow mode for each light (None for a light without modes), and
    the modes that changed.

    `wrong` counts the pixels with a wrong shadow answer, and `wrong_of_primitive` those that show the primitive.
    `due`, `culled` and `dynamic_only` count shadow rays of the whole frame."""

    number: int
    distance: float
    camera: Camera
    pixels: int
    highest: int
    occlusion: str
    shadows: list[str | None]
    changes: list[Change]
    wrong_of_primitive: int
    wrong: int
    due: int
    culled: int
    dynamic_only: int


@dataclass
class Approach:
    """The way gone with one zoom factor."""

    factor: float
    steps: list[Step] = field(default_factory=list)

    @property
    def examined_anew(self) -> list[int]:
        """Numbers of the steps at whose end the primitive, once fully rendered, is to be examined anew."""
        went_back = Change(None, OcclusionMode.FULLY_RENDERED.name, OcclusionMode.INIT.name)
        return [step.number for step in self.steps if went_back in step.changes]

    @property
    def seen_whole(self) -> bool:
        """Whether the primitive was ever fully rendered: else it is never culled."""
        return any(step.highest for step in self.steps)

    @property
    def wrong_steps(self) -> list[int]:
        """Numbers of the steps that show the primitive with wrong pixels."""
        return [step.number for step in self.steps if step.wrong_of_primitive]

    @property
    def most_wrong(self) -> int:
        """The most wrong pixels of the primitive in one step."""
        return max((step.wrong_of_primitive for step in self.steps), default=0)


@dataclass
class Results:
    """What was seen on the way, once per factor, in the order in which the factors were asked for."""

    scene: str
    size: tuple[int, int]
    primitive: int
    time: float
    target: Vector
    ratio: float
    still_frames: int = STILL_FRAMES
    approaches: list[Approach] = field(default_factory=list)
    lamp_radius: float | None = None
    lamp_samples: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers, for JSON."""
        return asdict(self) | {"size": list(self.size), "target": list(self.target)}


def aim(frame: Frame, primitive: int) -> Aim:
    """Point the camera of a frame at a primitive that the frame shows.

    If the camera looks straight at the primitive already, with all pixels around its axis, it keeps its direction.
    Otherwise it turns to the middle of what is visible of the primitive: the visible point that is nearest to the mean
    of all visible points. Nothing may lie in between on the way there.

    Parameters
    ----------
    frame : Frame
        A picture.
    primitive : int
        Number of the primitive.

    Returns
    -------
    Aim
        Where a zoom test starts.

    Raises
    ------
    ValueError
        If the frame does not show the primitive.
    """
    rows, columns = np.nonzero(frame.primitive == primitive)
    if primitive < 0 or not len(rows):
        raise ValueError(f"primitive {primitive} is not to be seen from here; choose one that the picture shows")
    camera = frame.camera
    right, up, forward = camera.basis()
    pixel = 2.0 * math.tan(math.radians(camera.angle) / 2.0) / frame.height
    x, y = (columns + 0.5 - 0.5 * frame.width) * pixel, (0.5 * frame.height - rows - 0.5) * pixel
    rays = forward + x[:, None] * right + y[:, None] * up
    ahead = frame.depth[rows, columns] / np.linalg.norm(rays, axis=1)  # along the view, not along the ray
    sides = ((frame.height - 1) // 2, frame.height // 2), ((frame.width - 1) // 2, frame.width // 2)
    if (frame.primitive[np.ix_(*sides)] == primitive).all():
        # The axis goes between those pixels. On a plane the inverse of this distance is linear over the picture, so
        # that its mean is the axis's own: a point beside the surface would be passed when the camera comes near.
        about = np.isin(rows, sides[0]) & np.isin(columns, sides[1])
        return Aim(primitive, frame.time, camera, vector(camera.position + forward / np.mean(1.0 / ahead[about])))
    points = camera.position + rays * ahead[:, None]
    target = points[np.argmin(np.linalg.norm(points - points.mean(0), axis=1))]
    return Aim(primitive, frame.time, replace(camera, direction=vector(target - camera.position)), vector(target))


def primitive_at(frame: Frame, x: int, y: int) -> int:
    """The primitive that a pixel shows; raises ValueError for one outside the picture or that shows none."""
    check_pixel((x, y), (frame.width, frame.height))
    primitive = int(frame.primitive[y, x])
    if primitive < 0:
        raise ValueError(f"pixel {x},{y} shows no primitive, only background")
    return primitive


def check_pixel(pixel: tuple[int, int], size: tuple[int, int]) -> None:
    """Raise ValueError for a pixel (x, y) outside a picture of this width and height."""
    (x, y), (width, height) = pixel, size
    if not (0 <= x < width and 0 <= y < height):
        raise ValueError(f"pixel {x},{y}: the picture has {width} × {height} pixels, counted from 0")


def check_primitive(scene: Scene, primitive: int) -> None:
    """Raise ValueError for a primitive that the scene has not, or that moves, which is never culled."""
    if not 0 <= primitive < scene.primitive_count:
        raise ValueError(f"there is no primitive {primitive}; the scene's are 0 to {scene.primitive_count - 1}")
    if scene.object_of(primitive):
        raise ValueError(f"primitive {primitive} belongs to an object that moves, and those are never culled")


def settings_of_tests(settings: Settings, factors: Sequence[float], steps: int, ratio: float) -> list[Settings]:
    """The settings of each factor's test, from those that all share; raises ValueError for numbers out of range."""
    if not 0.0 < ratio < 1.0 or steps < 1:
        raise ValueError("a zoom test goes at least one step, each to between 0 and 1 of the distance before")
    if ratio**steps < NEAREST:
        raise ValueError(
            f"{steps} steps of {ratio:g} end nearer than {NEAREST:g} of the distance; go fewer or smaller ones"
        )
    return [replace(settings, method=METHOD, verify=True, samples=1, zoom_factor=f).validated() for f in factors]


def run(
    scene: Scene,
    settings: Settings,
    start: Aim,
    factors: Sequence[float] = (4.0, 16.0),
    steps: int = 30,
    ratio: float = 0.94,
    cancel: Callable[[], bool] | None = None,
    world: World | None = None,
    on_frame: Callable[[float, int, Frame], None] | None = None,
) -> Iterator[Results]:
    """Move towards a primitive, once with each zoom factor, and yield the results after each frame.

    It always yields the same growing object, so that whoever stops early keeps what is done. The camera first stays
    where it is for STILL_FRAMES. Then each step ends at `ratio` of the distance before it, so that the camera comes
    near but never arrives. The method is always "paper", and every culled answer is verified.

    Parameters
    ----------
    scene : Scene
        What to render.
    settings : Settings
        How; method, verification, samples and zoom factor are replaced.
    start : Aim
        Where to start, from `aim`.
    factors : sequence of float
        Zoom factors.
    steps : int
        How many steps to go.
    ratio : float
        The part of the distance that remains after a step, between 0 and 1.
    cancel : callable, optional
        Once it returns true, the test ends after the last whole frame.
    world : World, optional
        The geometry of the scene, which nobody else may use meanwhile.
    on_frame : callable, optional
        Called with the factor, the number and the picture of each frame.

    Yields
    ------
    Results
        What was found so far.

    Raises
    ------
    ValueError
        If there is no such primitive, or if it moves, or if a number is out of range.
    """
    tests = settings_of_tests(settings, factors, steps, ratio)
    check_primitive(scene, start.primitive)
    world = world or World(scene, start.time, settings.accelerator)
    world.build()  # no frame that is measured has to
    size = (settings.width, settings.height)
    results = Results(str(scene.path), size, start.primitive, start.time, start.target, ratio)
    results.lamp_radius, results.lamp_samples = settings.lamp_radius, settings.lamp_samples
    for test in tests:
        renderer = Renderer(scene, test, world=world)
        approach = Approach(test.zoom_factor)
        results.approaches.append(approach)
        for number in range(STILL_FRAMES + steps):
            camera = start.after(max(0, number - STILL_FRAMES + 1), ratio)
            try:
                frame = renderer.render(start.time, camera, cancel)
            except Cancelled:
                return
            if on_frame is not None:
                on_frame(test.zoom_factor, number, frame)
            approach.steps.append(_step(frame, start, number, approach.steps))
            yield results


class ZoomTest(Run[Results]):
    """A zoom test as a run, of which every frame is to be seen; `record` is called with the factor, the number and the
    picture of each.  Raises ValueError for numbers out of range, or a primitive that cannot be tested."""

    name = "zoom test"
    each_is_seen = True

    def __init__(
        self,
        scene: Scene,
        settings: Settings,
        start: Aim,
        factors: Sequence[float] = (4.0, 16.0),
        steps: int = 30,
        ratio: float = 0.94,
        record: Callable[[float, int, Frame], None] = lambda factor, number, frame: None,
    ) -> None:
        settings_of_tests(settings, factors, steps, ratio)
        check_primitive(scene, start.primitive)
        self.settings, self.start, self.factors, self.ratio = settings, start, factors, ratio
        self.steps_each, self._record = steps + STILL_FRAMES, record
        super().__init__(scene, len(factors) * self.steps_each)

    def steps(self, scene: Scene, world: World | None, cancel: Callable[[], bool]) -> Iterator[Results]:
        def on_frame(factor: float, number: int, frame: Frame) -> None:
            self._record(factor, number, frame)
            self.progressed(f"zoom factor {factor:g}, step {number} of {self.steps_each - 1}", frame)

        self.make_ready([self.settings.method], scene, self.settings.accelerator, cancel)
        steps = self.steps_each - STILL_FRAMES
        yield from run(scene, self.settings, self.start, self.factors, steps, self.ratio, cancel, world, on_frame)

    def copy(self, results: Results) -> Results:
        return replace(results, approaches=[replace(a, steps=list(a.steps)) for a in results.approaches])


def _step(frame: Frame, start: Aim, number: int, before: list[Step]) -> Step:
    assert frame.wrong is not None
    word, wrong, shadow = frame.modes[start.primitive], frame.wrong > 0, frame.statistics.shadow
    occlusion = OcclusionMode(int(occlusion_mode(word))).name
    shadows = [
        ShadowMode(int(shadow_mode(word, light))).name if has_shadow_mode(frame.modes, light) else None
        for light in range(frame.lights)
    ]
    now = [occlusion, *shadows]
    then = [before[-1].occlusion, *before[-1].shadows] if before else ["INIT" if mode else None for mode in now]
    changes = [
        Change(index - 1 if index else None, str(old), str(new))
        for index, (old, new) in enumerate(zip(then, now, strict=True))
        if old != new
    ]
    return Step(
        number=number,
        distance=math.dist(frame.camera.position, start.target),
        camera=frame.camera,
        pixels=int(frame.pixel_count[start.primitive]),
        highest=int(frame.highest_count[start.primitive]),
        occlusion=occlusion,
        shadows=shadows,
        changes=changes,
        wrong_of_primitive=int(np.count_nonzero(wrong & (frame.primitive == start.primitive))),
        wrong=int(np.count_nonzero(wrong)),
        due=shadow.due,
        culled=shadow.culled,
        dynamic_only=shadow.dynamic_only,
    )
