"""Exact values: how closely the picture is looked at, the pixels that are watched, and how values of a region lie."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui, implot
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.frame import Frame
from viewer.state.comparison import Side
from viewer.state.picking import pixel_at
from viewer.state.pixels import ALL
from viewer.state.readings import can_draw
from viewer.state.views import View
from viewer.views import values_of, words_at
from viewer.views.base import Histogram, histogram
from viewer.views.color import CHANNELS
from viewer.window import picture_commands
from viewer.window.panels import sides
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, checkbox, clipped, count, em, paragraph, right, tooltip

_WIDE = 44.0  # ems of a panel that has room for the list and the histogram beside each other
_PLOT = 5.4  # ems, the least height of the histogram
_OF_CHANNELS = (ImVec4(0.92, 0.33, 0.31, 1.0), ImVec4(0.25, 0.70, 0.35, 1.0), ImVec4(0.35, 0.58, 0.96, 1.0))
_OF_VALUES = (ImVec4(0.42, 0.65, 0.93, 1.0),)


def show(ui: Ui) -> None:
    """The panel."""
    room = imgui.get_content_region_avail()
    if room.x > em(_WIDE):
        imgui.begin_child("watched", ImVec2(0.52 * room.x - em(0.5), 0.0))
        _watched(ui)
        imgui.end_child()
        imgui.same_line(0.0, em(1.0))
        imgui.begin_child("histogram", ImVec2(0.0, 0.0))
        _histogram(ui)
        imgui.end_child()
    else:
        _watched(ui)
        _histogram(ui)


def _watched(ui: Ui) -> None:
    """The list of watched pixels, each with its values in the newest frame."""
    c, p = ui.controller, ui.controller.preferences
    tip = "numbers in the pixels, and a grid, where the picture is enlarged enough"
    checkbox("Values in pixels", p.pixel_values, lambda on: setattr(p, "pixel_values", on), tip)
    imgui.same_line(0.0, em(1.0))
    if not c.session.draw.zoom.fits:
        if imgui.small_button("Fit"):
            picture_commands.fit(ui)
        imgui.same_line()
    zoom = c.session.draw.zoom
    clipped("the whole picture" if zoom.fits else f"enlarged {zoom.scale:.3g} times", QUIET)
    frame = c.frame
    if frame is None or not ui.pixels.watched:
        text = "Ctrl+wheel zooms into the picture, Ctrl+drag moves it. Watch the pixel under the pointer"
        paragraph(f"{text}{ui.key('Watch pixel')}.", QUIET)
        return
    seen = c.comparing.seen
    of_view = c.scheduler.drawn_view not in (View.COLOR, View.WIPE)  # else the value is the colour
    columns = [("", 1.2), ("pixel", 4.0), ("primitive", 3.6), ("colour", 8.4)]
    columns += [(c.scheduler.drawn_view.label.lower(), 5.0)] if of_view else []
    columns += [("the same in A", 8.4 if not of_view else 5.0)] if seen is not None else []
    flags = int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)
    if imgui.begin_table(f"watched pixels {len(columns)}", len(columns), flags):
        for name, width in columns:
            imgui.table_setup_column(name, int(imgui.TableColumnFlags_.width_stretch), width)
        imgui.table_headers_row()
        gone = None
        for number, point in enumerate(ui.pixels.watched):
            imgui.push_id(number)
            if _pixel(ui, frame, number, point, seen.a if seen is not None else None):
                gone = number
            imgui.pop_id()
        if gone is not None:
            del ui.pixels.watched[gone]
        imgui.end_table()


def _pixel(ui: Ui, frame: Frame, number: int, point: tuple[float, float], a: Side | None) -> bool:
    """A row; whether the pixel is to be watched no longer."""
    c = ui.controller
    x, y = pixel_at(frame, *point)
    imgui.table_next_row()
    imgui.table_next_column()
    gone = imgui.small_button(f"{number + 1}")
    tooltip("stop watching this pixel")
    imgui.table_next_column()
    if imgui.selectable(f"{x}, {y}##look", False)[0]:
        c.selection.select(point)
    tooltip("inspect this pixel")
    imgui.table_next_column()
    primitive = int(frame.primitive[y, x])
    clipped(str(primitive) if primitive >= 0 else "miss")
    imgui.table_next_column()
    digits = 4 if a is None else 3  # to fit beside those of A
    clipped(" ".join(f"{channel:.{digits}f}" for channel in frame.color[y, x]))
    if c.scheduler.drawn_view not in (View.COLOR, View.WIPE):
        imgui.table_next_column()
        clipped(_value(ui, frame, c.scheduler.drawn_view, c.session.draw.light, x, y))
    if a is not None:
        imgui.table_next_column()
        there = pixel_at(a.frame, *point)
        clipped(_value(ui, a.frame, a.view, a.light, *there))
    return bool(gone)


def _value(ui: Ui, frame: Frame, view: View, light: int, x: int, y: int) -> str:
    return " ".join(words_at(frame, replace(sides.draw_options(ui), view=view, light=light), x, y)) or "-"


def _histogram(ui: Ui) -> None:
    """How the values of the region lie, and the range of the colour map from them."""
    c, frame, region = ui.controller, ui.controller.frame, ui.pixels.region
    options = sides.draw_options(ui)
    view, light = options.view, options.light
    seen = c.comparing.seen
    difference = seen.difference if seen is not None else None
    if frame is None or not can_draw(frame, view, light):
        return
    if difference is not None and difference.pixels.shape != frame.primitive.shape:
        return  # it is drawn of the frame before
    rows, columns = (region or ALL).pixels(frame)
    wide, high = columns.stop - columns.start, rows.stop - rows.start
    where = f"{wide} x {high} pixels from {columns.start}, {rows.start}" if region is not None else "the whole picture"
    if region is not None:
        if imgui.small_button(f"{icons.ICON_FA_XMARK}##region"):
            ui.pixels.region = None
        tooltip("count the whole picture again")
        imgui.same_line()
    what = view.label if difference is None else f"B - A, {view.label.lower()}"
    clipped(f"{what}: {where}{'' if region is not None else '; Shift+drag for a part of it'}")
    if difference is not None:
        values = ui.cached("differing", difference, None, lambda: difference.differing)
    else:
        values = ui.cached("values", frame, options.of_pixels(), lambda: values_of(frame, options))
    if values.classes:
        paragraph("Modes and numbers of primitives have no histogram; the legend counts them.", QUIET)
        return
    found: Histogram | None = ui.cached("histogram", values, region, lambda: histogram(values, rows, columns))
    if found is None:
        paragraph("No pixel here has a value." if difference is None else "No pixel differs here.", QUIET)
        return
    if difference is not None:
        paragraph(f"{count(found.pixels)} of {count(found.of)} pixels differ; these are counted here", QUIET)
    elif found.pixels < found.of:
        paragraph(f"{count(found.pixels)} of {count(found.of)} pixels have a value", QUIET)
    _figures(found, values.names)
    if difference is not None:
        if imgui.small_button("Use as the range of colours"):
            c.comparing.change(limit=max(-found.least[0], found.largest[0]))
        tooltip("the colours go as far to both sides of 0 as the difference does here")
    elif view.has_range and not (view.needs_work and c.session.draw.shares):
        if imgui.small_button("Use as the range of colours"):
            span = min(found.least), max(max(found.largest), min(found.least) + 1e-6)
            c.session.change(draw=c.session.draw.with_span(span, view))
        tooltip("the first and the last colour of the map stand for the least and the largest value here")
    _plot(found, values.names)


def _figures(found: Histogram, names: tuple[str, ...]) -> None:
    width = imgui.get_content_region_avail().x - em(0.3)  # columns of figures at the right are a little wider by parts
    if imgui.begin_table("figures", 4, int(imgui.TableFlags_.sizing_stretch_prop), ImVec2(width, 0.0)):
        for column in ("name", "least", "mean", "largest"):
            imgui.table_setup_column(column, int(imgui.TableColumnFlags_.width_stretch), 1.0)
        for text in ("", "least", "mean", "largest"):
            imgui.table_next_column()
            right(text, QUIET)
        for number, name in enumerate(names):
            imgui.table_next_column()
            clipped(name, QUIET)
            for figure in (found.least[number], found.mean[number], found.largest[number]):
                imgui.table_next_column()
                right(f"{figure:.5g}")
        imgui.end_table()


def _plot(found: Histogram, names: tuple[str, ...]) -> None:
    room = imgui.get_content_region_avail()
    size = ImVec2(room.x, max(room.y, em(_PLOT)))
    flags = implot.Flags_.no_menus | implot.Flags_.no_box_select | implot.Flags_.no_mouse_text
    if len(names) == 1:
        flags |= implot.Flags_.no_legend
    if not implot.begin_plot("##histogram", size, int(flags)):
        return
    axis = int(implot.AxisFlags_.no_highlight)
    implot.setup_axes("", "", axis, axis | int(implot.AxisFlags_.no_tick_labels))
    top = float(found.counts.max())
    implot.setup_axes_limits(found.low, found.high, 0.0, 1.08 * top, int(imgui.Cond_.always))
    implot.setup_legend(implot.Location_.north_east)
    bins = found.counts.shape[1]
    edges = np.linspace(found.low, found.high, bins + 1)
    colors = _OF_CHANNELS if names == CHANNELS or len(names) == 3 else _OF_VALUES
    for name, counts, color in zip(names, found.counts, colors, strict=True):
        steps = np.append(counts, counts[-1]).astype(np.float64)
        look = implot.Spec(line_color=color, line_weight=1.4, fill_color=color, fill_alpha=0.28)
        look.flags = int(implot.StairsFlags_.shaded)
        implot.plot_stairs(name, edges, steps, look)
    implot.end_plot()
