"""Settings in the window: rows of panels, switches of menus and entries of the palette, all made from declarations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from imgui_bundle import imgui

from tracer.settings import Settings
from tracer.util.setting import Setting, settings_of
from viewer.state.preferences import Preferences
from viewer.state.view_state import ViewState
from viewer.window.command import Command, Condition, Kind
from viewer.window.ui import Ui
from viewer.window.widgets import checkbox, one_of_list, properties, row, same_line_for, size_field

LONGEST_SLIDER = 200.0
"""The range past which a number is typed, and has no slider."""
ALL = {one.path: one for one in (*settings_of(ViewState), *settings_of(Preferences))}
"""All settings of the window, by their paths: "draw.outlines"."""


def value_of(ui: Ui, one: Setting) -> Any:
    """Return what a setting is now."""
    c = ui.controller
    return one.get(c.session.state if one.within else c.preferences)


def in_panel(ui: Ui, *panels: str) -> list[Setting]:
    """List the settings of a panel, or of several, that do something as things are."""
    state = ui.controller.session.state
    return [one for one in ALL.values() if one.panel in panels and (not one.within or state.applies(one))]


def panel_rows(
    ui: Ui, panel: str, names: float, own: Mapping[str, Callable[[Ui, Setting], None]] = {},
    above: Callable[[], None] = lambda: None, below: Callable[[], None] = lambda: None,
    note: Callable[[Setting], str] = lambda one: "", also: Sequence[str] = (),
) -> None:  # fmt: skip
    """Show all settings that are declared for a panel, or as of others that it stands for `also`, and do something as
    things are: rows of those that have a value, with room for names of so many ems, and below these ticks beside each
    other.

    `own` has rows of another kind, by the setting's path; `above` and `below` show further rows; `note` is added to
    what is said of a setting."""
    settings = in_panel(ui, panel, *also)
    ticks = [one for one in settings if one.kind is bool and one.path not in own]
    with properties(panel, names) as shown:
        if shown:
            above()
            for one in settings:
                if one.path in own:
                    own[one.path](ui, one)
                elif one not in ticks:
                    setting_row(ui, one, note(one))
            below()
    for number, one in enumerate(ticks):
        if number:
            same_line_for(one.label)
        setting_switch(ui, one, note(one))


def setting_switch(ui: Ui, one: Setting, note: str = "") -> None:
    """Show a tick of a setting that is on or off."""
    tip = f"{one.help}{ui.key(one.label)}{note}"
    checkbox(one.label, value_of(ui, one), lambda on: ui.controller.settings.set(one, on), tip)


def setting_row(ui: Ui, one: Setting, note: str = "", room: float = 0.0) -> None:
    """Show a row of `properties`: a setting's name, and its value to be changed; `room` in ems is left behind it."""
    row(one.label, f"{one.help}{note}", room)
    now = value_of(ui, one)
    value = _value(ui, one, now)
    if value != now:
        ui.controller.settings.set(one, value)


def plan_rows(ui: Ui, plan: Any, *names: str) -> None:
    """Show rows of `properties` for fields of a plan, by their declarations or, where they are settings of the tracer,
    by those; a number out of range becomes the nearest in it."""
    kind: type = type(plan)
    declared = {one.name: one for one in (*settings_of(Settings), *settings_of(kind))}
    for name in names:
        one = declared[name]
        row(one.label, one.help)
        now = getattr(plan, name)
        value = _value(ui, one, now)
        if value != now:
            setattr(plan, name, min(max(value, one.low), one.high) if one.kind in (int, float) else value)


def _value(ui: Ui, one: Setting, now: Any) -> Any:
    """Show a value of any kind; returns what it is now."""
    if one.kind is bool:
        return checkbox(f"##{one.name}", now)
    if one.choices:
        return _choice(one, now)
    if one.kind in (int, float):
        return _number(one, now)
    if one.kind is str:
        return imgui.input_text_with_hint(f"##{one.name}", one.unset, now)[1]
    return size_field(now, int(one.high), ui.controller.notices.say)


def _choice(one: Setting, now: Any) -> Any:
    """A list; returns what is chosen now."""
    choices = ((choice, one.text(choice), meaning) for choice, meaning in one.choices.items())
    return one_of_list(f"##{one.name}", one.text(now), choices, now, one.choices[now])


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


def entries(ui: Ui) -> Iterator[Command]:
    """Return the settings that have a value, and switches that no menu has, for the palette."""
    commands = {command.name for command in ui.commands}
    for one in ALL.values():
        if one.panel and one.label not in commands:
            yield from _entries(ui, one, value_of(ui, one))


def _entries(ui: Ui, one: Setting, now: Any) -> Iterator[Command]:
    """Return the entries of one setting: for each of its choices, to switch it, or to type its value."""
    c = ui.controller
    free = Condition(lambda: c.runs.current is None or one.within != ("settings",), "a run is under way")

    def take(typed: str) -> str:
        try:
            c.settings.set(one, one.parse(typed, shown=True))
        except ValueError as error:
            return f"{one.label}: {error}"
        return ""

    def entry(run: Callable[[], None], tip: str, choice: str = "", **more: Any) -> Command:
        name, title = f"setting {one.label} {choice}".rstrip(), f"{one.label}: {choice}" if choice else one.label
        return Command(name, one.panel, run, title=title, kind=Kind.SETTING, enabled=free, tip=tip, **more)

    if one.choices:
        for choice, meaning in one.choices.items():
            choose = partial(c.settings.set, one, choice)
            yield entry(choose, meaning or one.help, one.text(choice), checked=partial(bool, choice == now))
    elif one.kind is bool:
        flip = partial(c.settings.set, one, not now)
        yield entry(flip, one.help, checked=partial(bool, now))
    else:
        tip = f"{one.expected_shown}. {one.help}".strip()
        yield entry(lambda: None, tip, value=one.text(now), take=take)
