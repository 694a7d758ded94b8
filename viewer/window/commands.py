"""Every action, once: the menus, the list of shortcuts and the handling of keys are all made from this list."""

from __future__ import annotations

from collections.abc import Callable

from tracer.method import Kind, Method, additions, bases
from viewer.state import navigation
from viewer.state.methods import toggled, with_base
from viewer.state.picking import extent_at, point_at
from viewer.state.preferences import SCALES
from viewer.state.views import View
from viewer.window import camera_commands, edit_commands, mesh_commands, space_commands, what_if_commands
from viewer.window.closer_commands import comparing, looking
from viewer.window.command import Command, Condition
from viewer.window.finding import finding, fly_to_selected
from viewer.window.taking import taking
from viewer.window.ui import CaptureKind, Dialog, Ui


def build(ui: Ui) -> list[Command]:
    """All commands, in the order of the menus."""
    menus = (
        _file, edit_commands.build, what_if_commands.build, _view, looking, comparing, _camera, _time,
        _culling, _run, _help,
    )  # fmt: skip
    return [command for menu in menus for command in menu(ui)]


def _file(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def want(kind: CaptureKind) -> Callable[[], None]:
        def ask() -> None:
            ui.capture_wanted = kind

        return ask

    return [
        Command("Open...", "File", lambda: ui.open(Dialog.OPEN_FILE), "Ctrl+O"),
        Command("Reload", "File", c.loader.reload, "F5", enabled=_open_scene(ui)),
        Command(
            "Reload when files change",
            "File",
            lambda: setattr(p, "watch_scene", not p.watch_scene),
            checked=lambda: p.watch_scene,
            tip="the scene, and what it includes: textures, materials, meshes",
        ),
        *mesh_commands.build(ui),
        Command("Save picture", "File", want(CaptureKind.PICTURE), "F12", separated=True),
        Command("Save picture with panels", "File", want(CaptureKind.WINDOW), "Shift+F12"),
        *taking(ui),
        Command(
            "Start where I left off",
            "File",
            lambda: setattr(p, "start_where_left", not p.start_where_left),
            checked=lambda: p.start_where_left,
            separated=True,
        ),
        Command("Reset settings...", "File", lambda: c.questions.before_resetting(c.settings.reset)),
        Command("Quit", "File", lambda: ui.request_exit(), "Ctrl+Q", separated=True),
    ]


def _view(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def show(view: View) -> Command:
        return Command(
            view.label,
            "View",
            lambda: c.settings.set_view(view),
            view.key,
            checked=lambda: c.session.view is view,
            also=view.declared.also,
        )

    def toggle(name: str) -> Callable[[], None]:
        return lambda: setattr(p, name, not getattr(p, name))

    def light(step: int) -> Callable[[], None]:
        return lambda: c.settings.set_light(c.session.light + step)

    def hide() -> None:
        ui.fold.hidden = not ui.fold.hidden

    def another(step: int) -> Callable[[], None]:
        views = list(View)
        return lambda: c.settings.set_view(views[(views.index(c.session.view) + step) % len(views)])

    lit = Condition(
        lambda: c.session.scene is not None and len(c.session.scene.lights) > 1, "there are not several lights"
    )
    return [
        *[show(view) for view in View],
        Command("Next view", "View", another(1)),
        Command("Previous view", "View", another(-1)),
        Command(
            "Next light", "View", lambda: c.settings.set_light(c.session.light + 1), "L", enabled=lit, separated=True
        ),
        Command("Previous light", "View", lambda: c.settings.set_light(c.session.light - 1), "Shift+L", enabled=lit),
        *space_commands.build(ui),
        Command(
            "What culling saves",
            "View",
            toggle("savings"),
            "Shift+B",
            checked=lambda: p.savings,
            separated=True,
            tip="one sentence above the picture, and a bar of the shadow rays by what became of them",
        ),
        Command("Legend", "View", toggle("legend"), "N", checked=lambda: p.legend),
        Command("Outlines", "View", toggle("outlines"), "B", checked=lambda: p.outlines),
        Command("Mark wrong pixels", "View", toggle("mark_wrong"), "M", checked=lambda: p.mark_wrong),
        Command("Shares of rays", "View", toggle("work_shares"), "U", checked=lambda: p.work_shares),
        *_rays(ui),
        *finding(ui),
        Command("Draw shadow rays", "View", toggle("draw_explanation"), "I", checked=lambda: p.draw_explanation),
        Command("Smooth upscaling", "View", toggle("smooth_upscaling"), checked=lambda: p.smooth_upscaling),
        *_looks(ui),
        Command("Hide panels", "View", hide, "Tab", checked=lambda: ui.fold.hidden, separated=True),
        Command("Full screen", "View", ui.full_screen.toggle, "F11", checked=lambda: ui.full_screen.wanted),
        Command("Default layout", "View", lambda: ui.reset_layout()),
    ]


def _rays(ui: Ui) -> list[Command]:
    """The tree of the clicked pixel's rays, and the steps of one of them."""
    rays = ui.controller.rays
    walked = Condition(lambda: bool(rays.visits), "no ray is selected: click a row of Rays in the Inspector")
    return [
        Command("Rays of the clicked pixel", "View", ui.show_rays, "X", separated=True),
        Command("Next step of the ray", "View", lambda: rays.go(1), "Period", enabled=walked, repeats=True),
        Command("Previous step of the ray", "View", lambda: rays.go(-1), "Comma", enabled=walked, repeats=True),
    ]  # fmt: skip


def _looks(ui: Ui) -> list[Command]:
    """The theme, and the size of the interface."""
    p = ui.controller.preferences

    def sized(steps: int) -> Callable[[], None]:
        def change() -> None:
            nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - p.ui_scale))
            p.ui_scale = SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)] if steps else 1.0
            ui.controller.notices.say(f"interface at {100.0 * p.ui_scale:.0f} %")

        return change

    largest = Condition(lambda: p.ui_scale < SCALES[-1], "it is as large as it can be")
    smallest = Condition(lambda: p.ui_scale > SCALES[0], "it is as small as it can be")

    def other_theme() -> None:
        p.theme = "dark" if p.theme == "light" else "light"

    return [
        Command("Light theme", "View", other_theme, checked=lambda: p.theme == "light", separated=True),
        Command("Larger interface", "View", sized(1), "Ctrl+Equal", enabled=largest,
                other_keys=("Ctrl+Shift+Equal", "Ctrl+KeypadAdd")),
        Command("Smaller interface", "View", sized(-1), "Ctrl+Minus", enabled=smallest,
                other_keys=("Ctrl+KeypadSubtract",)),
        Command("Interface at 100 %", "View", sized(0), "Ctrl+0", other_keys=("Ctrl+Keypad0",)),
    ]  # fmt: skip


