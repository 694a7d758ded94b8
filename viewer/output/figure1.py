"""The paper's Figure 1 with a frame's own numbers: its stages in their order, and what goes from each to the next.

What is here is the same for the window, which draws it in a panel, and for files (`figure1_layout`, `figure1_svg`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tracer.culling.fate import Fate
from tracer.culling.mode_changes import ModeChanges
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.method import Method
from tracer.statistics import FrameStatistics
from viewer.state import terms, verified
from viewer.state.methods import BY_MODES
from viewer.state.palette import (
    FATE_COLORS,
    FATE_MEANING,
    FATE_NAMES,
    FATE_WOULD,
    OCCLUSION_COLORS,
    OCCLUSION_MEANING,
    SHADOW_COLORS,
    SHADOW_MEANING,
    WRONG,
    Color,
)
from viewer.state.savings import bar_of
from viewer.state.views import View
from viewer.util.numbers import count, percent, whole_percent

TITLE = "Figure 1"
WITHIN = "in shading"
"""What is said of the time of stages that are parts of another."""


@dataclass(frozen=True)
class Flow:
    """What goes from a stage to the next: a name, how many, and which share of what it is a part of, if of anything;
    with a colour where it has one, `hollow` for what only would be.  `tip` says more, `view` shows it."""

    name: str
    number: int
    share: str = ""
    color: Color | None = None
    hollow: bool = False
    tip: str = ""
    view: View | None = None


@dataclass(frozen=True)
class Part:
    """A part of a bar: 0 to 1 of it."""

    share: float
    color: Color
    hollow: bool = False


@dataclass(frozen=True)
class Stage:
    """A box of the figure: its name, the paper's section or "", its rule in a sentence, its time, its part of the
    frame's time in words and as a number, what leaves it, a bar of parts or none, and the view that shows what it
    does."""

    name: str
    section: str
    rule: str
    time: str
    part: str
    share: float
    flows: tuple[Flow, ...] = ()
    bar: tuple[Part, ...] = ()
    bar_tip: str = ""
    view: View | None = None

    @property
    def heading(self) -> str:
        return f"{self.name} {self.section}".strip()

    @property
    def duration(self) -> str:
        return ", ".join(filter(None, (self.time, self.part)))


@dataclass(frozen=True)
class Figure:
    """The figure of a frame: what it is of, its stages, and, in sentences, what the next frame begins with and what
    else there is to say."""

    title: str
    stages: tuple[Stage, ...]
    next_frame: str
    notes: tuple[str, ...]


def figure_of(frame: Frame, name: str = "") -> Figure:
    """The figure of a frame, with a name of what it shows."""
    method, s = Method.parse(frame.settings.method), frame.statistics
    by_modes = frame.settings.keeps_modes and (method.uses_modes or not method.culls) and not method.clusters
    changes = s.mode_changes if by_modes else None
    counted = method.uses_modes  # else modes are only looked at, and cost the method nothing
    stages = [_placing(s, changes, _units(method)), _primary(s)]
    if by_modes:
        stages.append(_occlusion_testing(s, counted))
    if method.makes:
        stages.append(_preparing(method, s))
    stages += [_shading(s), _shadow_testing(frame, method, by_modes)]
    if changes is not None:
        stages += [_shadow_mode_setting(changes), _occlusion_mode_setting(s, changes, frame, _units(method), counted)]
    title = f"{frame.settings.method}, {frame.width} × {frame.height} pixels, {1e3 * s.seconds:.1f} ms"
    notes = tuple(_notes(s, method, by_modes))
    return Figure(", ".join(filter(None, (name, title))), tuple(stages), _next(s, changes, method), notes)


def _units(method: Method) -> str:
    return "cells" if method.uses_cells else "primitives"


def _notes(s: FrameStatistics, method: Method, by_modes: bool) -> Iterator[str]:
    """Short ones: the window has one line for them."""
    if s.part < 1.0:
        yield f"{whole_percent(s.part)} of pixels shaded so far."
    if by_modes and not method.culls:
        brackets = f"; in brackets: {terms.FOR_DISPLAY}" if s.part == 1.0 else ""  # for which there is room
        yield f"Outlined: what {BY_MODES} would do{brackets}."
    if s.decision:
        yield s.decision


def _stage(
    s: FrameStatistics,
    name: str,
    rule: str,
    phases: tuple[str, ...],
    section: str = "",
    counted: bool = True,
    **more: object,
) -> Stage:
    """A stage with the time of some phases of the frame; where that is not `counted`, it is no part of the frame's."""
    seconds = sum(s.phases.get(phase, 0.0) for phase in phases)
    time, part, share = f"{1e3 * seconds:.1f} ms", percent(seconds, s.seconds), min(seconds / max(s.seconds, 1e-9), 1.0)
    if not counted:
        rule, share = f"{rule} This is done {terms.WHY_FOR_DISPLAY}.", 0.0
        time, part = "", f"({time})"
    return Stage(name, section, rule, time, part, share, **more)  # type: ignore[arg-type]


