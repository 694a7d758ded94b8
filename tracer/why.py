"""Why is a pixel's shadow ray culled, or traced?  One reason for each light, and one sentence that names the rule.

A reason is found in what the frame really did with the ray (`tracer.ray_tree`), and in the modes as shadow testing read
them: as the frame before had left them, not as this frame leaves them.  Where a picture is shaded in part so far, it is
what these modes say.  `tracer.why_in_words` makes sentences of reasons.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate, by_modes
from tracer.culling.modes import (
    MAX_CULLED_LIGHTS,
    OcclusionMode,
    ShadowMode,
    has_shadow_mode,
    occlusion_mode,
    shadow_mode,
)
from tracer.culling.verdicts import Verdict
from tracer.explanation import Explanation, explain
from tracer.method import Method
from tracer.occluded_by import OccludedBy, Pixel, Reference, Seen, occluded_by, references
from tracer.ray_reasons import unused
from tracer.ray_tree import Cancel, ray_tree
from tracer.told_rays import VERDICTS, RayTree, ShadowRays

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.frame_in_progress import FrameInProgress
    from tracer.renderer import Renderer


class Rule(Enum):
    """What decides about a shadow ray, with the section of the paper that has it, if one does."""

    FACES_AWAY = ("faces away", "")
    FULL_SHADOW = ("FULL_SHADOW", "2.4")
    NON_SHADOW = ("NON_SHADOW", "2.4")
    KNOWN = ("another method knows", "")
    DYNAMIC = ("dynamic", "2.2")
    PARTLY_OCCLUDED = ("partly occluded", "2.3")
    NOT_SEEN_WHOLE = ("not seen whole", "2.6")
    PARTIAL_SHADOW = ("PARTIAL_SHADOW", "2.5")
    NO_SHADOW_MODE = ("no shadow mode", "2.5")
    NO_ROOM = ("no room for modes", "2.2")
    NOT_ANSWERED = ("the method leaves it", "")
    UNKNOWN = ("nothing is known", "")
    OFF = ("culling is off", "")
    CLUSTERS = ("clusters of lights", "")
    NOT_SHADED = ("not shaded yet", "")

    @property
    def section(self) -> str:
        """The section of the paper, "" for none."""
        return self.value[1]


SECTIONS = {
    "2.2": "Each primitive has an occlusion mode, and a shadow mode for each light. The occlusion mode of a "
    "dynamic object is DYNAMIC for good.",
    "2.3": "Occlusion testing: the ray of a pixel is tested against what its left and its upper neighbour see. What it "
    "meets there is hidden by something nearer, and so partly occluded; so is what the screen's edge cuts off.",
    "2.4": "Shadow testing: no ray of a fully rendered primitive in FULL_SHADOW is traced, those of one in NON_SHADOW "
    "ask dynamic objects alone, and every other ray is traced.",
    "2.5": "Shadow-mode setting: a blocked ray adds FULL_SHADOW to the mode of its primitive and light, one that "
    "reaches the light NON_SHADOW. Both together are PARTIAL_SHADOW, which stays.",
    "2.6": "Occlusion-mode setting: what no test finds occluded is FULLY_RENDERED, until it covers so many times the "
    "pixels that it covered then. After that it is examined anew.",
}
"""What the paper's sections say."""

