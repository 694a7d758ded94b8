"""In the panel of the view: exposure, white point and tone curve of pictures, and the range of views of numbers."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import imgui

from viewer.state.readings import can_draw
from viewer.state.tone import MID_GREY, MOST_EXPOSURE, NEUTRAL, WHITES, Curve, Tone
from viewer.state.views import View
from viewer.window.ui import Ui
from viewer.window.widgets import checkbox, em, row, tooltip

_STOPS = 6.0  # of the slider, up and down; more can be typed


def rows(ui: Ui) -> None:
    """Rows of the panel's table."""
    view, shares = ui.controller.session.view, ui.controller.preferences.work_shares
    if view.shows_picture:
        _tone(ui)
    if view.has_range and not (view.needs_work and shares):
        _range(ui)


def _tone(ui: Ui) -> None:
    s = ui.controller.session
    row("Exposure", "in stops, each of which doubles colours ([ and ]); Ctrl+click to type a number")
    imgui.set_next_item_width(-em(4.2))
    changed, stops = imgui.slider_float("##exposure", s.tone.exposure, -_STOPS, _STOPS, "%+.2f EV")
    if changed:
        s.tone = replace(s.tone, exposure=min(max(stops, -MOST_EXPOSURE), MOST_EXPOSURE))
    imgui.same_line(0.0, em(0.3))
    imgui.begin_disabled(s.tone.neutral)
    if imgui.button("Reset##tone", (-1.0, 0.0)):
        s.tone = NEUTRAL
    imgui.end_disabled()
    tooltip("show colours as they were traced")
    row("White", "the colour, once exposed, that becomes white")
    flags = int(imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.always_clamp)
    changed, white = imgui.drag_float("##white", s.tone.white, 0.01, *WHITES, "%.3g", flags)
    s.tone = replace(s.tone, white=min(max(white, WHITES[0]), WHITES[1])) if changed else s.tone
    row("Tone curve", "how colours up to white become those of the screen")
    curves = list(Curve)
    if imgui.begin_combo("##curve", s.tone.curve.label):
        for curve in curves:
            if imgui.selectable(curve.label, curve is s.tone.curve)[0]:
                s.tone = replace(s.tone, curve=curve)
            tooltip(told(replace(s.tone, curve=curve)))
        imgui.end_combo()
    else:
        tooltip(told(s.tone))


def told(tone: Tone) -> str:
    """What a curve does, and how bright mid grey becomes with it."""
    return f"{tone.curve.meaning}. Mid grey, {MID_GREY:g}, becomes {tone.mid_grey:.2f} as white and exposure are now"


def _range(ui: Ui) -> None:
    """What has the first and the last colour: as the frame has it, or as it was set."""
    c = ui.controller
    s, view, frame = c.session, c.session.view, c.frame
    if frame is None or not can_draw(frame, view, s.light):
        return
    chosen = s.spans.get(view)
    low, high = c.comparing.span(view) or view.declared.span(frame)
    row("Range", "what has the first and the last colour of the map; drag, or Ctrl+click to type")
    imgui.set_next_item_width(-em(4.2))
    speed = max((high - low) / 200.0, 1e-6)
    changed, low, high = imgui.drag_float_range2("##range", low, high, speed, 0.0, 0.0, "%.4g", "%.4g")
    if changed and low < high:
        s.spans[view] = (low, high)
    imgui.same_line(0.0, em(0.3))
    imgui.begin_disabled(chosen is None)
    if imgui.button("Fit##range", (-1.0, 0.0)):
        s.spans.pop(view, None)
    imgui.end_disabled()
    tooltip("let it follow what each frame has")


def ticks(ui: Ui) -> None:
    """Below the table."""
    s = ui.controller.session
    if s.view in (View.COLOR, View.WIPE):
        tip = "stripes over pixels that are too bright for the screen, in red, and over black ones, in blue"
        tip += ui.key("Mark clipped pixels")
        checkbox("Mark clipped pixels", s.clipping, lambda on: setattr(s, "clipping", on), tip)
