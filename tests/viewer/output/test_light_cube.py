"""The picture of a light's cube: what it shows is where it is, and it stays as it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tracer
from tests.commands import complaint, run
from tracer.methods.lightbuffer import LightBuffer
from viewer.output.light_cube import counts_of, picture_of, unfolded
from viewer.util import resources

GOLDEN = Path(__file__).resolve().parents[2] / "golden" / "light-cube.png"


def test_neighbours_on_the_cube_are_neighbours_on_the_cross():
    """Cells that hold the directions of their middles: across the seams of the cross these change no more than within
    faces."""
    side = 32
    middle = (np.arange(side) + 0.5) * (2.0 / side) - 1.0
    y, x = np.meshgrid(middle, middle, indexing="ij")
    ways = np.empty((6, side, side, 3))
    for face in range(6):
        axis = face >> 1
        ways[face][..., axis] = -1.0 if face & 1 else 1.0
        ways[face][..., [k for k in range(3) if k != axis]] = np.stack([x, y], -1)
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    cross = unfolded(ways, np.full(3, np.nan))
    there = np.isfinite(cross[..., 0])
    assert there.sum() == 6 * side * side and len(np.unique(cross[there].round(9), axis=0)) == 6 * side * side
    down, right = (np.linalg.norm(np.diff(cross, axis=axis), axis=-1) for axis in (0, 1))
    for steps in (down, right):
        assert np.nanmax(steps) < 2.1 * 2.0 / side
    assert np.allclose(cross[int(0.5 * side), int(1.5 * side)], (0, 1, 0), atol=0.1), "up is above"


def test_the_cube_of_a_light_is_the_golden_picture():
    scene = tracer.load_scene(resources.scene_path("figure3"))
    settings = tracer.Settings(width=8, height=8, method="lightbuffer", light_buffer_side=64, threads=2)
    renderer = tracer.Renderer(scene, settings)
    renderer.render()
    method = renderer.state.method("lightbuffer")
    assert isinstance(method, LightBuffer) and method.cube_of(99) is None
    cube = method.cube_of(0)
    assert cube is not None
    counts = counts_of(cube)
    assert counts.cells == 6 * 64 * 64 and min(counts.covered, counts.few) > 0
    made = picture_of(cube)
    expected = np.asarray(Image.open(GOLDEN).convert("RGB"))
    assert made.shape == expected.shape
    assert (np.abs(made.astype(int) - expected).max(2) > 4).mean() < 0.002


def test_the_command_saves_the_cube_and_says_what_is_wrong(capfd: pytest.CaptureFixture[str], tmp_path: Path):
    path = tmp_path / "new" / "cube.png"
    code, out, _ = run(capfd, "cube", "figure3", "--side", 16, "--threads", 1, "-o", path)
    assert code == 0 and "covered" in out
    with Image.open(path) as picture:
        assert picture.size == (2 * 64 + 1, 48)
    assert "lights are" in complaint(run(capfd, "cube", "figure3", "--light", 99, "-o", path))
    assert "power of two" in complaint(run(capfd, "cube", "figure3", "--side", 17, "-o", path))
