"""Panels without a window: ImGui lays them out and writes them down, and nothing is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from imgui_bundle import imgui

from tests.viewer.desk import Desk
from viewer.window import commands, setting_rows
from viewer.window.layout import PANELS
from viewer.window.setting_rows import ALL
from viewer.window.ui import Ui

WITH_SETTINGS = sorted({one.panel for one in ALL.values()} & set(PANELS))


@pytest.fixture
def written(desk: Desk) -> Iterator[Callable[[str], str]]:
    """What a panel writes, of a scene that is open, where it has all the room it needs."""
    ui = Ui(desk.c)
    ui.take_commands(commands.build(ui))
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size, io.delta_time = (4000.0, 8000.0), 0.02
    io.backend_flags |= int(imgui.BackendFlags_.renderer_has_textures)

    def text(panel: str) -> str:
        imgui.new_frame()
        imgui.set_next_window_size((3000.0, 7000.0))
        imgui.begin(panel)
        imgui.internal.log_to_buffer(0)
        PANELS[panel].show(ui)
        found = imgui.get_current_context().log_buffer.c_str()
        imgui.log_finish()
        imgui.end()
        imgui.end_frame()
        return str(found)

    yield text
    imgui.destroy_context(context)


def test_there_are_panels_with_settings() -> None:
    assert {"View", "Rendering", "Culling", "Camera", "Saving", "Pixels"} == set(WITH_SETTINGS)


@pytest.mark.parametrize("panel", WITH_SETTINGS)
def test_a_panel_shows_every_setting_that_is_declared_for_it(
    panel: str, written: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Switches and values, wherever they live."""
    for number, path in enumerate(
        ("settings.patient", "settings.depth", "draw.rays", "pace.every_frame", "loop", "tev")
    ):
        one = replace(ALL[path], label=f"New {number}", panel=panel)
        monkeypatch.setitem(setting_rows.ALL, f"new {number}", one)
    found = written(panel)
    assert not [number for number in range(6) if f"New {number}" not in found], found
