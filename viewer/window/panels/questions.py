"""The question that waits for an answer, over the window."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.window.ui import Ui
from viewer.window.widgets import em, paragraph


def show(ui: Ui) -> None:
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
    for option in question.options:
        changed, _ = imgui.checkbox(option, option in question.ticked)
        if changed:
            question.ticked.symmetric_difference_update({option})
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
