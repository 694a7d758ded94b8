"""Every action, once: the menus, the list of keys, the palette and the handling of keys are all made from this list."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from tracer.method import Kind, Method, additions, bases
from tracer.scene.meshes import MESH_EXTENSIONS
from tracer.scene.studio import TURNS, up_in_studio
from viewer.state.comparison import CompareMode
from viewer.state.draw_options import NEUTRAL, brighter
from viewer.state.methods import toggled, with_base
from viewer.state.pixels import MOST, STEP
from viewer.state.preferences import SCALES
from viewer.state.views import View
from viewer.views import view_of
from viewer.window.command import Command, Condition, scene_open, switch
from viewer.window.panels import what_if
from viewer.window.panels.camera import camera_commands, time_commands
from viewer.window.panels.find import FindState
from viewer.window.panels.pixels import fit, pointed_at, zoom_by
from viewer.window.panels.saving import copy_command
from viewer.window.setting_rows import setting_command
from viewer.window.ui import CaptureKind, Dialog, Ui

_STOPS = 0.5  # of exposure by a key


def build(ui: Ui) -> list[Command]:
    """Return all commands, in the order of the menus."""
    menus = (_file, _edit, _view, _picture, _compare, camera_commands, time_commands, _culling, _run, _help)
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
        *_models(ui),
        Command("Save picture", "File", want(CaptureKind.PICTURE), "F12", separated=True),
        Command("Save picture with panels", "File", want(CaptureKind.WINDOW), "Shift+F12"),
        Command("Save picture as...", "File", lambda: ui.open(Dialog.SAVE_AS), "Ctrl+S", enabled=there),
        Command("Copy picture", "File", want(CaptureKind.CLIPBOARD), "Ctrl+C", enabled=there, separated=True),
        Command("Copy as command", "File", lambda: copy_command(ui), "Ctrl+Alt+C", enabled=there,
                tip="the command that makes this picture, to the clipboard"),
        Command("Send to tev", "File", lambda: c.pictures.to_tev(c.frame), enabled=there,
                tip="the frame and its buffers, to tev or HDRView; the panel Saving says where it listens"),
        Command("Reset settings...", "File", lambda: c.questions.before_resetting(c.settings.reset), separated=True),
        Command("Quit", "File", lambda: ui.desktop.exit(), "Ctrl+Q", separated=True),
    ]  # fmt: skip


def _edit(ui: Ui) -> list[Command]:
    undo = ui.controller.undo
    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command("Command palette", "Edit", lambda: ui.open(Dialog.PALETTE), "Ctrl+Shift+P", separated=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command("Presets...", "Edit/Presets", lambda: ui.toggle(Dialog.PRESETS),
                checked=lambda: Dialog.PRESETS in ui.dialogs,
                tip="save the settings under a name; rename and delete presets"),
        *what_if.commands(ui),
    ]  # fmt: skip


def _models(ui: Ui) -> list[Command]:
    """Of models that come alone, without camera and lights: their studio, and which way is up."""
    session, loader = ui.controller.session, ui.controller.loader

    def shown_up() -> str | None:
        return up_in_studio(session.scene) if session.scene is not None else None

    def is_mesh() -> bool:
        return session.scene is not None and session.scene.path.suffix.lower() in MESH_EXTENSIONS

    def in_studio() -> bool:
        return (session.state.meshes if is_mesh() else loader.meshes).studio

    def toggle() -> None:
        if is_mesh():
            loader.read_as(replace(session.state.meshes, studio=not in_studio()))
        else:
            loader.meshes = replace(loader.meshes, studio=not in_studio())

    def turn() -> None:
        up = shown_up()
        if up is not None:
            loader.read_as(replace(session.state.meshes, up=TURNS[(TURNS.index(up) + 1) % len(TURNS)]))

    stands = Condition(
        lambda: loader.load_job is None and shown_up() is not None, "no model is in a studio, or one is being loaded"
    )
    return [
        Command("Studio", "File", toggle, checked=in_studio, separated=True,
                tip="a floor, three lamps and an upright view for a mesh that brings neither camera nor lights"),
        Command("Turn the model", "File", turn, "Ctrl+U", enabled=stands,
                tip="another axis points up: y, z, x, -y, -z, -x in turn"),
    ]  # fmt: skip


def _view(ui: Ui) -> list[Command]:
    c, p = ui.controller, ui.controller.preferences
    views = list(View)
    lit = Condition(
        lambda: c.session.scene is not None and len(c.session.scene.lights) > 1, "the scene has no other light"
    )

    def show(view: View) -> Command:
        return Command(view.label, "View", lambda: c.session.set_draw(view=view), view.key, also=view.declared.also,
                       checked=lambda: c.session.draw.view is view)  # fmt: skip

    def another(step: int) -> Callable[[], None]:
        return lambda: c.session.set_draw(view=views[(views.index(c.session.draw.view) + step) % len(views)])

    def light(step: int) -> Callable[[], None]:
        return lambda: c.settings.set_light(c.session.draw.light + step)

    def find() -> None:
        ui.show_panel("Find")
        ui.state(FindState).focus = True

    return [
        *[show(view) for view in views],
        Command("Next view", "View", another(1)),
        Command("Previous view", "View", another(-1)),
        Command("Next light", "View", light(1), "L", enabled=lit, separated=True),
        Command("Previous light", "View", light(-1), "Shift+L", enabled=lit),
        *_slice(ui),
        switch("What culling saves", "View", p, "savings", "Shift+B", separated=True,
               tip="one sentence above the picture, and a bar of the shadow rays by what became of them"),
        setting_command(ui, "draw.legend", "View", "N"),
        setting_command(ui, "draw.outlines", "View", "B"),
        setting_command(ui, "draw.mark_wrong", "View", "M"),
        setting_command(ui, "draw.shares", "View", "U"),
        Command("Rays of the clicked pixel", "View", ui.show_rays, "X", separated=True),
        Command("Find objects and primitives", "View", find, "Ctrl+F",
                tip="a table of all, with modes, pixels, rays saved and wrong answers"),
        setting_command(ui, "draw.rays", "View", "I"),
        setting_command(ui, "draw.smooth", "View"),
        *_interface(ui),
        switch("Hide panels", "View", ui, "panels_hidden", "Tab", separated=True),
        switch("Full screen", "View", ui.full_screen, "wanted", "F11"),
        Command("Default layout", "View", lambda: ui.desktop.reset_layout()),
    ]  # fmt: skip


def _slice(ui: Ui) -> list[Command]:
    """What methods keep of space: the slice through it."""
    c, s = ui.controller, ui.controller.session
    sliced = Condition(lambda: c.scheduler.drawn_view.has_slice, "choose the view Voxels or Tree built")

    def step(layers: int) -> Callable[[], None]:
        def go() -> None:
            cut = s.draw.slice
            many = view_of(s.draw.view).layers(c.frame, cut.axis) if c.frame is not None else 0
            if many:
                s.set_draw(slice=cut.in_layer(cut.layer(many) + layers, many))

        return go

    return [
        Command("Next layer of the slice", "View", step(1), "Shift+RightBracket", enabled=sliced, separated=True,
                repeats=True),
        Command("Previous layer of the slice", "View", step(-1), "Shift+LeftBracket", enabled=sliced, repeats=True),
    ]  # fmt: skip


def _interface(ui: Ui) -> list[Command]:
    """The theme, and the size of the interface."""
    p = ui.controller.preferences

    def sized(steps: int) -> Callable[[], None]:
        def change() -> None:
            nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - p.ui_scale))
            p.ui_scale = SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)] if steps else 1.0
            ui.controller.notices.say(f"interface at {100.0 * p.ui_scale:.0f} %")

        return change

    def other_theme() -> None:
        p.theme = "dark" if p.theme == "light" else "light"

    largest = Condition(lambda: p.ui_scale < SCALES[-1], "the interface is at its largest")
    smallest = Condition(lambda: p.ui_scale > SCALES[0], "the interface is at its smallest")
    return [
        Command("Light theme", "View", other_theme, checked=lambda: p.theme == "light", separated=True),
        Command("Larger interface", "View", sized(1), "Ctrl+Equal", enabled=largest,
                other_keys=("Ctrl+Shift+Equal", "Ctrl+KeypadAdd")),
        Command("Smaller interface", "View", sized(-1), "Ctrl+Minus", enabled=smallest,
                other_keys=("Ctrl+KeypadSubtract",)),
        Command("Interface at 100 %", "View", sized(0), "Ctrl+0", other_keys=("Ctrl+Keypad0",)),
    ]  # fmt: skip


def _picture(ui: Ui) -> list[Command]:
    """Zoom and values of pixels, exposure and what is clipped."""
    session, p = ui.controller.session, ui.controller.preferences

    def expose(stops: float) -> Callable[[], None]:
        def change() -> None:
            session.set_draw(tone=brighter(session.draw.tone, stops))
            ui.controller.notices.say(f"exposure {session.draw.tone.exposure:+.3g} EV")

        return change

    larger = Condition(lambda: session.draw.zoom.scale < MOST, f"{MOST:.0f} times is the largest zoom")
    enlarged = Condition(lambda: not session.draw.zoom.fits, "the whole picture is shown")
    toned = Condition(lambda: not session.draw.tone.neutral, "colours are shown as traced")
    return [
        Command("Zoom in", "Picture", lambda: zoom_by(ui, STEP, pointed_at(ui)), "Equal", repeats=True,
                enabled=larger, other_keys=("Shift+Equal", "KeypadAdd")),
        Command("Zoom out", "Picture", lambda: zoom_by(ui, 1.0 / STEP, pointed_at(ui)), "Minus", repeats=True,
                enabled=enlarged, other_keys=("KeypadSubtract",)),
        Command("Fit picture", "Picture", lambda: fit(ui), "Shift+F", enabled=enlarged),
        switch("Values in pixels", "Picture", p, "pixel_values", separated=True),
        Command("Brighter", "Picture", expose(_STOPS), "RightBracket", repeats=True, separated=True),
        Command("Darker", "Picture", expose(-_STOPS), "LeftBracket", repeats=True),
        Command("Colours as traced", "Picture", lambda: session.set_draw(tone=NEUTRAL), enabled=toned),
        setting_command(ui, "draw.clipping", "Picture", "Shift+M"),
    ]  # fmt: skip


def _compare(ui: Ui) -> list[Command]:
    comparing = ui.controller.comparing
    there = Condition(lambda: comparing.b is not None, "there is no picture yet")
    kept = Condition(lambda: comparing.kept is not None, "nothing is kept as A")

    def keep() -> None:
        comparing.keep()
        ui.offer_panel("Compare")

    def by(mode: CompareMode) -> Command:
        return Command(mode.command, "Compare", lambda: comparing.toggle(mode), enabled=there, tip=mode.help,
                       checked=lambda: comparing.state.on and comparing.state.mode is mode)  # fmt: skip

    return [
        Command("Keep as A", "Compare", keep, "Ctrl+A", enabled=there),
        Command("Clear A", "Compare", comparing.forget, enabled=kept),
        Command("Two methods live", "Compare", comparing.toggle_methods, "Shift+C", enabled=there,
                checked=lambda: bool(comparing.second_method),
                tip="trace each frame by a second method as well, with modes and counters of its own"),
        Command("Next compare mode", "Compare", comparing.next_mode, "Shift+Z", enabled=there, separated=True),
        *map(by, CompareMode),
        Command("B alone", "Compare", comparing.end, "Ctrl+Shift+A", checked=lambda: not comparing.state.on,
                separated=True),
    ]  # fmt: skip


def _culling(ui: Ui) -> list[Command]:
    """The methods, and what they have learnt."""
    c = ui.controller

    def method() -> Method:
        return Method.parse(c.session.settings.method)

    def base(kind: Kind) -> Command:
        def choose() -> None:
            c.settings.change(method=with_base(c.session.settings.method, kind.name))

        return Command(
            f"Method {kind.name}", "Culling", choose, checked=lambda: method().kind is kind, tip=kind.summary
        )

    def addition(kind: Kind) -> Command:
        def toggle() -> None:
            c.settings.change(method=toggled(c.session.settings.method, kind.name))

        fits = Condition(lambda: method().kind is not kind, "it is the method itself")
        return Command(f"Method +{kind.name}", "Culling", toggle, enabled=fits, tip=kind.summary,
                       checked=lambda: method().has(kind.name))  # fmt: skip

    return [
        *[base(kind) for kind in bases()],
        *[addition(kind) for kind in additions()],
        Command("Shadow culling", "Culling", c.settings.toggle_culling, "C", checked=lambda: method().culls,
                separated=True),
        setting_command(ui, "settings.symmetric", "Culling", "Y"),
        setting_command(ui, "settings.verify", "Culling", "V"),
        Command("Reset modes", "Culling", c.reset_modes, "Backspace", separated=True),
        Command("Trace again", "Culling", c.scheduler.trace_again, "T"),
        setting_command(ui, "pace.keep_tracing", "Culling", "K"),
    ]  # fmt: skip


def _run(ui: Ui) -> list[Command]:
    c, runner = ui.controller, ui.controller.runs

    def start(panel: str, begin: Callable[[], None] = lambda: None) -> Callable[[], None]:
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
            c.selection.clear()

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
        Command("Film", "Run", start("Film"), enabled=idle,
                tip="a path, or a flight through bookmarks, as pictures and video"),
        Command("Stop, or clear the selection", "Run", stop, "Escape", enabled=busy, separated=True),
    ]  # fmt: skip


def _help(ui: Ui) -> list[Command]:
    def dialog(which: Dialog, key: str = "", also: str = "") -> Command:
        return Command(which.value, "Help", lambda: ui.toggle(which), key, lambda: which in ui.dialogs, also=also)

    return [
        Command("Tour", "Help", ui.tour.toggle, checked=lambda: ui.tour.step is not None),
        dialog(Dialog.KEYS, "F1", "keys shortcuts"),
        dialog(Dialog.ABOUT),
    ]
