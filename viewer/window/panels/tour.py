"""The tour: a strip between the picture and its timeline, which covers nothing."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.tour import STEPS
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, paragraph, tooltip

_AGAIN = "End the tour. The menu Help starts it again."


def height(ui: Ui, width: float) -> float:
    """Return how much of the room for the picture goes to the tour, whichever step is next; 0 while none is taken."""
    if ui.tour.step is None:
        return 0.0
    style, wrap = imgui.get_style(), max(width - 2.0 * imgui.get_style().window_padding.x, em(4.0))
    words = max(imgui.calc_text_size(ui.tour.text(step), False, wrap).y for step in STEPS)
    return imgui.get_frame_height_with_spacing() + words + 2.0 * style.window_padding.y + style.item_spacing.y


def show(ui: Ui, width: float) -> None:
    """Show the step that is next, and what to do, in two or three lines."""
    tour, step, style = ui.tour, ui.tour.step, imgui.get_style()
    if step is None:
        return
    number, last = STEPS.index(step) + 1, step is STEPS[-1]
    size = ImVec2(width, height(ui, width) - style.item_spacing.y)
    if imgui.begin_child("tour", size, int(imgui.ChildFlags_.borders)):
        buttons = [
            (f"{icons.ICON_FA_PLAY}  Show me", tour.show, "Do this step for me."),
            ("Close" if last else "Skip", tour.skip, _AGAIN if last else "Go on to the next step."),
            (f"{icons.ICON_FA_XMARK}##end", tour.end, _AGAIN),
        ][last:]
        widths = (imgui.calc_text_size(label, True).x + 2.0 * style.frame_padding.x for label, *_ in buttons)
        left, spaces = imgui.get_cursor_pos_x(), len(buttons) * style.item_spacing.x
        room = imgui.get_content_region_avail().x - sum(widths) - spaces
        imgui.align_text_to_frame_padding()
        clipped(step.title if last else f"Step {number} of {len(STEPS) - 1}:  {step.title}", room=room)
        imgui.same_line(left + room)
        for label, do, tip in buttons:
            if imgui.button(label):
                do()
            tooltip(tip)
            imgui.same_line()
        imgui.new_line()
        begun = ui.controller.frame is not None
        paragraph(tour.text(step) if begun else "You can begin as soon as there is a picture.", QUIET)
    imgui.end_child()
