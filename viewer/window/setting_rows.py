"""Settings in the window: rows of panels, switches of menus and entries of the palette, all made from declarations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from imgui_bundle import imgui

from tracer.setting import Setting, settings_of
from tracer.settings import Settings
from viewer.state.preferences import Preferences
from viewer.state.view_state import ViewState
from viewer.window.command import Command
from viewer.window.finder import Item, Kind
from viewer.window.ui import Ui
from viewer.window.widgets import checkbox, row, size_field, tooltip

LONGEST_SLIDER = 200.0
"""The range past which a number is typed, and has no slider."""
ALL = {one.path: one for one in (*settings_of(ViewState), *settings_of(Preferences))}
"""All settings of the window, by their paths: "draw.outlines"."""


def value_of(ui: Ui, one: Setting) -> Any:
    """Return what a setting is now."""
    c = ui.controller
    return one.get(c.session.state if one.within else c.preferences)


def in_panel(ui: Ui, panel: str) -> list[Setting]:
    """List the settings of a panel that do something as things are."""
    state = ui.controller.session.state
    return [one for one in ALL.values() if one.panel == panel and (not one.within or state.applies(one))]


def setting_switch(ui: Ui, one: Setting, note: str = "") -> None:
    """Show a tick of a setting that is on or off."""
    tip = f"{one.help}{ui.key(one.label)}{note}"
    checkbox(one.label, value_of(ui, one), lambda on: ui.controller.settings.set(one, on), tip)


def setting_row(ui: Ui, one: Setting, note: str = "") -> None:
    """Show a row of `properties`: a setting's name, and its value to be changed."""
    _row(ui, one, value_of(ui, one), partial(ui.controller.settings.set, one), note)


def plan_rows(ui: Ui, plan: Any, *names: str) -> None:
    """Show rows of `properties` for fields of a plan, by their declarations or, where they are settings of the tracer,
    by those; a number out of range becomes the nearest in it."""
    kind: type = type(plan)
    declared = {one.name: one for one in (*settings_of(Settings), *settings_of(kind))}
    for name in names:
        one = declared[name]

        def put(value: Any, one: Setting = one) -> None:
            setattr(plan, one.name, min(max(value, one.low), one.high) if one.kind in (int, float) else value)

        _row(ui, one, getattr(plan, name), put)


def _row(ui: Ui, one: Setting, now: Any, change: Callable[[Any], None], note: str = "") -> None:
    """The row of a value of any kind."""
    row(one.label, f"{one.help}{note}")
    if one.kind is bool:
        checkbox(f"##{one.name}", now, change)
        return
    value: Any = now
    if one.choices:
        value = _choice(one, now)
    elif one.kind in (int, float):
        value = _number(one, now)
    elif one.kind is str:
        _, value = imgui.input_text_with_hint(f"##{one.name}", one.unset, now)
    elif one.kind is tuple:
        value = size_field(now, int(one.high), ui.controller.notices.say)
    if value != now:
        change(value)


def _choice(one: Setting, now: Any) -> Any:
    """A list; returns what is chosen now."""
    chosen = now
    if imgui.begin_combo(f"##{one.name}", one.text(now)):
        for choice, meaning in one.choices.items():
            if imgui.selectable(one.text(choice), choice == now)[0]:
                chosen = choice
            if meaning:
                tooltip(meaning)
        imgui.end_combo()
    elif one.choices[now]:
        tooltip(one.choices[now])
    return chosen


def _number(one: Setting, now: Any) -> Any:
    """A slider, or a field where the range is too long for one; returns what the number is now.

    More than a slider covers can be typed."""
    scale = 100.0 if one.percent else 1.0
    low, high = one.slider or (one.low, one.high)
    if high - low > LONGEST_SLIDER and not one.log:
        if one.kind is int:
            return imgui.input_int(f"##{one.name}", now, 0)[1]
        changed, value = imgui.input_float(f"##{one.name}", now, 0.0, 0.0, f"%.{one.digits}f")
        return value if changed else now  # floats of C would be others
    flags = int(imgui.SliderFlags_.logarithmic) if one.log else 0
    if one.kind is int:
        return imgui.slider_int(f"##{one.name}", now, int(low), int(high), f"%d{one.unit}", flags)[1]
    unit = " %%" if one.percent else one.unit
    shown = f"%{'+' if low < 0.0 else ''}.{one.digits}f{unit}"
    changed, value = imgui.slider_float(f"##{one.name}", scale * now, scale * low, scale * high, shown, flags)
    return value / scale if changed else now


# --- menus and the palette -------------------------------------------------------------------------


def setting_command(ui: Ui, path: str, menu: str, key: str = "", **more: Any) -> Command:
    """Return the command that switches a setting on or off."""
    one = ALL[path]

    def flip() -> None:
        ui.controller.settings.set(one, not value_of(ui, one))

    return Command(one.label, menu, flip, key, checked=lambda: bool(value_of(ui, one)), tip=one.help, **more)


def entries(ui: Ui) -> Iterator[Item]:
    """Return the settings that have a value, and switches that no menu has, for the palette."""
    c = ui.controller
    refused = "a run is under way" if c.runs.current is not None else ""
    commands = {command.name for command in ui.commands}
    for one in ALL.values():
        locked = refused if one.within == ("settings",) else ""
        if not one.panel or one.label in commands:
            continue
        if one.choices:
            yield from _choices(ui, one, locked)
        elif one.kind is bool:
            flip = partial(c.settings.set, one, not value_of(ui, one))
            yield _entry(ui, one, locked, run=flip, checked=value_of(ui, one), also="on off switch")
        else:
            yield _typed(ui, one, value_of(ui, one), partial(c.settings.set, one), locked)
    if c.session.animated and c.session.scene is not None:
        frame = Setting("Frame", "", 0, c.session.scene.frames - 1, kind=int, panel="Time", name="frame")
        yield _typed(ui, frame, c.session.frame, lambda number: c.motion.step(number - c.session.frame))
    lights = len(c.session.scene.lights) if c.session.scene is not None else 0
    if lights > 1:
        light = replace(ALL["draw.light"], high=lights - 1, panel="View")
        yield _typed(ui, light, c.session.draw.light, c.settings.set_light)


def _entry(ui: Ui, one: Setting, refused: str, **more: Any) -> Item:
    return Item(
        f"setting {one.label}", more.pop("label", one.label), Kind.SETTING, more.pop("run", lambda: None), one.panel,
        enabled=not refused, why_not=refused, hint=more.pop("hint", one.help), **more,
    )  # fmt: skip


def _typed(ui: Ui, one: Setting, now: Any, change: Callable[[Any], None], refused: str = "") -> Item:
    """An entry whose value is typed."""

    def take(typed: str) -> str:
        try:
            change(one.parse(typed, shown=True))
        except ValueError as error:
            return f"{one.label}: {error}"
        return ""

    hint = f"{one.expected_shown}. {one.help}".strip()
    return _entry(ui, one, refused, also="set value", value=one.text(now), take=take, hint=hint)


def _choices(ui: Ui, one: Setting, refused: str) -> Iterator[Item]:
    """An entry for each value of a setting."""
    now, change = value_of(ui, one), ui.controller.settings.set
    for choice, meaning in one.choices.items():
        text, hint = one.text(choice), meaning or one.help
        named = replace(one, label=f"{one.label} {text}")
        yield _entry(ui, named, refused, label=f"{one.label}: {text}", run=partial(change, one, choice),
                     checked=choice == now, hint=hint)  # fmt: skip
