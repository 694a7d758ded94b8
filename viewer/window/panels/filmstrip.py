"""The filmstrip of a zoom test: a row of small pictures for each zoom factor, as in the paper's Figure 4."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from tracer.experiments.zoom import Approach, Step
from viewer.output.filmstrip import Shot
from viewer.output.reports import changes_in_words
from viewer.services.runs import RecordedZoomTest, approaches_of
from viewer.window.style import MARK
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, count, em

_LARGE = 20.0  # ems of a picture that is pointed at


def strip(ui: Ui, test: RecordedZoomTest, approach: Approach, name: str, size: ImVec2) -> None:
    """The pictures towards the primitive with one factor, side by side; a click flies to where one was taken."""
    shots, steps = test.filmstrip.of(approach.factor), {step.number: step for step in approach.steps}
    if imgui.begin_child(name, size, 0, int(imgui.WindowFlags_.horizontal_scrollbar)):
        height = max(em(1.5), size.y - imgui.get_style().scrollbar_size - em(0.25))
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
        ui.controller.go_to_step(step)
    if not imgui.is_item_visible() or ui.graphics.textures is None:
        return
    start, end = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    draw, texture = imgui.get_window_draw_list(), ui.graphics.textures.texture_id(shot, small=True)
    if texture is not None:
        draw.add_image(imgui.ImTextureRef(texture), start, end)
    color = ERROR if step.wrong_of_primitive else MARK if step.changes else None
    if color is not None:
        draw.add_rect(start, end, imgui.get_color_u32(color), 0.0, em(0.1))
    if imgui.is_item_hovered():
        show_step(ui, test, shot.factor, step)


def show_step(ui: Ui, test: RecordedZoomTest, factor: float, step: Step) -> None:
    """Beside the pointer: a step in numbers, and its picture as it was recorded, or the nearest that is kept."""
    shot, textures = test.filmstrip.nearest(factor, step.number), ui.graphics.textures
    if not imgui.begin_tooltip():
        return
    highest = f"highest count {count(step.highest)}" if step.highest else "not yet fully rendered"
    imgui.text_unformatted(f"step {step.number}: {count(step.pixels)} pixels, {highest}")
    wrong = f"{count(step.wrong_of_primitive)} of them wrong, {count(step.wrong)} in the picture"
    imgui.text_unformatted("\n".join([wrong, *changes_in_words(step.changes), "click to fly there"]))
    texture = textures.texture_id(shot, small=False) if shot is not None and textures is not None else None
    if shot is not None and texture is not None:
        scale = em(_LARGE) / max(shot.width, shot.height)
        imgui.image(imgui.ImTextureRef(texture), ImVec2(scale * shot.width, scale * shot.height))
    imgui.end_tooltip()
