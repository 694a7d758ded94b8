"""Views that the method at hand has nothing to show in: why, and which method has."""

from __future__ import annotations

from dataclasses import dataclass

from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8, LAZY
from tracer.geometry.world import LARGE
from tracer.method import Method
from viewer.state.methods import BY_MODES, CERTIFIED, SHOWN_BY
from viewer.state.readings import MOST_RECORDED, TREE, TREE_IS_GONE, can_draw, can_record_lights
from viewer.state.views import View
from viewer.util.numbers import count

CLUSTERED = SHOWN_BY[View.CUTS]
"""The method that shades by clusters of lights."""

_MADE_BY = {
    View.VOXELS: "Voxels are made by the method voxels",
    View.CELL_LIGHTS: "Cells that know their lights are made by the methods lie-exact and lie",
}


_LAZY = (
    f"{LAZY} builds it where they arrive, and so does {BVH8} with more than {count(LARGE)} primitives that never move."
)


@dataclass(frozen=True)
class Missing:
    """Why there is nothing to see, in a sentence or two, and what culls in a method, or which structure, would show
    something; nothing where none helps."""

    text: str
    base: str
    accelerator: str = ""


def missing(view: View, frame: Frame, shares: bool = False, more: bool = False) -> Missing | None:
    """What to say over a frame in this view, maps of work as `shares` or as counts; None where there is something to
    see, or soon will be.  `more` says that frames follow."""
    method, decision = Method.parse(frame.settings.method), frame.statistics.decision
    if view is View.CERTIFICATE and not can_draw(frame, view):
        if decision and method.adaptive and frame.statistics.certificates and more:
            decision += " More are made and tried while nothing moves."
        why = "" if method.clusters or not method.has_certificates else decision
        return Missing(why or f"The method {method.base} makes no certificates; {CERTIFIED} does.", CERTIFIED)
    if view is View.CUTS and not can_draw(frame, view):
        why = decision if method.clusters else f"The method {method.base} clusters no lights; {CLUSTERED} does."
        return Missing(why, "" if method.clusters else CLUSTERED)
    if view in _MADE_BY and not can_draw(frame, view):
        return Missing(f"{_MADE_BY[view]}, not by {method}.", SHOWN_BY[view])
    if view is View.TREE and TREE in frame.structures and not can_draw(frame, view):
        return Missing(f"There is nothing to see: {TREE_IS_GONE}.", "")
    if view is View.TREE and not can_draw(frame, view):
        return Missing(f"All of the tree was built before rays came ({frame.settings.accelerator}). {_LAZY}", "", LAZY)
    if view is View.SAVED or (view is View.COST and shares):
        return _nothing_saved(view, frame)
    if view.needs_verify and method.exact and not method.uses_modes:
        why = "is exact" if method.kind.culls else "traces every shadow ray"
        text = f"The method {method.base} {why}: no answer can be wrong. The paper's method is sometimes wrong."
        return Missing(text, BY_MODES)
    if view is View.LIGHTS and not can_record_lights(frame.primitive.size, frame.lights):
        return _no_memory(frame)
    if view.needs_fates and method.clusters:
        return Missing(f"The method {method.base} shades by clusters of lights: single lights have no rays.", BY_MODES)
    if view.needs_fates and not can_record_lights(frame.primitive.size, frame.lights):
        return _no_memory(frame)
    if view.of_modes and not can_draw(frame, view):
        return Missing(f"This run keeps no modes with the method {method}.", "")
    return None


def _no_memory(frame: Frame) -> Missing:
    most = count(MOST_RECORDED // frame.lights)
    text = f"There is no memory to look at {count(frame.lights)} lights at each pixel of a picture of this size"
    return Missing(f"{text}, but at up to {most} pixels: give it a smaller size in the panel Rendering.", "")


def _nothing_saved(view: View, frame: Frame) -> Missing | None:
    """For a map of what culling saves, which is of one colour where it saves nothing."""
    if frame.saved is None or frame.saved.any() or (frame.due_rays is not None and not frame.due_rays.any()):
        return None
    method = Method.parse(frame.settings.method)
    why = frame.statistics.decision or (
        f"The method {method.base} has culled nothing here."
        if method.kind.culls
        else f"The method {method.base} traces every shadow ray."
    )
    shown = "no ray is untraced at any pixel" if view is View.SAVED else "100 % of the rays are traced at every pixel"
    helps = method.adaptive or not method.has_certificates
    return Missing(f"{why} So {shown}.", CERTIFIED if helps else "")
