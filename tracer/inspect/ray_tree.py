"""What became of a pixel's rays: its primary, reflected and refracted rays, and every shadow ray of each bounce.

A tile of the picture is shaded once more, in the company in which the pixel was shaded, with watchers between the
stages of its methods (`ray_probe`).  So each shadow ray is known to have been asked or not, and what answered it,
exactly as in the frame.  Those that were traced are traced once more by themselves, with their steps and tests counted.
And of all that were due the nearest thing in their way is found, whatever culling said, so that a wrong answer is seen
to be one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.cells import units_of
from tracer.culling.shadow_testing import LIGHT_MARGIN
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.queries import DYNAMIC_OBJECTS, EVERYTHING
from tracer.geometry.rays import MISS, Rays, ray_batch
from tracer.inspect.path_records import AWAY, NUMBER_OF, TRACED, PathRay, RayKind, RayTree, ShadowRays
from tracer.inspect.ray_probe import ANSWERED, DUE, LIT, SETTLED, SentRay, Watchers, secondary_rays
from tracer.method import Method
from tracer.scene.model import Cancelled
from tracer.shading import wave

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer

MOST_NAMED = 64  # lights of a point that are passed over and whose blockers are looked for

Cancel = Callable[[], bool] | None


def unused(state: str) -> str:
    """Say what is known where a certificate has this state and nobody has looked it up."""
    return f"proved {state}, unused"


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
    pixel = _Pixel(renderer, frame, x, y, True, cancelled)
    rays = pixel.path_rays(pixel.shadow_rays())
    _, costs = renderer.world.closest_hits_each(
        ray_batch([ray.origin for ray in rays], [ray.direction for ray in rays])
    )
    counted = (replace(ray, steps=int(n), tests=int(m)) for ray, (n, m) in zip(rays, costs, strict=True))
    return RayTree(frame, x, y, tuple(counted), pixel.lamps.samples)


def unculled_shadow_rays(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel = None) -> ShadowRays:
    """Trace all shadow rays of what a pixel shows, which may be of a picture that is shaded in part so far."""
    return _Pixel(renderer, frame, x, y, False, cancelled).shadow_rays()[0]


class _Pixel:
    """A pixel whose rays have been watched: as the frame's stages have answered them, or as if there were none."""

    def __init__(self, renderer: Renderer, frame: Frame, x: int, y: int, culls: bool, cancelled: Cancel) -> None:
        if not (0 <= x < frame.width and 0 <= y < frame.height):
            raise IndexError(f"no pixel {x},{y}: the picture is {frame.width} x {frame.height}")
        self._work, self._world = renderer.work_on(frame, in_part=not culls), renderer.world
        self._x, self._y, self._cancelled = x, y, cancelled
        self._stages = self._work.stages_now() if culls else []
        self._method = Method.parse(self._work.settings.method)
        self.lamps = self._work.shading.lamps
        self._lights = np.repeat(np.arange(len(self.lamps.places), dtype=np.int32), np.diff(self.lamps.first))
        self._watchers = self._watched()
        self._seen = self._watchers.seen
        self._go_on()

    def _go_on(self) -> None:
        if self._cancelled is not None and self._cancelled():
            raise Cancelled("cancelled")

    def _watched(self) -> Watchers:
        """Watchers that have seen all of the pixel's rays that hit something."""
        place, samples = self._y * self._work.settings.width + self._x, len(self.lamps.samples)
        watchers = Watchers(place, samples)
        if self._work.buffers.primitive[self._y, self._x] == MISS:
            return watchers
        self._shade(watchers)
        if watchers.wanted > len(watchers.seen.lane):
            watchers = Watchers(place, samples, watchers.wanted)
            self._shade(watchers)
        return watchers

    def _shade(self, watchers: Watchers) -> None:
        self._work.shade_again(self._x, self._y, watchers.between([stage for _, stage in self._stages]))

    # --- the rays on their way ---------------------------------------------------------------------------

    def path_rays(self, shadows: list[ShadowRays]) -> list[PathRay]:
        """All rays, each after the one that sent it: those that were seen, and those that have missed everything."""
        seen, work = self._seen, self._work
        if shadows:  # shaded by these answers, the points send the light that the frame has
            self._watchers.give(np.array([found.lit for found in shadows]))
            self._shade(self._watchers)
        rows: dict[tuple[int, bytes], list[int]] = {}
        for known in range(len(seen.lane)):
            rows.setdefault((int(seen.bounce[known]), seen.ray(known).key), []).append(known)
        rays: list[PathRay] = []
        waiting = deque([(-1, 0, RayKind.PRIMARY, self._primary())])
        while waiting:
            parent, bounce, kind, sent = waiting.popleft()
            number, found = len(rays), rows.get((bounce, sent.key))
            row = found.pop(0) if found else None
            light = work.shading.background if row is None else seen.light[row]
            ray = PathRay(number, parent, kind, bounce, *sent[1:], light=(sent.weight * light).astype(np.float64))
            if row is not None:
                t, primitive = float(seen.wave[row, wave.HIT_T]), seen.primitive(row)
                point, end = seen.position(row), seen.end(row)
                ray = replace(ray, t=t, primitive=primitive, point=point, end=end, shadows=shadows[row])
                for child in secondary_rays(seen, row) if bounce < work.settings.depth else ():
                    by = RayKind.REFRACTED if child.refracted else RayKind.REFLECTED
                    waiting.append((number, bounce + 1, by, child))
            rays.append(ray)
        assert not any(rows.values()), "every ray was sent by one that was seen"
        return rays

    def _primary(self) -> SentRay:
        if len(self._seen.lane):
            return self._seen.ray(0)
        rays = self._work.rays
        way = (rays.corner + np.float32(self._x) * rays.column + np.float32(self._y) * rays.row).astype(np.float32)
        return SentRay(False, np.asarray(rays.origin, np.float32), way / np.linalg.norm(way), np.ones(3, np.float32))

    # --- shadow rays -------------------------------------------------------------------------------------

    def _to_lights(self, those: NDArray[np.bool_]) -> Rays:
        """Some of the shadow rays (rays, samples), from the samples of lights to where they end."""
        rows, places = np.nonzero(those)
        starts = self.lamps.samples[places]
        ends = np.array([self._seen.end(row) for row in range(len(those))], np.float32).reshape(-1, 3)
        return ray_batch(starts, ends[rows] - starts, LIGHT_MARGIN, 1.0)

    def shadow_rays(self) -> list[ShadowRays]:
        """The shadow rays of each ray that was seen."""
        noted = self._seen.noted
        due, answered = noted & DUE != 0, noted >> ANSWERED != 0
        lit, settled = noted & LIT != 0, noted & SETTLED != 0
        traced, of_static = due & ~answered, lit & ~settled
        moving = of_static & bool(self._world.placed.has_dynamic)
        steps, tests = np.zeros(noted.shape, np.int32), np.zeros(noted.shape, np.int32)
        met, blocker = np.full(noted.shape, MISS, np.int32), np.full(noted.shape, MISS, np.int32)
        blocked_at = np.full(noted.shape, np.inf, np.float32)

        # What they have asked, each alone.
        for those, which in ((traced, EVERYTHING), (moving, DYNAMIC_OBJECTS)):
            found, costs = self._world.occluders_each(self._to_lights(those), which, self._cancelled)
            met[those], steps[those], tests[those] = found, costs[:, 0], costs[:, 1]
        lit = np.where(traced | moving, met == MISS, lit)

        # What is truly in the way, whatever culling has said.
        nearest = self._world.closest_hits(self._to_lights(due), threads=1)
        blocker[due], blocked_at[due] = nearest.primitive, nearest.t
        wrong = due & (lit == (blocker != MISS))
        verdicts, rays = np.where(traced, TRACED, AWAY).astype(np.uint8), []
        for row in range(len(noted)):
            reasons = self._why_culled(row) | self._what_was_known(row, np.flatnonzero(traced[row]).tolist())
            for place, reason in reasons.items():
                verdicts[row, place] = NUMBER_OF[reason.verdict]
            of_row = (verdicts, lit, wrong, blocker, blocked_at, met, moving, of_static, steps, tests)
            rays.append(ShadowRays(self._lights, reasons, *(values[row] for values in of_row)))
            self._go_on()
        return rays

    def _why_culled(self, row: int) -> dict[int, CullReason]:
        """Why each of a point's shadow rays that was culled was so, by its place."""
        noted, kept, end = self._seen.noted[row], self._seen.kept[row], self._seen.end(row)
        point, primitive = (float(end[0]), float(end[1]), float(end[2])), self._seen.primitive(row)
        selecting = next((method for method, stage in self._stages if stage.select is not None), None)
        passed_over, known, reasons = int((noted >> ANSWERED == 1).sum()), {}, {}
        for place in np.flatnonzero(noted >> ANSWERED).tolist():
            number, lit = int(noted[place] >> ANSWERED) - 1, bool(noted[place] & LIT)
            key = int(self._lights[place]), number, lit, int(kept[place])
            if key not in known:
                method = selecting if number == 0 else self._stages[number - 1][0]
                if number == 0 and (method is None or passed_over > MOST_NAMED):
                    known[key] = CullReason(Verdict.PASSED_OVER)
                else:
                    assert method is not None
                    known[key] = method.because(Answered(primitive, point, key[0], lit, key[3]))
            reasons[place] = known[key]
        return reasons

    def _what_was_known(self, row: int, places: list[int]) -> dict[int, CullReason]:
        """What was known of shadow rays of a point that were traced all the same, where anything was."""
        lights = {int(light): self._known(row, int(light)) for light in np.unique(self._lights[places])}
        return {
            place: CullReason(Verdict.TRACED, known=lights[light])
            for place, light in zip(places, self._lights[places].tolist(), strict=True)
            if lights[light]
        }

    def _known(self, row: int, light: int) -> str:
        """What was known of a point and a light, in a word or two, or nothing.

        A certificate that a method has, but does not look up as long as that takes longer than it saves (`auto`), is
        `unused`."""
        work = self._work
        if self._method.uses_modes and modes.has_shadow_mode(work.words, light):
            word = work.words[self._unit(row)]
            occlusion = modes.OcclusionMode(int(word) & 3)
            whole = occlusion is modes.OcclusionMode.FULLY_RENDERED
            return modes.ShadowMode(int(modes.shadow_mode(word, light))).name if whole else occlusion.name
        if self.lamps.radii[light] == 0:
            asked = {method for method, _ in self._stages}
            for method in work.methods:
                state, _ = method.explain(self._seen.primitive(row), self._seen.end(row), light)
                if method not in asked and state != "none":
                    return unused(state)
                if state == "candidates":
                    return state
        return ""

    def _unit(self, row: int) -> int:
        """What carries the modes of a ray's point."""
        primitive, found = self._seen.primitive(row), np.empty(1, np.int32)
        if not len(self._work.first):
            return primitive
        u, v = (self._seen.wave[row, at : at + 1] for at in (wave.HIT_U, wave.HIT_V))
        units_of(self._work.first, np.array([primitive], np.int32), u, v, found)
        return int(found[0])
