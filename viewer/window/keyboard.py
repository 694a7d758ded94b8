"""Keys as ImGui counts them, on whatever keyboard there is.

ImGui knows a letter by what is printed on its key.  A key without Ctrl, Alt or Super is meant as a place
(`viewer.state.keymap`): GLFW says what is printed there, and ImGui is asked for that.
"""

from __future__ import annotations

import re
import time
from collections import Counter
from collections.abc import Callable, Iterable

from imgui_bundle import glfw_utils, imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from viewer.state.keymap import HELD, MODIFIERS, Keymap, is_place

EVERY = 1.0
"""Seconds after which a keyboard may have got another layout."""
_SIGNS = {
    "GraveAccent": "`", "Minus": "-", "Equal": "=", "LeftBracket": "[", "RightBracket": "]", "Backslash": "\\",
    "Comma": ",", "Semicolon": ";", "Apostrophe": "'", "Period": ".", "Slash": "/",
}  # fmt: skip
_SPELLED = {sign: name for name, sign in _SIGNS.items()}
PLACES = {
    **{letter: getattr(glfw, f"KEY_{letter}") for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"},
    **{name: ord(sign) for name, sign in _SIGNS.items()},
}
"""GLFW's number of each place where something is printed."""
_MODIFIERS = {"Ctrl": imgui.Key.mod_ctrl, "Alt": imgui.Key.mod_alt, "Super": imgui.Key.mod_super,
              "Shift": imgui.Key.mod_shift}  # fmt: skip
_CHORD = int(imgui.Key.mod_ctrl) | int(imgui.Key.mod_alt) | int(imgui.Key.mod_super)
_OTHERS = (
    *(f"F{n}" for n in range(1, 25)), *(f"Keypad{n}" for n in range(10)), "KeypadAdd", "KeypadSubtract",
    "KeypadMultiply", "KeypadDivide", "KeypadDecimal", "KeypadEnter", "Space", "Tab", "Enter", "Backspace", "Delete",
    "Insert", "Home", "End", "PageUp", "PageDown", "LeftArrow", "RightArrow", "UpArrow", "DownArrow", "Oem102",
)  # fmt: skip


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


def printed_there(key: int) -> str | None:
    """What GLFW says is printed on a key; needs a window."""
    return glfw.get_key_name(key, 0)


def held_there(key: int) -> bool:
    """Whether GLFW says that a key is down; needs a window."""
    return bool(glfw.get_key(glfw_utils.glfw_window_hello_imgui(), key) == glfw.PRESS)


class Keyboard:
    """As a US keyboard until `update` is called.  `wanted_for` is the command that waits for a key to be pressed,
    `modifiers` are those that are held, `chorded` the names in HELD whose keys are down as part of a chord."""

    def __init__(
        self, printed: Callable[[int], str | None] = printed_there, held: Callable[[int], bool] = held_there
    ) -> None:
        self._printed, self._held = printed, held
        self._looked = -EVERY
        self._letters: dict[str, str] = {}
        self._chords: dict[str, int] = {}
        self._shared: set[int] = set()
        self.wanted_for = ""
        self.modifiers = 0
        self.chorded: set[str] = set()

    def update(self) -> None:
        """Look what is printed where, now and then."""
        now = time.monotonic()
        if now - self._looked < EVERY:
            return
        self._looked = now
        letters = {name: self._printed(key) or "" for name, key in PLACES.items()}
        if letters != self._letters:
            self._letters, self._chords = letters, {}
            counts = Counter(self.chord(name) for name in PLACES)
            self._shared = {number for number, count in counts.items() if count > 1}

    def chord(self, key: str) -> int:
        """ImGui's number of a key with its modifiers."""
        known = self._chords.get(key)
        if known is None:
            *modifiers, name = key.split("+")
            there = self._asked_for(name) if is_place(key) else name
            known = self._chords[key] = chord("+".join([*modifiers, there]))
        return known

    def is_meant(self, key: str) -> bool:
        """Whether ImGui's key is this one, where it takes two places for the same: French keyboards have a minus on the
        6, and ImGui knows the key that has it elsewhere as a minus too."""
        name = key.split("+")[-1]
        if not is_place(key) or name not in PLACES or self.chord(name) not in self._shared:
            return True
        if self._held(PLACES[name]):
            return True
        others = [other for other in PLACES if other != name and self.chord(other) == self.chord(name)]
        if any(self._held(PLACES[other]) for other in others):
            return False
        return self._asked_for(name) != name  # let go already: rather the one that has the sign printed on it

    def label(self, key: str) -> str:
        """A key as the user reads it on the keyboard."""
        if not key:
            return ""
        *modifiers, name = key.split("+")
        letter = self._letters.get(name, "") if is_place(key) and name not in "0123456789" else ""
        return "+".join([*modifiers, letter.upper() or key_label(name)])

    def is_down(self, keys: Iterable[str]) -> bool:
        """Whether one of these keys is held, whatever modifiers are held with it."""
        mask = ~int(imgui.Key.mod_mask_)
        return any(imgui.is_key_down(imgui.Key(self.chord(key) & mask)) and self.is_meant(key) for key in keys)

    def pressed(self) -> str | None:
        """The key that has just been pressed, with its modifiers, as commands have it."""
        held = int(imgui.get_io().key_mods)
        modifiers = [name for name, number in _MODIFIERS.items() if held & int(number)]
        prefix = "".join(f"{name}+" for name in modifiers)
        for name in (*PLACES, *_OTHERS):
            number = self.chord(prefix + name) & ~int(imgui.Key.mod_mask_)
            if imgui.is_key_pressed(imgui.Key(number), repeat=False) and self.is_meant(prefix + name):
                return prefix + name
        return None

    def update_modifiers(self, keymap: Keymap) -> int:
        """Take up which modifiers are held, once a frame; returns those that were held until now, or else are now.

        A chord that is quickly pressed and let go may be spread over two frames: first Ctrl goes down, then the letter
        goes down and Ctrl up.  So a modifier counts for one frame longer than it is held, and a key that steers and
        went down with one steers only once it was let go."""
        held, before = int(imgui.get_io().key_mods), self.modifiers
        self.modifiers = held
        down = {name for name in HELD if self.is_down(keymap.of(name))}
        self.chorded = down if (held | before) & _CHORD else self.chorded & down
        return held or before

    def _asked_for(self, name: str) -> str:
        """The name under which ImGui knows the key at a place: by what is printed there, as its GLFW backend says."""
        letter = self._letters.get(name, "").upper()
        if len(letter) == 1 and (letter in PLACES and letter.isascii() and letter.isalnum()):
            return letter
        return _SPELLED.get(letter, name)
