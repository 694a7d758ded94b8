"""`viewer.show`, and frames as notebooks show them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import viewer
from tests.viewer.drawn import picture
from tests.viewer.fakes import make_frame

ROOT = Path(__file__).resolve().parents[2]


def test_a_frame_shows_itself() -> None:
    frame = make_frame()
    frame = replace(frame, color=np.linspace(-0.2, 1.3, frame.color.size, dtype=np.float32).reshape(frame.color.shape))
    assert np.array_equal(frame.pixels, picture(frame))
    with Image.open(BytesIO(frame._repr_png_())) as image:
        assert np.array_equal(np.asarray(image), frame.pixels)
    html = frame._repr_html_()
    (code,) = re.findall(r"base64,([A-Za-z0-9+/=]+)'", html)
    assert b64decode(code) == frame._repr_png_()
    assert f"{frame.statistics.shadow.due:,}" in html and "shadow rays due" in html and "<script" not in html


def test_what_is_wrong_is_said_before_a_window_opens(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match="no method 'magic'; it is one of"):
        viewer.show("default", method="magic")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(OSError, match=r"tracer\.Renderer needs none"):
        viewer.show("default")


SCRIPT = """
import sys
from dataclasses import replace
import tracer, viewer

scene, seen = tracer.load_scene(sys.argv[1]), []
last = viewer.show(scene, lambda frame: seen.append(frame) or len(seen) < 2, method="paper", samples=2)
assert last is not None and last.settings.method == "paper"
assert len(seen) == 2 and all(frame.statistics.part == 1.0 for frame in seen)
made = replace(scene, path=scene.path.with_name("made.aff"), lights=scene.lights[:1])
last = viewer.show(made, lambda frame: False)
assert last is not None and last.lights == 1
print("shown", [frame.color.shape == frame.pixels.shape for frame in seen])
"""


@pytest.mark.gui
@pytest.mark.slow
def test_a_script_opens_the_window_twice(tiny_scene_file: Path) -> None:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "LIBGL_ALWAYS_SOFTWARE": "1"}
    command = [sys.executable, "-c", SCRIPT, str(tiny_scene_file)]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0 and "shown [True, True]" in done.stdout, done.stdout + done.stderr
