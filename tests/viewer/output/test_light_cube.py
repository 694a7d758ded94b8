"""The picture of a light's cube: what it shows is where it is, and it stays as it was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tracer
from tests.commands import complaint, run
from tracer.culling.lightbuffer.tell import listed
from tracer.methods.lightbuffer import LightBuffer
from viewer.output.light_cube import (
    COVERED,
    FEW,
    NOTHING_THERE,
    ONE,
    picture_of,
    seen,
    unfolded,
)
from viewer.state.palette import GREY
from viewer.util import resources


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


def test_the_cube_of_a_light_is_drawn_and_told_cell_by_cell():
    made = tracer.load_scene(resources.scene_path("figure3"))
    settings = tracer.Settings(width=8, height=8, method="lightbuffer", light_buffer_side=64, threads=2)
    renderer = tracer.Renderer(made, settings)
    renderer.render()
    method = renderer.state.method("lightbuffer")
    assert isinstance(method, LightBuffer) and method.cube_of(99) is None
    cube = method.cube_of(0)
    assert cube is not None
    drawn = seen(cube)
    counts = drawn.counts
    assert sum(counts.values()) == 6 * 64 * 64 and min(counts[ONE], counts[FEW]) > 0
    assert drawn.longest == max(2, drawn.lengths.max())
    side = cube.side
    for face in np.ndindex(6, 4, 4):  # some cells
        cell = face[0], 16 * face[1] + 5, 16 * face[2] + 9
        length, color = int(drawn.lengths[cell]), drawn.list_colors()[cell]
        known = NOTHING_THERE if length == 0 else COVERED if drawn.covered[cell] else GREY
        assert len(listed(cube, *cell)) == (length if length > 0 else int(drawn.covered[cell]))
        assert length > 0 or np.allclose(color, known)
    lists, depths = drawn.list_legend("light 0"), drawn.depth_legend()
    assert lists.scale is not None and lists.scale.high == str(drawn.longest)
    assert depths.scale is not None and depths.scale.low == f"{drawn.depths.min():.3g}"
    told = picture_of(cube, "light 0")
    enlarged = told.shape[0] // (3 * side)
    assert enlarged == 4 and told.shape[1] > 2 * 4 * side * enlarged
    plain = picture_of(cube).repeat(enlarged, 0)[:, : 4 * side].repeat(enlarged, 1)
    changed = (told[:, : 4 * side * enlarged] != plain).any(-1)
    assert changed.any() and not changed[: 2 * side * enlarged].any() and not changed[:, : 2 * side * enlarged].any()


def test_the_command_saves_the_cube_and_says_what_is_wrong(capfd: pytest.CaptureFixture[str], tmp_path: Path):
    path = tmp_path / "cube.png"
    code, out, _ = run(capfd, "cube", "figure3", "--side", 16, "--threads", 1, "-o", path, "--no-legend")
    assert code == 0 and "covered" in out and str(path) in out.replace("\n", "")
    with Image.open(path) as picture:
        assert picture.size == (2 * 64 + 1, 48)
    assert "there is no folder" in complaint(run(capfd, "cube", "figure3", "-o", tmp_path / "new" / "cube.png"))
    assert "lights are" in complaint(run(capfd, "cube", "figure3", "--light", 99, "-o", path))
    assert "17 is not one of 16, 32" in complaint(run(capfd, "cube", "figure3", "--side", 17, "-o", path))
