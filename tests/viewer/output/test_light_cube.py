"""The picture of a light's cube: what it shows is where it is."""

from __future__ import annotations

import numpy as np

import tracer
from tracer.neighbours.lightbuffer.tell import full_depths, list_lengths
from viewer.output.light_cube import COVERED, NOTHING_THERE, by_depths, by_lists, unfolded
from viewer.state.palette import BACKGROUND, GREY
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
    for axis in (0, 1):
        assert np.nanmax(np.linalg.norm(np.diff(cross, axis=axis), axis=-1)) < 2.1 * 2.0 / side
    assert np.allclose(cross[int(0.5 * side), int(1.5 * side)], (0, 1, 0), atol=0.1), "up is above"


def test_cells_have_the_colours_of_the_legend_which_counts_them():
    renderer = tracer.Renderer(
        tracer.load_scene(resources.scene_path("figure3")),
        tracer.Settings(width=8, height=8, method="lightbuffer", light_buffer_side=64, threads=2),
    )
    cube = renderer.render().structures["light cubes"][0].cube
    assert cube is not None
    lengths, depths = list_lengths(cube), full_depths(cube)
    covered = (lengths < 0) & np.isfinite(depths)
    drawn, told = by_lists(cube, "light 0"), by_depths(cube)
    cells = unfolded(np.arange(lengths.size).reshape(lengths.shape), np.array(-1))
    for mask, color in (((lengths == 0), NOTHING_THERE), (covered, COVERED), ((lengths < 0) & ~covered, GREY)):
        shown = (cells >= 0) & mask.ravel()[cells]
        (entry,) = (one for one in drawn.legend.entries if one.color == color)
        assert shown.sum() == mask.sum() and f": {mask.sum():,} cells" in entry.meaning
        assert np.allclose(drawn.picture[shown], np.round(np.multiply(color, 255.0)))
    assert covered.any() and (lengths > 0).any()
    assert drawn.legend.scale is not None and drawn.legend.scale.high == str(max(2, lengths.max()))
    assert told.legend.scale is not None and told.legend.scale.low == f"{depths.min():.3g}"
    nowhere = (cells >= 0) & ~np.isfinite(depths.ravel()[cells])
    assert (told.picture[nowhere] == np.round(np.multiply(BACKGROUND, 255.0))).all()
    assert (told.picture[(cells >= 0) & ~nowhere] != told.picture[0, 0]).any(-1).all()
