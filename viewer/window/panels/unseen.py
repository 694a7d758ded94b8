"""Over the picture: where what is selected lies behind something, as dashed lines."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.frame import Frame
from tracer.scene.edits import Edited
from viewer.state.projection import Stroke, strokes
from viewer.state.whereabouts import lines_of, lines_of_part
from viewer.window.panels import marks
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui

_COLOR = ImVec4(1.0, 1.0, 1.0, 1.0)
_WIDTH = 0.12  # in ems
_BEHIND = 0.75  # opacity of what lies behind something


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Draw on the picture that fills the rectangle from a corner to its end."""
    c = ui.controller
    frame, now, picked, part = c.frame, c.session.edited, c.selection.picked, c.selection.part
    if frame is None or now is None or picked is None:
        return
    at = c.selection.pixel
    if at is not None and (part is not None or frame.primitive[at[1], at[0]] == picked.primitive):
        return
    lines = ui.cached("unseen", frame, (picked.primitive, part), lambda: _strokes(frame, now, picked.primitive, part))
    width, height = end.x - corner.x, end.y - corner.y
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    for stroke in lines:
        alpha = 1.0 if stroke.seen else _BEHIND
        a, b = (ImVec2(corner.x + u * width, corner.y + v * height) for u, v in (stroke.start, stroke.end))
        marks.line(draw, a, b, with_alpha(_COLOR, alpha), _WIDTH, with_alpha(SHADE, alpha))
    draw.pop_clip_rect()


def _strokes(frame: Frame, now: Edited, primitive: int, part: int | None) -> list[Stroke]:
    lines = lines_of(now.scene, primitive, frame.time) if part is None else lines_of_part(now, part, frame.time)
    return [stroke for line in lines for stroke in strokes(frame, line)]
