"""Lamps: made of points by a slider, refined at idle, seen by their penumbra, and inspected."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import patch

import numpy as np

from tests.viewer.driver import Driver
from tracer.renderer import Renderer
from viewer.services.frame_scheduler import Activity
from viewer.state import views as view_names
from viewer.state.views import View
from viewer.views import penumbra
from viewer.window.panels.status import doing


def lamps(d: Driver) -> None:
    """Soft shadows come step by step, and are those of the renderer; of too many lights, one is looked at."""
    d.c.session.set_pace(target_fps=240.0)  # there is to be no time for many samples in motion
    d.settle()
    hard = d.c.frame.color
    left, top, right, _ = d.show_panel("Rendering").place("//Rendering/**/##lamp-radius")
    d.drag((left + 4.0, top + 6.0), (0.8 * (right - left) - 4.0, 0.0))
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

    d.press("J").settle()
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
    d.press("J", "L")
    assert np.abs(d.shown().astype(int) - shown).max() > 50, "another light"
    d.press("Shift+L")
    d.c.selection.select(d.places(between, reach=1)[0])
    d.wait(lambda: d.c.inspector.why is not None, "an answer about the penumbra", 20.0)
    (x, y), light = d.c.selection.pixel, d.c.session.draw.light
    one = d.c.inspector.why.reasons[light]
    assert (one.lit, one.samples) == (frame.reached[y, x, light], frame.asked[y, x, light])
    d.c.selection.clear()

    d.hold("D", 0.3)
    assert d.c.frame.settings.lamp_samples in (1, 4), "few in motion"
    d.press("1").click("//Rendering/**/x##lamp-radius").settle()
    assert d.c.frame.settings.lamp_radius is None and d.c.scheduler.lamp_samples_shown == 1

    many = d.folder / "lights.aff"
    lights = "".join(f"l {0.1 * i} 5 {0.05 * i} 0.02 0.02 0.02\n" for i in range(12))
    many.write_text(d.c.session.scene.path.read_text() + lights)
    d.open(many)
    _one_of_too_many(d)


def _one_of_too_many(d: Driver) -> None:
    """Where there is no memory for all lights, the chosen one is looked at alone, and nothing is traced again."""
    frame = d.c.frame
    settings = replace(frame.settings, record_lights=True)
    expected = Renderer(d.c.session.scene, settings).render(frame.time, frame.camera)
    with patch.object(view_names, "MOST_RECORDED", 1000):
        traced = d.c.history.frames
        d.press("J")
        for _ in range(2):
            d.press("L")
            light = d.c.session.draw.light
            d.wait(lambda: d.c.scheduler.drawn_view is View.PENUMBRA, "one light", 20.0)
            assert d.c.frame.only_light == light and d.c.history.frames == traced
            assert np.array_equal(penumbra.VIEW.find(d.c.frame, light), penumbra.VIEW.find(expected, light))
            d.expect_picture()
        d.press("Shift+J").settle()
        assert d.c.scheduler.drawn_view is View.COLOR, "there is no memory for all"
    d.press("1").settle()
