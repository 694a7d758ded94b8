"""Methods as the viewer chooses among them, and what is said where one has nothing to show; what each can do is
`tracer.method`'s to say."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from tracer.frame import Frame
from tracer.method import DEFAULT_METHOD, Kind, Method, additions, bases, title_of
from tracer.methods.method_limits import lamps_in, remark, too_few
from tracer.scene.lights import Light
from tracer.settings import Settings
from viewer.state.views import MOST_RECORDED, Record, View, can_draw, can_record_lights
from viewer.util.numbers import count

NO_CULLING, BY_MODES, CERTIFIED, ADAPTIVE = "none", "paper", "certified", "auto"
"""What is chosen to see every ray traced, the paper's modes at work, certificates, and whatever is quickest."""

SHOWN_BY = {View.CERTIFICATE: CERTIFIED, View.CUTS: "lightcuts", View.VOXELS: "voxels", View.CELL_LIGHTS: "lie-exact",
            View.SLACK: CERTIFIED, View.REGRET: CERTIFIED}  # fmt: skip
"""Views of what single methods have, and one that has it."""


def default_for(view: View) -> str:
    """Return the method for one picture in a view: the default one, or else one that has something to show there."""
    return SHOWN_BY.get(view, DEFAULT_METHOD)


def groups() -> list[tuple[str, list[Kind]]]:
    """Return the methods to choose from, those that are never wrong first."""
    exact, other = ([kind for kind in bases() if kind.exact is never] for never in (True, False))
    return [("Exact: the same picture as without culling", exact), ("With errors", other)]


def about(*kinds: Kind) -> str:
    """Return what a method of these kinds does, and what commands and files call it."""
    name = "+".join(kind.name for kind in kinds)
    return "\n".join([*(kind.summary for kind in kinds), f"On the command line: {name}"])


def with_base(method: str, base: str) -> str:
    """Return the method with another base and the same additions, but what is the base now."""
    return _named(base, Method.parse(method).additions)


def with_additions(method: str, more: Iterable[str]) -> str:
    """Return the method with these additions besides its own."""
    parsed = Method.parse(method)
    return _named(parsed.base, {*parsed.additions, *more})


def toggled(method: str, addition: str) -> str:
    """Return the method with an addition that it lacks, or without one that it has."""
    parsed = Method.parse(method)
    return _named(parsed.base, set(parsed.additions) ^ {addition})


def _named(base: str, chosen: Iterable[str]) -> str:
    """Return the name of a method with these additions, in their usual order."""
    wanted = set(chosen)
    return "+".join([base, *(kind.name for kind in additions(base, measures=True) if kind.name in wanted)])


def remark_on(lights: tuple[Light, ...], settings: Settings) -> str:
    """Return what the method leaves to tracing in a scene with these lights, in a sentence; nothing where it leaves
    none."""
    method = Method.parse(settings.method)
    lamps, samples = lamps_in(lights, settings.lamp_radius, settings.lamp_samples)
    few = too_few(method, len(lights), samples)
    return f"{few}." if few else remark(method, len(lights), lamps)


def can_ask(frame: Frame, view: View) -> bool:
    """Return whether the renderer can be asked for what a view shows: of a whole frame with certificates of cells."""
    by_cells = Method.parse(frame.settings.method).base in (CERTIFIED, ADAPTIVE) and frame.certificates is not None
    recorded = view.records is None or frame.fates is not None
    return view.asks is not None and frame.statistics.part >= 1.0 and by_cells and recorded


# --- where there is nothing to see -------------------------------------------------------------------


@dataclass(frozen=True)
class Missing:
    """Why there is nothing to see, in a sentence or two, and which base of methods would show something; none where
    none does."""

    text: str
    base: str = ""


def missing(view: View, frame: Frame, more: bool = False) -> Missing | None:
    """Return what to say over a frame in this view; None where there is something to see, or soon will be.  `more` says
    that frames follow."""
    method, decision, drawn = Method.parse(frame.settings.method), frame.statistics.decision, can_draw(frame, view)
    if frame.lights == 0 and (view.of_light or view in SHOWN_BY or view.records is Record.LIGHTS):
        return Missing("The scene has no lights.")
    if view in SHOWN_BY and not drawn and not (view.asks is not None and method.base == CERTIFIED):
        if view is View.CERTIFICATE and decision and method.has_certificates and not method.clusters:
            comes = method.adaptive and frame.statistics.certificates > 0 and more
            return Missing(f"{decision}{' More are made and tried while nothing moves.' if comes else ''}", CERTIFIED)
        if view is View.CUTS and decision and method.clusters:
            return Missing(decision)
        shown_by = SHOWN_BY[view]
        return Missing(f"{method.title} has nothing for the view {view.label}; {title_of(shown_by)} has.", shown_by)
    if view.records is Record.VERIFY and method.exact and not method.uses_modes:
        why = f"{method.kind.title} is exact" if method.kind.culls else "Every shadow ray is traced"
        return Missing(f"{why}: no answer can be wrong. The paper's method is sometimes wrong.", BY_MODES)
    if view.records is Record.FATES and method.clusters:
        return Missing(f"{method.kind.title} shades by clusters of lights: single lights have no rays.", BY_MODES)
    all_lights = view is View.LIGHTS or view.records is Record.FATES
    if all_lights and not can_record_lights(frame.primitive.size, frame.lights):
        text = f"There is no memory to look at {count(frame.lights)} lights at each pixel of a picture of this size"
        most = count(MOST_RECORDED // frame.lights)
        return Missing(f"{text}, but at up to {most} pixels: give it a smaller size in the panel Rendering.")
    if view.of_modes and not drawn:
        return Missing(f"This run keeps no modes with {method.title}.")
    return None
