"""Lamps: made of points by a slider, refined at idle, seen by their penumbra, inspected, and found in a list."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from tracer.renderer import Renderer
from viewer.services.frame_scheduler import Activity
from viewer.state import views as view_names
from viewer.state.views import View
from viewer.views import penumbra
from viewer.window.panels.lights import LightFilters
from viewer.window.panels.status import doing

KEY = imgui.Key


def lamps(d: Driver) -> None:
    """Soft shadows come step by step, and are those of the renderer; many lights are listed as they are looked for."""
    d.fix_resolution(320, 220)
    d.c.session.set_pace(target_fps=240.0)  # there is to be no time for many samples in motion
    d.settle()
    hard = d.c.frame.color
    d.show_panel("Rendering")
    area = d.context.item_info("//Rendering/**/##lamp-radius").rect_full
    middle = (area.min.x + 0.8 * (area.max.x - area.min.x), 0.5 * (area.min.y + area.max.y))
    d.drag((area.min.x + 4.0, middle[1]), (middle[0] - area.min.x - 4.0, 0.0))
    radius = d.c.session.settings.lamp_radius
    assert 0.1 < radius < 2.0 and d.c.scheduler.lamps.wanted == 16
    d.settle()
    d.c.settings.change(lamp_samples=64, lamp_radius=0.5)
    seen, said = [], set()

    def refined() -> bool:
        if d.c.scheduler.traced.whole and d.c.frame.settings.lamp_radius == 0.5:
            seen.append(d.c.frame.settings.lamp_samples)
        said.add(doing(d.c))
        return d.c.frame.settings.lamp_samples == 64 and d.c.scheduler.activity is not Activity.SAMPLING_LAMPS

    d.wait(refined, "all samples of the lamps")
    assert set(seen) <= {1, 4, 16, 64} and seen == sorted(seen), f"{seen}"
    assert said & {"lamp samples: 4 of 64", "lamp samples: 16 of 64"}
    d.settle()
    frame = d.c.frame
    alone = Renderer(d.c.session.scene, frame.settings).render(frame.time, frame.camera)
    assert np.array_equal(frame.color, alone.color) and not np.array_equal(frame.color, hard)

    d.press(KEY.j)
    d.settle()
    frame = d.c.frame
    between = np.isin(penumbra.VIEW.find(frame, d.c.session.draw.light), (penumbra.Arrival.MOST, penumbra.Arrival.FEW))
    assert between.any() and frame.asked.max() == 64
    assert d.c.history.values("penumbra")[-1] > between.sum() / 2, "it is plotted"
    assert d.c.history.values("samples_due")[-1] > d.c.history.values("samples_reached")[-1] > 0
    shown = d.shown().astype(int)
    assert d.c.scheduler.drawn_view is View.PENUMBRA
    d.expect_picture()
    d.press("Shift+J")
    assert d.c.scheduler.drawn_view is View.LIGHTS and d.c.frame is frame, "nothing is traced for it"
    d.expect_picture()
    d.press(KEY.j)
    d.press(KEY.l)
    assert np.abs(d.shown().astype(int) - shown).max() > 50, "another light"
    d.press("Shift+L")
    y, x = np.argwhere(between)[between.sum() // 2]
    d.c.selection.select(((x + 0.5) / frame.width, (y + 0.5) / frame.height))
    d.wait(lambda: d.c.inspector.why is not None, "an answer about the penumbra", 20.0)
    one = d.c.inspector.why.reasons[d.c.session.draw.light]
    reached = int(frame.reached[y, x, d.c.session.draw.light])
    assert (one.lit, one.samples) == (reached, int(frame.asked[y, x, d.c.session.draw.light]))
    d.frames(3)
    d.c.selection.clear()

    d.hold(KEY.d, 0.3)
    assert d.c.frame.settings.lamp_samples in (1, 4), "few in motion"
    d.press(KEY._1)
    d.click("//Rendering/**/x##lamp-radius")
    d.settle()
    assert d.c.frame.settings.lamp_radius is None and d.c.scheduler.lamp_samples_shown == 1

    many = d.folder / "lights.aff"
    lights = "".join(f"l {0.1 * i} 5 {0.05 * i} 0.02 0.02 0.02\n" for i in range(38))
    many.write_text(d.c.session.scene.path.read_text() + lights)
    d.open(many)
    _one_of_too_many(d)
    d.ui.show_panel("Scene")
    d.ui.state(LightFilters).texts["table"] = "light 3"
    d.frames(4)


def _one_of_too_many(d: Driver) -> None:
    """Where there is no memory for all lights, the chosen one is looked at alone, and nothing is traced again."""
    frame = d.c.frame
    settings = replace(frame.settings, record_lights=True)
    expected = Renderer(d.c.session.scene, settings).render(frame.time, frame.camera)
    most, view_names.MOST_RECORDED = view_names.MOST_RECORDED, 1000
    try:
        traced = d.c.history.frames
        d.press(KEY.j)
        for _ in range(2):
            d.press(KEY.l)
            light = d.c.session.draw.light
            d.wait(lambda: d.c.scheduler.drawn_view is View.PENUMBRA, "one light", 20.0)
            assert d.c.frame.only_light == light and d.c.history.frames == traced
            assert np.array_equal(penumbra.VIEW.find(d.c.frame, light), penumbra.VIEW.find(expected, light))
            d.expect_picture()
        d.press("Shift+J")
        d.settle()
        assert d.c.scheduler.drawn_view is View.COLOR, "there is no memory for all"
    finally:
        view_names.MOST_RECORDED = most
    d.press(KEY._1)
    d.settle()
