"""Shrinking a wrong pixel: delta debugging, until no primitive, light or frame before it can be taken away.

Chunks of what is there are left out, half of it first and single ones last.  What was left out stays out if the pixel
still is wrong, and too bright or too dark as before.  That goes on until leaving out any single thing makes it right.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.verdicts import Verdict
from tracer.editing.edits import NEVER, joined, subset
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.hunt import VISIBLE, History, find_at, repeatable, trace_before, wrong_in
from tracer.experiments.runner import Run, never
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame, Settings
from tracer.geometry.world import World
from tracer.inspect.projection import seen_at
from tracer.inspect.reasons import MEANING
from tracer.inspect.why_in_words import kind_of
from tracer.method import Method, title_of
from tracer.renderer import Renderer
from tracer.scene.aff_writer import as_word
from tracer.scene.bounds import ball_of, bounds
from tracer.scene.lights import named_light
from tracer.scene.model import Camera, Scene, SceneObject, Triangles, empty_quadrics
from tracer.scene.things import held_by, thing_numbers

Cancel = Callable[[], bool]
_FAR = 1000.0  # times the radius of what is left, with camera and lights: where the area is that was left out


@dataclass(frozen=True)
class WrongPixel:
    """A pixel of the picture at `time` by `settings`, after the frames `before`; a camera of None is the scene's."""

    x: int
    y: int
    time: float
    camera: Camera | None
    before: tuple[WarmupFrame, ...]
    settings: Settings


class Counts(NamedTuple):
    """How much there is."""

    primitives: int
    lights: int
    frames: int

    def __str__(self) -> str:
        return ", ".join(f"{n:,} {name if n != 1 else name[:-1]}" for name, n in zip(self._fields, self, strict=True))


@dataclass(frozen=True)
class Shrunk:
    """A wrong pixel and the scene that is left for it, from how much there was at first, and after how many tries."""

    scene: Scene
    wrong: WrongPixel
    first: Counts
    tries: int

    @property
    def counts(self) -> Counts:
        """How much is left."""
        return Counts(self.scene.primitive_count, len(self.scene.lights), len(self.wrong.before))


# --- whether it is wrong ------------------------------------------------------------------------------


def _traced(scene: Scene, wrong: WrongPixel, cancel: Cancel) -> tuple[Renderer, Frame, History]:
    """What has traced the picture, the picture with every culled ray verified, and the frames before it."""
    renderer = Renderer(scene, wrong.settings)
    history = trace_before(renderer, wrong.before, cancel)
    renderer.settings = replace(wrong.settings, verify=True)
    return renderer, renderer.render(wrong.time, wrong.camera, cancel), history


def error(scene: Scene, wrong: WrongPixel, cancel: Cancel = never) -> float:
    """Return how much too bright the pixel is, below 0 if it is too dark: of the channel that is off the most.

    0 where none of its shadow answers is wrong, or nobody would see it."""
    if not scene.primitive_count or not scene.lights:
        return 0.0
    _, frame, _ = _traced(scene, wrong, cancel)
    assert frame.wrong is not None and frame.reference is not None
    most = float(max((frame.color - frame.reference)[wrong.y, wrong.x], key=abs))
    return most if frame.wrong[wrong.y, wrong.x] and abs(most) > VISIBLE else 0.0


def explained(scene: Scene, wrong: WrongPixel) -> tuple[Counterexample, str] | None:
    """Return what is wrong at the pixel, and a sentence on the rule that failed; None where no answer is wrong."""
    renderer, frame, history = _traced(scene, wrong, never)
    find = find_at(renderer, frame, wrong.x, wrong.y, history, never)
    if find is None:
        return None
    unit = find.primitive
    if find.bounces == 0:
        unit = int(frame.unit[wrong.y, wrong.x])  # which may be a cell of it
        find = history.with_teacher(find, unit)
    return replace(find, **wrong_in(frame)[1]), _failed_rule(scene, find, unit, renderer, frame)


