"""The log of every message, and internal errors as the user meets them: a notice over the window, and in the place of a
panel that failed."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.notices import Entry, Level
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, WARNING, clipped, em, paragraph, tooltip

_ICONS = {
    Level.NOTICE: (icons.ICON_FA_CIRCLE_INFO, QUIET),
    Level.ERROR: (icons.ICON_FA_CIRCLE_EXCLAMATION, WARNING),
    Level.FAULT: (icons.ICON_FA_TRIANGLE_EXCLAMATION, ERROR),
}


@dataclass
class LogState:
    """Whether only errors are listed."""

    errors_only: bool = False


def show(ui: Ui) -> None:
    """Draw the panel: every message there was, newest first."""
    state = ui.state(LogState)
    notices = ui.controller.notices
    notices.mark_read()
    entries = [e for e in notices.entries() if not (state.errors_only and e.level is Level.NOTICE)]
    _, state.errors_only = imgui.checkbox("Errors only", state.errors_only)
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy all") and entries:
        imgui.set_clipboard_text("".join(e.as_text for e in entries))
    tooltip("Copy everything that is listed, oldest first.")
    imgui.same_line()
    if imgui.button("Clear"):
        notices.clear()
    if imgui.begin_child("entries", ImVec2(0.0, 0.0)):
        if not entries:
            imgui.text_colored(QUIET, "No errors yet." if state.errors_only else "No messages yet.")
        for number, entry in reversed(list(enumerate(entries))):
            imgui.push_id(number)
            _entry(ui, entry)
            imgui.pop_id()
    imgui.end_child()


def _entry(ui: Ui, entry: Entry) -> None:
    icon, color = _ICONS[entry.level]
    imgui.text_colored(QUIET, f"{entry.at:%H:%M:%S}")
    imgui.same_line(em(4.2))
    imgui.text_colored(color, icon)
    tooltip(entry.level.value)
    imgui.same_line(em(5.8))
    paragraph(entry.text + (f"  ({entry.count} times)" if entry.count > 1 else ""))
    if imgui.begin_popup_context_item("copy"):
        if imgui.menu_item("Copy", "", False)[0]:
            imgui.set_clipboard_text(entry.as_text)
        imgui.end_popup()
    if not entry.details:
        return
    imgui.indent(em(5.8))
    if imgui.tree_node("Details"):
        _copy_button(ui, entry)
        imgui.text_unformatted(entry.details.rstrip())
        imgui.tree_pop()
    imgui.unindent(em(5.8))


def show_fault(ui: Ui) -> None:
    """Draw the newest internal error at the window's lower right, until it is dismissed."""
    notices = ui.controller.notices
    entry = notices.newest_fault
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
        others = f", and {len(notices.faults) - 1} more in the log" if len(notices.faults) > 1 else ""
        icon, color = _ICONS[entry.level]
        imgui.text_colored(color, f"{icon}  Internal error{times}{others}")
        paragraph(entry.text)
        paragraph("Nothing was lost. The details help to fix it.", QUIET)
        _copy_button(ui, entry)
        imgui.same_line()
        if imgui.button("Show log"):
            ui.show_panel("Log")
        imgui.same_line()
        if imgui.button("Dismiss"):
            notices.dismiss_faults()
    imgui.end()


def _copy_button(ui: Ui, entry: Entry) -> None:
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy details"):
        imgui.set_clipboard_text(entry.as_text)
        ui.controller.notices.say("details copied")


def instead_of_part(ui: Ui, name: str, entry: Entry) -> None:
    """Draw what stands where a part of the window has failed: one line in a bar, which has no more room."""
    icon, color = _ICONS[entry.level]
    if name in ("The menus", "The status bar"):
        imgui.text_colored(color, f"{icon}  {name} failed")
        tooltip(entry.text)
        imgui.same_line()
        if imgui.small_button(f"Try again##{name}"):
            ui.guard.again(name)
        return
    imgui.text_colored(color, icon)
    imgui.same_line()
    clipped("This panel cannot be shown")
    paragraph(entry.text, QUIET)
    if imgui.button(f"{icons.ICON_FA_ROTATE_RIGHT}  Try again"):
        ui.guard.again(name)
    imgui.same_line()
    _copy_button(ui, entry)