def _placing(s: FrameStatistics, changes: ModeChanges | None, units: str) -> Stage:
    flows: tuple[Flow, ...] = ()
    if changes is not None:
        moving = changes.units["dynamic"]
        flows = (
            Flow(f"dynamic {units}", moving, "", OCCLUSION_COLORS[OcclusionMode.DYNAMIC], tip=OCCLUSION_MEANING[
                OcclusionMode.DYNAMIC], view=View.OCCLUSION),
        )  # fmt: skip
    rule = "Objects and lights move to where they are now. What is known of a light that moved is forgotten."
    return _stage(s, "Place dynamic objects", rule, ("place",), flows=flows)


def _primary(s: FrameStatistics) -> Stage:
    tip = "one through the centre of each pixel, to the nearest surface"
    flows = (Flow("primary rays", s.primary.rays, tip=tip, view=View.PRIMITIVE),)
    rule = "A ray through each pixel finds the nearest primitive: generation, traversal, intersection."
    return _stage(s, "Primary rays", rule, ("primary",), flows=flows, view=View.PRIMITIVE)


def _occlusion_testing(s: FrameStatistics, counted: bool) -> Stage:
    rule = "Where two neighbouring pixels see different primitives, the ray of one is tested against the primitive of "
    rule += "the other: a hit shows that this primitive is partially occluded."
    tip = "rays tested once more, each against one primitive"
    flows = (Flow("extra tests", s.occlusion_tests, tip=tip, view=View.OCCLUSION),) if counted else ()
    phases = ("occlusion testing",)
    return _stage(s, "Occlusion testing", rule, phases, "§2.3", counted, flows=flows, view=View.OCCLUSION)


_SHOW_WHAT_IS_MADE = {
    "certificates made": View.CERTIFICATE,
    "voxels classified": View.VOXELS,
    "cells settled": View.CELL_LIGHTS,
}


def _preparing(method: Method, s: FrameStatistics) -> Stage:
    made, meaning = terms.made(str(method))
    view = next((_SHOW_WHAT_IS_MADE[one] for one in method.makes if one in _SHOW_WHAT_IS_MADE), None)
    things = terms.things(made)
    rule = f"In place of modes: {meaning}. They stay from frame to frame."
    tip = f"{count(s.certificate_steps)} traversal steps and {count(s.certificate_tests)} intersection tests"
    flows = (Flow(made, s.certificates, tip=tip, view=view),)
    return _stage(s, things[0].upper() + things[1:], rule, ("certification",), flows=flows, view=view)


def _shading(s: FrameStatistics) -> Stage:
    flows = [Flow("shadow rays due", s.shadow.due, tip=terms.MEANINGS[terms.DUE], view=View.COLOR)]
    if s.secondary.rays:
        flows.insert(0, Flow("secondary rays", s.secondary.rays, tip="reflected and refracted", view=View.COST))
    rule = "Each hit is shaded: a shadow ray is due to each light that the surface faces; reflections and refractions "
    rule += "go on."
    return _stage(s, "Shading", rule, ("surfaces", "shading", "filling"), flows=tuple(flows), view=View.COLOR)


def _shadow_testing(frame: Frame, method: Method, by_modes: bool) -> Stage:
    s, bar = frame.statistics, bar_of(frame)
    always = (Fate.CULLED, Fate.DYNAMIC_ONLY, Fate.TRACED) if method.culls or by_modes else (Fate.TRACED,)
    rays = dict.fromkeys(always, 0) | {part.fate: part.rays for part in bar.parts}
    if method.uses_modes:
        rule = "Of a fully rendered primitive, FULL_SHADOW: culled. NON_SHADOW: only dynamic objects are tested. All "
        rule += "other rays are traced."
    elif method.clusters:
        rule = "Clusters of lights are looked at in place of lights; a ray to each is traced."
    elif method.culls:
        rule = "What is known to be in shadow is culled; what is known to be lit tests dynamic objects only. All other "
        rule += "rays test a few candidates, or are traced."
    else:
        rule = "All rays are traced."
    flows = [
        Flow(
            FATE_WOULD[fate] if bar.would and by_modes else FATE_NAMES[fate], number, percent(number, s.shadow.due),
            FATE_COLORS[fate], bar.would and fate.is_saved, FATE_MEANING[fate], View.FATE,
        )
        for fate, number in sorted(rays.items())
    ]  # fmt: skip
    if s.wrong is not None and s.cuts is None:
        tip, wrong = f"{terms.MEANINGS[terms.WRONG]}: {verified.share(s.wrong)}", s.wrong
        name = verified.named("wrong", wrong) if wrong.samples > 1 else terms.WRONG
        flows.append(Flow(name, wrong.answers, percent(wrong.answers, wrong.due), WRONG, False, tip, View.DIFFERENCE))
    due = max(s.shadow.due, 1)
    parts = tuple(
        Part(number / due, FATE_COLORS[fate], bar.would and fate.is_saved) for fate, number in sorted(rays.items())
    )
    return Stage(
        "Shadow testing",
        "§2.4",
        rule,
        WITHIN,
        "",
        0.0,
        tuple(flows),
        parts,
        "shadow rays by what became of them",
        View.FATE,
    )


