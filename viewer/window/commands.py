"""Every action, once: the menus, the list of keys, the palette and the handling of keys are all made from this list."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from tracer.scene.meshes import MESH_EXTENSIONS
from tracer.scene.studio import TURNS, up_in_studio
from viewer.window.camera_commands import camera, time
from viewer.window.command import Command, Condition, scene_open, switch
from viewer.window.panels import what_if
from viewer.window.picture_commands import comparing, copy_command, looking
from viewer.window.ui import CaptureKind, Dialog, Ui
from viewer.window.view_commands import culling, view


def build(ui: Ui) -> list[Command]:
    """All commands, in the order of the menus."""
    menus = _file, _edit, view, looking, comparing, camera, time, culling, _run, _help
    return [command for menu in menus for command in menu(ui)]


def _file(ui: Ui) -> list[Command]:
    c, p = ui.controller, ui.controller.preferences
    there = Condition(lambda: c.frame is not None, "there is no picture yet")

    def want(kind: CaptureKind) -> Callable[[], None]:
        return lambda: setattr(ui, "capture_wanted", kind)

    return [
        Command("Open...", "File", lambda: ui.open(Dialog.OPEN_FILE), "Ctrl+O"),
        Command("Reload", "File", c.loader.reload, "F5", enabled=scene_open(c)),
        switch("Reload when files change", "File", p, "watch_scene",
               tip="the scene, and what it includes: textures, materials, meshes"),
        *_meshes(ui),
        Command("Save picture", "File", want(CaptureKind.PICTURE), "F12", separated=True),
        Command("Save picture with panels", "File", want(CaptureKind.WINDOW), "Shift+F12"),
        Command("Save picture as...", "File", lambda: ui.open(Dialog.SAVE_AS), "Ctrl+S", enabled=there),
        Command("Copy picture", "File", want(CaptureKind.CLIPBOARD), "Ctrl+C", enabled=there, separated=True),
        Command("Copy as command", "File", lambda: copy_command(ui), "Ctrl+Alt+C", enabled=there,
                tip="the command that makes this picture, to the clipboard"),
        Command("Send to tev", "File", lambda: c.pictures.to_tev(c.frame), enabled=there,
                tip="the frame and its buffers, to tev or HDRView; the panel Saving says where it listens"),
        switch("Start where I left off", "File", p, "start_where_left", separated=True),
        Command("Reset settings...", "File", lambda: c.questions.before_resetting(c.settings.reset)),
        Command("Quit", "File", lambda: ui.desktop.exit(), "Ctrl+Q", separated=True),
    ]  # fmt: skip


def _edit(ui: Ui) -> list[Command]:
    undo = ui.controller.undo
    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command("Command palette", "Edit", lambda: ui.open(Dialog.PALETTE), "Ctrl+Shift+P",
                separated=True, while_typing=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command("Presets...", "Edit/Presets", lambda: ui.toggle(Dialog.PRESETS),
                checked=lambda: Dialog.PRESETS in ui.dialogs,
                tip="save the settings under a name; rename and delete presets"),
        *what_if.commands(ui),
    ]  # fmt: skip


def _meshes(ui: Ui) -> list[Command]:
    """Of models that come alone, without camera and lights: their studio, and which way is up."""
    c, loader = ui.controller, ui.controller.loader

    def shown_up() -> str | None:
        return up_in_studio(c.session.scene) if c.session.scene is not None else None

    def is_mesh() -> bool:
        return c.session.scene is not None and c.session.scene.path.suffix.lower() in MESH_EXTENSIONS

    def wanted() -> bool:
        return c.session.meshes.studio if is_mesh() else loader.meshes.studio

    def toggle() -> None:
        if is_mesh():
            loader.read_as(replace(c.session.meshes, studio=not wanted()))
        else:
            loader.meshes = replace(loader.meshes, studio=not wanted())

    def turn() -> None:
        up = shown_up()
        if up is not None:
            following = TURNS[(TURNS.index(up) + 1) % len(TURNS)]
            loader.read_as(replace(c.session.meshes, up=following))

    stands = Condition(
        lambda: loader.load_job is None and shown_up() is not None, "no model is in a studio, or one is being loaded"
    )
    return [
        Command("Studio", "File", toggle, checked=wanted, separated=True,
                tip="a floor, three lamps and an upright view for a mesh that brings neither camera nor lights"),
        Command("Turn the model", "File", turn, "Ctrl+U", enabled=stands,
                tip="another axis points up: y, z, x, -y, -z, -x in turn"),
    ]  # fmt: skip


def _run(ui: Ui) -> list[Command]:
    c, runner = ui.controller, ui.controller.runs

    def start(panel: str, begin: Callable[[], None]) -> Callable[[], None]:
        def run() -> None:
            ui.show_panel(panel)
            begin()

        return run

    def stop() -> None:
        if c.loader.load_job is not None:
            c.loader.cancel()
        elif runner.current is not None:
            runner.stop()
        else:
            c.selection.picked = None

    idle = Condition(
        lambda: c.session.scene is not None and runner.current is None, "no scene is open, or a run is in progress"
    )
    busy = Condition(
        lambda: c.loader.load_job is not None or runner.current is not None or c.selection.picked is not None,
        "nothing is running, and nothing is selected",
    )
    return [
        Command("Experiment", "Run", start("Experiment", runner.start_experiment), enabled=idle),
        Command("Zoom test", "Run", start("Zoom test", runner.start_zoom_test), enabled=idle),
        Command("Hunt", "Run", start("Hunt", c.hunts.start), enabled=idle,
                tip="search the path for the worst wrong pixels of a method"),
        Command("Film", "Run", lambda: ui.show_panel("Film"), enabled=idle,
                tip="a path, or a flight through bookmarks, as pictures and video"),
        Command("Stop, or clear the selection", "Run", stop, "Escape", enabled=busy, separated=True),
    ]  # fmt: skip


def _help(ui: Ui) -> list[Command]:
    def tour() -> None:
        (ui.tour.start if ui.tour.step is None else ui.tour.end)()

    def dialog(which: Dialog, key: str = "", also: str = "") -> Command:
        return Command(which.value, "Help", lambda: ui.toggle(which), key, lambda: which in ui.dialogs, also=also)

    return [
        Command("Tour", "Help", tour, checked=lambda: ui.tour.step is not None),
        dialog(Dialog.KEYS, "F1", "keys shortcuts"),
        dialog(Dialog.ABOUT),
        Command("Restart graphics", "Help", lambda: ui.desktop.restart_graphics(), separated=True,
                tip="for broken pictures or letters, as after sleep: a new window is made, nothing is lost"),
    ]  # fmt: skip