def _failed_rule(scene: Scene, find: Counterexample, unit: int, renderer: Renderer, frame: Frame) -> str:
    verdict = next(one for one in Verdict if one.value == find.verdict)
    method = title_of(frame.settings.method)
    if verdict not in (Verdict.FULL_SHADOW, Verdict.NON_SHADOW) or find.taught < 0:
        return f"This is no rule of the paper, but {method}'s own answer. {MEANING[verdict]}"
    what = f"{kind_of(scene, find.primitive)} {find.primitive}"
    what = f"the cell of {what}" if frame.cells is not None else what
    light, mode, before = named_light(scene.lights, find.light), find.verdict, find.before
    teacher = f"frame {find.taught + 1} of the {len(before)} before" if len(before) > 1 else "the frame before"
    met = "none of its shadow rays was blocked" if find.lit else "all of its shadow rays were blocked"
    learnt = f"In {teacher}, {met} on the way to {light}, which set {mode} (§2.5)"
    seen = alone = 0
    if frame.cells is None and find.bounces == 0:
        then, rays = before[find.taught], replace(frame.settings, method="none", depth=0, verify=False)
        seen, alone = (
            int(np.count_nonzero(Renderer(some, rays).render(then.time, then.camera).primitive == number))
            for some, number in ((scene, find.primitive), (with_primitives(scene, [find.primitive]), 0))
        )
    now, highest, factor = int(frame.pixel_count[unit]), int(renderer.highest_before[unit]), frame.settings.zoom_factor
    trust = "takes that to hold for all of it"
    if alone > seen > 0:
        failed = f"Occlusion testing (§2.3) failed: {what} showed {seen:,} of {alone:,} pixels, but passed for whole"
    elif now > highest > 0:
        failed = f"Occlusion-mode setting (§2.6) failed: {what} covers {now:,} pixels, {highest:,} when examined, "
        failed += f"and no frame before has found it more than {factor:g} times as large"
        trust = "still trusts that"
    else:
        failed = f"Shadow-mode setting (§2.5) failed, as it knows {what} by a few rays"
    return f"{failed}. {learnt}; shadow testing (§2.4) {trust}."


# --- what can be taken away ---------------------------------------------------------------------------


def bare(scene: Scene) -> Scene:
    """Return a scene as one file of AFF can hold it: without textures, and with names that are words."""
    objects = []
    for one in scene.objects:
        if NEVER not in [element for element in one.chain if isinstance(element, str)]:  # else it is hidden
            plain = np.full_like(one.triangles.texture, -1)
            objects.append(replace(one, triangles=replace(one.triangles, texture=plain)))
    lights = tuple(replace(light, name=light.track or as_word(light.name), number=None) for light in scene.lights)
    return replace(scene, objects=tuple(objects), textures=(), lights=lights)


def with_primitives(scene: Scene, kept: Sequence[int] | NDArray[np.intp]) -> Scene:
    """Return a scene with some of its primitives; objects that have none are gone."""
    keeps = np.zeros(scene.primitive_count, np.bool_)
    keeps[np.asarray(kept, np.intp)] = True
    left = [subset(one, keeps[np.concatenate(held_by(scene, index))]) for index, one in enumerate(scene.objects)]
    objects = [left[0], *(one for one in left[1:] if len(one.triangles) or len(one.quadrics))]
    return replace(scene, objects=tuple(objects))


def static_area(scene: Scene) -> float:
    """Return the area of all triangles that never move."""
    corners = scene.objects[0].triangles.corners.astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(normals, axis=1).sum())


