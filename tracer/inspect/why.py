"""Why is a pixel's shadow ray culled, or traced?  One reason for each light, and one sentence that names the rule.

A reason is found in what the frame really did with the ray (`ray_tree`), and in the modes as shadow testing read them:
as the frame before had left them, not as this frame leaves them.  Where a picture is shaded in part so far, it is what
these modes say.  `reasons` is the model, and `why_in_words` makes sentences of it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate, by_modes
from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode, occlusion_mode, shadow_mode
from tracer.culling.verdicts import Verdict
from tracer.inspect.occluded_by import Seen, occluded_by, references
from tracer.inspect.path_records import VERDICTS, ShadowRays
from tracer.inspect.ray_tree import Cancel, ray_tree, unculled_shadow_rays
from tracer.inspect.reasons import Coverage, Reason, Rule, Why
from tracer.method import Method

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.frame_in_progress import FrameInProgress
    from tracer.renderer import Renderer
    from tracer.scene.arrays import Float32


_RULES = {
    Fate.CULLED: Rule.FULL_SHADOW,
    Fate.DYNAMIC_ONLY: Rule.NON_SHADOW,
    Fate.PARTLY_OCCLUDED: Rule.PARTLY_OCCLUDED,
    Fate.PARTIAL_SHADOW: Rule.PARTIAL_SHADOW,
    Fate.NOT_SEEN_WHOLE: Rule.NOT_SEEN_WHOLE,
    Fate.DYNAMIC: Rule.DYNAMIC,
}
"""Of the paper's method, by what it does with a ray (`tracer.culling.fate.by_modes`)."""
_ANSWERED = {
    Verdict.AWAY: Rule.FACES_AWAY,
    Verdict.FULL_SHADOW: Rule.FULL_SHADOW,
    Verdict.NON_SHADOW: Rule.NON_SHADOW,
}
"""Of the rays that these have answered; of others another method knew."""


def why(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Cancel = None) -> Why:
    """Say for each light why the shadow rays of what a pixel shows were culled, or traced.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame; its world must still be placed for it.
    frame : Frame
        The picture.
    x, y : int
        Column and row of the pixel.
    cancelled : callable, optional
        Asked now and then.

    Returns
    -------
    Why
        The reasons; none where the pixel shows nothing.

    Raises
    ------
    IndexError
        If the picture has no such pixel.
    LookupError
        If the renderer has begun another frame.
    Cancelled
        Once `cancelled()` is true.
    """
    in_part = frame.statistics.part < 1.0
    work = renderer.work_on(frame, in_part)
    tree = None if in_part else ray_tree(renderer, frame, x, y, cancelled)
    primitive = int(frame.primitive[y, x])
    if primitive < 0:
        return Why(x, y, -1, (), tree=tree)
    shadows = unculled_shadow_rays(renderer, frame, x, y, cancelled) if tree is None else tree.rays[0].shadows
    assert shadows is not None, "the primary ray has hit"
    pixel = _Pixel(renderer, work, frame, x, y, None if tree is None else tree.rays[0].end)
    reasons = tuple(pixel.reason(shadows, light) for light in range(frame.lights))
    compared = references(pixel.seen, (x, y)) if frame.settings.keeps_modes else ()
    return Why(x, y, primitive, reasons, pixel.coverage, compared, tree)


