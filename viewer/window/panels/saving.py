"""Saving pictures: now, where to, and how named; and the dialog that saves one larger, with a caption, or as EXR."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.output import exr
from viewer.window.actions import copy_command
from viewer.window.setting_rows import in_panel, plan_rows, setting_switch
from viewer.window.ui import CaptureKind, Dialog, Ui
from viewer.window.widgets import QUIET, centred, em, paragraph, properties, row, tooltip, wide_button

NAME = "The dialog that saves a picture"
TITLE = "Save picture as"


def show(ui: Ui) -> None:
    """The panel."""
    p = ui.controller.preferences
    if wide_button(f"{icons.ICON_FA_CAMERA}  Save", f"the picture alone{ui.key('Save picture')}", 2):
        ui.capture_wanted = CaptureKind.PICTURE
    imgui.same_line()
    if wide_button(f"{icons.ICON_FA_DISPLAY}  With panels", f"the whole window{ui.key('Save picture with panels')}"):
        ui.capture_wanted = CaptureKind.WINDOW
    if wide_button(
        f"{icons.ICON_FA_FLOPPY_DISK}  Save as", f"larger, with a caption, or as EXR{ui.key('Save picture as...')}", 2
    ):
        ui.open(Dialog.SAVE_AS)
    imgui.same_line()
    if wide_button(
        f"{icons.ICON_FA_TERMINAL}  Copy command", f"the command that makes this picture{ui.key('Copy as command')}"
    ):
        copy_command(ui)
    with properties("pictures", 5.0) as shown:
        if shown:
            row("Folder", "where pictures are saved")
            hint = str(ui.default_folder)
            _, p.screenshot_folder = imgui.input_text_with_hint("##folder", hint, p.screenshot_folder)
            tooltip(p.screenshot_folder or hint)
            row("Name", "template of the file's name")
            _, p.screenshot_template = imgui.input_text("##template", p.screenshot_template)
            tooltip(ui.template_help)
            row("tev", "where tev or HDRView listens, for File, Send to tev")
            _, p.tev = imgui.input_text("##tev", p.tev)
    for one in in_panel(ui, "Saving"):
        setting_switch(ui, one)
    paragraph("A saved picture carries scene, camera, settings and statistics: open or drop it to come back.", QUIET)


def show_dialog(ui: Ui) -> None:
    """The dialog, while it is open."""
    if Dialog.SAVE_AS not in ui.dialogs:
        return
    if not imgui.is_popup_open(TITLE):
        imgui.open_popup(TITLE)
    centred(em(27.0))
    shown, stays = imgui.begin_popup_modal(TITLE, True, int(imgui.WindowFlags_.no_resize))
    if not shown:
        return
    pictures = ui.controller.pictures
    with properties("plan", 8.0) as rows:
        if rows:
            plan_rows(ui, pictures.plan, "multiple", "samples", "ending")
            if pictures.plan.ending != exr.ENDING:
                plan_rows(ui, pictures.plan, "legend", "caption")
                tooltip(ui.template_help)
    imgui.spacing()
    done = not stays or imgui.is_key_pressed(imgui.Key.escape)
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
