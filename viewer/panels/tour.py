"""The tour's window: small, at the picture's corner, or beside the progress of the first start."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.panels.widgets import GOOD, QUIET, em, paragraph, tooltip
from viewer.tour import STEPS
from viewer.ui import Ui

_WIDTH = 21.0  # ems
_HIGH = 48.0  # ems of a window that has room for the text of all steps


def show(ui: Ui) -> None:
    """The step that is next, and what to do; all steps while there is no picture yet."""
    tour = ui.tour
    tour.follow()
    step = tour.step
    if step is None or tour.at is None:
        return
    waiting = ui.controller.frame is None
    _place(ui, waiting)
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.no_focus_on_appearing
    title = f"Tour, step {tour.at + 1} of {len(STEPS)}###tour"
    shown, stays = imgui.begin(title, True, int(flags))
    if shown:
        for number, one in enumerate(STEPS):
            if number == tour.at or waiting:
                paragraph(f"{number + 1}  {one.title}", QUIET if number != tour.at else None)
            if number == tour.at or (waiting and imgui.get_main_viewport().work_size.y > em(_HIGH)):
                paragraph(one.text(ui.controller), QUIET)
        _buttons(ui, waiting)
    imgui.end()
    if not stays:
        tour.end()


def _place(ui: Ui, waiting: bool) -> None:
    """Under the progress of the first start, else in the lower right corner of the picture, or where it was moved from
    there; never outside the window."""
    area = imgui.get_main_viewport()
    width = min(em(1.3 * _WIDTH if waiting else _WIDTH), 0.9 * area.work_size.x)
    picture, own = (imgui.internal.find_window_by_name(name) for name in ("Picture", "###tour"))
    if own is not None and ui.tour_at is not None:  # what the user has dragged it by since
        (x, y), (set_x, set_y) = ui.tour_moved, ui.tour_at
        ui.tour_moved = (x + own.pos.x - set_x, y + own.pos.y - set_y)
    if waiting or picture is None:
        centre = area.get_work_center()
        corner, height = ImVec2(centre.x - 0.5 * width, centre.y + em(0.5)), 0.0
    else:
        width = min(width, 0.7 * picture.size.x)
        height = own.size.y if own is not None else 0.0
        right, bottom = picture.pos.x + picture.size.x - em(1.0), picture.pos.y + picture.size.y - em(3.0)
        corner = ImVec2(right - width, bottom - height)
    x = min(max(corner.x + ui.tour_moved[0], area.work_pos.x), area.work_pos.x + area.work_size.x - width)
    lowest = area.work_pos.y + area.work_size.y - max(height, em(4.0))
    y = min(max(corner.y + ui.tour_moved[1], area.work_pos.y), lowest)
    ui.tour_at = (float(int(x)), float(int(y)))
    imgui.set_next_window_pos(ImVec2(*ui.tour_at))
    imgui.set_next_window_size(ImVec2(width, 0.0))


def _buttons(ui: Ui, waiting: bool) -> None:
    tour = ui.tour
    if waiting:
        paragraph("You can begin as soon as there is a picture.", QUIET)
        return
    imgui.begin_disabled(tour.showing)
    if imgui.button(f"{icons.ICON_FA_PLAY}  Show me"):
        tour.show()
    imgui.end_disabled()
    tooltip("do this step for you")
    imgui.same_line()
    last = tour.at == len(STEPS) - 1
    if imgui.button("Finish" if last else "Skip"):
        tour.skip()
    tooltip("end the tour; the menu Help has it again" if last else "go on to the next step")
    if tour.done:
        imgui.same_line()
        imgui.text_colored(GOOD, icons.ICON_FA_CHECK * len(tour.done))
