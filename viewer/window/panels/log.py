"""The log: every message there was, newest first, with what lies behind it."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.log import Entry, Level
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, WARNING, em, paragraph, tooltip

_ICONS = {
    Level.NOTICE: icons.ICON_FA_CIRCLE_INFO,
    Level.ERROR: icons.ICON_FA_CIRCLE_EXCLAMATION,
    Level.FAULT: icons.ICON_FA_TRIANGLE_EXCLAMATION,
}
_COLORS = {Level.NOTICE: QUIET, Level.ERROR: WARNING, Level.FAULT: ERROR}


def show(ui: Ui) -> None:
    """The panel."""
    log = ui.controller.notices.log
    log.read()
    entries = [e for e in log.entries() if not (ui.log_errors_only and e.level is Level.NOTICE)]
    _, ui.log_errors_only = imgui.checkbox("errors only", ui.log_errors_only)
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_COPY}  Copy all") and entries:
        imgui.set_clipboard_text("".join(e.as_text for e in entries))
    tooltip("everything that is listed, oldest first")
    imgui.same_line()
    if imgui.button("Clear"):
        log.clear()
    if imgui.begin_child("entries", ImVec2(0.0, 0.0)):
        if not entries:
            imgui.text_colored(QUIET, "nothing went wrong yet" if ui.log_errors_only else "nothing has happened yet")
        for number, entry in reversed(list(enumerate(entries))):
            imgui.push_id(number)
            _entry(entry)
            imgui.pop_id()
    imgui.end_child()


def _entry(entry: Entry) -> None:
    imgui.text_colored(QUIET, f"{entry.at:%H:%M:%S}")
    imgui.same_line(em(4.2))
    imgui.text_colored(_COLORS[entry.level], _ICONS[entry.level])
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
    if imgui.tree_node("details"):
        if imgui.button(f"{icons.ICON_FA_COPY}  Copy details"):
            imgui.set_clipboard_text(entry.as_text)
        imgui.text_unformatted(entry.details.rstrip())
        imgui.tree_pop()
    imgui.unindent(em(5.8))
