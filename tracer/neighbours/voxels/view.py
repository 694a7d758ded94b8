"""What kernels are given of voxels."""

from __future__ import annotations

from typing import NamedTuple

from tracer.culling.modes import Words
from tracer.simd.records import I32, F32x2D, F32x3D, reading
from tracer.visibility.grid import Grid


class VoxelView(NamedTuple):
    """All voxels, as kernels that are called by address read them.

    Attributes:
        grid: the voxels.
        words: their states, with one more word for all that lies outside: in the bits of the occlusion mode 1 where
            anything static lies in the voxel, and for each light its state as a shadow mode (`tracer.culling.modes`).
        starts: (voxels + 1,) int32, where in names the primitives of each voxel begin.
        names: (m,) int32, numbers of primitives.
        light_space: (held lights, primitives, LIGHT_ROW) float32 (`tracer.visibility.light_space`).
        slot: (lights,) int32, which of the held lights each is; -1 for those about which nothing is known.
        resting: (k, 6) float32, boxes around what rests now.
        by_ray: whether steps and tests are counted ray by ray, or for vectors of sixteen.
        cell: (pixels,) int32, gets the voxel at each primary hit; empty where nobody wants to know.
    """

    grid: Grid
    words: Words
    starts: I32
    names: I32
    light_space: F32x3D
    slot: I32
    resting: F32x2D
    by_ray: bool
    cell: I32


voxel_view_at = reading(VoxelView)