class _Pixel:
    """What is known of a pixel for all lights alike."""

    def __init__(
        self, renderer: Renderer, work: FrameInProgress, frame: Frame, x: int, y: int, end: Float32 | None
    ) -> None:
        """`end` (3,) is where its shadow rays end, None where that is not known yet."""
        settings = frame.settings
        self._frame, self._by_modes, self._whole = frame, settings.keeps_modes, frame.statistics.part == 1.0
        self._method = Method.parse(settings.method)
        units = work.units
        self.seen = Seen(renderer.world.placed, work.rays, frame.primitive, units, work.first, settings.symmetric)
        unit = int(units[y, x])
        self._word = work.words[unit : unit + 1]
        self._examined_before = bool(renderer.highest_before[unit])
        self._before = OcclusionMode(int(occlusion_mode(self._word[0])))
        present = renderer.world.pose(frame.time).present
        self._dynamic_objects = int(np.count_nonzero(present[1:] & (work.resting.since[1:] == 0)))
        self._lamps = np.diff(work.shading.lamps.first)
        self._shaded, self.coverage = work.has_shaded(x, y), None
        self._methods, self._primitive, self._end = work.methods, int(frame.primitive[y, x]), end
        if self._by_modes:
            after = OcclusionMode(int(occlusion_mode(frame.modes[unit])))
            hidden = after is OcclusionMode.PARTIALLY_OCCLUDED
            self.coverage = Coverage(
                before=self._before,
                after=after,
                pixels=int(frame.pixel_count[unit]),
                highest=int(frame.highest_count[unit]),
                zoom_factor=settings.zoom_factor,
                in_cells=self._method.uses_cells,
                occluded=occluded_by(self.seen, unit, (x, y)) if hidden else None,
                taught_pixels=work.taught(unit),
            )

    def reason(self, s: ShadowRays, light: int) -> Reason:
        """Why the rays to a light had the fate that most of them had."""
        places = np.arange(len(s.light))[s.of_light(light)]
        those = _most(s, places)
        place = int(those[0])
        verdict, because = VERDICTS[s.verdict[place]], s.reason(place)
        told = Reason(
            light=light,
            rule=_ANSWERED.get(verdict, Rule.KNOWN),
            fate=s.fate(place),
            verdict=verdict,
            rays=len(those),
            samples=len(places),
            lit=int(s.lit[those].sum()),
            wrong=int(s.wrong[places].sum()),
            blocker=int(s.blocker[place]),
            named=because.named,
            dynamic_objects=self._dynamic_objects,
            told=because.told,
            more=self._more(verdict, light),
            method=self._frame.settings.method,
            shadow=ShadowMode(int(shadow_mode(self._word, light)[0])) if self._by_modes else ShadowMode.INIT,
        )
        if verdict is not Verdict.TRACED:
            return told
        return self._traced(told, because.known) if self._whole else self._in_part(told)

    def _more(self, verdict: Verdict, light: int) -> str:
        """What methods have to say besides of a ray that certificates have answered, or that was traced."""
        if self._end is None or verdict not in (Verdict.CERTIFIED_FULL, Verdict.CERTIFIED_LIT, Verdict.TRACED):
            return ""
        return next(filter(None, (method.more(self._primitive, self._end, light) for method in self._methods)), "")

    def _in_part(self, told: Reason) -> Reason:
        """What the modes say, where a picture is shaded in part so far."""
        told = replace(told, rule=Rule.NOT_SHADED, fate=Fate.NONE, verdict=None, samples=told.rays, wrong=0)
        if not self._method.uses_modes:
            return told
        by_paper = self._by_paper(told)
        return by_paper if self._shaded else replace(told, instead=by_paper)

    def _traced(self, told: Reason, known: str) -> Reason:
        """Why a ray was traced."""
        method, light = self._method, told.light
        by_paper = self._by_paper(told) if self._by_modes else None
        if method.uses_modes and by_paper is not None:
            return by_paper
        if method.clusters:
            return replace(told, rule=Rule.CLUSTERS)
        if not method.culls:
            return replace(told, rule=Rule.OFF, instead=by_paper)
        limit = max(kind.answers for kind in method.kinds if kind.culls)
        if light >= limit:
            return replace(told, rule=Rule.NO_ROOM, limit=limit)
        if self._lamps[light] > 1 and not any(kind.lamps or kind.in_part for kind in method.kinds if kind.culls):
            return replace(told, rule=Rule.NOT_ANSWERED)
        decision = self._frame.statistics.decision if method.adaptive else ""
        return replace(told, rule=Rule.UNKNOWN, told=known or decision)

    def _by_paper(self, told: Reason) -> Reason:
        """What the paper's method makes of the modes that shadow testing read."""
        if not has_shadow_mode(self._word, told.light):
            return replace(told, rule=Rule.NO_ROOM, fate=Fate.TRACED)
        fate = Fate(int(by_modes(np.array([Fate.TRACED], np.uint8), self._word, told.light)[0]))
        rule = _RULES[fate]
        if rule is Rule.NOT_SEEN_WHOLE and self._before is OcclusionMode.FULLY_RENDERED:
            rule = Rule.NO_SHADOW_MODE
        elif rule is Rule.NOT_SEEN_WHOLE and self._examined_before:
            rule = Rule.EXAMINED_ANEW
        return replace(told, rule=rule, fate=fate)


def _most(s: ShadowRays, places: NDArray[np.int64]) -> list[int]:
    """The places of a light's rays that have the verdict, the fate and what was known that most have that are due."""
    alike: dict[tuple[int, Fate, str], list[int]] = {}
    for place in places.tolist():
        alike.setdefault((int(s.verdict[place]), s.fate(place), s.reason(place).known), []).append(place)
    return alike[max(alike, key=lambda one: (VERDICTS[one[0]].due, len(alike[one])))]
