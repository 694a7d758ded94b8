"""Saving pictures: now, where to, and how named; by a dialog, larger, with a caption, or as EXR; and many as a film."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.method import title_of
from viewer.output import exr
from viewer.output.capture import TEMPLATE_HELP
from viewer.services.film import Films
from viewer.services.runs import duration
from viewer.window import menus
from viewer.window.panels.runs import frames_row, start_or_progress
from viewer.window.setting_rows import panel_rows, plan_rows
from viewer.window.ui import Dialog, Ui
from viewer.window.widgets import QUIET, WARNING, begin_modal, em, one_of, paragraph, properties, row, tooltip

TITLE = Dialog.SAVE_AS.value


def show(ui: Ui) -> None:
    """The panel."""
    menus.button(ui, "Save picture", icons.ICON_FA_CAMERA, "Save", 2)
    imgui.same_line()
    menus.button(ui, "Save picture with panels", icons.ICON_FA_DISPLAY, "With panels")
    menus.button(ui, f"{Dialog.SAVE_AS.value}...", icons.ICON_FA_FLOPPY_DISK, "Save as", 2)
    imgui.same_line()
    menus.button(ui, "Copy as command", icons.ICON_FA_TERMINAL, "Copy command")
    panel_rows(ui, "Saving", 5.0, note=lambda one: f"\n{TEMPLATE_HELP}" if one.path == "screenshot_template" else "")
    paragraph("A saved picture carries scene, camera, settings and statistics: open or drop it to come back.", QUIET)


def show_dialog(ui: Ui) -> None:
    """The dialog, while it is open."""
    if Dialog.SAVE_AS not in ui.dialogs:
        return
    shown, done = begin_modal(TITLE, 27.0)
    if not shown:
        return
    pictures = ui.controller.pictures
    with properties("plan", 8.0) as rows:
        if rows:
            plan_rows(ui, pictures.plan, "multiple", "samples", "ending")
            if pictures.plan.ending != exr.ENDING:
                plan_rows(ui, pictures.plan, "legend", "caption")
                tooltip(TEMPLATE_HELP)
    imgui.spacing()
    width, height = pictures.size
    paragraph(f"{width} x {height} pixels, into {ui.controller.preferences.picture_folder}", QUIET)
    imgui.spacing()
    if imgui.button("Save", ImVec2(em(6.0), 0.0)):
        done = pictures.save() or done
    imgui.same_line()
    done = imgui.button("Cancel", ImVec2(em(6.0), 0.0)) or done
    if done:
        ui.close(Dialog.SAVE_AS)
        imgui.close_current_popup()
    imgui.end_popup()


# --- films --------------------------------------------------------------------------------------------

_WIDE = 42.0  # ems of a panel that has room for its three parts side by side


def show_film(ui: Ui) -> None:
    """The panel Film: along what, what the pictures are like, and the button with what comes of it."""
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
    with properties("way", 4.0) as shown:
        if not shown:
            return
        row("Along", "The frames of the animation, or a flight through the bookmarks at an even speed.")
        ways = (False, "path", ""), (True, f"bookmarks ({marks})###bookmarks", "")
        plan.through_bookmarks = one_of(ways, plan.through_bookmarks)
        if not plan.through_bookmarks:
            frames_row(ui, plan, "First and last frame of the animation.")
            row("Camera", "The scene's own camera, or the one in the picture now, which stays where it is.")
            plan.from_here = one_of(((False, "own", ""), (True, "as here", "")), plan.from_here)
        plan_rows(ui, plan, "seconds", "fps")


def _looks(ui: Ui, films: Films) -> None:
    """The size and the quality of the pictures, and what is on them."""
    with properties("looks", 7.6) as shown:
        if shown:
            plan_rows(ui, films.plan, "size", "samples", "video", "legend", "caption")
            tooltip(TEMPLATE_HELP)


def _start(ui: Ui, films: Films) -> None:
    """The button, and what the film will be."""
    film, plan, session = films.film, films.plan, ui.controller.session
    start_or_progress(ui, film, films.start, "Trace and write every frame")
    if film is not None and not film.done:
        paragraph(f"to {film.output}", QUIET)
    elif films.count:
        what = f"method {title_of(session.settings.method)}, view {session.draw.view.label}"
        paragraph(f"{films.count} frames, {duration(films.count / plan.fps)}; {what}", QUIET)
    else:
        paragraph(f"A flight needs two bookmarks at least{ui.key('Add bookmark')}.", WARNING)