def with_area(scene: Scene, area: float) -> Scene:
    """Return a scene whose static triangles have this area together, by one more: far away, with its edge to all else.

    The cells of `cells` are a part of that area: without it they would be others, and so their modes."""
    static, missing = scene.objects[0], area - static_area(scene)
    box = bounds(scene.objects, scene.animation, scene.time_range[0])
    if missing <= 0.0 or box is None:
        return scene
    middle, radius = ball_of(box)
    eyes = np.array([scene.camera.position, *scene.light_positions(scene.time_range[0])])
    radius = max(radius, float(np.linalg.norm(eyes - middle, axis=1).max()))
    side = np.sqrt(2.0 * missing)
    edges = np.array([[0.0, 0.0, 0.0], [side, 0.0, 0.0], [0.0, side, 0.0]])
    corners = (np.add(middle, (_FAR * radius, 0.0, 0.0)) + edges)[None].astype(np.float32)
    normals = np.tile(np.array([0.0, 0.0, 1.0], np.float32), (1, 3, 1))
    number = np.zeros(1, np.int32)
    triangle = Triangles(corners, normals, np.zeros((1, 3, 2), np.float32), number, number - 1)
    static = joined(static, SceneObject("", triangle, empty_quadrics()), "area_left_out")
    return replace(scene, objects=(static, *scene.objects[1:]))


def _far_ones_first(scene: Scene, traced: Scene, wrong: WrongPixel, cancel: Cancel) -> NDArray[np.intp]:
    """The primitives by how far their middles are from the way between what the pixel shows and the light whose answer
    is wrong, and last those that the answer is about: what lies far away is rarely needed."""
    renderer, frame, history = _traced(traced, wrong, cancel)
    find = find_at(renderer, frame, wrong.x, wrong.y, history, cancel)
    assert find is not None
    point = seen_at(frame, wrong.x, wrong.y)
    way = scene.light_positions(wrong.time)[find.light] - point
    middles = np.empty((scene.primitive_count, 3))
    for index, one in enumerate(scene.objects):
        own = np.concatenate([one.triangles.corners.mean(axis=1), one.quadrics.to_object[:, :, 3]])
        matrix = scene.animation.matrix(one.chain, wrong.time)
        middles[np.concatenate(held_by(scene, index))] = own @ matrix[:3, :3].T + matrix[:3, 3] - point
    along = np.clip(middles @ way / max(float(way @ way), 1e-300), 0.0, 1.0)
    away = np.linalg.norm(middles - along[:, None] * way, axis=1)
    for number in (int(frame.primitive[wrong.y, wrong.x]), find.primitive, find.blocker):
        if number >= len(scene.objects[0].triangles):  # after those that stand for the area that was left out
            number -= traced.primitive_count - scene.primitive_count
        away[max(number, 0)] = -1.0
    return np.argsort(-away, kind="stable")


KINDS: tuple[str, ...] = ("frames", "lights", "objects", "primitives")
"""What can be taken away, in the order in which it is tried: first what makes further tries quick."""


def _parts(kind: str, scene: Scene, wrong: WrongPixel, traced: Callable[[Scene], Scene], cancel: Cancel) -> list[Any]:
    """What there is of a kind, each as `_only` takes it; what is needed least comes first."""
    if kind == "frames":
        return list(wrong.before)
    if kind == "lights":
        return list(scene.lights)
    primitives = _far_ones_first(scene, traced(scene), wrong, cancel)
    if kind == "primitives":
        return list(primitives[:, None])
    numbers = thing_numbers(scene)[primitives]
    nearest_first = dict.fromkeys(numbers[::-1].tolist())
    return [primitives[numbers == number] for number in reversed(nearest_first)]


def _only(kind: str, scene: Scene, wrong: WrongPixel, kept: list[Any]) -> tuple[Scene, WrongPixel]:
    """What is left with some of a kind."""
    if kind == "frames":
        return scene, replace(wrong, before=tuple(kept))
    if kind == "lights":
        return replace(scene, lights=tuple(kept)), wrong
    return with_primitives(scene, np.concatenate([np.empty(0, np.intp), *kept])), wrong


def _count(kind: str, now: Shrunk) -> int:
    return len(np.unique(thing_numbers(now.scene))) if kind == "objects" else getattr(now.counts, kind)


