"""The menus View and Culling: what the picture shows, how the window looks, and by which method is culled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tracer.method import Kind, Method, additions, bases
from viewer.state.draw_options import AXES
from viewer.state.methods import toggled, with_base
from viewer.state.preferences import SCALES
from viewer.state.scene_rows import Level
from viewer.state.views import View
from viewer.views import view_of
from viewer.window.command import Command, Condition, switch
from viewer.window.setting_rows import setting_command
from viewer.window.ui import Ui


@dataclass
class FindState:
    """`focus` asks for the keyboard above the table; `enters` says that Enter was pressed there, and the row that it
    selects is to come.  `drawn` rows were drawn last, in the order `order`, and `serial` is of the selection whose row
    has been shown."""

    focus: bool = False
    enters: bool = False
    drawn: int = 0
    order: object = None
    serial: int = 0


def view(ui: Ui) -> list[Command]:
    """The menu View."""
    c, p = ui.controller, ui.controller.preferences

    def show(view: View) -> Command:
        return Command(view.label, "View", lambda: c.session.set_draw(view=view), view.key, also=view.declared.also,
                       checked=lambda: c.session.draw.view is view)  # fmt: skip

    def light(step: int) -> Callable[[], None]:
        return lambda: c.settings.set_light(c.session.draw.light + step)

    def another(step: int) -> Callable[[], None]:
        views = list(View)
        return lambda: c.session.set_draw(view=views[(views.index(c.session.draw.view) + step) % len(views)])

    lit = Condition(
        lambda: c.session.scene is not None and len(c.session.scene.lights) > 1, "the scene has no other light"
    )
    return [
        *[show(view) for view in View],
        Command("Next view", "View", another(1)),
        Command("Previous view", "View", another(-1)),
        Command("Next light", "View", light(1), "L", enabled=lit, separated=True),
        Command("Previous light", "View", light(-1), "Shift+L", enabled=lit),
        *_space(ui),
        switch("What culling saves", "View", p, "savings", "Shift+B", separated=True,
               tip="one sentence above the picture, and a bar of the shadow rays by what became of them"),
        setting_command(ui, "draw.legend", "View", "N"),
        setting_command(ui, "draw.outlines", "View", "B"),
        setting_command(ui, "draw.mark_wrong", "View", "M"),
        setting_command(ui, "draw.shares", "View", "U"),
        Command("Rays of the clicked pixel", "View", ui.show_rays, "X", separated=True),
        *_find(ui),
        setting_command(ui, "draw.rays", "View", "I"),
        setting_command(ui, "draw.smooth", "View"),
        *_interface(ui),
        switch("Hide panels", "View", ui.fold, "hidden", "Tab", separated=True),
        switch("Full screen", "View", ui.full_screen, "wanted", "F11"),
        Command("Default layout", "View", lambda: ui.desktop.reset_layout()),
    ]  # fmt: skip


def _space(ui: Ui) -> list[Command]:
    """What methods keep of space: the slice through it."""
    sliced = Condition(
        lambda: ui.controller.scheduler.drawn_view.has_slice, "no slice is shown: choose the view Voxels or Tree built"
    )
    c, s = ui.controller, ui.controller.session

    def step(steps: int) -> None:
        cut = s.draw.slice
        layers = view_of(s.draw.view).layers(c.frame, cut.axis) if c.frame is not None else 0
        if layers:
            s.set_draw(slice=cut.in_layer(cut.layer(layers) + steps, layers))

    def turn() -> None:
        cut = s.draw.slice
        s.set_draw(slice=cut._replace(axis=(cut.axis + 1) % len(AXES)))

    return [
        Command("Next layer of the slice", "View", lambda: step(1), "Shift+RightBracket", enabled=sliced,
                separated=True, repeats=True),
        Command("Previous layer of the slice", "View", lambda: step(-1), "Shift+LeftBracket",
                enabled=sliced, repeats=True),
        Command("Slice across another axis", "View", turn, enabled=sliced),
    ]  # fmt: skip


def _find(ui: Ui) -> list[Command]:
    """Open the table, choose what its rows are, and save it."""
    table = ui.controller.table
    listed = Condition(lambda: table.listing is not None, "there is no table yet: open the panel Find")

    def find() -> None:
        ui.show_panel("Find")
        ui.state(FindState).focus = True

    def show(level: Level) -> None:
        table.level = level
        ui.show_panel("Find")

    return [
        Command("Find objects and primitives", "View", find, "Ctrl+F",
                tip="a table of all, with modes, pixels, rays saved and wrong answers"),
        Command("Table of objects", "View/Table", lambda: show(Level.OBJECTS),
                checked=lambda: table.level is Level.OBJECTS),
        Command("Table of primitives", "View/Table", lambda: show(Level.PRIMITIVES),
                checked=lambda: table.level is Level.PRIMITIVES),
        Command("Save the table as CSV", "View/Table", table.save, enabled=listed, separated=True,
                tip="the rows that the filter finds, in their order, into the folder of the pictures"),
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

    largest = Condition(lambda: p.ui_scale < SCALES[-1], "the interface is at its largest")
    smallest = Condition(lambda: p.ui_scale > SCALES[0], "the interface is at its smallest")

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


def culling(ui: Ui) -> list[Command]:
    """The menu Culling: the methods, and what they have learnt."""
    c = ui.controller

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
        setting_command(ui, "settings.symmetric", "Culling", "Y"),
        setting_command(ui, "settings.verify", "Culling", "V"),
        Command("Reset modes", "Culling", c.reset_modes, "Backspace", separated=True),
        Command("Trace again", "Culling", c.scheduler.trace_again, "T"),
        setting_command(ui, "pace.keep_tracing", "Culling", "K"),
    ]  # fmt: skip
