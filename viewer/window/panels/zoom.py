"""The zoom test in the window: towards what was clicked, and whether its shadows come in time."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from imgui_bundle import ImVec2, imgui, implot

from tracer.experiments.filmstrip import Shot
from tracer.experiments.titles import happenings, verdict
from tracer.experiments.zoom import Approach, Results, Step
from viewer.output.reports import STEPS, changes_in_words
from viewer.services.runs import RecordedZoomTest
from viewer.window.panels.plots import AXIS, COLORS, FLAGS, setup_legend, whole_numbers, wrong_axis
from viewer.window.panels.runs import Part, results_table, show_run
from viewer.window.setting_rows import plan_rows
from viewer.window.style import GREY, MARK
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, WARNING, clipped, count, em, paragraph, properties, row, tooltip

_PLOT, _FILMS, _TABLE = 16.0, 24.0, 21.0  # ems of width
_LEAST_FILM, _MOST_FILM = 3.2, 9.0  # ems of height
_CHANGES = "modes change"
_LARGE = 20.0  # ems of a picture that is pointed at


def show(ui: Ui) -> None:
    """The panel: how to go, the counts on the way, and what happened at which step."""
    test, parts = ui.controller.runs.zoom_test, list[Part]()
    if test is not None and (results := test.results) is not None:
        approaches = [approach for approach in results.approaches if approach.steps]
        parts.append(("Table", _TABLE, lambda: _table(ui, results)))
        parts.append(("Pictures", _FILMS, lambda: _films(ui, test, approaches)))
        parts.append(("Plot", _PLOT, lambda: _plot(ui, test, approaches)))
    show_run(
        ui, test, lambda: _plan(ui), ui.controller.runs.start_zoom_test,
        tip="Move towards the primitive, once with each factor",
        doing=f"Towards primitive {test.start.primitive}" if test is not None else "",
        parts=parts,
        why="Does a shadow that can only be seen from close up appear in time? Click a primitive, and start.",
    )  # fmt: skip


def _plan(ui: Ui) -> None:
    plan, picked = ui.controller.runs.zoom_plan, ui.controller.selection.picked
    with properties("plan", 4.6) as shown:
        if not shown:
            return
        row("Towards", "The primitive that you clicked in the picture.")
        if picked is not None:
            clipped(f"{picked.primitive}  ({picked.kind}, {picked.object_name})")
        else:
            imgui.text_colored(WARNING, "Click a primitive")
        plan_rows(ui, plan, "factors", "steps", "ratio")
        tooltip(f"The last step is at {100.0 * plan.ratio**plan.steps:.2g} % of the distance.")
        plan_rows(ui, plan, "size")


def _films(ui: Ui, test: RecordedZoomTest, approaches: list[Approach]) -> None:
    """The recorded pictures as in the paper's Figure 4, in a row for each factor."""
    if imgui.begin_child("films", ImVec2(0.0, 0.0), 0, int(imgui.WindowFlags_.horizontal_scrollbar)):
        room = imgui.get_content_region_avail().y / max(len(approaches), 1) - em(0.3)
        height = min(max(room, em(_LEAST_FILM)), em(_MOST_FILM))
        for approach in approaches:
            for shot in test.filmstrip.of(approach.factor):
                if shot.number < len(approach.steps):
                    _thumbnail(ui, test, shot, approach.steps[shot.number], height)
                    imgui.same_line(0.0, em(0.15))
            imgui.new_line()
    imgui.end_child()


def _thumbnail(ui: Ui, test: RecordedZoomTest, shot: Shot, step: Step, height: float) -> None:
    size = ImVec2(height * shot.width / shot.height, height)
    if imgui.invisible_button(f"{shot.factor:g} step {shot.number}##shot", size):
        ui.controller.navigator.go_to_step(shot.factor, step)
    if not imgui.is_item_visible():
        return
    start, end = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    draw, texture = imgui.get_window_draw_list(), ui.graphics.textures.texture_id(shot, small=True)
    if texture is not None:
        draw.add_image(imgui.ImTextureRef(texture), start, end)
    color = ERROR if step.wrong_of_primitive else MARK if step.changes else None
    if color is not None:
        draw.add_rect(start, end, imgui.get_color_u32(color), 0.0, em(0.1))
    if imgui.is_item_hovered():
        _show_step(ui, test, shot.factor, step)


