"""The tour: a strip between the picture and its timeline, which covers nothing."""

from __future__ import annotations

from collections.abc import Callable

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.tour import LAST_WORD, STEPS
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, paragraph, tooltip

_AGAIN = "End the tour. The menu Help starts it again."


def height(ui: Ui, width: float) -> float:
    """Return how much of the room for the picture goes to the tour, whichever step is next; 0 while none is taken."""
    if ui.tour.step is None and not ui.tour.over:
        return 0.0
    style, wrap = imgui.get_style(), max(width - 2.0 * imgui.get_style().window_padding.x, em(4.0))
    words = max(imgui.calc_text_size(ui.tour.text(step), False, wrap).y for step in STEPS)
    return imgui.get_frame_height_with_spacing() + words + 2.0 * style.window_padding.y + style.item_spacing.y


def show(ui: Ui, width: float) -> None:
    """Show the step that is next, and what to do, in two or three lines."""
    tour, step = ui.tour, ui.tour.step
    size = ImVec2(width, height(ui, width) - imgui.get_style().item_spacing.y)
    if imgui.begin_child("tour", size, int(imgui.ChildFlags_.borders)):
        if step is None:
            _head("The tour is done", ("Close", tour.end, ""))
            paragraph(LAST_WORD, QUIET)
        else:
            begun = ui.controller.frame is not None
            text = tour.text(step) if begun else "You can begin as soon as there is a picture."
            number, last = STEPS.index(step) + 1, step is STEPS[-1]
            _head(
                f"Step {number} of {len(STEPS)}:  {step.title}",
                ("Finish" if last else "Skip", tour.skip, _AGAIN if last else "Go on to the next step."),
                (f"{icons.ICON_FA_XMARK}##end", tour.end, _AGAIN),
            )
            paragraph(text, QUIET)
    imgui.end_child()


def _head(title: str, *buttons: tuple[str, Callable[[], None], str]) -> None:
    """Show a line with a title, and buttons at its end: what each is called, does, and says of itself."""
    style = imgui.get_style()
    room = sum(
        imgui.calc_text_size(label, True).x + 2.0 * style.frame_padding.x + style.item_spacing.x
        for label, *_ in buttons
    )
    imgui.align_text_to_frame_padding()
    left, width = imgui.get_cursor_pos_x(), imgui.get_content_region_avail().x
    clipped(title, room=width - room)
    for number, (label, run, tip) in enumerate(buttons):
        imgui.same_line(0.0 if number else left + width - room)
        if imgui.button(label):
            run()
        if tip:
            tooltip(tip)
