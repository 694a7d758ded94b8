"""What comes up over the window: opening a file, questions, shortcuts, about."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.window.command import HELD_KEYS, MENUS, key_label
from viewer.window.panels import browser, questions, save_as
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, centred, em, paragraph


def show(ui: Ui) -> None:
    """All of them; each shows itself only when it is wanted."""
    ui.guard.overlay(browser.NAME, lambda: browser.show(ui), lambda: setattr(ui.browser, "open", False))
    ui.guard.overlay(save_as.NAME, lambda: save_as.show(ui), lambda: setattr(ui, "save_as_open", False))
    ui.guard.overlay("The question", lambda: questions.show(ui), ui.controller.questions.drop)
    ui.guard.overlay("The list of keys", lambda: _shortcuts(ui), lambda: setattr(ui, "shortcuts_open", False))
    ui.guard.overlay("The dialog about the program", lambda: _about(ui), lambda: setattr(ui, "about_open", False))


def _shortcuts(ui: Ui) -> None:
    if not ui.shortcuts_open:
        return
    centred(em(46.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin("Keyboard and mouse", True, int(flags))
    ui.shortcuts_open = bool(open_)
    if shown:
        if imgui.begin_table("keys", 2, int(imgui.TableFlags_.sizing_stretch_same)):
            imgui.table_next_column()
            for menu in MENUS[:2]:
                _keys(menu, [(key_label(c.key), c.name) for c in ui.commands if c.menu == menu and c.key])
            imgui.table_next_column()
            for menu in MENUS[2:]:
                _keys(menu, [(key_label(c.key), c.name) for c in ui.commands if c.menu == menu and c.key])
            imgui.end_table()
        _keys("On the picture", list(HELD_KEYS), wide=True)
    imgui.end()


def _keys(title: str, lines: list[tuple[str, str]], wide: bool = False) -> None:
    imgui.separator_text(title)
    if not imgui.begin_table(f"keys of {title}", 2):
        return
    imgui.table_setup_column("key", int(imgui.TableColumnFlags_.width_fixed), em(8.5 if wide else 5.5))
    imgui.table_setup_column("meaning", int(imgui.TableColumnFlags_.width_stretch))
    for key, meaning in lines:
        imgui.table_next_column()
        imgui.text_unformatted(key)
        imgui.table_next_column()
        paragraph(meaning, QUIET)
    imgui.end_table()


def _about(ui: Ui) -> None:
    if not ui.about_open:
        return
    centred(em(30.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin("About Shadowcull", True, int(flags))
    ui.about_open = bool(open_)
    if shown:
        paragraph("A ray tracer that remembers its shadows.")
        imgui.spacing()
        paragraph(
            "Shadow results are kept on each primitive and reused in later frames, so that most shadow rays need not "
            "be traced: Nah, Lee, Park and Han, A Shadow Culling Algorithm for Interactive Ray Tracing.",
            QUIET,
        )
        imgui.spacing()
        paragraph(f"Drawn by {ui.renderer_name}" if ui.renderer_name else "", QUIET)
    imgui.end()
