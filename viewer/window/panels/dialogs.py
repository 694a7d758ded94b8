"""What comes up over the window: opening a file, questions, shortcuts, about."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.window.panels import command_palette, keys, named_states, open_file, saving
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import QUIET, centred, em, paragraph


def show(ui: Ui) -> None:
    """All of them; each shows itself only when it is wanted."""
    ui.guard.overlay(open_file.TITLE, lambda: open_file.show(ui), lambda: ui.close(Dialog.OPEN_FILE))
    ui.guard.overlay(saving.NAME, lambda: saving.show_dialog(ui), lambda: ui.close(Dialog.SAVE_AS))
    ui.guard.overlay("The question", lambda: _question(ui), ui.controller.questions.drop)
    ui.guard.overlay("The command palette", lambda: command_palette.show(ui), command_palette.close)
    ui.guard.overlay("The list of keys", lambda: keys.show(ui), lambda: ui.close(Dialog.KEYS))
    ui.guard.overlay("The presets", lambda: named_states.show_presets(ui), lambda: ui.close(Dialog.PRESETS))
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
        paragraph(f"Drawn by {ui.graphics.renderer_name}" if ui.graphics.renderer_name else "", QUIET)
    imgui.end()


def _question(ui: Ui) -> None:
    """A dialog with a button for each answer; Escape chooses the first, which changes nothing."""
    asking = ui.controller.questions
    question = asking.question
    if question is None:
        return
    name = f"{question.title}###question"
    if not imgui.is_popup_open(name):
        imgui.open_popup(name)
    viewport = imgui.get_main_viewport()
    imgui.set_next_window_pos(viewport.get_work_center(), int(imgui.Cond_.appearing), ImVec2(0.5, 0.5))
    imgui.set_next_window_size(ImVec2(min(em(30.0), 0.95 * viewport.work_size.x), 0.0))
    flags = imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_saved_settings
    shown, stays = imgui.begin_popup_modal(name, True, int(flags))
    if not shown:
        return
    paragraph(question.text)
    imgui.spacing()
    chosen = question.answers[0][0] if not stays or imgui.is_key_pressed(imgui.Key.escape) else ""
    for number, (answer, _) in enumerate(question.answers):
        if number:
            imgui.same_line()
        if imgui.button(answer):
            chosen = answer
    if chosen:
        imgui.close_current_popup()
        ui.guard.step(f"The answer {chosen}", lambda: asking.answer(chosen))
    imgui.end_popup()