MEANING: dict[Verdict, str] = {
    Verdict.AWAY: "The light is behind the surface, so that no shadow ray is due.",
    Verdict.PASSED_OVER: "The light is proven to be hidden from all that is near the point.",
    Verdict.FULL_SHADOW: "The primitive is fully rendered, and every shadow ray from it to this light was blocked.",
    Verdict.NON_SHADOW: "The primitive is fully rendered, and nothing static blocked any shadow ray from it to this "
    "light: only objects that move are tested.",
    Verdict.CERTIFIED_FULL: "The whole cell is proven to be in the shadow of static geometry.",
    Verdict.CERTIFIED_LIT: "Nothing static is between the whole cell and the light: only objects that move are tested.",
    Verdict.CANDIDATES: "Only a few primitives can block the light here: these are tested, and objects that move.",
    Verdict.BEAM: "What is between the lamp and neighbouring points was asked about all of its samples at once.",
    Verdict.CACHED: "The primitive that blocked a ray there before was tested first, and blocks this one too.",
    Verdict.BUFFER_LIT: "Nothing that the light sees in this direction is nearer to it than the point.",
    Verdict.BUFFER_FULL: "The point is behind a triangle that hides all of a cell of the light's cube.",
    Verdict.BUFFER_TESTED: "Only a few primitives are in the point's cell of the light's cube: these are tested.",
    Verdict.VOXEL_LIT: "Nothing static is between the light and any point of the voxel: only objects that move "
    "are tested.",
    Verdict.VOXEL_FULL: "One triangle hides the light from all of the voxel.",
    Verdict.VOXEL_WALK: "Of the point's voxel nothing is known: the ray walked on towards the light, from voxel to "
    "voxel.",
    Verdict.CELL_LIT: "The point's cell knows of nothing that blocks the light: only objects that move are tested.",
    Verdict.CELL_FULL: "The point's cell knows the light to be hidden from all of it.",
    Verdict.CELL_TESTED: "The point's cell knows what may block the light: these primitives are tested, and objects "
    "that move.",
    Verdict.ANSWERED: "The method knew the answer.",
    Verdict.TRACED: "Nothing was known: the ray was traced through the scene.",
}
"""What each verdict means."""

_PROVEN = {
    "full": "the light is hidden from the whole cell",
    "lit": "nothing static is in the way",
    "candidates": "only a few primitives can block the light here",
}
WHY_TRACED: dict[str, str] = {
    "INIT": "Traced: nothing is known of the primitive yet, or not towards this light.",
    "PARTIALLY_OCCLUDED": "Traced: something hides a part of the primitive, so that its shadow modes are not trusted.",
    "DYNAMIC": "Traced: the primitive moves, so that it has no shadow modes.",
    "PARTIAL_SHADOW": "Traced: some shadow rays from the primitive to this light were blocked, and others were not.",
    "candidates": "Traced: only a few primitives can block the light here, but to trace the ray with its neighbours is "
    "quicker than to test these.",
    **{
        unused(state): f"Traced: a certificate says that {known}. But the method auto looks no certificates up "
        "here, as it has measured that tracing every ray is quicker."
        for state, known in _PROVEN.items()
    },
}
"""What tracing says where something was known all the same (`ShadowRays.known`)."""

_FATES = {
    Verdict.AWAY: Fate.FACES_AWAY,
    Verdict.NON_SHADOW: Fate.DYNAMIC_ONLY,
    Verdict.CERTIFIED_LIT: Fate.DYNAMIC_ONLY,
    Verdict.VOXEL_LIT: Fate.DYNAMIC_ONLY,
    Verdict.CELL_LIT: Fate.DYNAMIC_ONLY,
    Verdict.VOXEL_WALK: Fate.CANDIDATES,
    Verdict.CANDIDATES: Fate.CANDIDATES,
    Verdict.BUFFER_TESTED: Fate.CANDIDATES,
    Verdict.CELL_TESTED: Fate.CANDIDATES,
    Verdict.CACHED: Fate.CACHED,
    Verdict.TRACED: Fate.TRACED,
}
_RULES = {
    Fate.CULLED: Rule.FULL_SHADOW,
    Fate.DYNAMIC_ONLY: Rule.NON_SHADOW,
    Fate.PARTLY_OCCLUDED: Rule.PARTLY_OCCLUDED,
    Fate.PARTIAL_SHADOW: Rule.PARTIAL_SHADOW,
    Fate.NOT_SEEN_WHOLE: Rule.NOT_SEEN_WHOLE,
    Fate.DYNAMIC: Rule.DYNAMIC,
}
"""Of the paper's method, by what it does with a ray (`tracer.culling.fate.by_modes`)."""


@dataclass(frozen=True)
class TaughtBy:
    """The frame that gave a primitive its mode: its number, and what it is called.

    `lit` says which answer was met, None where the frame saw the primitive whole.  `pixel` is one that met it, None
    where only reflected or refracted rays did, or where that is not `known`."""

    frame: int
    name: str
    pixel: Pixel | None = None
    lit: bool | None = None
    known: bool = True


