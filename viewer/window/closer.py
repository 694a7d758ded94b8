"""What looking closely at the picture does: zoom into it, and watch its pixels."""

from __future__ import annotations

from viewer.state.pixels import Point
from viewer.state.zooming import FIT, zoomed
from viewer.window.ui import Ui


def zoom_by(ui: Ui, factor: float, at: Point = (0.5, 0.5)) -> None:
    """Enlarge the picture; `at`, 0 to 1 in the room that it has, stays where it is."""
    session = ui.controller.session
    session.set_draw(zoom=zoomed(session.draw.zoom, factor, at))


def offer(ui: Ui, panel: str) -> None:
    """Bring a panel to the eye, unless panels are hidden or it would cover the picture that is looked at."""
    if not ui.fold.away:
        ui.show_panel(panel)


def pin(ui: Ui, point: Point | None) -> None:
    """Watch the pixel at a point, or no longer; says so."""
    c = ui.controller
    if c.frame is None or point is None:
        c.notices.say("point at a pixel, or click one, to watch it")
        return
    c.notices.say(ui.pixels.pin(c.frame, point))
    if ui.pixels.watched:
        offer(ui, "Pixels")


def pin_what_is_pointed_at(ui: Ui) -> None:
    """Watch the pixel under the pointer, or else what was clicked."""
    c = ui.controller
    point, clicked = c.selection.hovered, c.selection.pixel
    if point is None and clicked is not None and c.frame is not None:
        point = (clicked[0] + 0.5) / c.frame.width, (clicked[1] + 0.5) / c.frame.height
    pin(ui, point)


def fit(ui: Ui) -> None:
    """Show all of the picture."""
    ui.controller.session.set_draw(zoom=FIT)
