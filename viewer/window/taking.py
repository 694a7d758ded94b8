"""The commands by which pictures leave the window: to files, to the clipboard, to other programs."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.window.command import Command, Condition
from viewer.window.ui import CaptureKind, Dialog, Ui


def copy_command(ui: Ui) -> None:
    """Put the command that makes the picture on the clipboard."""
    words = ui.controller.recipes.command()
    if words is not None:
        imgui.set_clipboard_text(words)


def taking(ui: Ui) -> list[Command]:
    """What follows *Save picture* in the menu File."""
    c = ui.controller
    there = Condition(lambda: c.frame is not None, "there is no picture yet")

    def copy_picture() -> None:
        ui.capture_wanted = CaptureKind.CLIPBOARD

    return [
        Command("Save picture as...", "File", lambda: ui.open(Dialog.SAVE_AS), "Ctrl+S", enabled=there),
        Command("Copy picture", "File", copy_picture, "Ctrl+C", enabled=there, separated=True),
        Command("Copy as command", "File", lambda: copy_command(ui), "Ctrl+Alt+C", enabled=there,
                tip="the command that makes this picture, to the clipboard"),
        Command("Send to tev", "File", lambda: c.pictures.to_tev(c.frame), enabled=there,
                tip="the frame and its buffers, to tev or HDRView; the panel Saving says where it listens"),
    ]  # fmt: skip
