"""Which keys do what: those that commands have by themselves, and those that the user has chosen.

A key is written as "Ctrl+Shift+P", "W" or "Keypad7".  Without Ctrl, Alt or Super it is a *place* on the keyboard,
called by the letter that a US keyboard has there, so that W A S D lie together on every keyboard."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from viewer.state.preferences import Preferences

MODIFIERS = ("Ctrl", "Alt", "Super", "Shift")

HELD = {
    "Fly forward": "W",
    "Fly back": "S",
    "Fly left": "A",
    "Fly right": "D",
    "Fly up": "E",
    "Fly down": "Q",
    "Show A": "Z",
}
"""What is done for as long as a key is held, and its key; Shift makes it faster."""


class Keymap:
    """`defaults` maps names of commands, and of HELD, to their keys, first the one to be shown."""

    def __init__(self, preferences: Preferences, defaults: Mapping[str, tuple[str, ...]]) -> None:
        self._preferences = preferences
        self._defaults = {**{name: (key,) if key else () for name, key in HELD.items()}, **defaults}

    @property
    def names(self) -> Iterable[str]:
        """All that can have keys."""
        return self._defaults.keys()

    def of(self, name: str) -> tuple[str, ...]:
        """The keys of a command, or of one of HELD; the first is to be shown."""
        own = self._preferences.keys.get(name)
        return tuple(own) if own is not None else self.usual(name)

    def usual(self, name: str) -> tuple[str, ...]:
        """Its keys unless the user chooses others."""
        return self._defaults.get(name, ())

    def shown(self, name: str) -> str:
        """Its first key, "" where it has none."""
        return next(iter(self.of(name)), "")

    def changed(self, name: str) -> bool:
        """Whether the user has chosen its keys."""
        return name in self._preferences.keys

    def choose(self, name: str, keys: Iterable[str]) -> None:
        """Give it these keys; its usual ones are not remembered as chosen."""
        chosen = [tidy(key) for key in keys]
        if tuple(chosen) == self.usual(name):
            self._preferences.keys.pop(name, None)
        else:
            self._preferences.keys[name] = list(dict.fromkeys(chosen))

    def reset(self, name: str | None = None) -> None:
        """Give it its usual keys again, or everything."""
        if name is None:
            self._preferences.keys.clear()
        else:
            self._preferences.keys.pop(name, None)

    def conflicts(self) -> dict[str, list[str]]:
        """All that share a key, each with what else has one of its keys."""
        owners: dict[str, list[str]] = {}
        for name in self._defaults:
            for key in self.of(name):
                owners.setdefault(key, []).append(name)
        others = {
            name: [other for other in dict.fromkeys(n for key in self.of(name) for n in owners[key]) if other != name]
            for name in self._defaults
        }
        return {name: found for name, found in others.items() if found}


def tidy(key: str) -> str:
    """A key with its modifiers in their usual order."""
    *modifiers, name = key.split("+")
    return "+".join([*sorted(modifiers, key=MODIFIERS.index), name])


def is_place(key: str) -> bool:
    """Whether a key is a place on the keyboard, and not a letter."""
    return not any(modifier in ("Ctrl", "Alt", "Super") for modifier in key.split("+")[:-1])
