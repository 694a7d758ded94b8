"""Comparing the live picture, B, with A: what A is, how both are shown, and the statistics of both in columns."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.frame import Frame
from viewer.state.columns import Row, rows
from viewer.state.comparison import RATES, CompareMode, Side, Source, elided
from viewer.state.in_turn import InTurn
from viewer.state.palette import LESS, MORE
from viewer.window.panels.culling import method_list
from viewer.window.ui import Ui
from viewer.window.widgets import (
    QUIET,
    WARNING,
    checkbox,
    clipped,
    count,
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
    """The panel."""
    room = imgui.get_content_region_avail()
    if room.x > em(_WIDE):
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
    c = ui.controller
    comparing, state = c.comparing, c.comparing.state
    if wide_button(
        f"{icons.ICON_FA_THUMBTACK}  Keep as A",
        f"Keep this picture, to compare others with it{ui.key('Keep as A')}.",
        2,
    ):
        comparing.keep()
    imgui.same_line()
    imgui.begin_disabled(not state.on)
    if wide_button(f"{icons.ICON_FA_XMARK}  End", "Show the live picture only."):
        comparing.end()
    imgui.end_disabled()
    with properties("comparison", 5.0) as shown:
        if shown:
            row("A is", "What the live picture, B, is compared with.")
            names = {Source.KEPT: "a kept picture", Source.METHOD: "another method, live"}
            sources = list(Source)
            changed, index = imgui.combo("##source", sources.index(state.source), [names[one] for one in sources])
            if changed:
                comparing.use(sources[index])
            if state.source is Source.METHOD:
                row("A's method", "Each frame is traced a second time by this method, with its own modes and counters.")
                _second(ui)
            held = ui.key_label("Show A")
            row("Show", f"How A and B are shown.{f' Hold {held} to see A.' if held else ''}")
            _mode(ui)
            if state.mode is CompareMode.BLINK:
                row("Rate", "How often per second both are shown.")
                changed, rate = imgui.slider_float("##rate", state.rate, *RATES, "%.2f Hz")
                if changed:
                    comparing.change(rate=min(max(rate, RATES[0]), RATES[1]))
            if state.mode is CompareMode.DIFFERENCE and state.on:
                _limit(ui)
                _rings(ui)
    if state.source is Source.KEPT:
        _kept(ui)
    if comparing.remark:
        paragraph(comparing.remark, WARNING)


def _mode(ui: Ui) -> None:
    comparing, state = ui.controller.comparing, ui.controller.comparing.state
    if not imgui.begin_combo("##way", state.mode.label if state.on else "B alone"):
        return
    if imgui.selectable("B alone", not state.on)[0]:
        comparing.end()
    for mode in CompareMode:
        if imgui.selectable(mode.label, state.on and state.mode is mode)[0]:
            comparing.start(mode)
        tooltip(mode.meaning)
    imgui.end_combo()


def _second(ui: Ui) -> None:
    """The second method: a base, and what is added to it."""
    comparing = ui.controller.comparing
    method_list(ui, "##second", comparing.state.second or "none", comparing.trace_by)


def _limit(ui: Ui) -> None:
    """The range of the signed difference."""
    comparing, state = ui.controller.comparing, ui.controller.comparing.state
    sides = comparing.sides
    found = comparing.difference(*sides) if sides is not None else None
    if found is None or found.values.classes:
        return
    limit = comparing.limit(found)
    row("Range", "How far the colours go to both sides of 0. Drag, or Ctrl+click to type a number.")
    imgui.set_next_item_width(-em(4.2))
    changed, limit = imgui.drag_float("##limit", limit, max(limit / 100.0, 1e-6), 1e-6, 1e9, "\u00b1 %.4g")
    if changed and limit > 0.0:
        comparing.change(limit=limit)
    imgui.same_line(0.0, em(0.3))
    imgui.begin_disabled(state.limit is None)
    if imgui.button("Fit##limit", (-1.0, 0.0)):
        comparing.change(limit=None)
    imgui.end_disabled()


def _rings(ui: Ui) -> None:
    """Whether the signed difference marks where it is largest."""
    session = ui.controller.session
    row("Rings", f"Draw rings around the pixels that differ most{ui.key('Mark wrong pixels')}.")
    checkbox("##rings", session.draw.mark_wrong, lambda on: session.set_draw(mark_wrong=on))


def _kept(ui: Ui) -> None:
    """What is kept, and whether it follows the view."""
    comparing = ui.controller.comparing
    kept = comparing.kept
    if kept is None:
        paragraph("Nothing is kept yet. Keep a picture, change anything, and compare.", QUIET)
        return
    paragraph(
        f"kept: {kept.scene}, frame {kept.number}, {kept.method}, {kept.view.label.lower()}{kept.of_light}, "
        f"{kept.frame.width} x {kept.frame.height}",
        QUIET,
    )
    tip = "Show A in the view of B, where the frame of A has what that needs, not in the view in which it was kept."
    checkbox("A in the view of B", comparing.state.same_view, lambda on: comparing.change(same_view=on), tip)


def _columns(ui: Ui) -> None:
    """The statistics of A and B, and what B has more or less."""
    comparing = ui.controller.comparing
    a, b = comparing.a, comparing.b
    if a is None or b is None:
        return
    timed = ui.controller.baseline.measured if comparing.second_method else None
    found = figures(ui, a.frame, b.frame, timed)
    flags = int(
        imgui.TableFlags_.sizing_stretch_same
        | imgui.TableFlags_.row_bg
        | imgui.TableFlags_.scroll_y
        | imgui.TableFlags_.no_host_extend_x
    )
    if not imgui.begin_table(
        "statistics of both", 5, flags, ImVec2(0.0, max(imgui.get_content_region_avail().y, em(9.0)))
    ):
        return
    imgui.table_setup_scroll_freeze(0, 2)
    imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_fixed), em(_NAMES))
    for name, width in (("A", 1.25), ("B", 1.25), ("difference", 1.0), ("per cent", 0.85)):
        imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), width)
    _heads(a, b, comparing.names(a, b))
    for one in found:
        _row(one)
    imgui.end_table()


def figures(ui: Ui, a: Frame, b: Frame, timed: InTurn | None) -> list[Row]:
    """What there is to say of both, and of frames that were timed in turn; made anew once any of them is another."""
    found: list[Row] = ui.cached("columns", a, (b, timed), lambda: rows(a, b, timed))
    return found


def _heads(a: Side, b: Side, names: tuple[str, str]) -> None:
    """Two rows: which is which, and how large they are."""
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    imgui.table_next_column()
    for name, other, color in ((*names, LESS), (*names[::-1], MORE)):
        imgui.table_next_column()
        swatch(color)
        _name(name, other)
    for name in ("B - A", "of A"):
        imgui.table_next_column()
        right(name)
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    imgui.table_next_column()
    clipped("pixels", QUIET)
    for side in (a, b):
        imgui.table_next_column()
        right(f"{side.frame.width} x {side.frame.height}", QUIET)
    shaded = [side.frame.primitive.size * side.frame.statistics.part for side in (a, b)]
    imgui.table_next_column()
    imgui.table_next_column()
    if round(shaded[0]) != round(shaded[1]):
        right("not alike", WARNING)
        tooltip(f"figures are of {count(shaded[0])} shaded pixels of A and {count(shaded[1])} of B")


def _name(name: str, other: str) -> None:
    """What A or B is, so that one sees what sets it apart from the other."""
    letter, room = name[:3], imgui.get_content_region_avail().x + 0.5
    shown = letter + elided(name[3:], other[3:], lambda text: imgui.calc_text_size(letter + text).x <= room)
    imgui.text_unformatted(shown)
    if shown != name:
        tooltip(name)


def _row(one: Row) -> None:
    imgui.table_next_row()
    imgui.table_next_column()
    clipped(one.name, QUIET if not one.heading else None)
    if one.tip:
        tooltip(one.tip)
    if one.heading:
        return
    texts = (one.written(one.a), one.written(one.b), one.written(one.difference, signed=True), one.written_share)
    for text in texts:
        imgui.table_next_column()
        right(text)
