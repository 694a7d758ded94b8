"""The tour: a strip between the picture and its timeline, which covers nothing; a window with all steps while the first
start is still compiling."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.tour import STEPS, Step, Tour
from viewer.window.ui import Ui
from viewer.window.widgets import GOOD, QUIET, clipped, em, paragraph, tooltip_above

_WIDTH = 27.0  # ems of the window
_LEAST = 9.0  # ems of height that the picture keeps: with less room the strip lies over its lower edge
_PADDING = ImVec2(0.6, 0.45)  # ems


@dataclass
class TourState:
    """The height that the picture leaves free below it for the tour, and where that is: left, top and width."""

    height: float = 0.0
    place: tuple[float, float, float] | None = None


def show(ui: Ui) -> None:
    """The step that is next, and what to do; all steps while there is no picture yet."""
    state = ui.state(TourState)
    tour = ui.tour
    tour.update()
    if tour.step is None and not tour.last_word:
        state.height = 0.0
        return
    if ui.controller.frame is None and ui.graphics.preview is None:
        _all_steps(ui)
    elif state.place is not None:
        _strip(ui, *state.place)


def leave_room(ui: Ui, corner: ImVec2, room: ImVec2) -> float:
    """How much of the room that the picture has from `corner` on goes to the tour, below the picture."""
    wanted = height(ui)
    ui.state(TourState).place = (corner.x, corner.y + room.y - wanted, room.x)
    return wanted if room.y - wanted >= em(_LEAST) else 0.0


def height(ui: Ui) -> float:
    """How much the tour would have of the room for the picture; 0 while none is taken."""
    return ui.state(TourState).height if ui.tour.step is not None or ui.tour.last_word else 0.0


def _strip(ui: Ui, left: float, top: float, width: float) -> None:
    """The step in two or three lines, as wide as the picture's window."""
    state = ui.state(TourState)
    tour = ui.tour
    padding = ImVec2(em(_PADDING.x), em(_PADDING.y))
    wrap = max(width - 2.0 * padding.x, em(4.0))
    texts = [tour.text(step) for step in STEPS] if tour.step is not None else [tour.last_word]
    words = max(imgui.calc_text_size(text, False, wrap).y for text in texts)
    state.height = imgui.get_frame_height_with_spacing() + words + 2.0 * padding.y + em(0.2)
    imgui.set_next_window_pos(ImVec2(left, top))
    imgui.set_next_window_size(ImVec2(width, state.height - em(0.2)))
    flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_docking
    flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing
    imgui.push_style_var(imgui.StyleVar_.window_padding, padding)
    imgui.begin("Tour###tour", None, int(flags))
    imgui.pop_style_var()
    if tour.step is None:
        _end(tour, wrap)
    else:
        _step(tour, tour.step, wrap)
    imgui.end()


def _end(tour: Tour, wrap: float) -> None:
    """What is said after the last step."""
    label, style = "Close", imgui.get_style()
    button = imgui.calc_text_size(label).x + 2.0 * style.frame_padding.x + style.item_spacing.x
    if imgui.begin_child("title", ImVec2(max(wrap - button, em(2.0)), imgui.get_frame_height())):
        imgui.align_text_to_frame_padding()
        clipped("The tour is done")
        _marks(tour)
    imgui.end_child()
    imgui.same_line()
    text = tour.last_word
    if imgui.button(label):
        tour.end()
    paragraph(text, QUIET)


def _step(tour: Tour, step: Step, wrap: float) -> None:
    """What to do in a step, and to have it done or leave it out."""
    last = tour.at == len(STEPS) - 1
    labels = f"{icons.ICON_FA_PLAY}  Show me", "Finish" if last else "Skip", icons.ICON_FA_XMARK
    style = imgui.get_style()
    buttons = sum(
        imgui.calc_text_size(label).x + 2.0 * style.frame_padding.x + style.item_spacing.x for label in labels
    )
    imgui.align_text_to_frame_padding()
    if imgui.begin_child("title", ImVec2(max(wrap - buttons, em(2.0)), imgui.get_frame_height())):
        imgui.align_text_to_frame_padding()
        clipped(f"Step {STEPS.index(step) + 1} of {len(STEPS)}:  {step.title}")
        _marks(tour)
    imgui.end_child()
    imgui.same_line()
    imgui.begin_disabled(tour.showing)
    if imgui.button(labels[0]):
        tour.show()
    imgui.end_disabled()
    tooltip_above("do this step for you")
    imgui.same_line()
    text = tour.text(step)
    if imgui.button(labels[1]):
        tour.skip()
    tooltip_above("end the tour; the menu Help has it again" if last else "go on to the next step")
    imgui.same_line()
    if imgui.button(f"{labels[2]}##end"):
        tour.end()
    tooltip_above("end the tour; the menu Help has it again")
    paragraph(text, QUIET)


def _marks(tour: Tour) -> None:
    """A dot for each step, full where it is done, where there is room for them."""
    pitch, radius = em(0.75), em(0.22)
    imgui.same_line(0.0, em(1.0))
    if imgui.get_content_region_avail().x < pitch * len(STEPS):
        return
    corner, draw = imgui.get_cursor_screen_pos(), imgui.get_window_draw_list()
    for number in range(len(STEPS)):
        at = ImVec2(corner.x + (number + 0.5) * pitch, corner.y + 0.5 * imgui.get_frame_height())
        if number in tour.done:
            draw.add_circle_filled(at, radius, imgui.get_color_u32(GOOD))
        else:
            draw.add_circle(at, radius, imgui.get_color_u32(QUIET), 0, em(0.08))
    imgui.dummy(ImVec2(pitch * len(STEPS), imgui.get_frame_height()))
    tooltip_above(f"{len(tour.done)} of {len(STEPS)} steps are done")


def _all_steps(ui: Ui) -> None:
    """Under the progress of the first start."""
    tour, area = ui.tour, imgui.get_main_viewport()
    width = min(em(_WIDTH), 0.9 * area.work_size.x)
    centre = area.get_work_center()
    room = area.work_pos.y + area.work_size.y - centre.y - em(1.0)
    wrap = width - 2.0 * imgui.get_style().window_padding.x
    texts = [tour.text(step) for step in STEPS]
    told = sum(imgui.calc_text_size(text, False, wrap).y + imgui.get_style().item_spacing.y for text in texts)
    others = imgui.get_frame_height() + (len(STEPS) + 2) * imgui.get_text_line_height_with_spacing()
    imgui.set_next_window_pos(ImVec2(centre.x - 0.5 * width, centre.y + em(0.5)))
    imgui.set_next_window_size(ImVec2(width, 0.0))
    flags = imgui.WindowFlags_.no_docking | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_resize
    flags |= imgui.WindowFlags_.no_focus_on_appearing | imgui.WindowFlags_.no_move
    shown, stays = imgui.begin(f"A tour of {len(STEPS)} steps###steps", True, int(flags))
    if shown:
        for number, (step, text) in enumerate(zip(STEPS, texts, strict=True)):
            paragraph(f"{number + 1}  {step.title}")
            if told + others <= room:  # else only what the steps are called
                paragraph(text, QUIET)
        paragraph("You can begin as soon as there is a picture.", QUIET)
    imgui.end()
    if not stays:
        tour.end()
