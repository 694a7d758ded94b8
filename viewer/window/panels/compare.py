"""Comparing the live picture, B, with A: what A is, how both are shown, and the statistics of both in columns."""

from __future__ import annotations

from itertools import groupby

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.state.comparison import CompareMode
from viewer.state.frame_rows import beside, change
from viewer.state.palette import LESS, MORE
from viewer.window.panels.culling import method_list
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    WARNING,
    checkbox,
    clipped,
    em,
    paragraph,
    properties,
    right,
    row,
    swatch,
    tooltip,
    wide_button,
)

_WIDE = 44.0  # ems of a panel that has room for controls and columns beside each other
_CONTROLS = 15.5  # ems of the controls there
_NAMES = 7.2  # ems of the names of figures


def show(ui: Ui) -> None:
    """Draw the panel."""
    if imgui.get_content_region_avail().x > em(_WIDE):
        imgui.begin_child("controls", ImVec2(em(_CONTROLS), 0.0))
        _controls(ui)
        imgui.end_child()
        imgui.same_line(0.0, em(1.0))
        imgui.begin_child("columns", ImVec2(0.0, 0.0))
        _columns(ui)
        imgui.end_child()
    else:
        _controls(ui)
        _columns(ui)


def _controls(ui: Ui) -> None:
    """What A is, and how the two are shown."""
    session, comparing = ui.controller.session, ui.controller.comparing
    state, kept = comparing.state, comparing.kept
    tip = f"Keep this picture, to compare others with it{ui.key('Keep as A')}."
    if wide_button(f"{icons.ICON_FA_THUMBTACK}  Keep as A", tip, 2):
        comparing.keep()
    imgui.same_line()
    imgui.begin_disabled(not state.on)
    if wide_button(f"{icons.ICON_FA_XMARK}  End", "Show the live picture alone."):
        comparing.end()
    imgui.end_disabled()
    with properties("comparison", 5.0) as shown:
        if shown:
            row("A is", "What the live picture, B, is compared with.")
            kinds = ["a kept picture", "another method, live"]
            changed, live = imgui.combo("##source", int(bool(state.second)), kinds)
            if changed:
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
    if imgui.begin_combo("##mode", state.mode.label if state.on else "B alone"):
        if imgui.selectable("B alone", not state.on)[0]:
            comparing.end()
        for mode in CompareMode:
            if imgui.selectable(mode.label, state.on and state.mode is mode)[0]:
                comparing.start(mode)
            tooltip(mode.help)
        imgui.end_combo()


def _columns(ui: Ui) -> None:
    """The statistics of A and B, and what B has more or less."""
    c = ui.controller
    a, b = c.comparing.a, c.comparing.b
    if a is None or b is None:
        return
    timed = c.baseline.measured if c.comparing.second_method else None
    flags = imgui.TableFlags_.sizing_stretch_same | imgui.TableFlags_.row_bg | imgui.TableFlags_.scroll_y
    room = ImVec2(0.0, max(imgui.get_content_region_avail().y, em(9.0)))
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
    for name in ("B - A", "of A"):
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