def _show_step(ui: Ui, test: RecordedZoomTest, factor: float, step: Step) -> None:
    """Beside the pointer: a step in numbers, and its picture as it was recorded, or the nearest that is kept."""
    shot = test.filmstrip.nearest(factor, step.number)
    if not imgui.begin_tooltip():
        return
    examined = f"last examined at {count(step.highest)}" if step.highest else "not yet fully rendered"
    imgui.text_unformatted(f"step {step.number}: {count(step.pixels)} pixels, {examined}")
    wrong = f"{count(step.wrong_of_primitive)} of them wrong, {count(step.wrong)} in the picture"
    imgui.text_unformatted("\n".join([wrong, *changes_in_words(step.changes), "click to fly there"]))
    texture = ui.graphics.textures.texture_id(shot, small=False) if shot is not None else None
    if shot is not None and texture is not None:
        scale = em(_LARGE) / max(shot.width, shot.height)
        imgui.image(imgui.ImTextureRef(texture), ImVec2(scale * shot.width, scale * shot.height))
    imgui.end_tooltip()


def _plot(ui: Ui, test: RecordedZoomTest, approaches: list[Approach]) -> None:
    """The primitive's pixels on a logarithmic scale, and for each factor the count past which it is examined again,
    marks where modes change, and wrong pixels as bars."""
    size = imgui.get_content_region_avail()
    if not approaches or not implot.begin_plot("##steps", size, FLAGS):
        return
    last = test.frames / len(test.factors) - 0.3
    steps = max((approach.steps for approach in approaches), key=len)
    pixels = _counts(step.pixels for step in steps)
    most = max(max(step.pixels, step.highest, 1) for step in steps)
    implot.setup_axes("step", "pixels", AXIS, AXIS)
    implot.setup_axis_scale(implot.ImAxis_.y1, int(implot.Scale_.log10))
    whole_numbers(-0.7, last, size.x)
    implot.setup_axis_format(implot.ImAxis_.y1, "%.0f")
    always = int(imgui.Cond_.always)
    implot.setup_axes_limits(-0.7, last, 0.3 * float(pixels.min()), 6.0 * most, always)
    wrong_axis(max(1, *(approach.most_wrong for approach in approaches)), always, size.y)
    setup_legend([*(f"factor {approach.factor:g}" for approach in approaches), _CHANGES], size)
    for place, approach in enumerate(approaches):
        _plot_factor(approach, place, len(approaches))
    numbers = np.arange(len(steps), dtype=np.float64)
    implot.plot_line("##pixels", numbers, pixels, implot.Spec(line_color=GREY, line_weight=1.8))
    if implot.is_plot_hovered():
        number = min(max(round(implot.get_plot_mouse_pos().x), 0), len(steps) - 1)
        _show_step(ui, test, approaches[0].factor, steps[number])
        if imgui.is_mouse_clicked(imgui.MouseButton_.left):
            ui.controller.navigator.go_to_step(approaches[0].factor, steps[number])
    implot.end_plot()


def _plot_factor(approach: Approach, place: int, of: int) -> None:
    color, steps, name = COLORS[place % len(COLORS)], approach.steps, f"factor {approach.factor:g}"
    numbers = np.arange(len(steps), dtype=np.float64)
    limits = np.array([approach.factor * step.highest or np.nan for step in steps], np.float64)
    wrong = np.array([step.wrong_of_primitive for step in steps], np.float64)
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y2)
    shifted = numbers + 0.8 * ((place + 0.5) / of - 0.5)
    implot.plot_bars(name, shifted, wrong, 0.8 / of, implot.Spec(fill_color=color, fill_alpha=0.6))
    implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y1)
    implot.plot_stairs(name, numbers, limits, implot.Spec(line_color=color, line_weight=1.4))
    changed = np.array([step.number for step in steps if step.changes], np.float64)
    counts = _counts(step.pixels for step in steps if step.changes)
    mark = implot.Spec(marker=int(implot.Marker_.diamond), marker_size=em(0.24), marker_fill_color=color,
                       marker_line_color=MARK)  # fmt: skip
    implot.plot_scatter(f"##{_CHANGES} {name}" if place else _CHANGES, changed, counts, mark)


def _counts(pixels: Iterable[int]) -> np.ndarray:
    """Counts on a logarithmic scale, which has no 0."""
    return np.array([max(count, 0.5) for count in pixels], np.float64)


def _table(ui: Ui, results: Results) -> None:
    """What happened in a sentence for each factor, and the steps where something happens; a click flies there."""
    rows = happenings(results)
    for approach in filter(lambda approach: approach.steps, results.approaches):
        paragraph(f"{verdict(approach)}.")
    go = lambda number: ui.controller.navigator.go_to_step(*rows[number])  # noqa: E731
    results_table("steps", STEPS, rows, go, tip=lambda row: "\n".join(["fly there", *changes_in_words(row[1].changes)]))
