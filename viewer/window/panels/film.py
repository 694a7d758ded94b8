"""Films in the window: what to film, how far it is, and where it goes."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.services.film import Films
from viewer.services.runs import duration
from viewer.window.panels.runs import either, frames_row, start_or_progress
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, em, paragraph, properties, row, tooltip

_WIDE = 42.0  # ems of a panel that has room for its three parts side by side


def show(ui: Ui) -> None:
    """The panel: along what, what the pictures are like, and the button with what comes of it."""
    room, spacing = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.x
    wide = room > em(_WIDE)
    width = (room - 2.0 * spacing) / 3.0 if wide else 0.0
    for number, part in enumerate((_way, _looks, _start)):
        if wide and number:
            imgui.same_line()
        if imgui.begin_child(f"part {number}", ImVec2(width, 0.0), int(imgui.ChildFlags_.auto_resize_y)):
            part(ui, ui.controller.films)
        imgui.end_child()


def _way(ui: Ui, films: Films) -> None:
    """Along what, how long, and how fast."""
    plan, marks = films.plan, len(ui.controller.bookmarks.all)
    with properties("way", 5.0) as shown:
        if not shown:
            return
        row("Along", "The frames of the animation, or a flight through the bookmarks at an even speed.")
        plan.through_bookmarks = either("path", f"bookmarks ({marks})###bookmarks", plan.through_bookmarks)
        if not plan.through_bookmarks:
            frames_row(plan, films.frames, "First and last frame of the animation.")
            row("Camera", "The scene's own camera, or the one in the picture now, which stays where it is.")
            plan.from_here = either("own", "as here", plan.from_here)
        plan_rows(ui, plan, "seconds", "fps")


def _looks(ui: Ui, films: Films) -> None:
    """The size and the quality of the pictures, and what is on them."""
    with properties("looks", 7.6) as shown:
        if shown:
            plan_rows(ui, films.plan, "size", "samples", "video", "legend", "caption")
            tooltip(ui.template_help)


def _start(ui: Ui, films: Films) -> None:
    """The button, and what the film will be."""
    film, plan, session = films.film, films.plan, ui.controller.session
    start_or_progress(ui, film, films.start, "Trace and write every frame")
    if film is not None and not film.done:
        paragraph(f"to {film.output}", QUIET)
    elif films.count:
        what = f"method {session.settings.method}, view {session.draw.view.label}"
        paragraph(f"{films.count} frames, {duration(films.count / plan.fps)}; {what}", QUIET)
    else:
        paragraph(f"A flight needs two bookmarks at least{ui.key('Add bookmark')}.", WARNING)
