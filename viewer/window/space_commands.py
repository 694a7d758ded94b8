"""Commands of what methods keep of space: the slice through voxels, and what a light sees."""

from __future__ import annotations

from viewer.window.command import Command, Condition
from viewer.window.layers_of_slice import step, turn
from viewer.window.ui import Ui


def build(ui: Ui) -> list[Command]:
    """Those of the menu View."""
    sliced = Condition(
        lambda: ui.controller.tracing.drawn_view.has_slice, "no slice is shown: choose the view Voxels or Tree built"
    )
    return [
        Command("Next layer of the slice", "View", lambda: step(ui, 1), "Shift+RightBracket", enabled=sliced,
                separated=True, repeats=True),
        Command("Previous layer of the slice", "View", lambda: step(ui, -1), "Shift+LeftBracket",
                enabled=sliced, repeats=True),
        Command("Slice across another axis", "View", lambda: turn(ui), enabled=sliced),
    ]  # fmt: skip