class Shrink(Run[Shrunk]):
    """Shrinking as a run; its `frames` are sizes of chunks that are left out, as far as these are known."""

    name = "shrinking"
    unit = "step"
    verifies = False

    def __init__(self, scene: Scene, wrong: WrongPixel) -> None:
        """Raises ValueError, in one line, where settings or pixel are out of range."""
        settings = repeatable(replace(wrong.settings, verify=False))
        if not (0 <= wrong.x < settings.width and 0 <= wrong.y < settings.height):
            raise ValueError(f"--pixel {wrong.x},{wrong.y}: the picture is {settings.width} x {settings.height}")
        self.wrong = replace(wrong, settings=settings)
        super().__init__(scene, 1)

    def steps(self, scene: Scene, world: World | None, cancel: Cancel) -> Iterator[Shrunk]:
        settings = self.wrong.settings
        self.make_ready([settings.method], scene, settings.accelerator, cancel)
        frames = tuple(WarmupFrame(one.time, one.camera or scene.camera_at(one.time)) for one in self.wrong.before)
        wrong = replace(self.wrong, camera=self.wrong.camera or scene.camera_at(self.wrong.time), before=frames)
        scene = bare(scene)
        self._sign = np.sign(error(scene, wrong, cancel))
        if not self._sign:
            here = f"pixel {wrong.x},{wrong.y} is not wrong"
            after = f"after {len(frames)} frame{'s' * (len(frames) != 1)}"
            raise ValueError(f"{here}: by {settings.method}, {after}, no shadow answer is wrong there that can be seen")
        now = Shrunk(scene, wrong, Counts(scene.primitive_count, len(scene.lights), len(frames)), 1)
        yield now
        if Method.parse(settings.method).uses_cells:
            area = static_area(scene)
            for smaller in self._until_all_is_needed(now, lambda scene: with_area(scene, area), cancel):
                now = replace(smaller, scene=with_area(smaller.scene, area))
                yield now
        yield from self._until_all_is_needed(now, lambda scene: scene, cancel)

    def _until_all_is_needed(self, now: Shrunk, traced: Callable[[Scene], Scene], cancel: Cancel) -> Iterator[Shrunk]:
        """Leave out what is not needed of each kind until nothing more can be; `traced(scene)` is what is traced."""
        left = KINDS
        while left:
            self.frames = self.traced + sum(_count(kind, now).bit_length() for kind in left)
            kind, left, before = left[0], left[1:], now.counts
            for smaller in self._without(kind, now, traced, cancel):
                yield (now := smaller)
            if now.counts != before:  # so that others may be needed no more
                left = KINDS[KINDS.index(kind) + 1 :] + KINDS[: KINDS.index(kind)]

    def _without(self, kind: str, begin: Shrunk, traced: Callable[[Scene], Scene], cancel: Cancel) -> Iterator[Shrunk]:
        """Leave out what is not needed of a kind; gives what is left whenever that is less, and at last."""
        now, parts = begin, _parts(kind, begin.scene, begin.wrong, traced, cancel)
        first = len(parts)

        def does(fewer: list[Any]) -> bool:
            """Whether the pixel is wrong with these alone."""
            nonlocal now, parts
            scene, wrong = _only(kind, begin.scene, begin.wrong, fewer)
            now = replace(now, tries=now.tries + 1)
            self.label = f"{len(parts):,} of {first:,} {kind}"
            self._wake()
            shows = np.sign(error(traced(scene), wrong, cancel)) == self._sign
            if shows:
                now, parts = replace(now, scene=scene, wrong=wrong), fewer
            return bool(shows)

        for power in range((len(parts) // 2).bit_length()):  # perhaps the last ones are enough, which is tried quickly
            if does(parts[-(2**power) :]):
                yield now
                break
        size = 2 ** len(parts).bit_length() // 2
        while size:
            start, were = 0, len(parts)
            while start < len(parts):
                if does(parts[:start] + parts[start + size :]):
                    yield now
                else:
                    start += size
            if size > 1 or len(parts) == were:
                size //= 2
                self.progressed(self.label)
        yield now
