"""What some commands do, and panels as well."""

from __future__ import annotations

from dataclasses import dataclass

from viewer.state.pixels import FIT, Point, zoomed
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


def copy_command(ui: Ui) -> None:
    """Put the command that makes the picture on the clipboard."""
    words = ui.controller.pictures.command()
    if words is not None:
        ui.desktop.copy(words)


def pointed_at(ui: Ui) -> tuple[float, float]:
    """Return where the pointer is in the picture's room, else its middle."""
    hovered, zoom = ui.controller.selection.hovered, ui.controller.session.draw.zoom
    if hovered is None:
        return 0.5, 0.5
    return (hovered[0] - zoom.left) * zoom.scale, (hovered[1] - zoom.top) * zoom.scale


def zoom_by(ui: Ui, factor: float, at: Point = (0.5, 0.5)) -> None:
    """Enlarge the picture; `at`, 0 to 1 in the room that it has, stays where it is."""
    session = ui.controller.session
    session.set_draw(zoom=zoomed(session.draw.zoom, factor, at))


def fit(ui: Ui) -> None:
    """Show all of the picture."""
    ui.controller.session.set_draw(zoom=FIT)


def offer(ui: Ui, panel: str) -> None:
    """Open a panel, unless panels are hidden."""
    if not ui.panels_hidden:
        ui.show_panel(panel)
