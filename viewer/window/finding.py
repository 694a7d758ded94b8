"""The commands of the table of objects and primitives, and the flight to what is selected there."""

from __future__ import annotations

from dataclasses import dataclass

from viewer.state.scene_rows import Level
from viewer.state.selection_lookup import looking_at, place_of, place_of_part
from viewer.window.command import Command, Condition
from viewer.window.ui import Ui

PANEL = "Find"


@dataclass
class FindState:
    """`focus` asks for the keyboard above the table, of which `drawn` rows were drawn last, each `height` pixels high,
    in the order `order`."""

    focus: bool = False
    drawn: int = 0
    height: float = 0.0
    order: object = None


def finding(ui: Ui) -> list[Command]:
    """Open the table, choose what its rows are, and save it."""
    table = ui.controller.table
    listed = Condition(lambda: table.listing is not None, "there is no table yet: open the panel Find")

    def find() -> None:
        ui.show_panel(PANEL)
        ui.state(FindState).focus = True

    def show(level: Level) -> None:
        table.level = level
        ui.show_panel(PANEL)

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


def fly_to_selected(ui: Ui) -> None:
    """Go near what is selected, whether or not it is seen from here; orbits turn around it then."""
    c = ui.controller
    now, picked, part = c.session.edited, c.selection.picked, c.selection.part
    if now is None or picked is None:
        return
    time = c.session.time
    place = place_of(now.scene, picked.primitive, time) if part is None else place_of_part(now, part, time)
    if place is None:
        c.notices.say("what is selected is nowhere in the world at this moment")
        return
    x, y, z = place.middle.tolist()
    ui.picture.pivot = x, y, z
    seen = c.selection.pixel is not None
    c.motion.fly_to(looking_at(c.session.camera, place, c.motion.world_up, seen))
