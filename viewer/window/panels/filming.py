"""Films in the window: what to film, how far it is, and where it goes."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from viewer.services.film import FilmRun, Films
from viewer.services.runs import LONGEST_SIDE, duration
from viewer.window.panels.runs import start_or_progress
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    WARNING,
    checkbox,
    em,
    paragraph,
    properties,
    row,
    same_line_for,
    size_field,
    tooltip,
)

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
        row("Along", "the frames of the scene's animation, or a flight through the bookmarks at an even speed")
        if imgui.radio_button("path", not plan.through_bookmarks):
            plan.through_bookmarks = False
        same_line_for(f"bookmarks ({marks})")
        if imgui.radio_button(f"bookmarks ({marks})###bookmarks", plan.through_bookmarks):
            plan.through_bookmarks = True
        if not plan.through_bookmarks:
            first, last = films.frames
            row("Frames", "the first and the last of the animation")
            changed, span = imgui.input_int2("##frames", [first, last])
            if changed:
                plan.first, plan.last = max(0, span[0]), max(0, span[1])
            row("Camera", "the scene's own, or the one that you have taken in hand, which stays where it is")
            if imgui.radio_button("own", not plan.from_here):
                plan.from_here = False
            same_line_for("as here")
            if imgui.radio_button("as here", plan.from_here):
                plan.from_here = True
        row("Seconds", "how long the film is; 0: every frame once, or 2 seconds from bookmark to bookmark")
        changed, seconds = imgui.input_float("##seconds", plan.seconds, 0.0, 0.0, "%.1f")
        if changed:
            plan.seconds = min(max(seconds, 0.0), 3600.0)
        row("Frames / s")
        changed, fps = imgui.input_float("##fps", plan.fps, 0.0, 0.0, "%.3g")
        if changed:
            plan.fps = min(max(fps, 1.0), 240.0)


def _looks(ui: Ui, films: Films) -> None:
    """The size and the quality of the pictures, and what is on them."""
    plan = films.plan
    with properties("looks", 5.0) as shown:
        if shown:
            row("Size", "of the pictures")
            plan.size = size_field(plan.size, LONGEST_SIDE, ui.controller.notices.say)
            row("Samples", "of each pixel")
            changed, samples = imgui.input_int("##samples", plan.samples, 0)
            if changed:
                plan.samples = min(max(samples, 1), 4096)
            row("Caption", "a line below each picture, or nothing")
            _, plan.caption = imgui.input_text_with_hint("##caption", "none", plan.caption)
            tooltip(ui.template_help)
    checkbox("Video (mp4)", plan.video, lambda on: setattr(plan, "video", on), "beside the numbered pictures")
    checkbox("With legend", plan.legend, lambda on: setattr(plan, "legend", on), "where the view has one")


def _start(ui: Ui, films: Films) -> None:
    start_or_progress(ui, films.film, films.start, "trace every frame whole, and write it")
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
