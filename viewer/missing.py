"""Views that the method at hand has nothing to show in: why, and which method has."""

from __future__ import annotations

from dataclasses import dataclass

from tracer.frame import Frame
from tracer.method import base_of, culls_by_modes
from viewer.views import View


@dataclass(frozen=True)
class Missing:
    """Why there is nothing to see, in a sentence or two, and what culls in a method that would show something; nothing
    where none helps."""

    text: str
    base: str


def missing(view: View, frame: Frame) -> Missing | None:
    """What to say over a frame in this view; None where there is something to see, or soon will be."""
    method = frame.settings.method
    if view is View.CERTIFICATE and not view.can_draw(frame):
        why = frame.statistics.decision or f"The method {base_of(method)} makes no certificates; certified does."
        return Missing(why, "certified")
    if view.needs_verify and not culls_by_modes(method):
        why = "traces every shadow ray" if base_of(method) == "none" else "is exact"
        text = f"The method {base_of(method)} {why}: no answer can be wrong. The paper's method errs now and then."
        return Missing(text, "paper")
    if view.of_modes and not view.can_draw(frame):
        return Missing(f"This run keeps no modes with the method {method}.", "")
    return None
