"""A hunt for counterexamples: what to search, the worst wrong pixels so far, and what is wrong with one of them."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.experiments import counterexample, hunt
from tracer.experiments.counterexample import Counterexample
from tracer.scene.model import Scene
from viewer.services.hunts import Hunts
from viewer.window.panels.culling import method_list
from viewer.window.panels.runs import choice, export_buttons, frames_row, results_table, side_by_side, start_or_progress
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    clipped,
    em,
    in_window_style,
    paragraph,
    properties,
    right,
    row,
    tooltip_above,
)

_COLUMNS = {  # and what they mean
    "#": "The worst first.",
    "off by": "Difference of the colour from the right one, of 1.",
    "pixel": "Column and row, from the upper left.",
    "frame": "Frame of the path, or the one that it is near.",
    "light": "Light whose answer is wrong, and how many others are wrong in the same way.",
    "primitive": "Primitive at which the light is wrong: number and object.",
}


def show(ui: Ui) -> None:
    """The panel: what to search, the list of finds, and the one that was clicked."""
    hunts = ui.controller.hunts
    chosen = _chosen(ui, hunts)
    side_by_side(
        lambda: _controls(ui, hunts),
        lambda size: _finds(ui, hunts, size),
        None if chosen is None else lambda: _details(ui, hunts, *chosen),
        em(16.0),
    )


def _controls(ui: Ui, hunts: Hunts) -> None:
    start_or_progress(ui, hunts.hunt, hunts.start, "Search the frames for the worst wrong pixels of the method")
    if ui.controller.runs.current is not hunts.hunt or hunts.hunt is None:
        _plan(ui, hunts)
    export_buttons(ui, hunts.hunt)


def _plan(ui: Ui, hunts: Hunts) -> None:
    plan = hunts.plan
    with properties("plan", 4.6) as shown:
        if not shown:
            return
        row("Method", "The method whose wrong pixels are searched; an exact one has none.")
        method_list(ui, "##method", plan.method, lambda name: setattr(plan, "method", name), combined=False)
        frames_row(plan, hunts.frames, "First and last frame of the path, traced one after another.")
        plan_rows(ui, plan, "step", "around", "radius", "seed", "size")


def _finds(ui: Ui, hunts: Hunts, size: ImVec2) -> None:
    """A line for each find, the worst first; a click flies there."""
    found, scene = hunts.found, ui.controller.session.scene
    if imgui.begin_child("finds", size):
        if found is None or hunts.hunt is None:
            paragraph(
                "Where is a method wrong, and how badly? Start: the worst wrong pixels are listed here. Click one to "
                "fly there; the inspector explains it.",
                QUIET,
            )
        elif scene is None or not hunts.hunt.is_of(scene):
            paragraph(f"The last hunt was made {hunts.hunt.made_in(scene)}.", QUIET)
        else:
            paragraph(in_window_style(found.summary), QUIET)
            if found.finds:
                _table(ui, hunts, found, scene)
    imgui.end_child()


def _table(ui: Ui, hunts: Hunts, found: hunt.Results, scene: Scene) -> None:
    """As wide as its columns need, and scrolled where that is wider than the room."""
    rows = [_cells(number, find, scene) for number, find in enumerate(found.finds)]
    widths = [max(imgui.calc_text_size(text).x for text in column) for column in zip(_COLUMNS, *rows, strict=True)]
    columns = [(name, width + 1.0, tip) for (name, tip), width in zip(_COLUMNS.items(), widths, strict=True)]
    with results_table("finds", columns) as shown:
        for number, find in enumerate(found.finds if shown else ()):
            rank, *numbers, primitive = rows[number]
            if choice(f"{rank}##find {rank}", hunts.chosen == number):
                hunts.go(number)
                ui.show_panel("Inspector")
            tooltip_above(f"Fly there. {counterexample.in_its_frame(find)}")
            for text in numbers:
                imgui.table_next_column()
                right(text)
            imgui.table_next_column()
            clipped(primitive)


def _cells(number: int, find: Counterexample, scene: Scene) -> tuple[str, ...]:
    more = f" (+{find.more_lights})" if find.more_lights else ""
    return (
        f"{number + 1}",
        f"{find.difference:.3f}",
        f"{find.x}, {find.y}",
        counterexample.frame_of(find, scene),
        f"{find.light}{more}",
        counterexample.primitive_of(find, scene),
    )


def _chosen(ui: Ui, hunts: Hunts) -> tuple[int, Counterexample, Scene] | None:
    """The find that was clicked, by its place and itself, with its scene."""
    found, scene = hunts.found, ui.controller.session.scene
    if found is None or hunts.hunt is None or scene is None or not hunts.hunt.is_of(scene):
        return None
    if hunts.chosen is None or hunts.chosen >= len(found.finds):
        return None
    return hunts.chosen, found.finds[hunts.chosen], scene


def _details(ui: Ui, hunts: Hunts, number: int, find: Counterexample, scene: Scene) -> None:
    """What can be done with a find, and what is wrong there, in colours and words."""
    imgui.begin_disabled(ui.controller.runs.current is not None)
    if imgui.button(f"{icons.ICON_FA_PAPER_PLANE}  Fly there"):
        hunts.go(number)
        ui.show_panel("Inspector")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FLOPPY_DISK}  Figure"):
        hunts.save_figure(number)
    tooltip_above("Save it beside the right picture; shadowcull check draws it again")
    imgui.end_disabled()
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_CODE_BRANCH}  Rays"):
        ui.show_rays()
    tooltip_above(f"what became of each ray of the pixel{ui.key('Rays of the clicked pixel')}")
    _colors(find)
    for sentence in (*counterexample.in_words(find, scene), counterexample.in_its_frame(find)):
        paragraph(in_window_style(sentence))
    if ui.controller.scheduler.is_frozen:
        paragraph("The picture stays at 1 sample a pixel, as it was found, until you move.", QUIET)


def _colors(find: Counterexample) -> None:
    """The colour that the method shows, beside the right one."""
    side, at = imgui.get_text_line_height(), imgui.get_cursor_screen_pos()
    draw = imgui.get_window_draw_list()
    for number, color in enumerate((find.color, find.reference)):
        red, green, blue = (min(max(channel, 0.0), 1.0) for channel in color)
        start = ImVec2(at.x + 1.6 * side * number, at.y)
        fill = imgui.get_color_u32((red, green, blue, 1.0))
        draw.add_rect_filled(start, ImVec2(start.x + 1.6 * side, start.y + side), fill)
    imgui.dummy(ImVec2(3.2 * side, side))
    imgui.same_line(0.0, em(0.4))
    clipped("shown, and right", QUIET)
