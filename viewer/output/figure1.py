"""The paper's Figure 1 with a frame's own numbers: its stages in their order, and what goes from each to the next.

What is here is the same for the window, which draws it in a panel, and for files (`figure1_drawing`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from tracer.culling.fate import Fate
from tracer.culling.mode_changes import ModeChanges
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.method import Method
from tracer.statistics import FrameStatistics
from viewer.state import palette, terms, verified
from viewer.state.methods import BY_MODES
from viewer.state.palette import Color
from viewer.state.savings import bar_of
from viewer.state.views import View
from viewer.util.numbers import count, percent, whole_percent


@dataclass(frozen=True)
class Flow:
    """What goes from a stage to the next: a name, how many, and which share of what it is a part of, if of anything;
    with a colour where it has one, `hollow` for what only would be.  `tip` says more, `view` shows it."""

    name: str
    number: int
    color: Color | None = None
    tip: str = ""
    view: View | None = None
    share: str = ""
    hollow: bool = False


@dataclass(frozen=True)
class Stage:
    """A box of the figure: its name, its rule in a sentence, what leaves it, the view that shows what it does, and the
    paper's section or "".

    `time` is its time in words, `share` (0 to 1) its part of the frame's time."""

    name: str
    rule: str
    flows: tuple[Flow, ...] = ()
    view: View | None = None
    section: str = ""
    time: str = "in shading"
    share: float = 0.0

    @property
    def heading(self) -> str:
        return f"{self.name} {self.section}".strip()


@dataclass(frozen=True)
class Figure:
    """The figure of a frame: what it is of, its stages, and sentences below them."""

    title: str
    stages: tuple[Stage, ...]
    notes: tuple[str, ...]


def figure_of(frame: Frame, name: str = "") -> Figure:
    """Return the figure of a frame, with a name of what it shows."""
    method, s = Method.parse(frame.settings.method), frame.statistics
    by_modes = (method.uses_modes or not method.culls) and not method.clusters
    changes = s.mode_changes if by_modes else None
    stages = [*_until_shading(s, method, changes), _shadow_testing(frame, method, changes is not None)]
    if changes is not None:
        stages += [_shadow_mode_setting(changes), _occlusion_mode_setting(frame, method, changes)]
    title = f"{method.title}, {frame.width} × {frame.height} pixels, {1e3 * s.seconds:.1f} ms"
    return Figure(", ".join(filter(None, (name, title))), tuple(stages), tuple(_notes(s, method, changes)))


def _timed(s: FrameStatistics, stage: Stage, *phases: str, counted: bool = True) -> Stage:
    """Give a stage the time of some phases of the frame; where that is not `counted`, it is no part of the frame's."""
    seconds = sum(s.phases.get(phase, 0.0) for phase in phases)
    time = f"{1e3 * seconds:.1f} ms"
    if not counted:  # modes are only looked at, and cost the method nothing
        return replace(stage, time=f"({time})", rule=f"{stage.rule} This is done {terms.WHY_FOR_DISPLAY}.")
    share = min(seconds / max(s.seconds, 1e-9), 1.0)
    return replace(stage, time=f"{time}, {percent(seconds, s.seconds)}", share=share)


def _until_shading(s: FrameStatistics, method: Method, changes: ModeChanges | None) -> Iterator[Stage]:
    flows: tuple[Flow, ...] = ()
    rule = "Objects and lights move to where they are now. What is known of a light that moved is forgotten."
    if changes is not None:
        flows = (_modes_of(OcclusionMode.DYNAMIC, f"dynamic {_units(method)}", changes.units["dynamic"]),)
    yield _timed(s, Stage("Place dynamic objects", rule, flows), "place")

    rule = "A ray through each pixel finds the nearest primitive: generation, traversal, intersection."
    tip = "one through the centre of each pixel, to the nearest surface"
    flows = (Flow("primary rays", s.primary.rays, None, tip, View.PRIMITIVE),)
    yield _timed(s, Stage("Primary rays", rule, flows, View.PRIMITIVE), "primary")

    if changes is not None:
        rule = (
            "Where two neighbouring pixels see different primitives, the ray of one is tested against the primitive of "
            "the other: a hit shows that this primitive is partially occluded."
        )
        tip, counted = "rays tested once more, each against one primitive", method.uses_modes
        flows = (Flow("extra tests", s.occlusion_tests, None, tip, View.OCCLUSION),) if counted else ()
        stage = Stage("Occlusion testing", rule, flows, View.OCCLUSION, "§2.3")
        yield _timed(s, stage, "occlusion testing", counted=counted)
    if method.makes:
        made, meaning = terms.made(str(method))
        view = next((_SHOW_WHAT_IS_MADE[one] for one in method.makes if one in _SHOW_WHAT_IS_MADE), None)
        rule = f"In place of modes: {meaning}. They stay from frame to frame."
        tip = f"{count(s.certificate_steps)} traversal steps and {count(s.certificate_tests)} intersection tests"
        name, flows = terms.things(made), (Flow(made, s.certificates, None, tip, view),)
        yield _timed(s, Stage(name[0].upper() + name[1:], rule, flows, view), "certification")

    rule = (
        "Each hit is shaded: a shadow ray is due to each light that the surface faces; reflections and refractions "
        "go on."
    )
    flows = (Flow("shadow rays due", s.shadow.due, None, terms.MEANINGS[terms.DUE], View.COLOR),)
    if s.secondary.rays:
        flows = (Flow("secondary rays", s.secondary.rays, None, "reflected and refracted", View.COST), *flows)
    yield _timed(s, Stage("Shading", rule, flows, View.COLOR), "surfaces", "shading", "filling")


