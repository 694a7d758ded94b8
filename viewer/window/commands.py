"""The commands of the menus, from which keys, their list and the palette are made as well; scenes to open and presets
join them in `App._menus`.

Commands of the camera, bookmarks and time are in `panels.camera`, of comparing in `panels.compare`, of edits in
`panels.what_if`."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from imgui_bundle import hello_imgui, imgui

from tracer.method import Kind, Method, additions, bases
from tracer.scene.meshes import MESH_EXTENSIONS
from tracer.scene.studio import TURNS, up_in_studio
from viewer.services.questions import Question
from viewer.state.draw_options import NEUTRAL, brighter
from viewer.state.methods import about, toggled, with_base
from viewer.state.pixels import FIT, MOST, STEP
from viewer.state.preferences import SCALES
from viewer.state.views import View
from viewer.util import resources
from viewer.window.command import Command, Condition, scene_open
from viewer.window.layout import WORKSPACES, Workspace
from viewer.window.panels import paper, rays, what_if
from viewer.window.panels.camera import camera_commands, time_commands
from viewer.window.panels.compare import compare_commands
from viewer.window.panels.find import FindState
from viewer.window.panels.pixels import zoom_by
from viewer.window.panels.view import step_slice
from viewer.window.setting_rows import setting_command
from viewer.window.ui import CaptureKind, Dialog, Ui

_STOPS = 0.5  # of exposure by a key
_ABOUT = """A ray tracer that remembers its shadows.

