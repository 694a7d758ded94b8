"""The tour: a strip between the picture and its timeline, which covers nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.tour import STEPS, Tour
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, paragraph, tooltip_above

_LEAST = 9.0  # ems of height that the picture keeps: with less room the strip lies over its lower edge
_PADDING = ImVec2(0.6, 0.45)  # ems
_AGAIN = "end the tour; the menu Help has it again"


@dataclass
class TourState:
    """The height that the picture leaves free below it for the tour, and where that is: left, top and width."""

    height: float = 0.0
    place: tuple[float, float, float] | None = None


def show(ui: Ui) -> None:
    """The step that is next, and what to do, in two or three lines as wide as the picture's window."""
    state, tour = ui.state(TourState), ui.tour
    tour.update()
    if tour.step is None and not tour.last_word:
        state.height = 0.0
        return
    if state.place is None:
        return
    left, top, width = state.place
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
    step = tour.step
    if step is None:
        text = tour.last_word
        _head(tour, "The tour is done", wrap, ("Close", tour.end, ""))
    else:
        begun = ui.controller.frame is not None or ui.graphics.preview is not None
        text = tour.text(step) if begun else "You can begin as soon as there is a picture."
        last = tour.at == len(STEPS) - 1

        title = f"Step {STEPS.index(step) + 1} of {len(STEPS)}:  {step.title}"
        _head(
            tour, title, wrap,
            (f"{icons.ICON_FA_PLAY}  Show me", tour.show, "do this step for you"),
            ("Finish" if last else "Skip", tour.skip, _AGAIN if last else "go on to the next step"),
            (f"{icons.ICON_FA_XMARK}##end", tour.end, _AGAIN),
        )  # fmt: skip
    paragraph(text, QUIET)
    imgui.end()


def leave_room(ui: Ui, corner: ImVec2, room: ImVec2) -> float:
    """How much of the room that the picture has from `corner` on goes to the tour, below the picture."""
    wanted = height(ui)
    ui.state(TourState).place = (corner.x, corner.y + room.y - wanted, room.x)
    return wanted if room.y - wanted >= em(_LEAST) else 0.0


def height(ui: Ui) -> float:
    """How much the tour would have of the room for the picture; 0 while none is taken."""
    return ui.state(TourState).height if ui.tour.step is not None or ui.tour.last_word else 0.0


def _head(tour: Tour, title: str, width: float, *buttons: tuple[str, Callable[[], None], str]) -> None:
    """Show a line with a title and buttons: what each is called, does, and says of itself."""
    style, clicked = imgui.get_style(), []
    room = sum(
        imgui.calc_text_size(label, True).x + 2.0 * style.frame_padding.x + style.item_spacing.x
        for label, *_ in buttons
    )
    if imgui.begin_child("title", ImVec2(max(width - room, em(2.0)), imgui.get_frame_height())):
        imgui.align_text_to_frame_padding()
        clipped(title)
    imgui.end_child()
    for label, run, tip in buttons:
        imgui.same_line()
        imgui.begin_disabled(run == tour.show and tour.showing)
        if imgui.button(label):
            clicked.append(run)
        imgui.end_disabled()
        if tip:
            tooltip_above(tip)
    for run in clicked:  # when all is drawn of the step that it ends
        run()
