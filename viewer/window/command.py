"""One action of the window: its name, its menu, its key, and what it does.

Keys that are held down to fly are no commands: `viewer.state.keymap` lists them, and `viewer.window.panels.picture`
reads them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from viewer.state.keymap import MODIFIERS

MENUS = ("File", "Edit", "View", "Picture", "Compare", "Camera", "Time", "Culling", "Run", "Help")


@dataclass(frozen=True)
class Condition:
    """When a command can be run, and why not where it cannot."""

    holds: Callable[[], bool]
    reason: str

    def __call__(self) -> bool:
        return self.holds()


def _always() -> bool:
    return True


@dataclass(frozen=True)
class Command:
    """An action.  `menu` may name a menu within another, as "Camera/Bookmarks".  `key` is the one that it has unless
    the user gives it others, written as it is shown, e.g. "Ctrl+O"; `other_keys` do the same on other keyboards, and
    are not shown; `also` holds words by which the palette finds it, too; `checked` makes it a tick in its menu, where
    `tip` says more about it; `title` is what it is called now, where that changes, and "" where it is not to be
    seen."""

    name: str
    menu: str
    run: Callable[[], None]
    key: str = ""
    checked: Callable[[], bool] | None = None
    enabled: Callable[[], bool] = _always
    separated: bool = False
    repeats: bool = False
    tip: str = ""
    also: str = ""
    other_keys: tuple[str, ...] = ()
    title: Callable[[], str] | None = None

    @property
    def label(self) -> str:
        """What it is called now; "" while it is not to be seen."""
        return self.name if self.title is None else self.title()

    @property
    def why_not(self) -> str:
        """Why it cannot be run now, as far as that is known; "" where it can."""
        return "" if self.enabled() else getattr(self.enabled, "reason", "")

    @property
    def keys(self) -> tuple[str, ...]:
        """All that it has."""
        return (self.key, *self.other_keys) if self.key else ()


def chord(key: str) -> int:
    """ImGui's number of a key as it is shown, e.g. "Shift+F12"; raises ValueError for an unknown one."""
    *modifiers, name = key.split("+")
    number = 0
    for modifier in modifiers:
        number |= int(getattr(imgui.Key, f"mod_{modifier.lower()}"))
    spelled = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()
    found = getattr(imgui.Key, f"_{name}" if name.isdigit() else spelled, None)
    if found is None:
        raise ValueError(f"no key is called {key!r}")
    return number | int(found)


def is_key(key: str) -> bool:
    """Whether a key of this name exists, with modifiers that exist."""
    *modifiers, name = key.split("+")
    try:
        chord(name)
    except (ValueError, AttributeError, TypeError):
        return False
    return set(modifiers) <= set(MODIFIERS)


def key_label(key: str) -> str:
    """A key as the user reads it."""
    *modifiers, name = key.split("+")
    return "+".join([*modifiers, _SHOWN.get(name) or re.sub(r"^Keypad", "Keypad ", name)])


_SHOWN = {
    "RightArrow": "Right", "LeftArrow": "Left", "UpArrow": "Up", "DownArrow": "Down", "Equal": "+", "Minus": "-",
    "Comma": ",", "Period": ".", "Slash": "/", "Semicolon": ";", "Apostrophe": "'", "LeftBracket": "[",
    "RightBracket": "]", "Backslash": "\\", "GraveAccent": "`", "PageUp": "Page up", "PageDown": "Page down",
    "KeypadAdd": "Keypad +", "KeypadSubtract": "Keypad -", "KeypadMultiply": "Keypad *", "KeypadDivide": "Keypad /",
    "KeypadDecimal": "Keypad .", "KeypadEnter": "Keypad Enter", "Oem102": "<",
}  # fmt: skip
