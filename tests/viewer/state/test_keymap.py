"""Which keys do what."""

from __future__ import annotations

from viewer.state.keymap import Keymap, is_place, tidy
from viewer.state.preferences import Preferences

DEFAULTS = {"Focus": ("F",), "Reset camera": ("R",), "Step back": ("LeftArrow",), "Shadow culling": ("C",), "Loop": ()}


def test_keys_are_those_of_commands_then_of_the_user():
    p = Preferences()
    keymap = Keymap(p, DEFAULTS)
    assert keymap.of("Focus") == ("F",) and keymap.of("Fly forward") == ("W",) and keymap.shown("Loop") == ""
    keymap.choose("Step back", ["Shift+Ctrl+B"])
    assert keymap.of("Step back") == ("Ctrl+Shift+B",) and keymap.changed("Step back")
    keymap.choose("Step back", ["LeftArrow"])
    assert not keymap.changed("Step back") and p.keys == {}, "the usual key is none that was chosen"


def test_conflicts_are_seen_from_both_sides_and_end():
    keymap = Keymap(Preferences(), DEFAULTS)
    assert not keymap.conflicts()
    keymap.choose("Loop", ["W"])
    assert keymap.conflicts() == {"Loop": ["Fly forward"], "Fly forward": ["Loop"]}
    keymap.choose("Fly forward", [])
    assert not keymap.conflicts() and keymap.of("Fly forward") == ()
    keymap.reset("Fly forward")
    assert keymap.conflicts()["Fly forward"] == ["Loop"]
    keymap.reset()
    assert keymap.of("Loop") == () and not keymap.conflicts()


def test_places_and_letters_are_told_apart():
    assert is_place("W") and is_place("Shift+H") and not is_place("Ctrl+Z") and not is_place("Ctrl+Shift+Z")
    assert tidy("Shift+Alt+Ctrl+X") == "Ctrl+Alt+Shift+X"