Shadow results are kept on each primitive and reused in later frames, so that most shadow rays need not be traced: \
Nah, Lee, Park and Han, A Shadow Culling Algorithm for Interactive Ray Tracing."""


def build(ui: Ui) -> list[Command]:
    """Return all commands, in the order of the menus."""
    menus = (_file, _edit, _view, _interface, _picture, compare_commands, camera_commands, time_commands, _culling,
             _run, _help)  # fmt: skip
    return [command for menu in menus for command in menu(ui)]


def _file(ui: Ui) -> list[Command]:
    c, loader = ui.controller, ui.controller.loader
    there = Condition(lambda: c.frame is not None, "there is no picture yet")

    def want(kind: CaptureKind) -> None:
        ui.capture_wanted = kind

    def copy_command() -> None:
        if (words := c.pictures.command()) is not None:
            imgui.set_clipboard_text(words)

    def up() -> str | None:
        return up_in_studio(c.session.scene) if c.session.scene is not None else None

    def is_mesh() -> bool:
        return c.session.scene is not None and c.session.scene.path.suffix.lower() in MESH_EXTENSIONS

    def in_studio() -> bool:
        return (c.session.state.meshes if is_mesh() else loader.meshes).studio

    def toggle_studio() -> None:
        if is_mesh():
            loader.read_as(replace(c.session.state.meshes, studio=not in_studio()))
        else:
            loader.meshes = replace(loader.meshes, studio=not in_studio())

    def turn() -> None:
        if (now := up()) is not None:
            loader.read_as(replace(c.session.state.meshes, up=TURNS[(TURNS.index(now) + 1) % len(TURNS)]))

    stands = Condition(lambda: loader.load_job is None and up() is not None,
                       "no model is in a studio, or one is being loaded")  # fmt: skip
    return [
        Command("Open...", "File", lambda: ui.open(Dialog.OPEN_FILE), "Ctrl+O", also="scene"),
        Command("Reload", "File", loader.reload, "F5", enabled=scene_open(c)),
        setting_command(ui, "watch_scene", "File"),
        Command("Studio", "File", toggle_studio, checked=in_studio, separated=True,
                tip="a floor, three lamps and an upright view for a mesh that brings neither camera nor lights"),
        Command("Turn the model", "File", turn, "Ctrl+U", enabled=stands,
                tip="another axis points up: y, z, x, -y, -z, -x in turn"),
        Command("Save picture", "File", partial(want, CaptureKind.PICTURE), "F12", separated=True, also="screenshot",
                tip="the picture alone"),
        Command("Save picture with panels", "File", partial(want, CaptureKind.WINDOW), "Shift+F12",
                tip="the whole window"),
        Command(f"{Dialog.SAVE_AS.value}...", "File", lambda: ui.open(Dialog.SAVE_AS), "Ctrl+S", enabled=there,
                tip="larger, with a caption, or as EXR"),
        Command("Copy picture", "File", partial(want, CaptureKind.CLIPBOARD), "Ctrl+C", enabled=there, separated=True),
        Command("Copy as command", "File", copy_command, "Ctrl+Alt+C", enabled=there,
                tip="the command that makes this picture, to the clipboard"),
        Command("Send to tev", "File", lambda: c.pictures.to_tev(c.frame), enabled=there,
                tip="the frame and its buffers, to tev or HDRView; the panel Saving says where it listens"),
        Command("Reset settings...", "File", lambda: c.questions.before_resetting(c.settings.reset), separated=True),
        Command("Quit", "File", lambda: ui.exit(), "Ctrl+Q", separated=True),
    ]  # fmt: skip


def _edit(ui: Ui) -> list[Command]:
    undo = ui.controller.undo
    return [
        Command("Undo", "Edit", undo.undo, "Ctrl+Z", repeats=True, title=lambda: f"Undo {undo.undoes}".rstrip(),
                tip=partial(undo.details, 0),
                enabled=Condition(lambda: bool(undo.undoes), "there is nothing to undo")),
        Command("Redo", "Edit", undo.redo, "Ctrl+Shift+Z", repeats=True, title=lambda: f"Redo {undo.redoes}".rstrip(),
                tip=partial(undo.details, 1),
                enabled=Condition(lambda: bool(undo.redoes), "there is nothing to redo"), other_keys=("Ctrl+Y",)),
        Command(Dialog.PALETTE.value, "Edit", lambda: ui.open(Dialog.PALETTE), "Ctrl+Shift+P", separated=True,
                tip="finds commands, settings, scenes, bookmarks and presets as you type"),
        Command(f"{Dialog.PRESETS.value}...", "Edit/Presets", lambda: ui.toggle(Dialog.PRESETS),
                checked=lambda: Dialog.PRESETS in ui.dialogs,
                tip="save the settings under a name; rename and delete presets"),
        *what_if.commands(ui),
    ]  # fmt: skip


def _view(ui: Ui) -> list[Command]:
    c, views = ui.controller, list(View)
    lit = Condition(
        lambda: c.session.scene is not None and len(c.session.scene.lights) > 1, "the scene has no other light"
    )
    sliced = Condition(lambda: c.scheduler.drawn_view.has_slice, "choose the view Voxels")

    def show(view: View) -> Command:
        return Command(view.label, "View", lambda: c.session.set_draw(view=view), view.key, also=view.declared.also,
                       tip=view.help, checked=lambda: c.session.draw.view is view)  # fmt: skip

    def another(step: int) -> None:
        c.session.set_draw(view=views[(views.index(c.session.draw.view) + step) % len(views)])

    def light(step: int) -> None:
        c.settings.set_light(c.session.draw.light + step)

    def find() -> None:
        ui.show_panel("Find")
        ui.state(FindState).focus = True

    return [
        *[show(view) for view in views],
        Command("Next view", "View", partial(another, 1)),
        Command("Previous view", "View", partial(another, -1)),
        Command("Next light", "View", partial(light, 1), "L", enabled=lit, separated=True),
        Command("Previous light", "View", partial(light, -1), "Shift+L", enabled=lit),
        Command("Next layer of the slice", "View", partial(step_slice, ui, 1), "Shift+RightBracket", enabled=sliced,
                separated=True, repeats=True),
        Command("Previous layer of the slice", "View", partial(step_slice, ui, -1), "Shift+LeftBracket",
                enabled=sliced, repeats=True),
        setting_command(ui, "savings", "View", "Shift+B", separated=True),
        setting_command(ui, "draw.legend", "View", "N"),
        setting_command(ui, "draw.outlines", "View", "B"),
        setting_command(ui, "draw.mark_wrong", "View", "M"),
        setting_command(ui, "draw.shares", "View", "U"),
        Command("Rays of the clicked pixel", "View", partial(rays.show_rays, ui), "X", separated=True, also="why",
                tip="what became of each of its rays, and why, in the Inspector"),
        Command("Find objects and primitives", "View", find, "Ctrl+F",
                tip="a table of all, with modes, pixels, rays saved and wrong answers"),
        setting_command(ui, "draw.rays", "View", "I"),
        setting_command(ui, "draw.smooth", "View"),
    ]  # fmt: skip


def _interface(ui: Ui) -> list[Command]:
    """The second half of the menu View: the theme, and what else is the window's own."""
    p = ui.controller.preferences

    def size(steps: int) -> None:
        nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - p.ui_scale))
        p.ui_scale = SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)] if steps else 1.0
        ui.controller.notices.say(f"interface at {100.0 * p.ui_scale:.0f} %")

    def flip(owner: object, name: str) -> None:
        setattr(owner, name, not getattr(owner, name))

    def other_theme() -> None:
        p.theme = "dark" if p.theme == "light" else "light"

    def workspace(one: Workspace, key: str) -> Command:
        return Command(one.name, "View", partial(hello_imgui.switch_layout, one.name), key, tip=one.help,
                       checked=lambda: ui.workspace == one.name,
                       separated=one is WORKSPACES[0])  # fmt: skip

    largest = Condition(lambda: p.ui_scale < SCALES[-1], "the interface is at its largest")
    smallest = Condition(lambda: p.ui_scale > SCALES[0], "the interface is at its smallest")
    return [
        Command("Light theme", "View", other_theme, checked=lambda: p.theme == "light", separated=True),
        Command("Larger interface", "View", partial(size, 1), "Ctrl+Equal", enabled=largest,
                other_keys=("Ctrl+Shift+Equal", "Ctrl+KeypadAdd")),
        Command("Smaller interface", "View", partial(size, -1), "Ctrl+Minus", enabled=smallest,
                other_keys=("Ctrl+KeypadSubtract",)),
        Command("Interface at 100 %", "View", partial(size, 0), "Ctrl+0", other_keys=("Ctrl+Keypad0",)),
        Command("Hide panels", "View", partial(flip, ui, "panels_hidden"), "Tab", separated=True,
                checked=lambda: ui.panels_hidden),
        Command("Full screen", "View", partial(flip, ui.full_screen, "wanted"), "F11",
                checked=lambda: ui.full_screen.wanted),
        *[workspace(one, key) for one, key in zip(WORKSPACES, ("F2", "F3", "F4"))],
        Command("Default layout", "View", lambda: ui.reset_layout(), tip="the panels of this workspace as they were"),
    ]  # fmt: skip


