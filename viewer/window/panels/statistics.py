"""The numbers of the newest frame, and the resolution they are for."""

from __future__ import annotations

from itertools import groupby

from imgui_bundle import ImVec2, imgui

from tracer.method import title_of
from viewer.state import terms
from viewer.state.frame_rows import TIME, WORK, Row, rows
from viewer.util.numbers import count, whole_percent
from viewer.window.panels import status
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, clipped, em, heading, paragraph, right, tooltip

_SHARE_WIDTH = 3.6  # ems
_SHORT_OF_ROOM = 14.0  # ems of a panel below which shares are in tooltips alone


def show(ui: Ui) -> None:
    """Draw the panel."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.traced is None:
        paragraph(status.first_picture(c), QUIET)
        return
    divisor, part = c.traced.request.divisor, frame.statistics.part
    coarse = f", 1/{divisor} size" if divisor > 1 else ""
    clipped(f"{f'{whole_percent(part)} of ' if part < 1.0 else ''}{frame.width} x {frame.height} pixels{coarse}")
    tooltip("Of the first sample of each pixel that is shaded; primary rays and certificates are of all pixels.")
    old = c.scheduler.outdated  # said in a line that is there anyway, so that nothing moves
    clipped(f"method {title_of(frame.settings.method)}{', before the change' if old else ''}", QUIET if old else None)
    if old:
        tooltip("These are for the previous settings; a new frame is being traced.")
    drawn = Row(TIME, "Window", 1e3 * c.drawn_seconds, "the window's own frame, without tracing", digits=1, unit=" ms")
    for group, found in groupby([*ui.cached("statistics", frame, part, lambda: rows(frame)), drawn], lambda r: r.group):
        heading(group)
        _table(group, list(found))
        if group == WORK and terms.asks_by_beams(frame, c.scheduler.lamps.any):
            paragraph(terms.BY_BEAMS, QUIET)


def _table(name: str, found: list[Row]) -> None:
    """Draw names, exact numbers at the right edge, and shares where any number has a whole."""
    shares = any(row.share for row in found) and imgui.get_content_region_avail().x > em(_SHORT_OF_ROOM)
    room = ImVec2(-em(0.2), 0.0)  # as columns may be wider by parts of a pixel
    if not imgui.begin_table(name, 3 if shares else 2, int(imgui.TableFlags_.sizing_stretch_prop), room):
        return
    imgui.table_setup_column("name", int(imgui.TableColumnFlags_.width_stretch), 1.2)
    imgui.table_setup_column("number", int(imgui.TableColumnFlags_.width_stretch), 1.0)
    if shares:
        imgui.table_setup_column("share", int(imgui.TableColumnFlags_.width_fixed), em(_SHARE_WIDTH))
    for row in found:
        text = row.text(row.number)
        of = f"{text} of {count(row.whole)} ({row.share})" if row.whole is not None else text
        for at, part in enumerate((row.name, text, row.share)[: 3 if shares else 2]):
            imgui.table_next_column()
            (right if at else clipped)(part)
            tooltip("\n".join(filter(None, (row.tip, of))))
    imgui.end_table()
