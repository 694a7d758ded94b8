"""The view: what is shown of the frame, and what its colours mean."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui
from numpy.typing import NDArray

from tracer.method import culls_by_modes
from tracer.renderer import Frame
from tracer.statistics import SaidByModes
from viewer.legends import (
    DifferenceLegend,
    LegendRow,
    WorkLegend,
    certificate_legend,
    difference_legend,
    occlusion_legend,
    shadow_legend,
    work_legend,
)
from viewer.panels.widgets import (
    GOOD,
    QUIET,
    WARNING,
    checkbox,
    count,
    em,
    paragraph,
    percent,
    properties,
    row,
    swatch,
    tooltip,
    value,
)
from viewer.ui import Ui
from viewer.views import GREY, WRONG, View, color_map, has_modes_of_cells

_GRADIENT_STEPS = 24
FULL_TOLD = "they end on primitives that are fully rendered and in full shadow"
NON_TOLD = "they end on primitives that are fully rendered and in non-shadow"
_FLAT = (View.OCCLUSION, View.SHADOW, View.PRIMITIVE, View.PIXEL_COUNT, View.CERTIFICATE)


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    p = c.preferences
    views = list(View)
    with properties("view", 5.0) as shown:
        if shown:
            row("View", "keys 1 to 9, 0, H and Shift+H")
            chosen = views.index(c.session.view)
            changed, index = imgui.combo("##view", chosen, [f"{v.label}" for v in views])
            if changed:
                c.set_view(views[index])
            if c.session.view.of_light and c.session.scene is not None and c.session.scene.lights:
                row("Light", "L and Shift+L")
                names = [f"{i}  {light.name}" for i, light in enumerate(c.session.scene.lights)]
                changed, light = imgui.combo("##light", c.session.light, names)
                if changed:
                    c.set_light(light)
            if c.session.view is View.WIPE:
                row("Line", "where it is; or drag it in the picture")
                changed, at = imgui.slider_float("##wipe", 100.0 * c.session.wipe, 0.0, 100.0, "%.0f %%")
                c.session.wipe = min(max(at / 100.0, 0.0), 1.0) if changed else c.session.wipe
            if c.session.view is View.DIFFERENCE:
                row("Beneath", "how bright the picture is beneath the wrong pixels")
                changed, percents = imgui.slider_float("##beneath", 100.0 * p.beneath, 0.0, 60.0, "%.0f %%")
                p.beneath = min(max(percents / 100.0, 0.0), 0.6) if changed else p.beneath
            if c.session.view in _FLAT:
                row("Shading", "how much of the picture's light and shade shows under the colours")
                _, c.preferences.shading = imgui.slider_float("##shading", c.preferences.shading, 0.0, 1.0, "%.2f")
    checkbox("Outlines", p.outlines, lambda on: setattr(p, "outlines", on), "borders between primitives (B)")
    if c.session.view.needs_work:
        imgui.same_line(0.0, em(1.0))
        tip = "which share of the rays that were due, not how many (U)"
        checkbox("Shares", p.work_shares, lambda on: setattr(p, "work_shares", on), tip)
    if c.session.view.needs_verify:
        imgui.same_line(0.0, em(1.0))
        tip = "rings around pixels with wrong shadow answers, so that a lone one is found (M)"
        checkbox("Mark wrong pixels", p.mark_wrong, lambda on: setattr(p, "mark_wrong", on), tip)
    if c.frame is not None:
        _legend(ui, c.frame)


def _legend(ui: Ui, frame: Frame) -> None:
    """What the colours stand for, and how much of the frame each is."""
    view, light = ui.controller.session.view, ui.controller.session.light
    tip = view.explanation
    if not view.can_draw(frame) and not (view.needs_verify or view.needs_work):
        return  # the picture says why
    units = "cells" if has_modes_of_cells(frame) else "primitives"
    if view is View.OCCLUSION:
        _table(ui.cached("occlusion", frame, 0, lambda: occlusion_legend(frame)), units)
    elif view.of_light:
        legend = shadow_legend if view is View.SHADOW else certificate_legend
        rows = ui.cached(view.value, frame, light, lambda: legend(frame, light))
        if not rows:
            paragraph("Culling does not cover this light: its shadow rays are all traced.", WARNING)
            return
        _table(rows, units if view is View.SHADOW else "cells seen")
    elif view is View.DEPTH and ui.display is not None:
        near, far = ui.display.depth_range
        _gradient(f"{near:.4g}", f"{far:.4g}", reverse=True)
    elif view is View.PIXEL_COUNT:
        zoom = frame.settings.zoom_factor
        _gradient(f"1/{zoom:.3g}", f"{zoom:.3g} x", "as many")
        swatch(GREY)
        imgui.text_unformatted("never fully rendered")
    elif view.needs_work:
        _work(ui, frame)
    elif view.needs_verify:
        run = ui.controller.runner.current
        if run is not None and run.lacks(view):
            paragraph("This run does not verify; tick Verify in the Experiment panel before the next.", WARNING)
            return
        _difference(ui, frame)
        tip += " While it is chosen each culled ray is traced as well, so that frames take longer."
    if view.of_modes:
        _would_cull(frame, light if view is View.SHADOW else None)
    paragraph(tip, QUIET)


def _would_cull(frame: Frame, light: int | None) -> None:
    """What the paper's method would cull of this frame's shadow rays: of all lights, and of one."""
    said, columns = frame.statistics.by_modes, [("all lights", frame.statistics.by_modes_in_all)]
    if light is not None and light < len(said) > 1:
        columns.insert(0, (f"light {light}", said[light]))
    if not said or not imgui.begin_table("would cull", 1 + len(columns), int(imgui.TableFlags_.sizing_stretch_prop)):
        return
    culls = culls_by_modes(frame.settings.method)
    imgui.table_next_column()
    imgui.text_colored(QUIET, "shadow rays, this method" if culls else "shadow rays, paper's method")
    tooltip("of this frame, at all bounces; by the modes that the frame before has left")
    for name, _ in columns:
        imgui.table_next_column()
        _right(name, QUIET)
    fates: tuple[tuple[str, str, Callable[[SaidByModes], int]], ...] = (
        ("culled" if culls else "would be culled", FULL_TOLD, lambda one: one.full_shadow),
        ("ask moving objects only" if culls else "would ask moving objects only", NON_TOLD, lambda one: one.non_shadow),
    )
    for name, told, part in fates:
        imgui.table_next_column()
        imgui.text_unformatted(name)
        tooltip(told)
        for _, one in columns:
            imgui.table_next_column()
            _right(percent(part(one), one.due))
            tooltip(f"{count(part(one))} of {count(one.due)} that are due")
    imgui.end_table()


def _work(ui: Ui, frame: Frame) -> None:
    """The scale of a heat map, and what it sums up to."""
    view, run = ui.controller.session.view, ui.controller.runner.current
    if not view.can_draw(frame):
        lacks = run.lacks(view) if run is not None else ""
        paragraph(f"This run {lacks}." if lacks else "Nothing has been counted yet; a frame is being traced ...", QUIET)
        return
    found: WorkLegend = ui.cached(view.value, frame, 0, lambda: work_legend(frame, view))
    saved = view is View.SAVED
    if ui.controller.preferences.work_shares:
        _gradient("0 %", "100 %", "of those due" if saved else "of those without culling")
        swatch(GREY)
        imgui.text_unformatted("no shadow ray is due" if saved else "no ray")
    else:
        _gradient("0", f"{found.top:.4g} and more", f"{found.top / 2.0:.3g}")
    with properties("work", 6.5) as shown:
        if shown:
            tip = "of the first sample of each pixel; "
            tip += "its share of all shadow rays that were due" if saved else "its share of what no culling would trace"
            value("Saved" if saved else "Traced", f"{count(found.total)}  ({percent(found.total, found.whole)})", tip)
            value("Per pixel", f"{found.per_pixel:.2f}", "on average, the background counted")
            value("At one pixel", f"{count(found.most)} at most", "99 % of what is seen lies within the scale")


def _difference(ui: Ui, frame: Frame) -> None:
    """What is wrong in the frame, or why nothing is."""
    if frame.wrong is None:
        paragraph("No frame has been verified yet; one is being traced ...", QUIET)
        return
    found: DifferenceLegend = ui.cached("difference", frame, 0, lambda: difference_legend(frame))
    shadow = frame.statistics.shadow
    if frame.settings.method == "none":
        paragraph("Culling is off (C): every shadow ray is traced, so nothing can be wrong.", WARNING)
    elif not shadow.culled + shadow.candidates_only + shadow.dynamic_only + shadow.cache_hits:
        paragraph("No shadow ray of this frame was culled, so none can be wrong. Move, or trace again (T).", WARNING)
    elif found.pixels:
        _wrong_swatch(ui)
    else:
        paragraph("Nothing is wrong: every culled shadow ray was answered as a trace answers it.", GOOD)
    with properties("difference", 8.5) as shown:
        if shown:
            tip = "culled shadow rays whose answer a trace contradicts, of all that were due"
            if frame.settings.samples > 1:
                tip += "; of the first sample of each pixel, while wrong pixels are those of all"
            value("Wrong answers", f"{count(found.answers)}  ({percent(found.answers, found.due)} of due)", tip)
            share = percent(found.pixel_share, 1.0)
            value("Wrong pixels", f"{count(found.pixels)}  ({share})", "with a wrong answer of any light at any bounce")
            tip = "between a wrong pixel's colour and the right one; an answer deep in reflections may change nothing"
            value("Largest difference", f"{255.0 * found.largest:.0f} of 255", tip)


def _wrong_swatch(ui: Ui) -> None:
    """What the one colour of both views means: the pixels themselves, or the rings around them."""
    marked = ui.controller.preferences.mark_wrong
    if ui.controller.session.view is View.DIFFERENCE:
        swatch(WRONG)
        imgui.text_unformatted("a wrong shadow answer" + (", in a ring" if marked else ""))
    elif marked:
        swatch(WRONG)
        imgui.text_unformatted("around wrong shadow answers")


def _table(rows: list[LegendRow], units: str) -> None:
    """Each class of modes or certificates, with its pixels and its primitives or cells."""
    flags = int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)
    if not imgui.begin_table("legend", 3, flags):
        return
    imgui.table_setup_column("mode", int(imgui.TableColumnFlags_.width_stretch), 1.7)
    imgui.table_setup_column("pixels", int(imgui.TableColumnFlags_.width_stretch), 0.8)
    imgui.table_setup_column(units, int(imgui.TableColumnFlags_.width_stretch), 1.0)
    for title in ("proven" if units == "cells seen" else "mode", "pixels", units):
        imgui.table_next_column()
        if title not in ("pixels", units):
            imgui.text_colored(QUIET, title)
        else:
            _right(title, QUIET)
    for entry in rows:
        imgui.table_next_column()
        swatch(entry.color)
        imgui.text_unformatted(entry.name.replace("_", " ").lower())
        tooltip(f"{entry.name}: {entry.meaning}")
        imgui.table_next_column()
        _right(f"{100.0 * entry.pixel_share:.1f} %")
        tooltip(f"{count(entry.pixels)} primary pixels")
        imgui.table_next_column()
        _right(count(entry.units))
        tooltip(f"{100.0 * entry.unit_share:.2f} % of all {units}")
    imgui.end_table()


def _right(text: str, color: ImVec4 | None = None) -> None:
    """Text at the right edge of its column."""
    room = imgui.get_content_region_avail().x - imgui.calc_text_size(text).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(0.0, room))
    if color is None:
        imgui.text_unformatted(text)
    else:
        imgui.text_colored(color, text)


def _opaque(color: NDArray[np.float32]) -> ImVec4:
    red, green, blue = (float(channel) for channel in color)
    return ImVec4(red, green, blue, 1.0)


def _gradient(low: str, high: str, middle: str = "", reverse: bool = False) -> None:
    """The colour map as a bar, with its ends named under it."""
    colors = color_map(_GRADIENT_STEPS + 1)
    if reverse:
        colors = colors[::-1]
    at, width, height = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x, em(0.8)
    draw = imgui.get_window_draw_list()
    for i in range(_GRADIENT_STEPS):
        left, right = (imgui.get_color_u32(_opaque(colors[i + k])) for k in (0, 1))
        start = ImVec2(at.x + width * i / _GRADIENT_STEPS, at.y)
        end = ImVec2(at.x + width * (i + 1) / _GRADIENT_STEPS, at.y + height)
        draw.add_rect_filled_multi_color(start, end, left, right, right, left)
    imgui.dummy(ImVec2(width, height))
    left_edge = imgui.get_cursor_pos_x()
    imgui.text_unformatted(low)
    if middle:
        imgui.same_line(left_edge + (width - imgui.calc_text_size(middle).x) / 2.0)
        imgui.text_unformatted(middle)
    imgui.same_line(left_edge + width - imgui.calc_text_size(high).x)
    imgui.text_unformatted(high)
