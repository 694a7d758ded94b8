"""Over a signed difference: rings around the pixels that are furthest apart, with what they say."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.window import comparing
from viewer.window.panels.area import Area
from viewer.window.panels.marks import radius_around_pixel, ring
from viewer.window.ui import Ui


def show(ui: Ui, area: Area, seen: comparing.Seen) -> None:
    """The rings, where marks are wanted."""
    spots = comparing.marked(ui)
    if not spots:
        return
    frame, draw = seen[1].frame, imgui.get_window_draw_list()
    across, down = area.whole_size.x / frame.width, area.whole_size.y / frame.height
    radius = max(0.65, radius_around_pixel(across, down))
    draw.push_clip_rect(area.corner, area.end, True)
    for x, y in spots:
        at = area.to_screen((x + 0.5) / frame.width, (y + 0.5) / frame.height)
        ring(draw, ImVec2(at.x, at.y), radius)
    draw.pop_clip_rect()