@dataclass(frozen=True)
class Reason:
    """Why a pixel's shadow ray to one light was culled, or traced.

    Attributes
    ----------
    light : int
        Number of the light.
    rule : Rule
        What decided.
    fate : Fate
        What became of the ray.
    verdict : Verdict or None
        The same as `ray_tree` tells it; None where the pixel has not been shaded.
    rays, samples : int
        How many shadow rays this holds for, of how many to the light.
    lit : int
        How many of them reach the light.
    wrong : int
        How many answers for the light are not true.
    blocker : int
        The primitive that is truly in the way, -1 for none.
    shadow : ShadowMode
        The shadow mode by which the ray was decided about.
    occlusion, occlusion_after : OcclusionMode
        The occlusion mode by which it was, and the one that the frame leaves.
    taught_pixels : int
        How many pixels have set its modes, where that is too few to trust them.
    occluded : OccludedBy or None
        Where this frame finds the primitive partly occluded.
    named : tuple of int
        The primitives that the answer rests on.
    dynamic_objects : int
        How many dynamic objects there are to ask.
    limit : int
        To how many lights the method answers rays.
    told : str
        What more there is to say, in sentences.
    method : str
        The method.
    instead : Reason or None
        What the paper's method makes of the modes, where culling is off, or the pixel may not have been shaded yet.
    taught : tuple of TaughtBy
        Who set the shadow mode, where that is known.
    """

    light: int
    rule: Rule
    fate: Fate
    verdict: Verdict | None = None
    rays: int = 1
    samples: int = 1
    lit: int = 0
    wrong: int = 0
    blocker: int = -1
    shadow: ShadowMode = ShadowMode.INIT
    occlusion: OcclusionMode = OcclusionMode.INIT
    occlusion_after: OcclusionMode = OcclusionMode.INIT
    occluded: OccludedBy | None = None
    taught_pixels: int = 0
    named: tuple[int, ...] = ()
    dynamic_objects: int = 0
    limit: int = MAX_CULLED_LIGHTS
    told: str = ""
    method: str = "paper"
    instead: Reason | None = None
    taught: tuple[TaughtBy, ...] = ()


@dataclass(frozen=True)
class Coverage:
    """How a pixel's unit, a primitive or a cell of one, stands in occlusion-mode setting (§2.6): its mode before the
    frame and after it, the pixels that it covers and those that it covered when it was examined last, how many times
    those it may cover, where it is partly occluded, how many pixels have set its modes where these are too few yet, and
    the frame that saw it whole."""

    before: OcclusionMode
    after: OcclusionMode
    pixels: int
    highest: int
    zoom_factor: float
    in_cells: bool
    occluded: OccludedBy | None = None
    taught_pixels: int = 0
    taught: TaughtBy | None = None


@dataclass(frozen=True)
class Why:
    """All that there is to say of a pixel: a reason for each light, how its unit stands, None where the frame keeps no
    modes, the two pixels that it is compared with, and its rays, None while they are not known."""

    x: int
    y: int
    primitive: int
    reasons: tuple[Reason, ...]
    coverage: Coverage | None = None
    references: tuple[Reference, ...] = ()
    tree: RayTree | None = None


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
    pixel = _Pixel(renderer, work, frame, x, y)
    shadows = None if tree is None else tree.rays[0].shadows
    if shadows is None:
        reasons = tuple(pixel.in_part(one) for one in explain(renderer, frame, x, y))
    else:
        reasons = tuple(pixel.reason(shadows, light) for light in range(frame.lights))
    compared = references(pixel.seen, (x, y)) if frame.settings.keeps_modes else ()
    return Why(x, y, primitive, reasons, pixel.coverage, compared, tree)


