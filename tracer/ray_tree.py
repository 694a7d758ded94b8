"""What became of a pixel's rays: its primary, reflected and refracted rays, and every shadow ray of each bounce.

A tile of the picture is shaded once more with watchers between the stages of its methods, in the company in which the
pixel was shaded.  So each shadow ray is known to have been asked or not, and what answered it, exactly as it was in the
frame.  Those that were traced are traced once more by themselves, with their steps and tests counted; and of all that
were due the nearest thing in their way is found, whatever culling said, so that a wrong answer is seen to be one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.verdicts import Answered, Because, Verdict
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING
from tracer.geometry.rays import MISS, ray_batch
from tracer.methods.watching import ANSWERED, DUE, LIT, SETTLED, Watchers
from tracer.scene.arrays import Float32, Float64
from tracer.scene.model import Cancelled
from tracer.shading import pixel_rays as told_as
from tracer.shading.pixel_rays import PixelRays, pixel_rays

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.frame_in_progress import FrameInProgress
    from tracer.geometry.visits import Visit
    from tracer.geometry.world import World
    from tracer.methods.interface import ShadowMethod, Stage
    from tracer.renderer import Renderer

VERDICTS = tuple(Verdict)
NUMBER_OF = {verdict: number for number, verdict in enumerate(VERDICTS)}
AWAY, TRACED = NUMBER_OF[Verdict.AWAY], NUMBER_OF[Verdict.TRACED]
ROOM = 64  # rays of a pixel to begin with
MOST_NAMED = 64  # lights of a point that are passed over and whose blockers are looked for

Cancel = Callable[[], bool] | None


class RayKind(Enum):
    """What sent a ray."""

    PRIMARY = "primary"
    REFLECTED = "reflected"
    REFRACTED = "refracted"


@dataclass(frozen=True)
class ShadowRays:
    """The shadow rays of a point, s of them: one for each sample of each light, due or not.

    Attributes
    ----------
    light : (s,) int32
        The light of each.
    verdict : (s,) uint8
        What became of it, as its place among `VERDICTS`.
    lit : (s,) bool
        Whether the light gets to the point, as the frame has it; false if the ray is not due.
    wrong : (s,) bool
        Whether that is not true.
    blocker : (s,) int32
        The primitive that is truly in the way first, seen from the light; -1 for none.
    blocked_at : (s,) float32
        How far along the ray that is, 0 at the light and 1 at the point; inf for none.
    met : (s,) int32
        For rays that were traced, the primitive that the search came upon, which need not be the first; -1 for none.
    asked_moving : (s,) bool
        Whether moving objects alone were asked.
    steps, tests : (s,) int32
        Traversal steps and intersection tests of the ray, traced alone; 0 unless it was traced or moving objects were
        asked.
    named : dict of int to tuple of int
        For rays that were culled: the primitives that this rests on, where it rests on some.
    """

    light: NDArray[np.int32]
    verdict: NDArray[np.uint8]
    lit: NDArray[np.bool_]
    wrong: NDArray[np.bool_]
    blocker: NDArray[np.int32]
    blocked_at: Float32
    met: NDArray[np.int32]
    asked_moving: NDArray[np.bool_]
    steps: NDArray[np.int32]
    tests: NDArray[np.int32]
    named: dict[int, tuple[int, ...]]

    def of_light(self, light: int) -> slice:
        """The places of a light's samples."""
        first, end = np.searchsorted(self.light, [light, light + 1])
        return slice(int(first), int(end))

    @cached_property
    def counts(self) -> Counter[Verdict]:
        """How many rays each verdict has."""
        return counted(self.verdict)


def counted(verdicts: NDArray[np.uint8]) -> Counter[Verdict]:
    """How many of them are which, in the order of `Verdict`, without those that none is."""
    numbers = np.bincount(verdicts, minlength=len(VERDICTS))
    return Counter({verdict: int(n) for verdict, n in zip(VERDICTS, numbers) if n})


