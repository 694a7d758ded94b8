"""Exact values: the picture itself is looked at closely, with the values of its pixels in them, and the panel says how
those lie that are seen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui, implot

from viewer.state.comparison import Side
from viewer.state.palette import DARK
from viewer.state.pixels import FIT, GRID_FROM, pixels_shown, zoomed
from viewer.state.views import can_draw
from viewer.views import values_of
from viewer.views.base import Histogram, histogram
from viewer.window.panels import sides
from viewer.window.panels.area import FRONT, Area, inside
from viewer.window.panels.plots import AXIS, FLAGS
from viewer.window.setting_rows import panel_rows
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, count, em, paragraph, right

_FIGURES, _PLOT = 20.0, 5.4  # ems: the width of the figures, and the least height of the histogram
_OF_CHANNELS = (ImVec4(0.92, 0.33, 0.31, 1.0), ImVec4(0.25, 0.70, 0.35, 1.0), ImVec4(0.35, 0.58, 0.96, 1.0))
_OF_VALUES = (ImVec4(0.42, 0.65, 0.93, 1.0),)
_GRID, _BACK = ImVec4(0.5, 0.5, 0.5, 0.45), ImVec4(*DARK, 0.66)
_SMALLEST = 0.62  # of the usual size of letters, for the numbers in pixels
_MOST_NUMBERS = 1500  # pixels whose values are written at once


# --- the panel ----------------------------------------------------------------------------------------


def show(ui: Ui) -> None:
    """How closely the picture is looked at, how the values that are seen lie, and the range of colours from them."""
    session = ui.controller.session
    zoom = session.draw.zoom
    panel_rows(ui, "Pixels", 5.0)
    imgui.same_line(0.0, em(1.0))
    if zoom.fits:
        clipped("Ctrl+wheel zooms into the picture, Ctrl+drag moves it", QUIET)
    else:
        if imgui.small_button("Fit"):
            session.set_draw(zoom=FIT)
        imgui.same_line()
        clipped(f"enlarged {zoom.scale:.3g} times", QUIET)
    _histogram(ui)


def _histogram(ui: Ui) -> None:
    c, frame = ui.controller, ui.controller.frame
    options, seen = sides.draw_options(ui), c.comparing.seen
    difference = seen.difference if seen is not None else None
    view, zoom = options.view, c.session.draw.zoom
    if frame is None or not can_draw(frame, view, options.light):
        return
    if difference is not None and difference.pixels.shape != frame.primitive.shape:
        return  # it is drawn of the frame before
    x, y = pixels_shown(zoom, frame.width, frame.height)
    where = "the whole picture" if zoom.fits else f"the {len(x)} x {len(y)} pixels that are seen"
    paragraph(f"{view.label if difference is None else f'B - A, {view.label.lower()}'}: {where}")
    if difference is not None:
        values = ui.cached("differing", difference, None, lambda: difference.differing)
    else:
        values = ui.cached("values", frame, options.of_pixels(), lambda: values_of(frame, options))
    if values.classes:
        paragraph("Modes and numbers of primitives have no histogram; the legend counts them.", QUIET)
        return
    found: Histogram | None = ui.cached(
        "histogram", values, (x, y),
        lambda: histogram(values, slice(y.start, y.stop), slice(x.start, x.stop)),
    )  # fmt: skip
    if found is None:
        paragraph("No pixel here has a value." if difference is None else "No pixel differs here.", QUIET)
        return
    if found.pixels < found.of or difference is not None:
        what = "have a value" if difference is None else "differ"
        paragraph(f"{count(found.pixels)} of {count(found.of)} pixels {what}; these are counted here", QUIET)
    ranged = c.session.draw.has_span
    if difference is None and ranged and imgui.small_button("Use as the range of colours"):
        span = min(found.least), max(max(found.largest), min(found.least) + 1e-6)
        c.session.change(draw=c.session.draw.with_span(span, view))
    room = imgui.get_content_region_avail().x
    _figures(found, values.names, em(_FIGURES) if room > 2.0 * em(_FIGURES) else room)
    if room > 2.0 * em(_FIGURES):
        imgui.same_line()
    _plot(found, values.names)


def _figures(found: Histogram, names: tuple[str, ...], width: float) -> None:
    width -= em(0.3)  # columns of figures at the right are a little wider by parts
    if imgui.begin_table("figures", 4, int(imgui.TableFlags_.sizing_stretch_same), ImVec2(width, 0.0)):
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
    flags = FLAGS | (int(implot.Flags_.no_legend) if len(names) == 1 else 0)
    if not implot.begin_plot("##histogram", ImVec2(room.x, max(room.y, em(_PLOT))), flags):
        return
    implot.setup_axes("", "", AXIS, AXIS | int(implot.AxisFlags_.no_tick_labels))
    top = float(found.counts.max())
    implot.setup_axes_limits(found.low, found.high, 0.0, 1.08 * top, int(imgui.Cond_.always))
    implot.setup_legend(implot.Location_.north_east)
    edges = np.linspace(found.low, found.high, found.counts.shape[1] + 1)
    colors = _OF_CHANNELS if len(names) == 3 else _OF_VALUES
    for name, counts, color in zip(names, found.counts, colors, strict=True):
        steps = np.append(counts, counts[-1]).astype(np.float64)
        look = implot.Spec(line_color=color, line_weight=1.4, fill_color=color, fill_alpha=0.28)
        look.flags = int(implot.StairsFlags_.shaded)
        implot.plot_stairs(name, edges, steps, look)
    implot.end_plot()


# --- over the picture ---------------------------------------------------------------------------------


def draw(ui: Ui, area: Area, side: Side | None = None) -> None:
    """Over the picture of a side, or what else is seen: a grid of pixels with their values."""
    found = sides.words(ui, sides.draw_options(ui), side)
    if found is None or not ui.controller.preferences.pixel_values:
        return
    frame, words = found
    with inside(area):
        _grid(area, frame.width, frame.height)
        _numbers(area, frame.width, frame.height, words)


def _grid(area: Area, width: int, height: int) -> None:
    """Lines between the picture's pixels, where these are large."""
    made, across, down = imgui.get_window_draw_list(), area.whole_size.x / width, area.whole_size.y / height
    if min(across, down) < GRID_FROM:
        return
    color, (columns, rows) = imgui.get_color_u32(_GRID), pixels_shown(area.zoom, width, height)
    for x in columns:
        at = round(area.whole.x + x * across)
        made.add_line(ImVec2(at, area.corner.y), ImVec2(at, area.end.y), color)
    for y in rows:
        at = round(area.whole.y + y * down)
        made.add_line(ImVec2(area.corner.x, at), ImVec2(area.end.x, at), color)


