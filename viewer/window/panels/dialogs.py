"""What comes up over the window: opening a file, questions, shortcuts, about."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.window.panels import browser, command_palette, keys, presets, questions, save_as
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import QUIET, centred, em, paragraph


def show(ui: Ui) -> None:
    """All of them; each shows itself only when it is wanted."""
    ui.guard.overlay(browser.NAME, lambda: browser.show(ui), lambda: setattr(ui.browser, "open", False))
    ui.guard.overlay(save_as.NAME, lambda: save_as.show(ui), lambda: ui.close(Dialog.SAVE_AS))
    ui.guard.overlay("The question", lambda: questions.show(ui), ui.controller.questions.drop)
    ui.guard.overlay("The command palette", lambda: command_palette.show(ui), command_palette.close)
    ui.guard.overlay("The list of keys", lambda: keys.show(ui), lambda: ui.close(Dialog.KEYS))
    ui.guard.overlay("The presets", lambda: presets.show(ui), lambda: ui.close(Dialog.PRESETS))
    ui.guard.overlay("The dialog about the program", lambda: _about(ui), lambda: ui.close(Dialog.ABOUT))


def _about(ui: Ui) -> None:
    if Dialog.ABOUT not in ui.dialogs:
        return
    centred(em(30.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    shown, open_ = imgui.begin("About Shadowcull", True, int(flags))
    if not open_:
        ui.close(Dialog.ABOUT)
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
