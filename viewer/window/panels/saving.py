"""Saving pictures: now, where to, and under which name."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.window.commands import copy_command
from viewer.window.ui import CaptureKind, Dialog, Ui
from viewer.window.widgets import QUIET, checkbox, paragraph, properties, row, tooltip, wide_button


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
    tip = "where the view has one; the picture with panels shows what the window shows"
    checkbox("With legend", p.legend_in_pictures, lambda on: setattr(p, "legend_in_pictures", on), tip)
    tip = "the sentence and the bar, above the picture"
    checkbox("With what culling saves", p.savings_in_pictures, lambda on: setattr(p, "savings_in_pictures", on), tip)
    paragraph("A saved picture carries scene, camera, settings and statistics: open or drop it to come back.", QUIET)