def _numbers(area: Area, width: int, height: int, words: Callable[[int, int], tuple[str, ...]]) -> None:
    """The value of each pixel in it, as large as fits, where all fit."""
    across, down = area.whole_size.x / width, area.whole_size.y / height
    columns, rows = pixels_shown(area.zoom, width, height)
    letters = imgui.get_font_size()
    if down < _SMALLEST * letters or across < 2.0 * _SMALLEST * letters or len(columns) * len(rows) > _MOST_NUMBERS:
        return
    texts = {(x, y): words(x, y) for x in columns for y in rows}
    widest = max((imgui.calc_text_size(line).x for lines in texts.values() for line in lines), default=0.0)
    tallest = max((len(lines) for lines in texts.values()), default=0) * letters
    part = min(0.9 * across / widest, 0.9 * down / tallest, 1.0) if widest and tallest else 0.0
    if part < _SMALLEST:
        return
    made, font, size = imgui.get_window_draw_list(), imgui.get_font(), part * letters
    back, front = imgui.get_color_u32(_BACK), imgui.get_color_u32(FRONT)
    for (x, y), lines in texts.items():
        middle = area.to_screen((x + 0.5) / width, (y + 0.5) / height)
        halves = [0.5 * part * imgui.calc_text_size(line).x for line in lines]
        half, top, pad = max(halves, default=0.0), middle.y - 0.5 * size * len(lines), 0.12 * size
        end = ImVec2(middle.x + half + pad, top + size * len(lines))
        made.add_rect_filled(ImVec2(middle.x - half - pad, top), end, back, 2.0 * pad)
        for number, line in enumerate(lines):
            made.add_text(font, size, ImVec2(middle.x - halves[number], top + number * size), front, line)


# --- zoom, by the wheel and by commands ---------------------------------------------------------------


def zoom_by(ui: Ui, factor: float) -> None:
    """Enlarge the picture around what is under the pointer, which stays where it is; else around its middle."""
    session, hovered = ui.controller.session, ui.controller.selection.hovered
    zoom, at = session.draw.zoom, (0.5, 0.5)
    if hovered is not None:
        at = (hovered[0] - zoom.left) * zoom.scale, (hovered[1] - zoom.top) * zoom.scale
    session.set_draw(zoom=zoomed(zoom, factor, at))