_GAINED = {
    ShadowMode.FULL_SHADOW: "full shadow",
    ShadowMode.NON_SHADOW: "non-shadow",
    ShadowMode.PARTIAL_SHADOW: "partial shadow",
}


def _shadow_mode_setting(changes: ModeChanges) -> Stage:
    rule = "A blocked ray adds FULL_SHADOW to its primitive and light, an unblocked one NON_SHADOW; both together are "
    rule += "PARTIAL_SHADOW, and always traced."
    gained = {mode: getattr(changes, mode.name.lower()) for mode in _GAINED}
    flows = tuple(
        Flow(f"→ {_GAINED[mode]}", number, "", SHADOW_COLORS[mode], False,
             f"modes gained in this frame, of a primitive and a light each. {mode.name}: {SHADOW_MEANING[mode]}. "
             f"There are {count(changes.shadow_modes[mode.name.lower()])} now.", View.SHADOW)
        for mode, number in gained.items()
    )  # fmt: skip
    known = sum(changes.shadow_modes.values())
    parts = tuple(Part(changes.shadow_modes[m.name.lower()] / max(known, 1), SHADOW_COLORS[m]) for m in _GAINED)
    tip = f"the {count(known)} shadow modes, of a primitive and a light each, that are known now"
    return Stage("Shadow-mode setting", "§2.5", rule, WITHIN, "", 0.0, flows, parts, tip, View.SHADOW)


def _occlusion_mode_setting(s: FrameStatistics, changes: ModeChanges, frame: Frame, units: str, counted: bool) -> Stage:
    factor = f"{frame.settings.zoom_factor:g}"
    rule = "What is seen and was not found occluded is FULLY_RENDERED. What covers more than "
    rule += f"{factor} times the pixels by which that was found is INIT again."
    whole, part, init = OcclusionMode.FULLY_RENDERED, OcclusionMode.PARTIALLY_OCCLUDED, OcclusionMode.INIT
    flows = (
        Flow("→ fully rendered", changes.fully_rendered, "", OCCLUSION_COLORS[whole], False,
             f"{units} that went from INIT to FULLY_RENDERED in this frame", View.OCCLUSION),
        Flow("→ partially occluded", changes.partially_occluded, "", OCCLUSION_COLORS[part], False,
             f"{units} that became PARTIALLY_OCCLUDED, and were not in the last frame", View.OCCLUSION),
        Flow("→ examined anew", changes.examined_anew, "", OCCLUSION_COLORS[init], False,
             f"{units} that went from FULLY_RENDERED to INIT, as they cover more than {factor} times their highest "
             "pixel count: they may show shadows that were too small before", View.PIXEL_COUNT),
    )  # fmt: skip
    modes = (whole, part, init, OcclusionMode.DYNAMIC)
    total = max(sum(changes.units.values()), 1)
    parts = tuple(Part(changes.units[m.name.lower()] / total, OCCLUSION_COLORS[m]) for m in modes)
    now = ", ".join(f"{count(changes.units[m.name.lower()])} {m.name}" for m in modes)
    more = {"flows": flows, "bar": parts, "bar_tip": f"all {units} by their occlusion modes now: {now}"}
    return _stage(s, "Occlusion-mode setting", rule, ("mode setting",), "§2.6", counted, view=View.OCCLUSION, **more)


def _next(s: FrameStatistics, changes: ModeChanges | None, method: Method) -> str:
    if changes is not None:
        units = sum(changes.units.values())
        return (
            f"Next frame: {count(changes.units['fully_rendered'])} of {count(units)} {_units(method)} fully rendered."
        )
    if method.makes:
        return f"Next frame: with all {terms.things(terms.made(str(method))[0])} made so far."
    return "Next frame."
