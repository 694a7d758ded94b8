"""The filmstrip of a zoom test: a row of small pictures for each zoom factor; one is shown in the picture's place."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments.zoom import Approach, Step
from viewer.output.filmstrip import Shot
from viewer.output.reports import changes_in_words
from viewer.services.runs import FramePreview, RecordedZoomTest, approaches_of
from viewer.window.style import MARK
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, count, em, paragraph, tooltip

_CHOSEN = ImVec4(0.42, 0.70, 0.96, 1.0)


def show_step(ui: Ui, test: RecordedZoomTest, factor: float, number: int) -> None:
    """Show the recorded picture of a step, or of the nearest that is kept."""
    shot = test.filmstrip.nearest(factor, number)
    if shot is None:
        ui.controller.notices.say("no picture of this step was kept")
    else:
        ui.frame_preview = FramePreview(test, shot, _live(ui))


def _live(ui: Ui) -> object:
    """What the user does with the traced picture: once that is something else, it is what they want to see."""
    s = ui.controller.session
    return s.scene, s.camera, s.time, s.draw.view, s.draw.light, s.playing


def strip(ui: Ui, test: RecordedZoomTest, approach: Approach, name: str, size: ImVec2) -> None:
    """The pictures towards the primitive with one factor, side by side; a click shows one large."""
    shots, steps = test.filmstrip.of(approach.factor), {step.number: step for step in approach.steps}
    bar = imgui.get_style().scrollbar_size
    if imgui.begin_child(name, size, 0, int(imgui.WindowFlags_.horizontal_scrollbar)):
        height = max(em(1.5), size.y - bar - em(0.25))
        for shot in shots:
            if shot.number in steps:
                _thumbnail(ui, test, shot, steps[shot.number], height)
                imgui.same_line(0.0, em(0.15))
        if ui.controller.runs.current is test and approach is approaches_of(test)[-1]:
            imgui.set_scroll_x(imgui.get_scroll_max_x())
    imgui.end_child()


def _thumbnail(ui: Ui, test: RecordedZoomTest, shot: Shot, step: Step, height: float) -> None:
    size = ImVec2(height * shot.width / shot.height, height)
    if imgui.invisible_button(f"{shot.factor:g} step {shot.number}##shot", size):
        show_step(ui, test, shot.factor, shot.number)
    if not imgui.is_item_visible() or ui.graphics.textures is None:
        return
    start, end = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    draw, texture = imgui.get_window_draw_list(), ui.graphics.textures.texture_id(shot, small=True)
    if texture is not None:
        draw.add_image(imgui.ImTextureRef(texture), start, end)
    chosen = ui.frame_preview is not None and ui.frame_preview.shot is shot
    color = _CHOSEN if chosen else ERROR if step.wrong_of_primitive else MARK if step.changes else None
    if color is not None:
        draw.add_rect(start, end, imgui.get_color_u32(color), 0.0, em(0.15 if chosen else 0.1))
    tooltip("\n".join([*in_words(step), "click to see it large"]))


def in_words(step: Step) -> list[str]:
    """A step in numbers and words."""
    highest = f"highest count {count(step.highest)}" if step.highest else "not yet fully rendered"
    return [
        f"step {step.number}: {count(step.pixels)} pixels, {highest}",
        f"{count(step.wrong_of_primitive)} of them wrong, {count(step.wrong)} in the picture",
        *changes_in_words(step.changes),
    ]


def screen(ui: Ui, room: ImVec2) -> bool:
    """The recorded picture that was asked for, in the picture's room; returns whether there is one.

    It goes as soon as anything else is done with the traced picture."""
    shown = ui.frame_preview
    c = ui.controller
    if shown is None or ui.graphics.textures is None:
        return False
    if shown.test is not c.runs.zoom_test or shown.beside != _live(ui):
        ui.frame_preview = None
        return False
    c.selection.hovered = None
    top = imgui.get_cursor_screen_pos()
    texture = ui.graphics.textures.texture_id(shown.shot, small=False)
    factor = min(room.x / shown.shot.width, room.y / shown.shot.height)
    size = ImVec2(shown.shot.width * factor, shown.shot.height * factor)
    start = ImVec2(top.x + (room.x - size.x) / 2.0, top.y + (room.y - size.y) / 2.0)
    if texture is not None:
        imgui.get_window_draw_list().add_image(
            imgui.ImTextureRef(texture), start, ImVec2(start.x + size.x, start.y + size.y)
        )
    _caption(ui, shown, top, room)
    return True


def _caption(ui: Ui, shown: FramePreview, top: ImVec2, room: ImVec2) -> None:
    """What it is, the way to its neighbours, and the way back."""
    imgui.set_cursor_screen_pos(ImVec2(top.x + em(0.4), top.y + em(0.4)))
    imgui.push_style_color(imgui.Col_.child_bg, imgui.get_style_color_vec4(imgui.Col_.popup_bg))
    flags = imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.always_use_window_padding
    if imgui.begin_child("recorded", ImVec2(min(room.x - em(0.8), em(25.0)), 0.0), int(flags)):
        step = shown.step()
        paragraph(f"Recorded with zoom factor {shown.shot.factor:g}")
        for line in in_words(step) if step is not None else ():
            paragraph(line, QUIET)
        _turn(ui, shown, -1, icons.ICON_FA_CHEVRON_LEFT, "the step before")
        imgui.same_line()
        _turn(ui, shown, 1, icons.ICON_FA_CHEVRON_RIGHT, "the next step")
        imgui.same_line()
        if imgui.button("Back (Escape)##recorded"):
            ui.frame_preview = None
        if step is not None and ui.controller.runs.current is None:
            imgui.same_line()
            if imgui.button("Fly there"):
                ui.controller.go_to_step(step)
            tooltip("traced at the window's size and with its modes, so that wrong pixels may be missing")
    imgui.end_child()
    imgui.pop_style_color()


def _turn(ui: Ui, shown: FramePreview, by: int, icon: str, tip: str) -> None:
    shots = shown.test.filmstrip.of(shown.shot.factor)
    at = next((i for i, shot in enumerate(shots) if shot.number == shown.shot.number), 0) + by
    imgui.begin_disabled(not 0 <= at < len(shots))
    if imgui.button(f"{icon}##{by}") and 0 <= at < len(shots):
        show_step(ui, shown.test, shots[at].factor, shots[at].number)
    imgui.end_disabled()
    tooltip(tip)
