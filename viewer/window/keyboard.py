"""Which keys do what, and keys as ImGui counts them, on whatever keyboard there is.

A key is written as "Ctrl+Shift+P", "W" or "Keypad7".  Without Ctrl, Alt or Super it is a *place* on the keyboard,
called by the letter that a US keyboard has there, so that W A S D lie together on every keyboard.  ImGui knows a letter
by what is printed on its key: GLFW says what is printed at a place, and ImGui is asked for that."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Mapping

from imgui_bundle import imgui

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from viewer.state.preferences import Preferences

HELD = {"Fly forward": "W", "Fly back": "S", "Fly left": "A", "Fly right": "D", "Fly up": "E", "Fly down": "Q",
        "Show A": "Z"}  # fmt: skip
"""What is done for as long as a key is held, and its key; Shift makes it faster."""
_MODIFIERS = {"Ctrl": imgui.Key.mod_ctrl, "Alt": imgui.Key.mod_alt, "Super": imgui.Key.mod_super,
              "Shift": imgui.Key.mod_shift}  # fmt: skip
_OF_LETTERS = ("Ctrl", "Alt", "Super")  # with which a key means a letter, and no place
_CHORD = sum(int(_MODIFIERS[name]) for name in _OF_LETTERS)
_ALL_MODIFIERS = int(imgui.Key.mod_mask_)
_NO_KEYS = re.compile(r"none|(gamepad|mouse|reserved|named|mod|(left|right)_(ctrl|shift|alt|super))(_|$)")
KEYS = {name.title().replace("_", ""): key for name, key in imgui.Key.__members__.items() if not _NO_KEYS.match(name)}
"""ImGui's keys by their names, "LeftArrow" or "Keypad7", but for modifiers."""
_SIGNS = {
    "GraveAccent": "`", "Minus": "-", "Equal": "=", "LeftBracket": "[", "RightBracket": "]", "Backslash": "\\",
    "Comma": ",", "Semicolon": ";", "Apostrophe": "'", "Period": ".", "Slash": "/",
}  # fmt: skip
PLACES = {
    **{letter: getattr(glfw, f"KEY_{letter}") for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"},
    **{name: ord(sign) for name, sign in _SIGNS.items()},
}
"""GLFW's number of each place where something is printed."""
_SHOWN = _SIGNS | {"Equal": "+", "Oem102": "<"}
_EVERY = 1.0  # seconds after which a keyboard may have got another layout


def is_key(key: str) -> bool:
    """Return whether a key of this name exists."""
    *modifiers, name = key.split("+")
    return name in KEYS and set(modifiers) <= set(_MODIFIERS)


def chord(key: str) -> int:
    """Return ImGui's number of a key, e.g. "Shift+F12"; raises ValueError for an unknown one."""
    if not is_key(key):
        raise ValueError(f"no key is called {key!r}")
    *modifiers, name = key.split("+")
    return sum(int(_MODIFIERS[modifier]) for modifier in set(modifiers)) | int(KEYS[name])


def tidy(key: str) -> str:
    """Return a key with its modifiers in their usual order."""
    *modifiers, name = key.split("+")
    return "+".join([*sorted(modifiers, key=list(_MODIFIERS).index), name])


def is_place(key: str) -> bool:
    """Return whether a key is a place on the keyboard, and not a letter."""
    return not any(modifier in _OF_LETTERS for modifier in key.split("+")[:-1])


def works_while_typing(key: str) -> bool:
    """Return whether a key means its command also while a field of text has the keyboard, which uses others itself."""
    *modifiers, name = key.split("+")
    chorded = ("Ctrl" in modifiers or "Super" in modifiers) and name in PLACES and name not in "ACVXYZ"
    return chorded or re.fullmatch(r"F\d+", name) is not None


class Keymap:
    """The keys of all that can have some.  `defaults` has those of HELD, and of commands by their names, first the one
    to be shown; the user's own go before."""

    def __init__(self, preferences: Preferences, commands: Mapping[str, tuple[str, ...]]) -> None:
        self._preferences = preferences
        self.defaults = {**{name: (key,) for name, key in HELD.items()}, **commands}

    def of(self, name: str) -> tuple[str, ...]:
        """Return its keys as they are now; the first is to be shown."""
        return tuple(self._preferences.keys.get(name, self.defaults.get(name, ())))

    def choose(self, name: str, keys: Iterable[str]) -> None:
        """Give it these keys; its usual ones are not remembered as chosen."""
        self._preferences.keys[name] = list(dict.fromkeys(map(tidy, keys)))
        if self.of(name) == self.defaults.get(name, ()):
            del self._preferences.keys[name]

    def conflicts(self) -> dict[str, list[str]]:
        """Return all that share a key, each with what else has one of its keys."""
        owners: dict[str, list[str]] = {}
        for name in self.defaults:
            for key in self.of(name):
                owners.setdefault(key, []).append(name)
        shared = {name: [o for key in self.of(name) for o in owners[key] if o != name] for name in self.defaults}
        return {name: list(dict.fromkeys(others)) for name, others in shared.items() if others}


def printed_there(key: int) -> str | None:
    """Return what GLFW says is printed on a key; needs a window."""
    return glfw.get_key_name(key, 0)


class Keyboard:
    """As a US keyboard until `update` is called.  `wanted_for` is the command that waits for a key to be pressed,
    `modifiers` are those that are held, `chorded` the names in HELD whose keys are down as part of a chord."""

    def __init__(self, printed: Callable[[int], str | None] = printed_there) -> None:
        self._printed = printed
        self._looked = -_EVERY
        self._letters: dict[str, str] = {}
        self._chords: dict[str, int] = {}
        self.wanted_for = ""
        self.modifiers = 0
        self.chorded: set[str] = set()

    def update(self) -> None:
        """Look what is printed where, now and then."""
        if (now := time.monotonic()) - self._looked >= _EVERY:
            self._looked = now
            letters = {name: self._printed(key) or "" for name, key in PLACES.items()}
            if letters != self._letters:
                self._letters, self._chords = letters, {}

    def chord(self, key: str) -> int:
        """Return ImGui's number of a key with its modifiers."""
        if key not in self._chords:
            *modifiers, name = key.split("+")
            self._chords[key] = chord("+".join([*modifiers, self._asked_for(name) if is_place(key) else name]))
        return self._chords[key]

    def is_pressed(self, key: str, modifiers: int, repeats: bool = False) -> bool:
        """Return whether a key has just been pressed with its modifiers."""
        number = self.chord(key)
        if number & _ALL_MODIFIERS != modifiers:
            return False
        return imgui.is_key_pressed(imgui.Key(number & ~_ALL_MODIFIERS), repeats)

    def label(self, key: str) -> str:
        """Return a key as the user reads it on the keyboard."""
        *modifiers, name = key.split("+")
        letter = self._letters.get(name, "") if is_place(key) and not name.isdigit() else ""
        words = re.sub(r"(?<=[a-z])(?=[A-Z0-9])", " ", name.removesuffix("Arrow"))  # "Keypad 7"
        return "+".join([*modifiers, letter.upper() or _SHOWN.get(name) or words])

    def is_down(self, keys: Iterable[str]) -> bool:
        """Return whether one of these keys is held, whatever modifiers are held with it."""
        return any(imgui.is_key_down(imgui.Key(self.chord(key) & ~_ALL_MODIFIERS)) for key in keys)

    def pressed(self) -> str | None:
        """Return the key that has just been pressed, with its modifiers, as commands have it."""
        held = int(imgui.get_io().key_mods)
        prefix = "".join(f"{name}+" for name, number in _MODIFIERS.items() if held & int(number))
        return next((prefix + name for name in KEYS if self.is_pressed(prefix + name, held)), None)

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
        """Return the name under which ImGui knows the key at a place: by what is printed there, as its GLFW backend
        says."""
        letter = self._letters.get(name, "").upper()
        if letter in PLACES and letter.isascii():
            return letter
        return next((sign for sign, printed in _SIGNS.items() if printed == letter), name)
