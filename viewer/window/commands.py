"""Every action, once: its name, its key, and what it does.

The menus, the list of shortcuts and the handling of keys are all made from this one list, so
that they cannot disagree.  Keys that are held down to fly are not commands; they are listed in
`HELD_KEYS` for the help window, and `viewer.window.panels.picture` reads them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from tracer.method import BASES, EXTRAS, base_of, takes
from viewer.state import navigation
from viewer.state.methods import EXTRAS_TOLD, toggled, with_base
from viewer.state.picking import extent_at, point_at
from viewer.state.preferences import SCALES
from viewer.state.views import View
from viewer.window.panels import escape
from viewer.window.ui import CaptureKind, Ui

MENUS = ("File", "View", "Camera", "Time", "Culling", "Run", "Help")

HELD_KEYS = (
    ("W  A  S  D", "fly forward, left, back, right"),
    ("E  Q", "fly up, down"),
    ("Shift", "fly faster"),
    ("Left or right drag", "look around (fly); orbit around what was clicked, or pan (orbit)"),
    ("Middle drag", "pan"),
    ("Wheel", "set the speed (fly); go nearer or farther (orbit)"),
    ("Drag the wipe's line", "compare the picture with the right one"),
    ("Drag the legend", "put it elsewhere in the picture; it snaps to edges and corners"),
    ("Click", "inspect a pixel, and draw its shadow rays; click the background to let go"),
)


def _always() -> bool:
    return True


@dataclass(frozen=True)
class Command:
    """An action.  `key` is written as it is shown, e.g. "Ctrl+O"; `checked` makes it a tick in its menu."""

    name: str
    menu: str
    run: Callable[[], None]
    key: str = ""
    checked: Callable[[], bool] | None = None
    enabled: Callable[[], bool] = _always
    separated: bool = False
    repeats: bool = False


def build(ui: Ui) -> list[Command]:
    """All commands, in the order of the menus."""
    return [*_file(ui), *_view(ui), *_camera(ui), *_time(ui), *_culling(ui), *_run(ui), *_help(ui)]


def _file(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def browse() -> None:
        ui.browser.open = True

    def want(kind: CaptureKind) -> Callable[[], None]:
        def ask() -> None:
            ui.capture_wanted = kind

        return ask

    return [
        Command("Open...", "File", browse, "Ctrl+O"),
        Command("Reload", "File", c.opener.reload, "F5", enabled=lambda: c.session.scene is not None),
        Command("Save picture", "File", want(CaptureKind.PICTURE), "F12", separated=True),
        Command("Save picture with panels", "File", want(CaptureKind.WINDOW), "Shift+F12"),
        Command(
            "Start where I left off",
            "File",
            lambda: setattr(p, "start_where_left", not p.start_where_left),
            checked=lambda: p.start_where_left,
            separated=True,
        ),
        Command("Reset settings...", "File", c.asking.before_resetting),
        Command("Quit", "File", lambda: ui.request_exit(), "Ctrl+Q", separated=True),
    ]


def _view(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def show(view: View) -> Command:
        return Command(view.label, "View", lambda: c.set_view(view), view.key, checked=lambda: c.session.view is view)

    def toggle(name: str) -> Callable[[], None]:
        return lambda: setattr(p, name, not getattr(p, name))

    def hide() -> None:
        ui.fold.hidden = not ui.fold.hidden

    lit = lambda: c.session.scene is not None and len(c.session.scene.lights) > 1  # noqa: E731
    return [
        *[show(view) for view in View],
        Command("Next light", "View", lambda: c.set_light(c.session.light + 1), "L", enabled=lit, separated=True),
        Command("Previous light", "View", lambda: c.set_light(c.session.light - 1), "Shift+L", enabled=lit),
        Command("Legend", "View", toggle("legend"), "N", checked=lambda: p.legend, separated=True),
        Command("Outlines", "View", toggle("outlines"), "B", checked=lambda: p.outlines),
        Command("Mark wrong pixels", "View", toggle("mark_wrong"), "M", checked=lambda: p.mark_wrong),
        Command("Shares of rays", "View", toggle("work_shares"), "U", checked=lambda: p.work_shares),
        Command("Draw shadow rays", "View", toggle("draw_explanation"), "I", checked=lambda: p.draw_explanation),
        Command("Smooth upscaling", "View", toggle("smooth_upscaling"), checked=lambda: p.smooth_upscaling),
        *_looks(ui),
        Command("Hide panels", "View", hide, "Tab", checked=lambda: ui.fold.hidden, separated=True),
        Command("Full screen", "View", ui.full_screen.toggle, "F11", checked=lambda: ui.full_screen.wanted),
        Command("Default layout", "View", lambda: ui.reset_layout()),
    ]


def _looks(ui: Ui) -> list[Command]:
    """The theme, and the size of the interface."""
    p = ui.controller.preferences

    def sized(steps: int) -> Callable[[], None]:
        def change() -> None:
            nearest = min(range(len(SCALES)), key=lambda i: abs(SCALES[i] - p.ui_scale))
            p.ui_scale = SCALES[min(max(nearest + steps, 0), len(SCALES) - 1)] if steps else 1.0
            ui.controller.say(f"interface at {100.0 * p.ui_scale:.0f} %")

        return change

    def other_theme() -> None:
        p.theme = "dark" if p.theme == "light" else "light"

    return [
        Command("Light theme", "View", other_theme, checked=lambda: p.theme == "light", separated=True),
        Command("Larger interface", "View", sized(1), "Ctrl+Equal", enabled=lambda: p.ui_scale < SCALES[-1]),
        Command("Smaller interface", "View", sized(-1), "Ctrl+Minus", enabled=lambda: p.ui_scale > SCALES[0]),
        Command("Interface at 100 %", "View", sized(0), "Ctrl+0"),
    ]


def _camera(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def mode(name: str) -> Callable[[], None]:
        return lambda: setattr(p, "navigation", name)

    here = lambda: c.session.scene is not None  # noqa: E731
    return [
        Command("Fly", "Camera", mode("fly"), "G", checked=lambda: p.navigation == "fly"),
        Command("Orbit", "Camera", mode("orbit"), "O", checked=lambda: p.navigation == "orbit"),
        Command("Focus", "Camera", lambda: focus(ui), "F", enabled=here, separated=True),
        Command("Reset camera", "Camera", c.reset_camera, "R", enabled=here),
        Command(
            "Follow the scene's path",
            "Camera",
            lambda: c.follow_path(not c.session.follow),
            "P",
            checked=lambda: c.session.follow,
            enabled=here,
        ),
        Command("Add bookmark", "Camera", c.keeper.add_bookmark, "Ctrl+B", enabled=here, separated=True),
    ]


def _time(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences
    moves = lambda: c.session.animated  # noqa: E731

    def toggle(name: str) -> Callable[[], None]:
        return lambda: setattr(p, name, not getattr(p, name))

    def to_end() -> None:
        if c.session.scene is not None:
            c.step(c.session.scene.frames)

    return [
        Command("Play", "Time", c.toggle_play, "Space", checked=lambda: c.session.playing, enabled=moves),
        Command("Step forward", "Time", lambda: c.step(1), "RightArrow", enabled=moves, repeats=True),
        Command("Step back", "Time", lambda: c.step(-1), "LeftArrow", enabled=moves, repeats=True),
        Command("First frame", "Time", lambda: c.step(-c.session.frame), "Home", enabled=moves),
        Command("Last frame", "Time", to_end, "End", enabled=moves),
        Command("Loop", "Time", toggle("loop"), checked=lambda: p.loop, separated=True),
        Command("Trace every frame", "Time", toggle("every_frame"), checked=lambda: p.every_frame),
    ]


def _culling(ui: Ui) -> list[Command]:
    c = ui.controller
    p = c.preferences

    def toggle_tracing() -> None:
        p.keep_tracing = not p.keep_tracing
        c.trace_again()

    s = lambda: c.session.settings  # noqa: E731

    def base(name: str) -> Command:
        chosen = lambda: base_of(s().method) == name  # noqa: E731
        return Command(
            f"Method {name}", "Culling", lambda: c.change(method=with_base(s().method, name)), checked=chosen
        )

    def extra(name: str) -> Command:
        taken = lambda: takes(s().method, name)  # noqa: E731
        change = lambda: c.change(method=toggled(s().method, name))  # noqa: E731
        return Command(EXTRAS_TOLD[name][0], "Culling", change, checked=taken)

    return [
        *[base(name) for name in BASES],
        *[extra(name) for name in EXTRAS],
        Command("Shadow culling", "Culling", c.toggle_culling, "C", checked=lambda: s().method != "none",
                separated=True),
        Command("Symmetric occlusion test", "Culling", lambda: c.change(symmetric=not s().symmetric), "Y",
                checked=lambda: s().symmetric),
        Command("Verify", "Culling", lambda: c.change(verify=not s().verify), "V", checked=lambda: s().verify),
        Command("Reset modes", "Culling", c.reset_modes, "Backspace", separated=True),
        Command("Trace again", "Culling", c.trace_again, "T"),
        Command("Keep tracing when idle", "Culling", toggle_tracing, "K", checked=lambda: p.keep_tracing),
    ]  # fmt: skip


def _run(ui: Ui) -> list[Command]:
    c = ui.controller
    runner = c.runner

    def start(panel: str, begin: Callable[[], None]) -> Callable[[], None]:
        def run() -> None:
            ui.show_panel(panel)
            begin()

        return run

    def stop() -> None:
        if c.opener.load_job is not None:
            c.opener.cancel()
        elif runner.current is not None:
            runner.stop()
        else:
            c.selected = None

    idle = lambda: c.session.scene is not None and runner.current is None  # noqa: E731
    busy = lambda: c.opener.load_job is not None or runner.current is not None or c.selected is not None  # noqa: E731
    return [
        Command("Experiment", "Run", start("Experiment", runner.start_experiment), enabled=idle),
        Command("Zoom test", "Run", start("Zoom test", runner.start_zoom_test), enabled=idle),
        Command("Stop, or clear the selection", "Run", stop, "Escape", enabled=busy, separated=True),
    ]


def _help(ui: Ui) -> list[Command]:
    def shortcuts() -> None:
        ui.shortcuts_open = not ui.shortcuts_open

    def about() -> None:
        ui.about_open = not ui.about_open

    def tour() -> None:
        (ui.tour.start if ui.tour.step is None else ui.tour.end)()

    return [
        Command("Tour", "Help", tour, checked=lambda: ui.tour.step is not None),
        Command("Keyboard and mouse", "Help", shortcuts, "F1", checked=lambda: ui.shortcuts_open),
        Command("About Shadowcull", "Help", about, checked=lambda: ui.about_open),
    ]


def focus(ui: Ui) -> None:
    """Turn to what is under the pointer, else to what is selected, and go near it; orbits turn around it then."""
    c = ui.controller
    at = c.hovered
    if at is None and c.selected is not None and c.frame is not None:
        at = ((c.selected.x + 0.5) / c.frame.width, (c.selected.y + 0.5) / c.frame.height)
    if at is None or c.frame is None:
        c.say("point at something, or click it, to focus on it")
        return
    point, extent = point_at(c.frame, *at), extent_at(c.frame, *at)
    if point is None or extent is None:
        c.say("there is nothing to focus on")
        return
    ui.pivot = (float(point[0]), float(point[1]), float(point[2]))
    c.glide(navigation.focus(c.session.camera, ui.pivot, extent, c.world_up))


def handle_keys(ui: Ui) -> None:
    """Run the commands whose keys were just pressed, unless the user is typing or a dialog is up."""
    # A chord that is quickly pressed and let go may be spread over two frames: first Ctrl goes down, then the
    # letter goes down and Ctrl up. So a modifier counts for one frame longer than it is held.
    held, before = int(imgui.get_io().key_mods), ui.modifiers
    ui.modifiers = held
    if imgui.get_io().want_text_input:
        return
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False) and escape.close_newest(ui):
        return
    if imgui.is_popup_open("", escape.ANY_POPUP):
        return
    for command in ui.commands:
        if command.key and _pressed(command, held or before) and command.enabled():
            ui.guard.step(f"The command {command.name}", command.run)


def menus(ui: Ui) -> None:
    """All menus of the menu bar."""
    for name in MENUS:
        if imgui.begin_menu(name):
            for command in ui.commands:
                if command.menu == name:
                    _menu_item(ui, command)
            imgui.end_menu()


def chord(key: str) -> int:
    """ImGui's number of a key as it is shown, e.g. "Shift+F12"; raises ValueError for an unknown one."""
    *modifiers, name = key.split("+")
    number = int(_MODIFIERS_NONE)
    for modifier in modifiers:
        number |= int(getattr(imgui.Key, f"mod_{modifier.lower()}"))
    spelled = {"RightArrow": "right_arrow", "LeftArrow": "left_arrow"}.get(name, name.lower())
    found = getattr(imgui.Key, f"_{name}" if name.isdigit() else spelled, None)
    if found is None:
        raise ValueError(f"no key is called {key!r}")
    return number | int(found)


def key_label(key: str) -> str:
    """A key as the user reads it."""
    for name, shown in (("RightArrow", "Right"), ("LeftArrow", "Left"), ("Equal", "+"), ("Minus", "-")):
        key = key.replace(name, shown)
    return key


def _pressed(command: Command, modifiers: int) -> bool:
    number = chord(command.key)
    if number & int(imgui.Key.mod_mask_) != modifiers:
        return False
    return imgui.is_key_pressed(imgui.Key(number & ~int(imgui.Key.mod_mask_)), repeat=command.repeats)


def _menu_item(ui: Ui, command: Command) -> None:
    if command.separated:
        imgui.separator()
    checked = command.checked() if command.checked is not None else False
    clicked, _ = imgui.menu_item(command.name, key_label(command.key), checked, command.enabled())
    if clicked:
        ui.guard.step(f"The command {command.name}", command.run)


_MODIFIERS_NONE = 0