class _Pixel:
    """What is known of a pixel for all lights alike."""

    def __init__(self, renderer: Renderer, work: FrameInProgress, frame: Frame, x: int, y: int) -> None:
        settings = frame.settings
        self._frame, self._by_modes = frame, settings.keeps_modes
        self._method = Method.parse(settings.method)
        units = work.units
        self.seen = Seen(renderer.world.placed, work.rays, frame.primitive, units, work.first, settings.symmetric)
        unit = int(units[y, x])
        self._word = work.words[unit : unit + 1]
        self._before, self._after = (
            OcclusionMode(int(occlusion_mode(words[unit]))) for words in (work.words, frame.modes)
        )
        present = renderer.world.pose(frame.time).present
        self._dynamic_objects = int(np.count_nonzero(present[1:] & (work.resting.since[1:] == 0)))
        self._lamps = np.diff(work.shading.lamps.first)
        self._shaded, self._taught = work.has_shaded(x, y), work.taught(unit) if self._by_modes else 0
        self._occluded = None
        if self._by_modes and self._after is OcclusionMode.PARTIALLY_OCCLUDED:
            self._occluded = occluded_by(self.seen, unit, (x, y))
        self.coverage = None
        if self._by_modes:
            self.coverage = Coverage(
                self._before, self._after, int(frame.pixel_count[unit]), int(frame.highest_count[unit]),
                settings.zoom_factor, self._method.uses_cells, self._occluded, self._taught,
            )  # fmt: skip

    def reason(self, s: ShadowRays, light: int) -> Reason:
        """Why the rays to a light had the fate that most of them had."""
        places = np.arange(len(s.light))[s.of_light(light)]
        verdict, known, those = _most(s, places)
        place = int(those[0])
        fate = _FATES.get(verdict, Fate.CULLED)
        if verdict is Verdict.BUFFER_LIT and s.asked_moving[place]:  # else their depth is known, too
            fate = Fate.DYNAMIC_ONLY
        told = Reason(
            light=light,
            rule=Rule.KNOWN,
            fate=fate,
            verdict=verdict,
            rays=len(those),
            samples=len(places),
            lit=int(s.lit[those].sum()),
            wrong=int(s.wrong[places].sum()),
            blocker=int(s.blocker[place]),
            named=s.named.get(place, ()),
            dynamic_objects=self._dynamic_objects,
            told=s.told.get(place, ""),
            method=self._frame.settings.method,
            **self._modes(light),
        )
        if verdict is Verdict.TRACED:
            return self._traced(told, known)
        rules = {
            Verdict.AWAY: Rule.FACES_AWAY,
            Verdict.FULL_SHADOW: Rule.FULL_SHADOW,
            Verdict.NON_SHADOW: Rule.NON_SHADOW,
        }
        return replace(told, rule=rules.get(verdict, Rule.KNOWN))

    def in_part(self, one: Explanation) -> Reason:
        """What is truly in a light's way, and what the modes say, where a picture is shaded in part so far."""
        told = Reason(
            light=one.light,
            rule=Rule.NOT_SHADED if one.due else Rule.FACES_AWAY,
            fate=Fate.NONE if one.due else Fate.FACES_AWAY,
            rays=one.samples,
            samples=one.samples,
            lit=one.reached,
            blocker=-1 if one.blocker is None else one.blocker,
            dynamic_objects=self._dynamic_objects,
            method=self._frame.settings.method,
            **self._modes(one.light),
        )
        if not one.due or not self._method.uses_modes:
            return told
        by_paper = self._by_paper(told)
        return by_paper if self._shaded else replace(told, instead=by_paper)

    def _modes(self, light: int) -> dict:
        if not self._by_modes:
            return {}
        shadow = ShadowMode(int(shadow_mode(self._word, light)[0]))
        return {
            "shadow": shadow, "occlusion": self._before, "occlusion_after": self._after, "occluded": self._occluded,
            "taught_pixels": self._taught,
        }  # fmt: skip

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
        if rule is Rule.NOT_SEEN_WHOLE and told.occlusion is OcclusionMode.FULLY_RENDERED:
            rule = Rule.NO_SHADOW_MODE
        return replace(told, rule=rule, fate=fate)


def _most(s: ShadowRays, places: NDArray[np.int64]) -> tuple[Verdict, str, NDArray[np.int64]]:
    """The verdict that most rays of a light have that are due, with what was known of them, and their places."""
    fates: dict[tuple[int, str], list[int]] = {}
    for place in places.tolist():
        fates.setdefault((int(s.verdict[place]), s.known.get(place, "")), []).append(place)
    number, known = max(fates, key=lambda fate: (VERDICTS[fate[0]].due, len(fates[fate])))
    return VERDICTS[number], known, np.array(fates[number, known])
