"""What is left of the panels in a small window: a strip of icons at its right edge, and the one that is open."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window.panels.catalogue import PANELS, PICTURE, Panel
from viewer.window.ui import Ui
from viewer.window.widgets import clipped, em, tooltip

WIDTH = 2.4
"""Of the strip, in ems."""
_DRAWER, _WIDE = 21.0, 44.0  # width of an open panel in ems; it leaves some of the picture to be seen
_SHARE = 0.86  # of the room beside the strip, which an open panel takes at most
_FLAGS = int(
    imgui.WindowFlags_.no_title_bar
    | imgui.WindowFlags_.no_resize
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_docking
    | imgui.WindowFlags_.no_saved_settings
)


def show(ui: Ui) -> None:
    """The strip, and beside it, over the picture, the panel that was opened by it; only where panels are folded."""
    fold = ui.fold
    if not fold.folded or fold.hidden:
        return
    area = imgui.get_main_viewport()
    status = imgui.get_frame_height() + imgui.get_style().window_padding.y  # what the status bar takes
    bottom = min(area.work_pos.y + area.work_size.y, area.pos.y + area.size.y - status)
    top, right, height = area.work_pos.y, area.work_pos.x + area.work_size.x, bottom - area.work_pos.y
    _strip(ui, ImVec2(right - em(WIDTH), top), height)
    panel = PANELS.get(fold.drawer)
    if panel is None:
        return
    room = area.work_size.x - em(WIDTH)
    width = min(em(_WIDE if panel.wide else _DRAWER), _SHARE * room)
    _drawer(ui, panel, ImVec2(right - em(WIDTH) - width, top), ImVec2(width, height))


def _strip(ui: Ui, at: ImVec2, height: float) -> None:
    imgui.set_next_window_pos(at)
    imgui.set_next_window_size(ImVec2(em(WIDTH), height))
    imgui.push_style_var(imgui.StyleVar_.window_padding, ImVec2(em(0.25), em(0.25)))
    imgui.begin("##strip", None, _FLAGS | int(imgui.WindowFlags_.no_scrollbar))
    imgui.pop_style_var()
    panels = [panel for panel in PANELS.values() if panel.label != PICTURE]
    gap = em(0.15)
    side = min(em(WIDTH - 0.5), imgui.get_content_region_avail().y / len(panels) - gap)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(gap, gap))
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(0.0, 0.0))
    for panel in panels:
        is_open = ui.fold.drawer == panel.label
        slot = imgui.Col_.button_active if is_open else imgui.Col_.window_bg
        imgui.push_style_color(imgui.Col_.button, imgui.get_style_color_vec4(slot))
        if imgui.button(f"{panel.icon}##{panel.label}", ImVec2(em(WIDTH - 0.5), side)):
            ui.fold.drawer = "" if is_open else panel.label
        imgui.pop_style_color()
        tooltip(panel.label)
    imgui.pop_style_var(2)
    imgui.end()


def _drawer(ui: Ui, panel: Panel, at: ImVec2, size: ImVec2) -> None:
    imgui.set_next_window_pos(at)
    imgui.set_next_window_size(size)
    imgui.begin("##drawer", None, _FLAGS)
    side = imgui.get_frame_height()
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(panel.icon)
    imgui.same_line()
    clipped(panel.label)
    imgui.same_line(imgui.get_window_width() - side - em(0.55))
    if imgui.button(icons.ICON_FA_XMARK, ImVec2(side, side)):
        ui.fold.drawer = ""
    tooltip("close (Escape)")
    imgui.separator()
    if imgui.begin_child(f"{panel.label}##in drawer"):
        ui.guard.panel(f"The panel {panel.label}", lambda: panel.show(ui))
    imgui.end_child()
    imgui.end()
