"""The real window, driven by keyboard and pointer: one process for each scenario of `tests.viewer.scenarios`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.gui

SCENARIOS = ("views", "difference", "wiping", "culling", "certifying", "explaining", "flying", "orbiting",
             "playing", "capturing", "dropping", "browsing", "reopening", "failing", "asking", "closing_panels",
             "looks", "cancelling", "resizing", "closing_while_tracing", "closing_while_loading",
             "closing_while_experimenting", "experimenting", "zooming", "panels", "hiding", "folding",
             "legends", "filmstrip", "touring", "fitting")  # fmt: skip


@pytest.mark.parametrize("name", SCENARIOS)
def test_window(name: str, tiny_scene_file: Path, own_settings: Path):
    folder = tiny_scene_file.parent
    (folder / "big.aff").write_text(_big_scene())
    command = [sys.executable, "-m", "tests.viewer.window", name, str(tiny_scene_file), str(folder)]
    environment = os.environ | {"SHADOWCULL_CONFIG_DIR": str(own_settings), "LIBGL_ALWAYS_SOFTWARE": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, f"{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    assert "[imgui-error]" not in done.stdout + done.stderr, "ImGui was used wrongly"
    settings = json.loads((own_settings / "settings.json").read_text())
    assert str(tiny_scene_file) in settings["recent"]
    kept = {p.name for p in own_settings.iterdir()}
    assert kept == {"settings.json", "layout.ini"}, "something was left half-written"


def _big_scene() -> str:
    """Enough triangles for loading to take a while."""
    lines = ["v", "from 0 0 50", "at 0 0 0", "up 0 1 0", "angle 40", "hither 0.1", "resolution 8 8", "l 1 9 30"]
    lines.append("f 1 0 0 1 0 1 0 1")
    for i in range(60000):
        x, y, z = i % 40, i // 40 % 40, i // 1600
        lines.append(f"p 3\n{x} {y} {z}\n{x + 1} {y} {z}\n{x} {y + 1} {z + 0.5}")
    return "\n".join(lines) + "\n"