def _picture(ui: Ui) -> list[Command]:
    """Zoom and values of pixels, exposure and what is clipped."""
    session = ui.controller.session

    def expose(stops: float) -> None:
        session.set_draw(tone=brighter(session.draw.tone, stops))
        ui.controller.notices.say(f"exposure {session.draw.tone.exposure:+.3g} EV")

    larger = Condition(lambda: session.draw.zoom.scale < MOST, f"{MOST:.0f} times is the largest zoom")
    enlarged = Condition(lambda: not session.draw.zoom.fits, "the whole picture is shown")
    toned = Condition(lambda: not session.draw.tone.neutral, "colours are shown as traced")
    return [
        Command("Zoom in", "Picture", partial(zoom_by, ui, STEP), "Equal", repeats=True,
                enabled=larger, other_keys=("Shift+Equal", "KeypadAdd")),
        Command("Zoom out", "Picture", partial(zoom_by, ui, 1.0 / STEP), "Minus", repeats=True,
                enabled=enlarged, other_keys=("KeypadSubtract",)),
        Command("Fit picture", "Picture", lambda: session.set_draw(zoom=FIT), "Shift+F", enabled=enlarged),
        setting_command(ui, "pixel_values", "Picture", separated=True),
        Command("Brighter", "Picture", partial(expose, _STOPS), "RightBracket", repeats=True, separated=True),
        Command("Darker", "Picture", partial(expose, -_STOPS), "LeftBracket", repeats=True),
        Command("Colours as traced", "Picture", lambda: session.set_draw(tone=NEUTRAL), enabled=toned,
                tip="reset exposure, white and tone curve"),
        setting_command(ui, "draw.clipping", "Picture", "Shift+M"),
    ]  # fmt: skip


def _culling(ui: Ui) -> list[Command]:
    """The methods, and what they have learnt."""
    c = ui.controller

    def method() -> Method:
        return Method.parse(c.session.settings.method)

    def change(combine: Callable[[str, str], str], name: str) -> None:
        c.settings.change(method=combine(c.session.settings.method, name))

    def base(kind: Kind) -> Command:
        return Command(f"Method {kind.name}", "Culling", partial(change, with_base, kind.name), tip=about(kind),
                       title=f"Method {kind.title}", checked=lambda: method().kind is kind)  # fmt: skip

    def addition(kind: Kind) -> Command:
        fits = Condition(lambda: method().kind is not kind, "it is the chosen method")
        return Command(f"Method +{kind.name}", "Culling", partial(change, toggled, kind.name), tip=about(kind),
                       title=f"Method {kind.plus}", checked=lambda: method().has(kind.name), enabled=fits)  # fmt: skip

    return [
        *map(base, bases()),
        *map(addition, additions()),
        Command("Shadow culling", "Culling", c.settings.toggle_culling, "C", checked=lambda: method().culls,
                separated=True, tip="off, every shadow ray is traced; on again, by the method that was chosen"),
        setting_command(ui, "settings.symmetric", "Culling", "Y"),
        setting_command(ui, "settings.verify", "Culling", "V"),
        Command("Reset modes", "Culling", c.reset_modes, "Backspace", separated=True,
                tip="forget all modes and certificates"),
        Command("Trace again", "Culling", c.scheduler.trace_again, "T",
                tip="trace the same frame once more, with what is known after the last one"),
        setting_command(ui, "pace.keep_tracing", "Culling", "K"),
        *paper.commands(ui),
    ]  # fmt: skip


