"""Keys on keyboards of several countries."""

from __future__ import annotations

from types import SimpleNamespace

import glfw
import pytest
from imgui_bundle import imgui

from viewer.services.controller import Controller
from viewer.state.keymap import Keymap, is_place, tidy
from viewer.state.preferences import Preferences
from viewer.window import commands, widgets
from viewer.window.keyboard import PLACES, Keyboard
from viewer.window.ui import Ui

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


def test_a_place_is_asked_for_by_what_is_printed_there():
    french = keyboard(FRENCH)
    assert [french.chord(key) for key in "WASD"] == [int(KEY.z), int(KEY.q), int(KEY.s), int(KEY.d)]
    assert [french.label(key) for key in ("W", "Shift+A", "M")] == ["Z", "Shift+Q", ","]
    assert french.chord("M") == int(KEY.comma)
    assert [keyboard(US).chord(key) for key in "WA"] == [int(KEY.w), int(KEY.a)]


def test_letters_with_ctrl_are_those_that_are_printed():
    french = keyboard(FRENCH)
    assert french.chord("Ctrl+Z") == int(KEY.mod_ctrl) | int(KEY.z) and french.label("Ctrl+Z") == "Ctrl+Z"


def test_digits_are_places_whatever_else_is_printed_there():
    french = keyboard(FRENCH)
    assert (french.chord("1"), french.label("1")) == (int(KEY._1), "1")


def test_keys_that_nothing_is_printed_on_are_everywhere_the_same():
    french = keyboard(FRENCH)
    assert french.chord("F5") == int(KEY.f5) and french.label("LeftArrow") == "Left"
    assert french.label("Keypad7") == "Keypad 7" and french.chord("Keypad7") == int(KEY.keypad7)


def test_a_place_that_imgui_takes_for_another_is_told_from_it_by_glfw():
    """On French keyboards the 6 has a minus, and what is a minus elsewhere is one for ImGui as well."""
    down: set[int] = set()
    made = Keyboard((FRENCH | {glfw.KEY_MINUS: ")"}).get, down.__contains__)
    made.update()
    assert made.chord("6") == made.chord("Minus") == int(KEY.minus)
    for key, other in (("6", "Minus"), ("Minus", "6")):
        down.clear()
        down.add(PLACES[key])
        assert made.is_meant(key) and not made.is_meant(other) and made.is_meant("W")
    down.clear()
    assert made.is_meant("6") and not made.is_meant("Minus"), "of a tap that is over the sign is what is known"


def test_another_layout_is_noticed(monkeypatch: pytest.MonkeyPatch):
    printed = dict(US)
    made = keyboard(printed)
    assert made.chord("W") == int(KEY.w)
    printed.update(FRENCH)
    made._looked = float("-inf")
    made.update()
    assert made.chord("W") == int(KEY.z)


@pytest.fixture
def ui():
    ui = Ui(Controller(Preferences()))
    ui.take_commands(commands.build(ui))
    yield ui
    ui.controller.close()


@pytest.mark.parametrize("printed", [US, FRENCH, DVORAK], ids=["us", "french", "dvorak"])
def test_no_key_does_two_things(ui, printed: dict[int, str]):
    assert not ui.keymap.conflicts()
    made = keyboard(printed)
    keys = [key for name in ui.keymap.names for key in ui.keymap.of(name)]
    unclear = [key for key in keys if key in PLACES and made.chord(key) in made._shared]
    assert len({made.chord(key) for key in keys if key not in unclear}) == len(keys) - len(unclear)


def test_keys_that_a_file_cannot_mean_are_dropped():
    preferences = Preferences(keys={"Focus": ["Hyper+X", "Ctrl+J", "Nonsense", ""], "No such command": ["X"]})
    ui = Ui(Controller(preferences))
    ui.take_commands(commands.build(ui))
    assert ui.keymap.of("Focus") == ("Ctrl+J",)
    ui.controller.close()


def test_hints_name_the_key_that_is_chosen(ui):
    assert ui.key("Focus") == " (F)" and ui.keys("Next light", "Previous light") == " (L and Shift+L)"
    ui.keymap.choose("Focus", ["Ctrl+J"])
    ui.keymap.choose("Next light", [])
    assert ui.key("Focus") == " (Ctrl+J)" and ui.keys("Next light", "Previous light") == " (Shift+L)"
    assert ui.key("Next light") == "" and ui.key_or_menu("Next light") == "View > Next light"
    assert ui.key_or_menu("Fly forward") == "W"


def test_a_name_in_a_tooltip_is_never_taken_for_a_key(ui, monkeypatch: pytest.MonkeyPatch):
    said: list[str] = []
    functions = ("begin_tooltip", "push_text_wrap_pos", "pop_text_wrap_pos", "end_tooltip")
    silent = SimpleNamespace(text_unformatted=said.append, **dict.fromkeys(functions, lambda *_: True))
    monkeypatch.setattr(widgets, "imgui", silent)
    monkeypatch.setattr(widgets, "em", lambda size: size)
    ui.keymap.choose("Shadow culling", ["F9"])  # which has the key C otherwise
    widgets.tooltip_at("chair (C)")
    assert said == ["chair (C)"]


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
