"""How finely to trace: resolution, in motion and at rest, and the rays of a pixel."""

from __future__ import annotations

import os

from imgui_bundle import imgui

from tracer.geometry.accelerators import ACCELERATORS
from viewer.state.preferences import LONGEST_SIDE
from viewer.state.terms import TREES
from viewer.window.panels import lights
from viewer.window.ui import Ui
from viewer.window.widgets import checkbox, properties, row, size_field

_TREES = "; ".join(f"{name}: {meaning}" for name, meaning in TREES.items()) + (
    "; another one is built, and the first time compiled, before the next picture, and modes and certificates are "
    "learnt anew"
)
SAMPLES = (1, 2, 4, 8, 16, 32, 64)


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    p = c.preferences
    checkbox("Fixed size", p.fixed_resolution, lambda on: setattr(p, "fixed_resolution", on), "else that of the window")
    if p.fixed_resolution:
        imgui.same_line()
        p.fixed_width, p.fixed_height = size_field(
            (p.fixed_width, p.fixed_height), LONGEST_SIDE, ui.controller.notices.say
        )
    tip = "show pictures before all of their pixels are shaded, so that frames come fast"
    checkbox("Progressive refinement", p.dynamic_resolution, lambda on: setattr(p, "dynamic_resolution", on), tip)
    with properties("quality", 6.4) as shown:
        if shown:
            if p.dynamic_resolution:
                row("In motion", "frames per second to aim at")
                changed, fps = imgui.slider_float("##fps", p.target_fps, 2.0, 60.0, "%.0f fps")
                p.target_fps = min(max(fps, 1.0), 240.0) if changed else p.target_fps
            row("Bounces", "of reflected and refracted rays, at most")
            changed, depth = imgui.slider_int("##depth", c.session.settings.depth, 0, 20)
            if changed:
                c.settings.change(depth=min(max(depth, 0), 100))
            row("Samples", "per pixel, when nothing moves: added one by one once the picture is whole")
            now = SAMPLES.index(c.session.settings.samples) if c.session.settings.samples in SAMPLES else 0
            changed, index = imgui.combo("##samples", now, [str(n) for n in SAMPLES])
            if changed:
                c.settings.change(samples=SAMPLES[index])
            if c.session.scene is not None and c.session.scene.lights:
                lights.lamp_rows(ui)
            row("Tree", _TREES)
            chosen = ACCELERATORS.index(c.session.settings.accelerator)
            changed, index = imgui.combo("##accelerator", chosen, list(ACCELERATORS))
            if changed:
                c.settings.change(accelerator=ACCELERATORS[index])
            now = c.session.settings.threads
            row("Threads", "0: all cores; the picture and the numbers are the same for any")
            changed, threads = imgui.slider_int("##threads", now, 0, os.cpu_count() or 1, "%d" if now else "all cores")
            if changed:
                c.settings.change(threads=min(max(threads, 0), 1024))
