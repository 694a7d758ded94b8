"""The culling: on or off, its settings, and what is learnt."""

from __future__ import annotations

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.panels.widgets import ERROR, GOOD, QUIET, checkbox, count, paragraph, percent, properties, row, wide_button
from viewer.ui import Ui


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    s, p = c.session.settings, c.preferences
    checkbox("Shadow culling", s.method != "none", lambda _: c.toggle_culling(), "skip shadow rays that are known (C)")
    tip = "test both pixels of a pair against each other's primitive, not just one of them (Y)"
    checkbox("Symmetric occlusion test", s.symmetric, lambda on: c.change(symmetric=on), tip)
    tip = "trace every culled shadow ray as well, and count those that would have answered otherwise (V)"
    checkbox("Verify", s.verify, lambda on: c.change(verify=on), tip)
    _wrong(ui)
    with properties("culling", 6.5) as shown:
        if shown:
            row("Zoom factor", "a primitive that covers so many times more pixels than ever is looked at again")
            flags = int(imgui.SliderFlags_.logarithmic)
            changed, factor = imgui.slider_float("##zoom", s.zoom_factor, 1.0, 64.0, "%.1f", flags)
            if changed:
                c.change(zoom_factor=factor)
    if wide_button(f"{icons.ICON_FA_ERASER}  Reset modes", "forget all that was learnt (Backspace)", 2):
        c.reset_modes()
    imgui.same_line()
    if wide_button(f"{icons.ICON_FA_ROTATE_RIGHT}  Trace again", "the same frame with what was learnt (T)"):
        c.trace_again()

    def keep(on: bool) -> None:
        p.keep_tracing = on
        c.trace_again()

    checkbox("Keep tracing at rest", p.keep_tracing, keep, "frame after frame, to watch the modes settle (K)")


def _wrong(ui: Ui) -> None:
    c = ui.controller
    if c.frame is None or not c.frame.settings.verify:
        return
    shadow = c.frame.statistics.shadow
    imgui.same_line()
    if shadow.wrong:
        paragraph(f"{count(shadow.wrong)} wrong ({percent(shadow.wrong, shadow.due)})", ERROR)
    elif not shadow.culled + shadow.dynamic_only:
        paragraph("nothing culled", QUIET)
    else:
        paragraph("none wrong", GOOD)
