"""The numbers of the newest frame, and the resolution they are for."""

from __future__ import annotations

from imgui_bundle import imgui

from tracer.method import base_of, takes
from viewer.history import fully_traced
from viewer.panels.widgets import (
    QUIET,
    clipped,
    count,
    em,
    heading,
    paragraph,
    percent,
    properties,
    short,
    tooltip,
    value,
)
from viewer.ui import Ui

_PHASE_ORDER = ("place", "primary", "occlusion testing", "certification", "shading", "mode setting")


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.traced is None:
        paragraph("No frame has been traced yet.", QUIET)
        return
    s = frame.statistics
    pixels = max(frame.width * frame.height, 1)
    divisor = c.traced.request.divisor
    coarse = f" (1/{divisor} of the window)" if divisor > 1 else ""
    clipped(f"for {frame.width} x {frame.height} pixels{coarse}, method {frame.settings.method}")
    if c.tracing.outdated:
        paragraph("with the settings before; tracing ...", QUIET)
    shadow, certifies = s.shadow, base_of(frame.settings.method) == "certified"
    heading("Shadow rays")
    with properties("shadow") as shown:
        if shown:
            value("Due", f"{count(shadow.due)}  ({shadow.due / pixels:.2f} / pixel)", "light on the viewer's side")
            value("Culled", _share(shadow.culled, shadow.due), "known to be in shadow: not traced at all")
            value("Dynamic only", _share(shadow.dynamic_only, shadow.due), "asked only the objects that move")
            if certifies or shadow.candidates_only:
                tip = "asked a few primitives instead of the tree, and the objects that move"
                value("Candidates", _share(shadow.candidates_only, shadow.due), tip)
            if takes(frame.settings.method, "cache") or shadow.cache_hits:
                tip = "blocked by what the occluder cache had asked about first"
                value("Cache hits", _share(shadow.cache_hits, shadow.due), tip)
            value("Traced", _share(fully_traced(shadow), shadow.due), "nothing was known: asked everything")
            if frame.settings.verify:
                value("Wrong", _share(shadow.wrong, shadow.due), "culled, but a trace answers otherwise")
            if frame.settings.keeps_modes:
                tests = f"{count(s.occlusion_tests)}  ({s.occlusion_tests / pixels:.3f} / pixel)"
                value("Occlusion tests", tests, "against the neighbouring pixels' primitives")
    if certifies:
        heading("Certificates")
        with properties("certificates") as shown:
            if shown:
                seconds = s.phases.get("certification", 0.0)
                tip = "of cells that rays wanted, those that were wanted most first"
                value("Made", f"{count(s.certificates)}  in {1e3 * seconds:.1f} ms", tip)
    heading("Work")
    _work(ui)
    heading("Time")
    with properties("time") as shown:
        if shown:
            value("Traced in", f"{1e3 * s.seconds:.1f} ms")
            for name in [*_PHASE_ORDER, *(n for n in s.phases if n not in _PHASE_ORDER)]:
                if name in s.phases and (certifies or name != "certification"):
                    value(f"  {name}", f"{1e3 * s.phases[name]:.1f} ms")
            value("Drawn in", f"{1e3 * c.drawn_seconds:.1f} ms", "what the window itself takes for one of its frames")


def _share(part: int, whole: int) -> str:
    return f"{count(part)}  ({percent(part, whole)})"


def _work(ui: Ui) -> None:
    """Rays, steps and tests of each kind of ray, and steps and tests of certificates."""
    frame = ui.controller.frame
    assert frame is not None
    s = frame.statistics
    if not imgui.begin_table("work", 4, int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)):
        return
    imgui.table_setup_column("kind", int(imgui.TableColumnFlags_.width_fixed), em(4.8))
    for title in ("rays", "steps", "tests"):
        imgui.table_setup_column(title, int(imgui.TableColumnFlags_.width_stretch))
    for title in ("", "rays", "steps", "tests"):
        imgui.table_next_column()
        imgui.text_colored(QUIET, title)
    told = "traversal steps: nodes of the tree entered; tests: rays against primitives"
    if frame.settings.accelerator != "kdtree":
        told += "; of whole packets of rays where these are coherent (an experiment counts each ray's, in a kd-tree)"
    tooltip(told)
    total = [0, 0, 0]
    for name, part in (("primary", s.primary), ("secondary", s.secondary), ("shadow", s.shadow)):
        numbers = (part.rays, part.traversal_steps, part.intersection_tests)
        total = [t + n for t, n in zip(total, numbers)]
        _cells(name, numbers)
    if base_of(frame.settings.method) == "certified":
        numbers = (0, s.certificate_steps, s.certificate_tests)
        total = [t + n for t, n in zip(total, numbers)]
        _cells("certificates", numbers)
    _cells("all", total)
    imgui.end_table()


def _cells(name: str, numbers: tuple[int, ...] | list[int]) -> None:
    imgui.table_next_column()
    imgui.text_colored(QUIET, name)
    for number in numbers:
        imgui.table_next_column()
        imgui.text_unformatted(short(number))
        tooltip(count(number))
