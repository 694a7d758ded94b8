"""Panels without a window: ImGui lays them out and writes them down, and nothing is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from imgui_bundle import imgui, implot

from tests.viewer.desk import Desk, place_of
from viewer.window import commands
from viewer.window.layout import PANELS
from viewer.window.panels.plots import as_steps
from viewer.window.setting_rows import ALL
from viewer.window.ui import Ui

KINDS = ("settings.patient", "settings.depth", "draw.rays", "pace.every_frame", "loop", "tev")
"""A setting of each kind, wherever values live."""


@pytest.fixture
def written(desk: Desk) -> Iterator[Callable[[str], str]]:
    """What a panel writes, of a scene that is open, where it has all the room it needs."""
    ui = Ui(desk.c)
    ui.take_commands(commands.build(ui))
    context, plots = imgui.create_context(), implot.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size, io.delta_time = (4000.0, 8000.0), 0.02
    io.backend_flags |= int(imgui.BackendFlags_.renderer_has_textures)

    def text(panel: str) -> str:
        imgui.new_frame()
        imgui.set_next_window_size((3000.0, 7000.0))
        imgui.begin(panel)
        imgui.internal.log_to_buffer(0)
        PANELS[panel](ui)
        found = imgui.get_current_context().log_buffer.c_str()
        imgui.log_finish()
        imgui.end()
        imgui.end_frame()
        return str(found)

    yield text
    implot.destroy_context(plots)
    imgui.destroy_context(context)


def test_a_panel_shows_every_setting_that_is_declared_for_it(
    written: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    panels = sorted({one.panel for one in ALL.values()} & set(PANELS))
    assert panels == ["Camera", "Culling", "Pixels", "Rendering", "Saving", "View"]
    for panel in panels:
        labels = {f"New {number}": path for number, path in enumerate(KINDS)}
        for label, path in labels.items():
            monkeypatch.setitem(ALL, label, replace(ALL[path], label=label, panel=panel))
        found = written(panel)
        assert not [label for label in labels if label not in found], f"{panel}: {found}"


def test_curves_are_level_over_each_picture() -> None:
    x, y = as_steps(np.array([1.0, 5.0]), 9.5)
    assert x.tolist() == [9.5, 10.5, 10.5, 11.5] and y.tolist() == [1.0, 1.0, 5.0, 5.0]


def test_the_papers_text_stands_with_values_beside_what_has_run(written: Callable[[str], str], desk: Desk) -> None:
    stepping = desk.c.stepping
    assert "Click a pixel" in written("Paper")
    desk.c.settings.change(method="paper")
    desk.c.selection.select(place_of(desk.c, lit=False, near=2))

    def shown() -> str:
        """What is written, while somebody looks."""
        said = written("Paper")
        desk.tick()
        return said

    desk.until(lambda: "step 1 of" in shown())
    stepping.go(1)
    said = shown()
    assert "def reached_by_light(work, primitive, point, light):" in said and "§2.3 occlusion testing, pixel" in said
    assert f"current = {desk.c.selection.picked.primitive}" in said and "height = 48, width = 64" in said
    desk.c.settings.change(method="cells")
    desk.until(lambda: "the text speaks of primitives" in shown())
    assert "Use Paper" in shown()
