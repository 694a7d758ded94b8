"""Keys on keyboards of several countries."""

from __future__ import annotations

import glfw
import pytest
from imgui_bundle import imgui

from viewer.state.preferences import Preferences
from viewer.window.keyboard import HELD, PLACES, Keyboard, Keymap, chord, is_place, tidy, works_while_typing

KEY = imgui.Key
DEFAULTS = {"Focus": ("F",), "Reset camera": ("R",), "Step back": ("LeftArrow",), "Shadow culling": ("C",), "Loop": ()}
US = dict(zip(PLACES.values(), "abcdefghijklmnopqrstuvwxyz0123456789`-=[]\\,;'./", strict=True))
FRENCH = US | {
    glfw.KEY_Q: "a", glfw.KEY_A: "q", glfw.KEY_W: "z", glfw.KEY_Z: "w", glfw.KEY_SEMICOLON: "m", glfw.KEY_M: ",",
    **dict(zip(range(glfw.KEY_0, glfw.KEY_9 + 1), "à&é\"'(-è_ç", strict=True)),
}  # fmt: skip
_PLACES = "qwertyuiop[]asdfghjkl;'zxcvbnm,./-="
_DVORAK = "',.pyfgcrl/=aoeuidhtns-;qjkxbmwvz[]"
DVORAK = {key: dict(zip(_PLACES, _DVORAK, strict=True)).get(letter, letter) for key, letter in US.items()}


def keyboard(printed: dict[int, str]) -> Keyboard:
    made = Keyboard(printed.get)
    made.update()
    return made


@pytest.mark.parametrize(
    ("key", "asked", "label"),
    [
        ("W", KEY.z, "Z"), ("D", KEY.d, "D"), ("M", KEY.comma, ","), ("1", KEY._1, "1"), ("F5", KEY.f5, "F5"),
        ("Shift+A", int(KEY.mod_shift) | int(KEY.q), "Shift+Q"), ("LeftArrow", KEY.left_arrow, "Left"),
        ("Keypad7", KEY.keypad7, "Keypad 7"), ("Ctrl+Z", int(KEY.mod_ctrl) | int(KEY.z), "Ctrl+Z"),
    ],
)  # fmt: skip
def test_places_are_asked_for_by_what_is_printed_there_and_letters_as_they_are(key: str, asked: int, label: str):
    french = keyboard(FRENCH)
    assert french.chord(key) == int(asked) and french.label(key) == label


def test_another_layout_is_noticed():
    printed = dict(US)
    made = keyboard(printed)
    assert made.chord("W") == int(KEY.w)
    printed.update(FRENCH)
    made._looked = float("-inf")
    made.update()
    assert made.chord("W") == int(KEY.z)


def test_keys_that_a_file_cannot_mean_are_dropped(ui):
    assert ui.keymap.of("Focus") == ("Ctrl+J",)


@pytest.mark.parametrize("printed", [US, FRENCH, DVORAK], ids=["us", "french", "dvorak"])
def test_no_key_does_two_things(ui, printed: dict[int, str]):
    assert not ui.keymap.conflicts()
    numbers = [keyboard(printed).chord(key) for name in ui.keymap.defaults for key in ui.keymap.of(name)]
    assert len(set(numbers)) == len(numbers) - (printed is FRENCH)  # the 6 is the minus there


def test_hints_name_the_key_that_is_chosen(ui):
    assert ui.key("Focus") == " (Ctrl+J)" and ui.key("Next light") == " (L)"
    ui.keymap.choose("Next light", [])
    assert ui.key("Next light") == "" and ui.key_or_menu("Next light") == "View > Next light"
    assert ui.key_or_menu("Fly forward") == "W"


def test_keys_are_the_users_own_then_those_of_commands_and_conflicts_are_seen_from_both_sides():
    p = Preferences()
    keymap = Keymap(p, DEFAULTS)
    assert keymap.of("Focus") == ("F",) and keymap.of("Fly forward") == ("W",) and keymap.of("Loop") == ()
    keymap.choose("Step back", ["Shift+Ctrl+B"])
    assert keymap.of("Step back") == ("Ctrl+Shift+B",) and list(p.keys) == ["Step back"]
    keymap.choose("Step back", ["LeftArrow"])
    assert p.keys == {}, "the usual key is none that was chosen"
    keymap.choose("Loop", ["W"])
    assert keymap.conflicts() == {"Loop": ["Fly forward"], "Fly forward": ["Loop"]}
    keymap.choose("Fly forward", [])
    assert not keymap.conflicts() and keymap.of("Fly forward") == ()
    del p.keys["Fly forward"]
    assert keymap.conflicts()["Fly forward"] == ["Loop"]
    p.keys.clear()
    assert keymap.of("Loop") == () and not keymap.conflicts()


def test_keys_are_read_as_they_are_written():
    assert is_place("W") and is_place("Shift+H") and not is_place("Ctrl+Z") and not is_place("Ctrl+Shift+Z")
    assert tidy("Shift+Alt+Ctrl+X") == "Ctrl+Alt+Shift+X"
    assert set(HELD.values()) <= set(PLACES)
    for unknown in ("HyperKey", "Hyper+X"):
        with pytest.raises(ValueError, match="Hyper"):
            chord(unknown)


@pytest.mark.parametrize(
    ("key", "works"),
    [("Ctrl+Shift+P", True), ("Ctrl+O", True), ("F1", True), ("Shift+F12", True), ("C", False), ("Shift+C", False),
     ("Ctrl+C", False), ("Ctrl+Shift+Z", False), ("Ctrl+LeftArrow", False), ("Alt+1", False), ("Tab", False)],
)  # fmt: skip
def test_fields_of_text_keep_the_keys_that_they_use(key: str, works: bool):
    assert works_while_typing(key) is works
