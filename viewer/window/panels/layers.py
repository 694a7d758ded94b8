"""Pictures in their place in the window, with crisp pixels where they are to be."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.window.panels.area import Area
from viewer.window.ui import Ui


def draw(ui: Ui, name: str, texture: int, area: Area, right: float = 1.0) -> None:
    """As much of a picture as is to be seen, up to a column, 0 to 1 from the picture's left edge."""
    left, top, end, bottom = area.zoom.shown()
    right = min(right, end)
    if right <= left:
        return
    at = ImVec2(area.corner.x + (right - left) / (end - left) * area.size.x, area.end.y)
    start, stop = ImVec2(left, top), ImVec2(right, bottom)
    crisp = (
        ui.graphics.magnifier.texture_of(name, texture, area.zoom, ui.picture.size)
        if ui.graphics.magnifier is not None
        else None
    )
    if crisp is not None:
        texture, start, stop = crisp, ImVec2(0.0, 0.0), ImVec2((right - left) / (end - left), 1.0)
    imgui.get_window_draw_list().add_image(imgui.ImTextureRef(texture), area.corner, at, start, stop)