@dataclass(frozen=True)
class PathRay:
    """A primary, reflected or refracted ray.

    `number` is its place in `RayTree.rays`, `parent` that of the ray that sent it, -1 for the primary ray. It starts at
    `origin` (3,), goes in the unit `direction` (3,), and counts with `weight` (3,). It hits `primitive` at `t`, -1 and
    inf for a miss; `point` (3,) is where, and `end` (3,) a little above it, where the shadow rays `shadows` end, None
    for a miss. `light` (3,) is what it brings to the pixel by itself, without what it sends on. `steps` and `tests` are
    what it costs, traced alone."""

    number: int
    parent: int
    kind: RayKind
    bounce: int
    origin: Float32
    direction: Float32
    weight: Float32
    t: float
    primitive: int
    point: Float32
    end: Float32
    light: Float64
    steps: int
    tests: int
    shadows: ShadowRays | None


@dataclass(frozen=True)
class RayTree:
    """The rays of pixel (x, y) of a frame, and `samples` (s, 3), where the lights' samples are."""

    frame: Frame
    x: int
    y: int
    rays: tuple[PathRay, ...]
    samples: Float32

    @cached_property
    def children(self) -> dict[int, tuple[int, ...]]:
        """The rays that each has sent, and under -1 the primary one."""
        found: dict[int, list[int]] = {}
        for ray in self.rays:
            found.setdefault(ray.parent, []).append(ray.number)
        return {parent: tuple(numbers) for parent, numbers in found.items()}

    @cached_property
    def counts(self) -> Counter[Verdict]:
        """How many shadow rays each verdict has."""
        return sum((ray.shadows.counts for ray in self.rays if ray.shadows is not None), Counter())

    @property
    def due(self) -> int:
        """Shadow rays that had to be answered."""
        return sum(number for verdict, number in self.counts.items() if verdict.due)

    @property
    def traced(self) -> int:
        """Shadow rays that asked static geometry."""
        return self.counts[Verdict.TRACED]

    @property
    def color(self) -> Float32:
        """(3,) what all rays bring to the pixel."""
        return np.sum([ray.light for ray in self.rays], axis=0).astype(np.float32)

    def shadow_rays(self) -> Iterator[tuple[PathRay, int]]:
        """Each ray with the places of its shadow rays that are due."""
        for ray in self.rays:
            if ray.shadows is not None:
                for place in np.flatnonzero(ray.shadows.verdict != AWAY):
                    yield ray, int(place)


def ray_tree(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel = None) -> RayTree:
    """Find out what became of a pixel's rays.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame, and has begun no other since.
    frame : Frame
        The picture, all of it. If it has several samples a pixel, the rays are those of the first.
    x, y : int
        Column and row of the pixel.
    cancelled : callable, optional
        Asked now and then.

    Returns
    -------
    RayTree
        All rays.

    Raises
    ------
    IndexError
        If the picture has no such pixel.
    LookupError
        If the renderer has begun another frame.
    Cancelled
        Once `cancelled()` is true.
    """
    if not (0 <= x < frame.width and 0 <= y < frame.height):
        raise IndexError(f"no pixel {x},{y}: the picture is {frame.width} x {frame.height}")
    work, world = renderer.work_on(frame), renderer.world
    samples = work.shading.lamps.samples
    told, count = _followed(work, x, y)
    _go_on(cancelled)
    hit = np.flatnonzero(told.names[:count, told_as.PRIMITIVE] != MISS)
    stages = work.stages_now()
    noted, kept = _watched(work, x, y, told, hit, [stage for _, stage in stages], len(samples))
    _go_on(cancelled)
    shadows = _shadow_rays(work, world, told, hit, noted, kept, stages, cancelled)
    lit = np.zeros((count, len(samples)), np.uint8)
    for row, found in zip(hit, shadows, strict=True):
        lit[row] = found.lit
    light = _lit(work, x, y, lit, count)
    rays = _path_rays(world, told, count, light)
    of = dict(zip(hit.tolist(), shadows, strict=True))
    return RayTree(frame, x, y, tuple(replace(ray, shadows=of.get(ray.number)) for ray in rays), samples)


