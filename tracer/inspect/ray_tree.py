"""What became of a pixel's rays: its primary, reflected and refracted rays, and every shadow ray of each bounce.

A tile of the picture is shaded once more, in the company in which the pixel was shaded, with watchers between the
stages of its methods (`tracer.methods.watching`).  So each shadow ray is known to have been asked or not, and what
answered it, exactly as in the frame.  Those that were traced are traced once more by themselves, with their steps and
tests counted.  And of all that were due the nearest thing in their way is found, whatever culling said, so that a wrong
answer is seen to be one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING
from tracer.geometry.rays import MISS, ray_batch
from tracer.inspect.path_records import AWAY, NUMBER_OF, TRACED, PathRay, RayKind, RayTree, ShadowRays
from tracer.inspect.ray_reasons import end_of, known_of, primitive_of, reasons_of
from tracer.inspect.secondary_rays import SentRay, sent_rays
from tracer.methods.watching import ANSWERED, DUE, LIT, SETTLED, Seen, Watchers
from tracer.scene.model import Cancelled
from tracer.shading import points, wave

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.frame_in_progress import FrameInProgress
    from tracer.geometry.world import World
    from tracer.methods.interface import ShadowMethod, Stage
    from tracer.renderer import Renderer


Cancel = Callable[[], bool] | None


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
    samples, stages = work.shading.lamps.samples, work.stages_now()
    watchers = _watched(work, x, y, [stage for _, stage in stages], len(samples))
    _go_on(cancelled)
    shadows = _shadow_rays(work, world, watchers.seen, stages, cancelled)
    if shadows:
        watchers.give(np.array([found.lit for found in shadows]))
        work.shade_again(x, y, watchers.between([stage for _, stage in stages]))
    rays = _path_rays(work, x, y, watchers.seen, shadows)
    _, costs = world.closest_hits_each(ray_batch([ray.origin for ray in rays], [ray.direction for ray in rays]))
    counted_rays = (replace(ray, steps=int(n), tests=int(m)) for ray, (n, m) in zip(rays, costs, strict=True))
    return RayTree(frame, x, y, tuple(counted_rays), samples)


def _go_on(cancelled: Cancel) -> None:
    if cancelled is not None and cancelled():
        raise Cancelled("cancelled")


def _watched(work: FrameInProgress, x: int, y: int, stages: list[Stage], samples: int) -> Watchers:
    """Watchers that have seen all of the pixel's rays that hit something."""
    watchers = Watchers(y * work.settings.width + x, samples)
    if work.buffers.primitive[y, x] == MISS:
        return watchers
    while True:
        work.shade_again(x, y, watchers.between(stages))
        if watchers.wanted <= len(watchers.seen.lane):
            return watchers
        watchers = Watchers(y * work.settings.width + x, samples, watchers.wanted)


def _path_rays(work: FrameInProgress, x: int, y: int, seen: Seen, shadows: list[ShadowRays]) -> list[PathRay]:
    """All rays, each after the one that sent it: those that were seen, and those that have missed everything."""
    rows: dict[tuple[int, bytes], list[int]] = {}
    for known in range(len(seen.lane)):
        rows.setdefault((int(seen.bounce[known]), seen.wave[known, : wave.WEIGHT].tobytes()), []).append(known)
    first = work.rays
    way = (first.corner + np.float32(x) * first.column + np.float32(y) * first.row).astype(np.float32)
    origin, white = np.asarray(first.origin, np.float32), np.ones(3, np.float32)
    primary = SentRay(False, origin, way / np.linalg.norm(way), white)
    if len(seen.lane):
        told = seen.wave[0]
        primary = SentRay(False, told[wave.ORIGIN :][:3], told[wave.DIRECTION :][:3], white)
    rays: list[PathRay] = []
    waiting = deque([(-1, 0, RayKind.PRIMARY, primary)])
    while waiting:
        parent, bounce, kind, sent = waiting.popleft()
        found = rows.get((bounce, sent.key), [])
        row: int | None = found.pop(0) if found else None
        number = len(rays)
        rays.append(_path_ray(work, number, parent, bounce, kind, sent, seen, row, shadows))
        if row is not None and bounce < work.settings.depth:
            for child in sent_rays(seen, row):
                waiting.append((number, bounce + 1, RayKind.REFRACTED if child.refracted else RayKind.REFLECTED, child))
    assert not any(rows.values()), "every ray was sent by one that was seen"
    return rays


