"""What Escape closes before it stops anything: the newest of what lies over the panels."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.window.ui import Ui

ANY_POPUP = int(imgui.PopupFlags_.any_popup_id) | int(imgui.PopupFlags_.any_popup_level)


def close_newest(ui: Ui) -> bool:
    """Close one menu, list, dialog or folded panel; returns whether there was one.

    A dialog that has the keyboard to itself closes itself."""
    if imgui.is_popup_open("", ANY_POPUP):
        _close_list()
    elif ui.tour.step is not None and ui.controller.frame is None:  # a window until there is a picture
        ui.tour.end()
    elif ui.dialogs:
        ui.dialogs.pop()
    elif ui.fold.drawer:
        ui.fold.drawer = ""
    elif ui.screening is not None:
        ui.screening = None
    elif ui.controller.notices.newest_fault is not None:
        ui.controller.notices.dismiss_faults()
    else:
        return False
    return True


def _close_list() -> None:
    """Close the menu or list that was opened last; ImGui does so itself only where it steers the keyboard."""
    opened = imgui.get_current_context().open_popup_stack
    newest = opened[len(opened) - 1].window
    if newest is not None and not newest.flags & int(imgui.WindowFlags_.modal):
        imgui.internal.close_popup_to_level(len(opened) - 1, True)
