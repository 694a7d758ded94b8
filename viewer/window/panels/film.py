"""Films in the window: what to film, how far it is, and where it goes."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.services.film import FilmRun, Films
from viewer.services.runs import duration
from viewer.window.panels.runs import either, frames_row, start_or_progress
from viewer.window.setting_rows import plan_rows
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, WARNING, checkbox, em, paragraph, properties, row, tooltip

_WIDE = 42.0  # ems of a panel that has room for its three parts side by side
_HIGH = int(imgui.ChildFlags_.auto_resize_y)


def show(ui: Ui) -> None:
    """The panel: along what, what the pictures are like, and the button with what comes of it."""
    films = ui.controller.films
    room, spacing = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.x
    wide = room > em(_WIDE)
    width = (room - 2.0 * spacing) / 3.0 if wide else 0.0
    parts = (lambda: _way(ui, films), lambda: _looks(ui, films), lambda: _start(ui, films))
    for number, part in enumerate(parts):
        if wide and number:
            imgui.same_line()
        if imgui.begin_child(f"part {number}", ImVec2(width, 0.0), _HIGH):
            part()
        imgui.end_child()


def _way(ui: Ui, films: Films) -> None:
    """Along what, how long, and how fast."""
    c, plan = ui.controller, films.plan
    marks = len(c.bookmarks.all)
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
    plan = films.plan
    with properties("looks", 7.6) as shown:
        if shown:
            plan_rows(ui, plan, "size", "samples", "caption")
            tooltip(ui.template_help)
    checkbox("Video (mp4)", plan.video, lambda on: setattr(plan, "video", on), "Beside the numbered pictures.")
    checkbox("With legend", plan.legend, lambda on: setattr(plan, "legend", on), "Where the view has one.")


def _start(ui: Ui, films: Films) -> None:
    start_or_progress(ui, films.film, films.start, "Trace and write every frame")
    _tell(ui, films)


def _tell(ui: Ui, films: Films) -> None:
    """What the film will be, or what became of the last one."""
    c, film = ui.controller, films.film
    if film is not None and not film.done:
        paragraph(f"to {film.script.folder}", QUIET)
        return
    if films.count:
        seconds = films.count / films.plan.fps
        method, view = c.session.settings.method, c.session.draw.view.label
        paragraph(f"{films.count} frames, {duration(seconds)}; method {method}, view {view}", QUIET)
    elif films.plan.through_bookmarks:
        text = f"A flight needs two bookmarks at least: add one where the camera is{ui.key('Add bookmark')}."
        paragraph(text, WARNING)
    if film is not None:
        paragraph(_outcome(film), QUIET)


def _outcome(film: FilmRun) -> str:
    done, frames = film.done_of
    if film.error is not None:
        return f"The last film failed after {done} frames."
    much = "The last film is" if film.whole else f"{done} of {frames} frames are"
    return f"{much} in {film.script.video or film.script.folder}"
