"""Commands for comparing pictures, and for looking closely at one, which are some of those of `commands`."""

from __future__ import annotations

from collections.abc import Callable

from viewer.state.comparison import CompareMode
from viewer.state.tone import NEUTRAL, brighter
from viewer.state.zooming import MOST, STEP
from viewer.window import closer
from viewer.window.command import Command, Condition
from viewer.window.ui import Ui

_STOPS = 0.5  # of exposure by a key
_NAMES = {
    CompareMode.FLIP: "Flip between A and B",
    CompareMode.WIPE: "Wipe between A and B",
    CompareMode.SIDE: "A and B side by side",
    CompareMode.DIFFERENCE: "Signed difference B - A",
    CompareMode.BLINK: "Blink A and B",
}


def comparing(ui: Ui) -> list[Command]:
    """The menu Compare."""
    c = ui.controller
    comparing, state = c.comparing, c.comparing.state
    there = Condition(lambda: comparing.b is not None, "there is no picture yet")
    kept = Condition(lambda: state.kept is not None, "nothing is kept as A")

    def keep() -> None:
        comparing.keep()
        closer.offer(ui, "Compare")

    def by(way: CompareMode) -> Command:
        return Command(
            _NAMES[way],
            "Compare",
            lambda: comparing.toggle(way),
            checked=lambda: state.on and state.mode is way,
            enabled=there,
            tip=way.meaning,
        )

    return [
        Command("Keep as A", "Compare", keep, "Ctrl+A", enabled=there),
        Command("Let go of A", "Compare", comparing.forget, enabled=kept),
        Command(
            "Two methods live",
            "Compare",
            comparing.toggle_methods,
            "Shift+C",
            checked=lambda: bool(c.tracing.second),
            enabled=there,
            tip="trace each frame by a second method as well, with modes and counters of its own",
        ),
        Command("Next way to compare", "Compare", comparing.next_mode, "Shift+Z", enabled=there, separated=True),
        *[by(way) for way in CompareMode],
        Command("B alone", "Compare", comparing.end, "Ctrl+Shift+A", checked=lambda: not state.on, separated=True),
    ]


def looking(ui: Ui) -> list[Command]:
    """The menu Picture: zoom and values of pixels, exposure and what is clipped."""
    session, p, watched = ui.controller.session, ui.controller.preferences, ui.pixels.watched

    def expose(stops: float) -> Callable[[], None]:
        def change() -> None:
            session.tone = brighter(session.tone, stops)
            ui.controller.notices.say(f"exposure {session.tone.exposure:+.3g} stops")

        return change

    def toggle_values() -> None:
        p.pixel_values = not p.pixel_values

    def clear_region() -> None:
        ui.pixels.region = None

    larger = Condition(lambda: session.zoom.scale < MOST, f"it is enlarged {MOST:.0f} times, which is the most")
    zoomed = Condition(lambda: not session.zoom.fits, "the whole picture is shown")
    watching = Condition(lambda: bool(watched), "no pixel is watched")
    chosen = Condition(lambda: ui.pixels.region is not None, "no region is chosen")
    toned = Condition(lambda: not session.tone.neutral, "colours are shown as traced")
    return [
        Command("Zoom in", "Picture", lambda: closer.zoom_by(ui, STEP, _at(ui)), "Equal", repeats=True,
                enabled=larger, other_keys=("Shift+Equal", "KeypadAdd")),
        Command("Zoom out", "Picture", lambda: closer.zoom_by(ui, 1.0 / STEP, _at(ui)), "Minus", repeats=True,
                enabled=zoomed, other_keys=("KeypadSubtract",)),
        Command("Fit picture", "Picture", lambda: closer.fit(ui), "Shift+F", enabled=zoomed),
        Command("Values in pixels", "Picture", toggle_values, checked=lambda: p.pixel_values, separated=True),
        Command("Watch pixel", "Picture", lambda: closer.pin_what_is_pointed_at(ui), "Shift+P"),
        Command("Let go of watched pixels", "Picture", watched.clear, enabled=watching),
        Command("Clear the region", "Picture", clear_region, enabled=chosen),
        Command("Brighter", "Picture", expose(_STOPS), "RightBracket", repeats=True, separated=True),
        Command("Darker", "Picture", expose(-_STOPS), "LeftBracket", repeats=True),
        Command("Colours as traced", "Picture", lambda: setattr(session, "tone", NEUTRAL),
                enabled=toned),
        Command("Mark clipped pixels", "Picture", lambda: setattr(session, "clipping", not session.clipping), "Shift+M",
                checked=lambda: session.clipping),
    ]  # fmt: skip


def _at(ui: Ui) -> tuple[float, float]:
    """Where the pointer is in the picture's room, else its middle."""
    hovered, zoom = ui.controller.selection.hovered, ui.controller.session.zoom
    if hovered is None:
        return 0.5, 0.5
    return (hovered[0] - zoom.left) * zoom.scale, (hovered[1] - zoom.top) * zoom.scale
