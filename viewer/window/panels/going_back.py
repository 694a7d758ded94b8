"""From a plot over frames back to one of them: a line and a word where the pointer is, a click, and a menu."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui, implot

from viewer.window.palette import GREY
from viewer.window.ui import Ui


def pointed(first: int, last: int) -> int | None:
    """The number of the frame that the pointer is on, of those of the plot that is being drawn, with a line there."""
    if last < first or not implot.is_plot_hovered():
        return None
    number = min(max(round(implot.get_plot_mouse_pos().x), first), last)
    implot.plot_inf_lines("##pointed", np.array([float(number)]), implot.Spec(line_color=GREY, line_weight=1.0))
    return number


def handle(ui: Ui, plot: str, number: int | None, values: list[str]) -> None:
    """After the plot of a name: say which frame it is, and go there where that is clicked."""
    c = ui.controller
    imgui.push_id(plot)
    if number is not None:
        if imgui.is_mouse_clicked(imgui.MouseButton_.left):
            c.travel.go(number)
        elif imgui.is_mouse_clicked(imgui.MouseButton_.right):
            ui.plot_frame = number
            imgui.open_popup("frame of the plot")
        elif not imgui.is_popup_open("frame of the plot"):
            _tip(ui, number, values)
    if imgui.begin_popup("frame of the plot"):
        chosen = ui.plot_frame
        if imgui.menu_item(f"Go to frame {chosen}", "", False, True)[0]:
            c.travel.go(chosen)
        if imgui.menu_item(f"Go to frame {chosen} with its modes", "", False, True)[0]:
            c.travel.go(chosen, modes=True)
        imgui.end_popup()
    imgui.pop_id()


def _tip(ui: Ui, number: int, values: list[str]) -> None:
    moment = ui.controller.record.moments.get(number)
    if not imgui.begin_tooltip():
        return
    imgui.text_unformatted(f"frame {number}")
    if moment is not None:
        session = ui.controller.session
        of_path = f"frame {session.frame_at(moment.time)} of the path, " if session.animated else ""
        width, height = moment.settings.width, moment.settings.height
        imgui.text_unformatted(f"{of_path}{moment.time:.3f} s, {moment.settings.method}, {width} x {height}")
    imgui.text_unformatted("\n".join(values))
    imgui.text_unformatted("click: go there; right button: more" if moment is not None else "no longer kept")
    imgui.end_tooltip()