def visits_of(world: World, tree: RayTree, ray: int, place: int | None = None) -> list[Visit]:
    """Follow a ray of a tree through the acceleration structure, node by node.

    Parameters
    ----------
    world : World
        The scene placed at the time of the tree's frame, in either structure.
    tree : RayTree
        The rays.
    ray : int
        The number of a primary, reflected or refracted ray.
    place : int, optional
        Which of the shadow rays from its point is meant instead. One that was not traced is followed as it would have
        been; where only moving objects were asked, it is followed through these.

    Returns
    -------
    list of Visit
        The nodes that it enters, in their order.
    """
    sent = tree.rays[ray]
    if place is None or sent.shadows is None:
        return world.visits(ray_batch(sent.origin[None], sent.direction[None]), 0, nearest=True)
    start = tree.samples[place : place + 1]
    which = DYNAMIC_OBJECTS if sent.shadows.asked_moving[place] else EVERYTHING
    return world.visits(ray_batch(start, sent.end - start, LIGHT_MARGIN, 1.0), 0, which)


def _go_on(cancelled: Cancel) -> None:
    if cancelled is not None and cancelled():
        raise Cancelled("cancelled")


def _followed(work: FrameInProgress, x: int, y: int) -> tuple[PixelRays, int]:
    """The pixel's rays, and how many there are."""
    nothing, room = np.empty((0, 0), np.uint8), ROOM
    while True:
        told = pixel_rays(room)
        count = work.follow_pixel(x, y, nothing, told)
        if count <= room:
            return told, count
        room = max(2 * room, count)


def _lit(work: FrameInProgress, x: int, y: int, lit: NDArray[np.uint8], count: int) -> Float64:
    """(count, 3) what each ray brings to the pixel where the lights get to its point as `lit` says."""
    told = pixel_rays(count)
    work.follow_pixel(x, y, lit, told)
    return told.light.T.copy()


def _path_rays(world: World, told: PixelRays, count: int, light: Float64) -> list[PathRay]:
    """The rays, their steps and tests counted, without their shadow rays."""
    numbers, names = told.numbers[:count], told.names[:count]

    def three(row: int, column: int) -> Float32:
        return numbers[row, column : column + 3]

    every = ray_batch(numbers[:, told_as.RAY_ORIGIN :][:, :3], numbers[:, told_as.RAY_DIRECTION :][:, :3])
    _, costs = world.closest_hits_each(every)
    rays = []
    for row in range(count):
        parent = int(names[row, told_as.PARENT])
        kind = RayKind.PRIMARY
        if parent >= 0:
            above = np.array_equal(three(row, told_as.RAY_ORIGIN), three(parent, told_as.LIFTED))
            kind = RayKind.REFLECTED if above else RayKind.REFRACTED
        rays.append(
            PathRay(
                number=row,
                parent=parent,
                kind=kind,
                bounce=int(names[row, told_as.BOUNCE]),
                origin=three(row, told_as.RAY_ORIGIN),
                direction=three(row, told_as.RAY_DIRECTION),
                weight=three(row, told_as.RAY_WEIGHT),
                t=float(numbers[row, told_as.RAY_T]),
                primitive=int(names[row, told_as.PRIMITIVE]),
                point=three(row, told_as.POSITION),
                end=three(row, told_as.LIFTED),
                light=light[row],
                steps=int(costs[row, 0]),
                tests=int(costs[row, 1]),
                shadows=None,
            )
        )
    return rays


