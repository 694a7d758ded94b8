"""A hunt for counterexamples: what to search, the worst wrong pixels so far, and what is wrong with one of them."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.method import bases
from tracer.scene.model import Scene
from viewer.output import finds
from viewer.output.finds import Find, Findings
from viewer.services.hunt_controller import HuntController
from viewer.services.runs import LONGEST_SIDE
from viewer.window.panels.runs import side_by_side, start_or_progress
from viewer.window.ui import Ui
from viewer.window.widgets import (
    GOOD,
    QUIET,
    clipped,
    em,
    in_window_style,
    paragraph,
    properties,
    row,
    size_field,
    tooltip,
    tooltip_above,
)

_COLUMNS = (("", 1.4), ("by", 2.6), ("pixel", 4.2), ("wrong", 2.8))
_REST = ("frame", "primitive", "light")


def show(ui: Ui) -> None:
    """The panel: what to search, the list of finds, and the one that was clicked."""
    hunts = ui.controller.hunts
    side_by_side(
        lambda: _controls(ui, hunts),
        lambda size: _finds(ui, hunts, size),
        lambda: _chosen(ui, hunts),
        em(16.0),
    )


def _controls(ui: Ui, hunts: HuntController) -> None:
    start_or_progress(ui, hunts.hunt, hunts.start, "search the frames for the worst wrong pixels of the method")
    if ui.controller.runs.current is not hunts.hunt or hunts.hunt is None:
        _plan(ui, hunts)


def _plan(ui: Ui, hunts: HuntController) -> None:
    plan = hunts.plan
    with properties("plan", 4.6) as shown:
        if not shown:
            return
        row("Method", "whose wrong pixels are searched; of an exact one, it shows that there are none")
        if imgui.begin_combo("##method", plan.method):
            for kind in bases():
                if imgui.selectable(kind.name, kind.name == plan.method)[0]:
                    plan.method = kind.name
                tooltip(kind.summary)
            imgui.end_combo()
        first, last = hunts.frames
        row("Frames", "the first and the last of the path, traced one after another")
        changed, span = imgui.input_int2("##frames", [first, last])
        if changed:
            plan.first, plan.last = max(0, span[0]), max(0, span[1])
        row("Step", "only every so many of them")
        changed, step = imgui.input_int("##step", plan.step, 0)
        if changed:
            plan.step = min(max(step, 1), 100_000)
        row("Around", "so many pictures near the worst finds, after the path")
        changed, around = imgui.input_int("##around", plan.around, 0)
        if changed:
            plan.around = min(max(around, 0), 100_000)
        row("Radius", "how far from the camera of a find, in parts of its distance to what is wrong")
        changed, radius = imgui.slider_float("##radius", plan.radius, 0.0, 1.0, "%.2f")
        if changed:
            plan.radius = min(max(radius, 0.0), 100.0)
        row("Seed", "by which these pictures are drawn")
        changed, seed = imgui.input_int("##seed", plan.seed, 0)
        if changed:
            plan.seed = max(seed, 0)
        row("Size", "of the pictures: modes are those of a size")
        plan.size = size_field(plan.size, LONGEST_SIDE, ui.controller.notices.say)


def _finds(ui: Ui, hunts: HuntController, size: ImVec2) -> None:
    """A line for each find, the worst first; a click flies there."""
    found, scene = hunts.found, ui.controller.session.scene
    if imgui.begin_child("finds", size):
        if found is None or hunts.hunt is None:
            paragraph(
                "Where is a method wrong, and how badly? Start, and the worst wrong pixels are listed here. A click on "
                "one flies there, and the inspector explains it.",
                QUIET,
            )
        elif scene is None or not hunts.hunt.is_of(scene):
            paragraph(f"The last hunt was made {hunts.hunt.made_in(scene)}.", QUIET)
        else:
            clipped(in_window_style(found.summary), QUIET if found.wrong_pixels else GOOD)
            if found.finds:
                _table(ui, hunts, found, scene)
    imgui.end_child()


def _table(ui: Ui, hunts: HuntController, found: Findings, scene: Scene) -> None:
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_y | imgui.TableFlags_.sizing_stretch_prop
    if not imgui.begin_table("finds", len(_COLUMNS) + len(_REST), int(flags)):
        return
    imgui.table_setup_scroll_freeze(0, 1)
    for heading, width in _COLUMNS:
        imgui.table_setup_column(heading, int(imgui.TableColumnFlags_.width_fixed), em(width))
    for heading, weight in zip(_REST, (0.9, 1.7, 0.7), strict=True):
        imgui.table_setup_column(heading, int(imgui.TableColumnFlags_.width_stretch), weight)
    imgui.table_headers_row()
    for number, find in enumerate(found.finds):
        imgui.table_next_row()
        imgui.table_next_column()
        spans = imgui.SelectableFlags_.span_all_columns | imgui.SelectableFlags_.allow_overlap
        if imgui.selectable(f"{number + 1}##find", hunts.chosen == number, int(spans))[0]:
            hunts.go(number)
            ui.show_panel("Inspector")
        tooltip_above("fly there: the frames before it are traced again, and its pixel is selected")
        more = f" (+{find.more_lights})" if find.more_lights else ""
        for text in (
            f"{find.difference:.3f}",
            f"{find.x}, {find.y}",
            f"{find.pixels}",
            finds.frame_of(find, scene),
            finds.primitive_of(find, scene),
            f"{find.light}{more}",
        ):
            imgui.table_next_column()
            clipped(text)
    imgui.end_table()


def _chosen(ui: Ui, hunts: HuntController) -> None:
    """What is wrong at the find that was clicked, in words and colours, and its figure."""
    found, scene = hunts.found, ui.controller.session.scene
    if found is None or hunts.hunt is None or scene is None or not hunts.hunt.is_of(scene):
        return
    if hunts.chosen is None or hunts.chosen >= len(found.finds):
        if found.finds:
            paragraph("Click a find to fly there.", QUIET)
        return
    find = found.finds[hunts.chosen]
    _colors(find)
    for sentence in finds.in_words(find, scene):
        paragraph(in_window_style(sentence))
    imgui.begin_disabled(ui.controller.runs.current is not None)
    if imgui.button(f"{icons.ICON_FA_PAPER_PLANE}  Fly there"):
        hunts.go(hunts.chosen)
        ui.show_panel("Inspector")
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FLOPPY_DISK}  Figure"):
        hunts.save_figure(hunts.chosen)
    tooltip_above("save it beside the right picture; shadowcull check draws it again")
    imgui.end_disabled()
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_CODE_BRANCH}  Rays"):
        ui.show_panel("Rays")
    tooltip_above("what became of each ray of the pixel (X)")


def _colors(find: Find) -> None:
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
    clipped("as it is shown, and as it is right", QUIET)
