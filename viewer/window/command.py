"""One action of the window: its name, its menu, its key, and what it does.

Keys that are held down to fly are no commands; they are listed in `HELD_KEYS` for the help window, and
`viewer.window.panels.picture` reads them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

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
    """An action.  `key` is written as it is shown, e.g. "Ctrl+O"; `other_keys` do the same on other keyboards, and
    are not shown; `checked` makes it a tick in its menu, where `tip` says more about it."""

    name: str
    menu: str
    run: Callable[[], None]
    key: str = ""
    checked: Callable[[], bool] | None = None
    enabled: Callable[[], bool] = _always
    separated: bool = False
    repeats: bool = False
    tip: str = ""
    other_keys: tuple[str, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """All that it has."""
        return (self.key, *self.other_keys) if self.key else ()


_SPELLED = {
    "RightArrow": "right_arrow",
    "LeftArrow": "left_arrow",
    "KeypadAdd": "keypad_add",
    "KeypadSubtract": "keypad_subtract",
}


def chord(key: str) -> int:
    """ImGui's number of a key as it is shown, e.g. "Shift+F12"; raises ValueError for an unknown one."""
    *modifiers, name = key.split("+")
    number = 0
    for modifier in modifiers:
        number |= int(getattr(imgui.Key, f"mod_{modifier.lower()}"))
    spelled = _SPELLED.get(name, name.lower())
    found = getattr(imgui.Key, f"_{name}" if name.isdigit() else spelled, None)
    if found is None:
        raise ValueError(f"no key is called {key!r}")
    return number | int(found)


def key_label(key: str) -> str:
    """A key as the user reads it."""
    for name, shown in (
        ("RightArrow", "Right"),
        ("LeftArrow", "Left"),
        ("Equal", "+"),
        ("Minus", "-"),
        ("Comma", ","),
        ("Period", "."),
    ):
        key = key.replace(name, shown)
    return key
