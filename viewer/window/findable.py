"""All that the command palette finds: commands, settings, presets, bookmarks and scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from viewer.util.resources import embedded_scenes
from viewer.window import setting_rows
from viewer.window.command import Command
from viewer.window.finder import Item, Kind
from viewer.window.ui import Ui


def items(ui: Ui) -> list[Item]:
    """Everything, as it is now; commands first, in the order of the menus."""
    return [*_commands(ui), *setting_rows.entries(ui), *_presets(ui), *_panels(ui), *_bookmarks(ui), *_scenes(ui)]


def _commands(ui: Ui) -> Iterator[Item]:
    for command in ui.commands:
        label = command.label
        if label and command.run != ui.finder.begin:
            yield Item(
                command.name,
                label,
                Kind.COMMAND,
                _running(ui, command),
                path=command.menu.replace("/", " > "),
                key=ui.keyboard.label(ui.keymap.shown(command.name)),
                checked=command.checked() if command.checked is not None else None,
                enabled=command.enabled(),
                why_not=command.why_not,
                also=f"{command.name} {command.also}",
            )


def _running(ui: Ui, command: Command) -> Callable[[], None]:
    return lambda: ui.guard.step(f"The command {command.name}", command.run)


def _presets(ui: Ui) -> Iterator[Item]:
    presets = ui.controller.presets
    for name in presets.names:
        yield Item(f"preset {name}", name, Kind.PRESET, partial(presets.apply, name), "Edit > Presets",
                   also="apply")  # fmt: skip


def _panels(ui: Ui) -> Iterator[Item]:
    for label in ui.panel_labels:
        yield Item(f"panel {label}", f"Panel {label}", Kind.COMMAND, partial(ui.show_panel, label), "Panels",
                   also="show open")  # fmt: skip


def _bookmarks(ui: Ui) -> Iterator[Item]:
    c = ui.controller
    for number, mark in enumerate(c.bookmarks.all):
        yield Item(
            f"bookmark {number}",
            mark.name,
            Kind.BOOKMARK,
            partial(c.go_to_bookmark, number),
            "go there",
        )


def _scenes(ui: Ui) -> Iterator[Item]:
    loader, own = ui.controller.loader, embedded_scenes()
    for name, path in own.items():
        yield Item(f"scene {path}", name, Kind.SCENE, partial(loader.open, path), "comes with Shadowcull",
                   also="open")  # fmt: skip
    for text in ui.controller.preferences.recent:
        path = Path(text)
        if path not in own.values():
            yield Item(f"scene {path}", path.name, Kind.SCENE, partial(loader.open, path), str(path.parent),
                       also="open recent")  # fmt: skip
