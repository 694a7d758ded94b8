"""The menus Picture and Compare: zoom, exact values, exposure; what is kept as A, and how it is compared with B."""

from __future__ import annotations

from collections.abc import Callable

from viewer.state.comparison import CompareMode
from viewer.state.pixels import FIT, MOST, STEP, Point, zoomed
from viewer.state.tone import NEUTRAL, brighter
from viewer.window.command import Command, Condition, switch
from viewer.window.setting_rows import setting_command
from viewer.window.ui import Ui

_STOPS = 0.5  # of exposure by a key
_NAMES = {
    CompareMode.FLIP: "Flip between A and B",
    CompareMode.WIPE: "Wipe between A and B",
    CompareMode.SIDE: "A and B side by side",
    CompareMode.DIFFERENCE: "Signed difference B - A",
    CompareMode.BLINK: "Blink A and B",
}


def copy_command(ui: Ui) -> None:
    """Put the command that makes the picture on the clipboard."""
    words = ui.controller.pictures.command()
    if words is not None:
        ui.desktop.copy(words)


def comparing(ui: Ui) -> list[Command]:
    """The menu Compare."""
    c = ui.controller
    comparing = c.comparing
    there = Condition(lambda: comparing.b is not None, "there is no picture yet")
    kept = Condition(lambda: comparing.kept is not None, "nothing is kept as A")

    def keep() -> None:
        comparing.keep()
        offer(ui, "Compare")

    def by(mode: CompareMode) -> Command:
        return Command(_NAMES[mode], "Compare", lambda: comparing.toggle(mode), enabled=there, tip=mode.meaning,
                       checked=lambda: comparing.state.on and comparing.state.mode is mode)  # fmt: skip

    return [
        Command("Keep as A", "Compare", keep, "Ctrl+A", enabled=there),
        Command("Clear A", "Compare", comparing.forget, enabled=kept),
        Command("Two methods live", "Compare", comparing.toggle_methods, "Shift+C", enabled=there,
                checked=lambda: bool(c.comparing.second_method),
                tip="trace each frame by a second method as well, with modes and counters of its own"),
        Command("Next compare mode", "Compare", comparing.next_mode, "Shift+Z", enabled=there, separated=True),
        *[by(way) for way in CompareMode],
        Command("B alone", "Compare", comparing.end, "Ctrl+Shift+A", checked=lambda: not comparing.state.on,
                separated=True),
    ]  # fmt: skip


def looking(ui: Ui) -> list[Command]:
    """The menu Picture: zoom and values of pixels, exposure and what is clipped."""
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
        Command("Zoom in", "Picture", lambda: zoom_by(ui, STEP, _at(ui)), "Equal", repeats=True,
                enabled=larger, other_keys=("Shift+Equal", "KeypadAdd")),
        Command("Zoom out", "Picture", lambda: zoom_by(ui, 1.0 / STEP, _at(ui)), "Minus", repeats=True,
                enabled=enlarged, other_keys=("KeypadSubtract",)),
        Command("Fit picture", "Picture", lambda: fit(ui), "Shift+F", enabled=enlarged),
        switch("Values in pixels", "Picture", p, "pixel_values", separated=True),
        Command("Brighter", "Picture", expose(_STOPS), "RightBracket", repeats=True, separated=True),
        Command("Darker", "Picture", expose(-_STOPS), "LeftBracket", repeats=True),
        Command("Colours as traced", "Picture", lambda: session.set_draw(tone=NEUTRAL),
                enabled=toned),
        setting_command(ui, "draw.clipping", "Picture", "Shift+M"),
    ]  # fmt: skip


def _at(ui: Ui) -> tuple[float, float]:
    """Where the pointer is in the picture's room, else its middle."""
    hovered, zoom = ui.controller.selection.hovered, ui.controller.session.draw.zoom
    if hovered is None:
        return 0.5, 0.5
    return (hovered[0] - zoom.left) * zoom.scale, (hovered[1] - zoom.top) * zoom.scale


def zoom_by(ui: Ui, factor: float, at: Point = (0.5, 0.5)) -> None:
    """Enlarge the picture; `at`, 0 to 1 in the room that it has, stays where it is."""
    session = ui.controller.session
    session.set_draw(zoom=zoomed(session.draw.zoom, factor, at))


def offer(ui: Ui, panel: str) -> None:
    """Bring a panel to the eye, unless panels are hidden or it would cover the picture that is looked at."""
    if not ui.fold.away:
        ui.show_panel(panel)


def fit(ui: Ui) -> None:
    """Show all of the picture."""
    ui.controller.session.set_draw(zoom=FIT)