_SHOW_WHAT_IS_MADE = {
    "certificates made": View.CERTIFICATE,
    "voxels classified": View.VOXELS,
    "cells settled": View.CELL_LIGHTS,
}


def _shadow_testing(frame: Frame, method: Method, by_modes: bool) -> Stage:
    s, bar = frame.statistics, bar_of(frame)
    always = (Fate.CULLED, Fate.DYNAMIC_ONLY, Fate.TRACED) if method.culls or by_modes else (Fate.TRACED,)
    rays = dict.fromkeys(always, 0) | {part.fate: part.rays for part in bar}
    if method.uses_modes:
        rule = (
            "Of a fully rendered primitive, FULL_SHADOW: culled. NON_SHADOW: only dynamic objects are tested. All "
            "other rays are traced."
        )
    elif method.clusters:
        rule = "Clusters of lights stand in for their lights; a ray to each cluster is traced."
    elif method.culls:
        rule = (
            "What is known to be in shadow is culled; what is known to be lit tests dynamic objects only. All other "
            "rays test a few candidates, or are traced."
        )
    else:
        rule = "All rays are traced."
    would = any(part.would for part in bar)
    flows = tuple(
        Flow(palette.FATE_WOULD[fate] if would and by_modes else one.name, number, one.color, one.meaning, View.FATE,
             percent(number, s.shadow.due), hollow=would and fate.is_saved)
        for fate, number, one in ((fate, rays[fate], palette.FATES[fate]) for fate in sorted(rays))
    )  # fmt: skip
    if s.wrong is not None and s.cuts is None:
        tip, wrong = f"{terms.MEANINGS[terms.WRONG]}: {verified.share(s.wrong)}", s.wrong
        name = verified.named("wrong", wrong) if wrong.samples > 1 else terms.WRONG
        share = percent(wrong.answers, wrong.due)
        flows = (*flows, Flow(name, wrong.answers, palette.WRONG, tip, View.DIFFERENCE, share))
    return Stage("Shadow testing", rule, flows, View.FATE, "§2.4")


def _shadow_mode_setting(changes: ModeChanges) -> Stage:
    rule = (
        "A blocked ray adds FULL_SHADOW to its primitive and light, an unblocked one NON_SHADOW; both together are "
        "PARTIAL_SHADOW, and always traced."
    )

    def gained(mode: ShadowMode, number: int) -> Flow:
        one, now = palette.SHADOW[mode], count(changes.shadow_modes[mode.name.lower()])
        tip = f"{one.meaning}: modes gained in this frame, of a primitive and a light each; there are {now} now"
        return Flow(f"→ {one.name}", number, one.color, tip, View.SHADOW)

    flows = (
        gained(ShadowMode.FULL_SHADOW, changes.full_shadow),
        gained(ShadowMode.NON_SHADOW, changes.non_shadow),
        gained(ShadowMode.PARTIAL_SHADOW, changes.partial_shadow),
    )
    return Stage("Shadow-mode setting", rule, flows, View.SHADOW, "§2.5")


def _occlusion_mode_setting(frame: Frame, method: Method, changes: ModeChanges) -> Stage:
    factor, units = f"{frame.settings.zoom_factor:g}", _units(method)
    rule = (
        "What is seen and was not found occluded is FULLY_RENDERED. What covers more than "
        f"{factor} times the pixels by which that was found is INIT again."
    )
    flows = (
        _modes_of(OcclusionMode.FULLY_RENDERED, "→ fully rendered", changes.fully_rendered,
                  f"{units} that went from INIT to FULLY_RENDERED in this frame"),
        _modes_of(OcclusionMode.PARTIALLY_OCCLUDED, "→ partially occluded", changes.partially_occluded,
                  f"{units} that became PARTIALLY_OCCLUDED, and were not in the last frame"),
        _modes_of(OcclusionMode.INIT, "→ examined anew", changes.examined_anew,
                  f"{units} that went from FULLY_RENDERED to INIT, as they cover more than {factor} times the pixels "
                  "of their last examination: they may show shadows that were too small before", View.PIXEL_COUNT),
    )  # fmt: skip
    stage = Stage("Occlusion-mode setting", rule, flows, View.OCCLUSION, "§2.6")
    return _timed(frame.statistics, stage, "mode setting", counted=method.uses_modes)


def _modes_of(mode: OcclusionMode, name: str, number: int, tip: str = "", view: View = View.OCCLUSION) -> Flow:
    return Flow(name, number, palette.OCCLUSION[mode].color, tip or palette.OCCLUSION[mode].meaning, view)


def _notes(s: FrameStatistics, method: Method, changes: ModeChanges | None) -> Iterator[str]:
    """Say what the next frame begins with, and more; shortly, as the window has one line for it."""
    if changes is not None:
        whole, units = changes.units["fully_rendered"], sum(changes.units.values())
        yield f"Next frame: {count(whole)} of {count(units)} {_units(method)} fully rendered."
    elif method.makes:
        yield f"Next frame: with all {terms.things(terms.made(str(method))[0])} made so far."
    if s.part < 1.0:
        yield f"{whole_percent(s.part)} of pixels shaded so far."
    if changes is not None and not method.culls:
        brackets = f"; in brackets: {terms.FOR_DISPLAY}" if s.part == 1.0 else ""  # for which there is room
        yield f"Outlined: what {BY_MODES} would do{brackets}."
    if s.decision:
        yield s.decision


def _units(method: Method) -> str:
    return "cells" if method.uses_cells else "primitives"
