"""The panel Tour: the step that is next, and what to do."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.tour import STEPS
from viewer.window import menus
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, paragraph, wide_button

_ICONS = icons.ICON_FA_TABLE, icons.ICON_FA_MAGNIFYING_GLASS_PLUS  # of the commands


def show(ui: Ui) -> None:
    """Show the panel."""
    tour, step = ui.tour, ui.tour.step
    if step is None:
        return
    last = step is STEPS[-1]
    paragraph(step.title if last else f"{STEPS.index(step) + 1} of {len(STEPS) - 1}: {step.title}")
    if last:  # no command is where the button was that led here: it may be clicked once more
        if wide_button("Close"):
            tour.end()
            return
    else:  # above the text, so that no text moves them, and without tips, which would cover it
        done = tour.is_done
        if wide_button(f"{icons.ICON_FA_CHECK}  Done" if done else f"{icons.ICON_FA_PLAY}  Show me", columns=3):
            (tour.skip if done else tour.show)()
        imgui.same_line()
        imgui.begin_disabled(step is STEPS[0])
        if wide_button("Back", columns=2):
            tour.back()
        imgui.end_disabled()
        imgui.same_line()
        if wide_button("Next"):
            tour.skip()
    text = tour.text(step) if ui.controller.frame is not None else "You can begin as soon as there is a picture."
    paragraph(text, QUIET)
    for number, name in enumerate(step.commands):
        if number:
            imgui.same_line()
        menus.button(ui, name, _ICONS[number], columns=len(step.commands) - number)
