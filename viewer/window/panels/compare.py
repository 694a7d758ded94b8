"""Comparing the live picture, B, with A: what A is, how both are shown, and the statistics of both in columns."""

from __future__ import annotations

from itertools import groupby

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.comparison import CompareMode
from viewer.state.frame_rows import beside, change
from viewer.state.palette import LESS, MORE
from viewer.window import menus
from viewer.window.command import Command, Condition
from viewer.window.panels.culling import method_list
from viewer.window.panels.runs import arrange
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    WARNING,
    checkbox,
    clipped,
    em,
    one_of_list,
    paragraph,
    properties,
    right,
    row,
    swatch,
    tooltip,
    wide_button,
)

_COLUMNS = 12.0  # ems of the statistics, at least
_NAMES = 7.2  # ems of the names of figures


def show(ui: Ui) -> None:
    """Draw the panel."""
    arrange(lambda: _controls(ui), lambda: None, (("Statistics", _COLUMNS, lambda: _columns(ui)),))


def _controls(ui: Ui) -> None:
    """What A is, and how the two are shown."""
    session, comparing = ui.controller.session, ui.controller.comparing
    state, kept = comparing.state, comparing.kept
    menus.button(ui, "Keep as A", icons.ICON_FA_THUMBTACK, columns=2)
    imgui.same_line()
    imgui.begin_disabled(not state.on)
    if wide_button(f"{icons.ICON_FA_XMARK}  End", "Show the live picture alone."):
        comparing.end()
    imgui.end_disabled()
    with properties("comparison", 5.0) as shown:
        if shown:
            row("A is", "What the live picture, B, is compared with.")
            kinds = {False: "a kept picture", True: "another method, live"}
            was = bool(state.second)
            live = one_of_list("##source", kinds[was], ((kind, label, "") for kind, label in kinds.items()), was)
            if live != was:
                comparing.trace_by(comparing.other_method if live else "")
            if state.second:
                row("A's method", "Each frame is traced a second time by this method, with its own modes and counters.")
                method_list(ui, "##second", state.second, comparing.trace_by)
            held = ui.key_label("Show A")
            row("Show", f"How A and B are shown.{f' Hold {held} to see A.' if held else ''}")
            _mode(ui)
            if comparing.seen is not None and comparing.seen.difference is not None:
                row("Rings", f"Draw rings around pixels that differ{ui.key('Mark wrong pixels')}.")
                checkbox("##rings", session.draw.mark_wrong, lambda on: session.set_draw(mark_wrong=on))
    if not state.second and kept is None:
        paragraph("Nothing is kept yet. Keep a picture, change anything, and compare.", QUIET)
    elif comparing.remark:
        paragraph(comparing.remark, WARNING)
    if not state.second and kept is not None:
        size = f"{kept.frame.width} x {kept.frame.height}"
        paragraph(f"kept: {kept.scene}, frame {kept.number}, {kept.method}, {size}", QUIET)


def _mode(ui: Ui) -> None:
    comparing, state = ui.controller.comparing, ui.controller.comparing.state
    modes = [(None, "B alone", ""), *((mode, mode.label, mode.help) for mode in CompareMode)]
    now = state.mode if state.on else None
    chosen = one_of_list("##mode", state.mode.label if state.on else "B alone", modes, now)
    if chosen is not now and chosen is not None:
        comparing.start(chosen)
    elif chosen is not now:
        comparing.end()


def _columns(ui: Ui) -> None:
    """The statistics of A and B, and what B has more or less."""
    c = ui.controller
    a, b = c.comparing.a, c.comparing.b
    if a is None or b is None:
        return
    timed = c.baseline.measured if c.comparing.second_method else None
    flags = imgui.TableFlags_.sizing_stretch_same | imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_y
    left = imgui.get_content_region_avail()
    room = ImVec2(left.x - 1.0, max(left.y, em(9.0)))
    if not imgui.begin_table("statistics of both", 5, int(flags | imgui.TableFlags_.no_host_extend_x), room):
        return
    imgui.table_setup_scroll_freeze(0, 1)
    imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_fixed), em(_NAMES))
    for name, width in (("A", 1.25), ("B", 1.25), ("difference", 1.0), ("per cent", 0.85)):
        imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), width)
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    imgui.table_next_column()
    for name, color in ((f"A  {a.named(b)}", LESS), (f"B  {b.named(a)}", MORE)):
        imgui.table_next_column()
        swatch(color)
        clipped(name)
    for name in ("B - A", "in %"):
        imgui.table_next_column()
        right(name)
    found = ui.cached("pairs", a.frame, (b.frame, timed), lambda: beside(a.frame, b.frame, timed))
    for group, pairs in groupby(found, lambda pair: pair[0].group):
        imgui.table_next_row()
        imgui.table_next_column()
        clipped(group)
        for one, other in pairs:
            imgui.table_next_row()
            imgui.table_next_column()
            clipped(" / ".join(dict.fromkeys(filter(None, (one.name, other.name)))), QUIET)
            tooltip(one.tip or other.tip)
            for text in (one.text(one.number), other.text(other.number), *change(one, other)):
                imgui.table_next_column()
                right(text)
    imgui.end_table()


def compare_commands(ui: Ui) -> list[Command]:
    """The menu Compare."""
    comparing = ui.controller.comparing
    there = Condition(lambda: comparing.b is not None, "there is no picture yet")
    kept = Condition(lambda: comparing.kept is not None, "nothing is kept as A")

    def keep() -> None:
        comparing.keep()
        ui.offer_panel("Compare")

    def by(mode: CompareMode) -> Command:
        return Command(mode.command, "Compare", lambda: comparing.toggle(mode), enabled=there, tip=mode.help,
                       checked=lambda: comparing.state.on and comparing.state.mode is mode)  # fmt: skip

    return [
        Command("Keep as A", "Compare", keep, "Ctrl+A", enabled=there, tip="this picture, to compare others with it"),
        Command("Clear A", "Compare", comparing.forget, enabled=kept),
        Command("Two methods live", "Compare", comparing.toggle_methods, "Shift+C", enabled=there,
                checked=lambda: bool(comparing.second_method),
                tip="trace each frame by a second method as well: which is faster, and what each saves"),
        Command("Next compare mode", "Compare", comparing.next_mode, "Shift+Z", enabled=there, separated=True),
        *map(by, CompareMode),
        Command("B alone", "Compare", comparing.end, "Ctrl+Shift+A", checked=lambda: not comparing.state.on,
                separated=True),
    ]  # fmt: skip