def _watched(
    work: FrameInProgress, x: int, y: int, told: PixelRays, hit: NDArray, stages: list[Stage], samples: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """What watchers have noted, and what stages keep, (hits, samples) each, in the order of the rays that hit."""
    watchers = Watchers(y * work.settings.width + x, len(hit), samples)
    if len(hit):
        work.shade_again(x, y, watchers.between(stages))
    seen = watchers.seen
    rows: dict[bytes, list[int]] = {}
    for row in range(seen.rows):
        rows.setdefault(seen.ray[row].tobytes(), []).append(row)
    order = [rows[told.numbers[number, : told_as.RAY_WEIGHT].tobytes()].pop(0) for number in hit]
    return seen.noted[order], seen.kept[order]


def _shadow_rays(
    work: FrameInProgress,
    world: World,
    told: PixelRays,
    hit: NDArray,
    noted: NDArray[np.int32],
    kept: NDArray[np.int32],
    stages: list[tuple[ShadowMethod, Stage]],
    cancelled: Cancel,
) -> list[ShadowRays]:
    """The shadow rays of each ray that hits."""
    lamps, shape = work.shading.lamps, noted.shape
    ends = told.numbers[hit, told_as.LIFTED : told_as.LIFTED + 3]
    due, answer = noted & DUE != 0, noted >> ANSWERED
    lit, settled = noted & LIT != 0, noted & SETTLED != 0
    traced, moving = due & (answer == 0), lit & ~settled & bool(world.placed.has_dynamic)
    steps, tests, met = (np.zeros(shape, np.int32) for _ in range(3))
    met[:] = MISS

    def asked(those: NDArray[np.bool_], which: int) -> NDArray[np.int32]:
        """Trace some rays alone, write down what they cost, and return what blocks each."""
        points, ones = np.nonzero(those)
        starts = lamps.samples[ones]
        rays = ray_batch(starts, ends[points] - starts, LIGHT_MARGIN, 1.0)
        found, costs = world.occluders_each(rays, which, cancelled)
        steps[those], tests[those] = costs[:, 0], costs[:, 1]
        met[those] = found
        return found

    lit[traced] = asked(traced, EVERYTHING) == MISS
    lit[moving] &= asked(moving, DYNAMIC_OBJECTS) == MISS

    # What is truly in the way, whatever culling has said.
    points, ones = np.nonzero(due)
    starts = lamps.samples[ones]
    nearest = world.closest_hits(ray_batch(starts, ends[points] - starts, LIGHT_MARGIN, 1.0), threads=1)
    blocker, blocked_at = np.full(shape, MISS, np.int32), np.full(shape, np.inf, np.float32)
    blocker[due], blocked_at[due] = nearest.primitive, nearest.t
    lights = np.repeat(np.arange(len(lamps.places), dtype=np.int32), np.diff(lamps.first))
    verdicts = np.where(traced, TRACED, AWAY).astype(np.uint8)
    found = []
    for row, number in enumerate(hit):
        primitive = int(told.names[number, told_as.PRIMITIVE])
        whys = _reasons(stages, primitive, ends[row], lights, noted[row], kept[row])
        named = {}
        for place, why in whys.items():
            verdicts[row, place] = NUMBER_OF[why.verdict]
            if why.named:
                named[place] = why.named
        found.append(
            ShadowRays(
                lights, verdicts[row], lit[row], due[row] & (lit[row] == (blocker[row] != MISS)), blocker[row],
                blocked_at[row], met[row], moving[row], steps[row], tests[row], named,
            )
        )  # fmt: skip
        _go_on(cancelled)
    return found


def _reasons(
    stages: list[tuple[ShadowMethod, Stage]],
    primitive: int,
    end: Float32,
    lights: NDArray[np.int32],
    noted: NDArray[np.int32],
    kept: NDArray[np.int32],
) -> dict[int, Because]:
    """Why each of a point's shadow rays that was culled was so, by its place."""
    point = float(end[0]), float(end[1]), float(end[2])
    selecting = next((method for method, stage in stages if stage.select is not None), None)
    places = np.flatnonzero(noted >> ANSWERED)
    passed_over, known, whys = int((noted >> ANSWERED == 1).sum()), {}, {}
    for place in places.tolist():
        number, lit = int(noted[place] >> ANSWERED) - 1, bool(noted[place] & LIT)
        key = int(lights[place]), number, lit, int(kept[place])
        if key not in known:
            method = selecting if number == 0 else stages[number - 1][0]
            if number == 0 and (method is None or passed_over > MOST_NAMED):
                known[key] = Because(Verdict.PASSED_OVER)
            else:
                assert method is not None
                known[key] = method.because(Answered(primitive, point, int(lights[place]), lit, int(kept[place])))
        whys[place] = known[key]
    return whys