def _camera(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def mode(name: str) -> Callable[[], None]:
        return lambda: setattr(p, "navigation", name)

    here = _open_scene(ui)
    return [
        Command("Fly", "Camera", mode("fly"), "G", checked=lambda: p.navigation == "fly"),
        Command("Orbit", "Camera", mode("orbit"), "O", checked=lambda: p.navigation == "orbit"),
        Command("Focus", "Camera", lambda: focus(ui), "F", enabled=here, separated=True),
        Command("Reset camera", "Camera", c.motion.reset_camera, "R", enabled=here),
        Command(
            "Follow the scene's path",
            "Camera",
            lambda: c.motion.follow_path(not c.session.follow),
            "P",
            checked=lambda: c.session.follow,
            enabled=here,
        ),
        Command("Add bookmark", "Camera/Bookmarks", c.bookmarks.add, "Ctrl+B", enabled=here, separated=True),
        *camera_commands.build(ui),
    ]


def _time(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences
    moves = Condition(lambda: c.session.animated, "nothing moves in this scene")

    def toggle(name: str) -> Callable[[], None]:
        return lambda: setattr(p, name, not getattr(p, name))

    def to_end() -> None:
        if c.session.scene is not None:
            c.motion.step(c.session.scene.frames)

    return [
        Command("Play", "Time", c.motion.toggle_play, "Space", checked=lambda: c.session.playing, enabled=moves),
        Command("Step forward", "Time", lambda: c.motion.step(1), "RightArrow", enabled=moves, repeats=True),
        Command("Step back", "Time", lambda: c.motion.step(-1), "LeftArrow", enabled=moves, repeats=True),
        Command("First frame", "Time", lambda: c.motion.step(-c.session.frame), "Home", enabled=moves),
        Command("Last frame", "Time", to_end, "End", enabled=moves),
        Command("Loop", "Time", toggle("loop"), checked=lambda: p.loop, separated=True),
        Command("Trace every frame", "Time", toggle("every_frame"), checked=lambda: p.every_frame),
    ]


def _culling(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def toggle_tracing() -> None:
        p.keep_tracing = not p.keep_tracing
        c.tracing.trace_again()

    s = lambda: c.session.settings  # noqa: E731
    method = lambda: Method.parse(s().method)  # noqa: E731

    def base(kind: Kind) -> Command:
        change = lambda: c.settings.change(method=with_base(s().method, kind.name))  # noqa: E731
        name, chosen = f"Method {kind.name}", lambda: method().kind is kind
        return Command(name, "Culling", change, checked=chosen, tip=kind.summary)

    def addition(kind: Kind) -> Command:
        change = lambda: c.settings.change(method=toggled(s().method, kind.name))  # noqa: E731
        name, chosen = f"Method +{kind.name}", lambda: method().has(kind.name)
        enabled = lambda: method().kind is not kind  # noqa: E731
        return Command(name, "Culling", change, enabled=enabled, checked=chosen, tip=kind.summary)

    return [
        *[base(kind) for kind in bases()],
        *[addition(kind) for kind in additions()],
        Command("Shadow culling", "Culling", c.settings.toggle_culling, "C", checked=lambda: method().culls,
                separated=True),
        Command("Symmetric occlusion test", "Culling", lambda: c.settings.change(symmetric=not s().symmetric), "Y",
                checked=lambda: s().symmetric),
        Command("Verify", "Culling", lambda: c.settings.change(verify=not s().verify), "V", checked=lambda: s().verify),
        Command("Reset modes", "Culling", c.tracing.reset_modes, "Backspace", separated=True),
        Command("Trace again", "Culling", c.tracing.trace_again, "T"),
        Command("Keep tracing when idle", "Culling", toggle_tracing, "K", checked=lambda: p.keep_tracing),
    ]  # fmt: skip


def _run(ui: Ui) -> list[Command]:
    c = ui.controller
    runner = c.runs

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
        lambda: c.session.scene is not None and runner.current is None, "no scene is open, or a run is under way"
    )
    busy = Condition(
        lambda: c.loader.load_job is not None or runner.current is not None or c.selection.picked is not None,
        "nothing is under way, and nothing is selected",
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

    return [
        Command("Tour", "Help", tour, checked=lambda: ui.tour.step is not None),
        Command(
            "Keyboard and mouse",
            "Help",
            lambda: ui.toggle(Dialog.KEYS),
            "F1",
            checked=lambda: Dialog.KEYS in ui.dialogs,
            also="keys shortcuts",
        ),
        Command(
            "About Shadowcull",
            "Help",
            lambda: ui.toggle(Dialog.ABOUT),
            checked=lambda: Dialog.ABOUT in ui.dialogs,
        ),
        Command(
            "Restart graphics",
            "Help",
            lambda: ui.restart_graphics(),
            separated=True,
            tip="for broken pictures or letters, as after sleep: the window is made anew, nothing is lost",
        ),
    ]


def _open_scene(ui: Ui) -> Condition:
    return Condition(lambda: ui.controller.session.scene is not None, "no scene is open")


def focus(ui: Ui) -> None:
    """Turn to what is under the pointer, else to what is selected, and go near it; orbits turn around it then."""
    c = ui.controller
    at = c.selection.hovered
    pixel = c.selection.pixel
    if at is None and pixel is not None and c.frame is not None:
        at = (pixel[0] + 0.5) / c.frame.width, (pixel[1] + 0.5) / c.frame.height
    if c.selection.picked is not None and c.selection.hovered is None and (at is None or c.selection.part is not None):
        fly_to_selected(ui)
        return
    if at is None or c.frame is None:
        c.notices.say("point at something, or click it, to focus on it")
        return
    point, extent = point_at(c.frame, *at), extent_at(c.frame, *at)
    if point is None or extent is None:
        c.notices.say("there is nothing to focus on")
        return
    ui.picture.pivot = (float(point[0]), float(point[1]), float(point[2]))
    c.motion.glide(navigation.focus(c.session.camera, ui.picture.pivot, extent, c.motion.world_up))
