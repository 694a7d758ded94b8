"""A mistake of the program as the user meets it: a notice over the window, and in the place of a panel that failed."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.log import Entry
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, em, paragraph, tooltip


def notice(ui: Ui) -> None:
    """The newest fault, at the window's lower right, until it is dismissed."""
    faults = ui.controller.notices.faults
    entry = faults.notice
    if entry is None:
        return
    viewport = imgui.get_main_viewport()
    corner = ImVec2(viewport.work_pos.x + viewport.work_size.x, viewport.work_pos.y + viewport.work_size.y)
    at = ImVec2(corner.x - em(1.0), corner.y - em(3.0))
    imgui.set_next_window_pos(at, int(imgui.Cond_.always), ImVec2(1.0, 1.0))
    imgui.set_next_window_size(ImVec2(min(em(30.0), 0.9 * viewport.work_size.x), 0.0))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_move
    if imgui.begin("##fault", None, int(flags)):
        times = f" ({entry.count} times)" if entry.count > 1 else ""
        others = f", and {faults.others} more in the log" if faults.others else ""
        imgui.text_colored(ERROR, f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  A mistake of the program{times}{others}")
        paragraph(entry.text)
        paragraph("Nothing is lost, and the rest of the window works on. The details help to mend it.", QUIET)
        copy_button(ui, entry)
        imgui.same_line()
        if imgui.button("Show log"):
            ui.show_panel("Log")
        imgui.same_line()
        if imgui.button("Dismiss"):
            faults.dismiss()
    imgui.end()


def copy_button(ui: Ui, entry: Entry) -> None:
    """Puts all that is known on the clipboard."""
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy details"):
        imgui.set_clipboard_text(entry.as_text)
        ui.controller.notices.say("details copied")


def instead(ui: Ui, name: str, entry: Entry) -> None:
    """Stands where a part of the window has failed: in one line where that is all the room, as in a bar."""
    if name in ("The menus", "The status bar"):
        imgui.text_colored(ERROR, f"{icons.ICON_FA_TRIANGLE_EXCLAMATION}  {name} failed")
        tooltip(entry.text)
        imgui.same_line()
        if imgui.small_button(f"Try again##{name}"):
            ui.guard.again(name)
        return
    imgui.text_colored(ERROR, icons.ICON_FA_TRIANGLE_EXCLAMATION)
    imgui.same_line()
    clipped("This panel cannot be shown")
    paragraph(entry.text, QUIET)
    if imgui.button(f"{icons.ICON_FA_ROTATE_RIGHT}  Try again"):
        ui.guard.again(name)
    imgui.same_line()
    copy_button(ui, entry)