def _path_ray(
    work: FrameInProgress,
    number: int,
    parent: int,
    bounce: int,
    kind: RayKind,
    sent: SentRay,
    seen: Seen,
    row: int | None,
    shadows: list[ShadowRays],
) -> PathRay:
    """A ray that was seen as a row, or else has missed."""
    nowhere = np.full(3, np.nan, np.float32)
    coming = work.shading.background if row is None else seen.light[row]
    ray = PathRay(
        number=number,
        parent=parent,
        kind=kind,
        bounce=bounce,
        origin=sent.origin,
        direction=sent.direction,
        weight=sent.weight,
        t=np.inf,
        primitive=MISS,
        point=nowhere,
        end=nowhere,
        light=(sent.weight * coming).astype(np.float64),
        steps=0,
        tests=0,
        shadows=None,
    )
    if row is None:
        return ray
    return replace(
        ray,
        t=float(seen.wave[row, wave.HIT_T]),
        primitive=primitive_of(seen, row),
        point=seen.point[row, points.POSITION_ROW :][:3],
        end=end_of(seen, row),
        shadows=shadows[row],
    )


def _shadow_rays(
    work: FrameInProgress, world: World, seen: Seen, stages: list[tuple[ShadowMethod, Stage]], cancelled: Cancel
) -> list[ShadowRays]:
    """The shadow rays of each ray that was seen."""
    lamps, noted, shape = work.shading.lamps, seen.noted, seen.noted.shape
    ends = seen.point[:, points.LIFTED_ROW : points.LIFTED_ROW + 3]
    due, answer = noted & DUE != 0, noted >> ANSWERED
    lit, settled = noted & LIT != 0, noted & SETTLED != 0
    traced, of_static = due & (answer == 0), lit & ~settled
    moving = of_static & bool(world.placed.has_dynamic)
    steps, tests, met = (np.zeros(shape, np.int32) for _ in range(3))
    met[:] = MISS

    def asked(those: NDArray[np.bool_], which: int) -> NDArray[np.int32]:
        """Trace some rays alone, write down what they cost, and return what blocks each."""
        at, ones = np.nonzero(those)
        starts = lamps.samples[ones]
        rays = ray_batch(starts, ends[at] - starts, LIGHT_MARGIN, 1.0)
        found, costs = world.occluders_each(rays, which, cancelled)
        steps[those], tests[those] = costs[:, 0], costs[:, 1]
        met[those] = found
        return found

    lit[traced] = asked(traced, EVERYTHING) == MISS
    lit[moving] &= asked(moving, DYNAMIC_OBJECTS) == MISS

    # What is truly in the way, whatever culling has said.
    at, ones = np.nonzero(due)
    starts = lamps.samples[ones]
    nearest = world.closest_hits(ray_batch(starts, ends[at] - starts, LIGHT_MARGIN, 1.0), threads=1)
    blocker, blocked_at = np.full(shape, MISS, np.int32), np.full(shape, np.inf, np.float32)
    blocker[due], blocked_at[due] = nearest.primitive, nearest.t
    lights = np.repeat(np.arange(len(lamps.places), dtype=np.int32), np.diff(lamps.first))
    verdicts = np.where(traced, TRACED, AWAY).astype(np.uint8)
    found = []
    for row in range(len(noted)):
        whys = reasons_of(stages, primitive_of(seen, row), ends[row], lights, noted[row], seen.kept[row])
        named, known, told = {}, {}, {}
        for place, why in whys.items():
            verdicts[row, place] = NUMBER_OF[why.verdict]
            if why.named:
                named[place] = why.named
            if why.told:
                told[place] = why.told
        for place in np.flatnonzero(traced[row]).tolist():
            if word := known_of(work, stages, seen, row, int(lights[place]), bool(lamps.radii[lights[place]] == 0)):
                known[place] = word
        found.append(
            ShadowRays(
                lights, verdicts[row], lit[row], due[row] & (lit[row] == (blocker[row] != MISS)), blocker[row],
                blocked_at[row], met[row], moving[row], of_static[row], steps[row], tests[row], named, known, told,
            )
        )  # fmt: skip
        _go_on(cancelled)
    return found
