"""Words over the picture, beside a point of it."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import ImVec2, ImVec4, imgui

from viewer.state.placing import Rect, beside
from viewer.window.widgets import em

_BACK, _FRONT = ImVec4(0.05, 0.06, 0.08, 0.90), ImVec4(0.93, 0.94, 0.96, 1.0)
_GAPS = 1.2, 0.6  # ems from the point: to the right of it or below it, and on its other sides


def write(lines: Sequence[str], at: ImVec2, room: Rect, taken: Rect | None) -> None:
    """Write a few lines, inside the room and not over what is taken, if that can be."""
    pad, line = em(0.4), imgui.get_text_line_height()
    width, height = max(imgui.calc_text_size(text).x for text in lines) + 2.0 * pad, line * len(lines) + 2.0 * pad
    left, top = beside((at.x, at.y), (width, height), (em(_GAPS[0]), em(_GAPS[1])), room, taken)
    draw = imgui.get_window_draw_list()
    back, front = imgui.get_color_u32(_BACK), imgui.get_color_u32(_FRONT)
    draw.add_rect_filled(ImVec2(left, top), ImVec2(left + width, top + height), back, em(0.3))
    for number, text in enumerate(lines):
        draw.add_text(ImVec2(left + pad, top + pad + number * line), front, text)
