"""The commands by which pictures leave the window: to files, to the clipboard, to other programs."""

from __future__ import annotations

from imgui_bundle import imgui

from viewer.state.annotations import Kind
from viewer.window.command import Command, Condition
from viewer.window.ui import CaptureKind, Ui

_NAMES = {Kind.ARROW: "Draw an arrow", Kind.BOX: "Draw a box", Kind.TEXT: "Write on the picture"}


def copy_command(ui: Ui) -> None:
    """Put the command that makes the picture on the clipboard."""
    words = ui.controller.recipes.command()
    if words is not None:
        imgui.set_clipboard_text(words)


def choose(ui: Ui, kind: Kind) -> None:
    """Take up a tool, or lay it down."""
    ui.tool = None if ui.tool is kind else kind
    ui.drawn = None


def undo(ui: Ui) -> None:
    """Take back the last."""
    if ui.controller.session.annotations:
        ui.controller.session.annotations.pop()


def clear(ui: Ui) -> None:
    """Take back all."""
    ui.controller.session.annotations.clear()


def taking(ui: Ui) -> list[Command]:
    """What follows *Save picture* in the menu File."""
    c = ui.controller
    there = Condition(lambda: c.frame is not None, "there is no picture yet")

    def copy_picture() -> None:
        ui.capture_wanted = CaptureKind.CLIPBOARD

    def save_as() -> None:
        ui.save_as_open = True

    return [
        Command("Save picture as...", "File", save_as, "Ctrl+S", enabled=there),
        Command("Copy picture", "File", copy_picture, "Ctrl+C", enabled=there, separated=True),
        Command("Copy as command", "File", lambda: copy_command(ui), "Ctrl+Alt+C", enabled=there,
                tip="the command that makes this picture, to the clipboard"),
        Command("Send to tev", "File", lambda: c.pictures.to_tev(c.frame), enabled=there,
                tip="the frame and its buffers, to tev or HDRView; the panel Saving says where it listens"),
    ]  # fmt: skip


def drawing(ui: Ui) -> list[Command]:
    """What draws on the picture, in the menu Edit."""
    c = ui.controller
    some = Condition(lambda: bool(c.session.annotations), "nothing is drawn on the picture")

    def tool(kind: Kind) -> Command:
        chosen = lambda: ui.tool is kind  # noqa: E731
        return Command(_NAMES[kind], "Edit/Drawings", lambda: choose(ui, kind), checked=chosen)

    return [
        *[tool(kind) for kind in Kind],
        Command("Undo drawing", "Edit/Drawings", lambda: undo(ui), enabled=some),
        Command("Clear drawings", "Edit/Drawings", lambda: clear(ui), enabled=some),
    ]