def _run(ui: Ui) -> list[Command]:
    c, runs = ui.controller, ui.controller.runs

    def start(panel: str, begin: Callable[[], None] = lambda: None) -> None:
        ui.show_panel(panel)
        begin()

    def stop() -> None:
        if c.loader.load_job is not None:
            c.loader.cancel()
        elif runs.current is not None:
            runs.stop()
        else:
            c.selection.clear()

    idle = Condition(
        lambda: c.session.scene is not None and runs.current is None, "no scene is open, or a run is in progress"
    )
    wrong = Condition(
        lambda: runs.current is None and c.shrinking.offers, "no wrong pixel is clicked, or a run is in progress"
    )
    busy = Condition(
        lambda: c.loader.load_job is not None or runs.current is not None or c.selection.picked is not None,
        "nothing is running, and nothing is selected",
    )
    return [
        Command("Start experiment", "Run", partial(start, "Experiment", runs.start_experiment), enabled=idle,
                tip="methods compared along the path: faster or not, and how much is saved"),
        Command("Start zoom test", "Run", partial(start, "Zoom test", runs.start_zoom_test), enabled=idle,
                tip="towards the clicked primitive: is a shadow missing that shows only from near?"),
        Command("Start hunt", "Run", partial(start, "Hunt", c.runs.start_hunt), enabled=idle, also="wrong",
                tip="search the path for the worst wrong pixels of a method"),
        Command("Shrink the wrong pixel", "Run", c.shrinking.start, enabled=wrong, also="minimal",
                tip="the few triangles, lights and frames that it takes, with a figure and a test, into a folder"),
        Command("Film...", "Run", partial(start, "Film"), enabled=idle,
                tip="a path, or a flight through bookmarks, as pictures and video"),
        Command("Table 1", "Run", partial(start, "Experiment", ui.figures.table_1), enabled=idle, separated=True,
                tip="the paper's table for the open scene: 512 x 512, 10 bounces, 100 frames"),
        Command("Figure 3", "Run", partial(start, "View", ui.figures.figure_3), enabled=idle,
                tip="the paper's example of an occlusion that the test misses"),
        Command("Figure 4", "Run", partial(start, "Zoom test", ui.figures.figure_4), enabled=idle,
                tip="the paper's example of a shadow that shows only from near, and of the zoom factor"),
        Command("Stop, or clear the selection", "Run", stop, "Escape", enabled=busy, separated=True),
    ]  # fmt: skip


def _help(ui: Ui) -> list[Command]:
    def read(page: str) -> None:
        file = resources.documentation(page)
        asked = file is not None and webbrowser.open(file.as_uri())
        where = file or f"docs/{page}.md of the program's source"
        ui.controller.notices.say(f"{'the desktop was asked to open' if asked else 'the documentation is in'} {where}")

    def about() -> None:
        text = f"{_ABOUT}\n\nDrawn by {ui.graphics.renderer_name}"
        ui.controller.questions.question = Question("About Shadowcull", text, (("Close", lambda: None),))

    return [
        Command("Tour", "Help", lambda: (ui.tour.end if ui.tour.step else ui.tour.start)(),
                checked=lambda: ui.tour.step is not None),
        Command(Dialog.KEYS.value, "Help", lambda: ui.toggle(Dialog.KEYS), "F1", also="keys shortcuts",
                checked=lambda: Dialog.KEYS in ui.dialogs),
        Command("Documentation", "Help", partial(read, "index"), also="manual docs", tip="in the web browser"),
        Command("Glossary", "Help", partial(read, "glossary"), tip="the words of the paper and ours"),
        Command("Scenes", "Help", partial(read, "scenes"), also="bart kitchen robot museum",
                tip="which files are read, and where BART's scenes are to be had"),
        Command("About Shadowcull", "Help", about),
    ]  # fmt: skip
