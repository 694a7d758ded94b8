"""The status bar: one line of what happened, and how fast it goes."""

from __future__ import annotations

from imgui_bundle import hello_imgui, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.panels.widgets import ERROR, QUIET, clipped, count, em
from viewer.ui import Ui


def show(ui: Ui) -> None:
    """The bar."""
    c = ui.controller
    message = c.current_message
    right = _summary(ui)
    width = imgui.calc_text_size(right).x + em(1.0)
    room = imgui.get_content_region_avail().x
    left = imgui.get_cursor_pos_x()
    if imgui.begin_child("message", (max(em(4.0), room - width), imgui.get_text_line_height() + 2.0)):
        if message is not None:
            icon = icons.ICON_FA_CIRCLE_EXCLAMATION if message.error else icons.ICON_FA_CIRCLE_INFO
            clipped(f"{icon}  {message.text}", ERROR if message.error else None)
            if message.error and imgui.is_item_clicked():
                c.message = None
        elif c.runner.current is not None:
            imgui.text_colored(QUIET, f"{c.runner.current.name}, traced: {c.runner.current.label} ...  Escape stops it")
        elif c.render.busy:
            imgui.text_colored(QUIET, "tracing ...")
        else:
            imgui.text_colored(QUIET, "F1: keyboard and mouse")
    imgui.end_child()
    imgui.same_line(left + max(0.0, room - width + em(0.5)))
    imgui.text_colored(QUIET, right)


def _summary(ui: Ui) -> str:
    frame = ui.controller.frame
    drawn = f"window at {hello_imgui.frame_rate():.0f} fps"
    if frame is None:
        return drawn
    wrong = f"{count(frame.statistics.shadow.wrong)} wrong   " if frame.settings.verify else ""
    return f"{wrong}{frame.width} x {frame.height}   {1e3 * frame.statistics.seconds:.0f} ms traced   {drawn}"
