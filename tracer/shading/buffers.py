"""Where pictures are written to, and the memory that a worker shades in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.shadow_testing import SHADOW_ROWS
from tracer.runtime.kernels import inlined
from tracer.shading.blocks import NO_PLANES, Planes
from tracer.shading.points import POINT_ROWS
from tracer.shading.wave import WAVE_ROWS

TILE = 64  # pixels on a side: more would make a few packets more coherent, but leave too little to share among threads
PIXEL_ROWS = 10


class Buffers(NamedTuple):
    """One picture: color and normal (height * width, 3), depth, u and v (height, width) float32,
    primitive (height, width) int32; asked and reached (height * width, lights) uint16, or without rows; fates
    (height * width, lights) uint8 (`tracer.culling.fate`), or without rows; reference like color and wrong
    (height * width,) int32, or without rows where nothing is verified; saved, cost and due_rays (height * width,)
    int32, or without rows; and planes for a picture that is refined progressively."""

    color: NDArray[np.float32]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    primitive: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    asked: NDArray[np.uint16]
    reached: NDArray[np.uint16]
    fates: NDArray[np.uint8]
    reference: NDArray[np.float32]
    wrong: NDArray[np.int32]
    saved: NDArray[np.int32]
    cost: NDArray[np.int32]
    due_rays: NDArray[np.int32]
    planes: Planes


def empty_buffers(
    width: int, height: int, lights: int, *, record_lights: bool = False, record_fates: bool = False,
    verify: bool = False, record_work: bool = False, planes: Planes = NO_PLANES,
) -> Buffers:  # fmt: skip
    """Buffers for a picture of this size, with rows for what is to be recorded."""
    pixels = width * height
    recorded, told, verified, worked = (
        pixels if asked else 0 for asked in (record_lights, record_fates, verify, record_work)
    )
    return Buffers(
        color=np.zeros((pixels, 3), np.float32),
        normal=np.zeros((pixels, 3), np.float32),
        depth=np.empty((height, width), np.float32),
        primitive=np.empty((height, width), np.int32),
        u=np.empty((height, width), np.float32),
        v=np.empty((height, width), np.float32),
        asked=np.zeros((recorded, lights), np.uint16),
        reached=np.zeros((recorded, lights), np.uint16),
        fates=np.zeros((told, lights), np.uint8),
        reference=np.zeros((verified, 3), np.float32),
        wrong=np.zeros(verified, np.int32),
        saved=np.zeros(worked, np.int32),
        cost=np.zeros(worked, np.int32),
        due_rays=np.zeros(worked, np.int32),
        planes=planes,
    )


class Workspace(NamedTuple):
    """Memory that one worker shades in, tile after tile (`workspace`)."""

    wave: NDArray[np.float32]
    next: NDArray[np.float32]
    points: NDArray[np.float32]
    shadows: NDArray[np.float32]
    scratch: NDArray[np.float32]
    pixels: NDArray[np.float64]


class TilePixels(NamedTuple):
    """A tile's pixels in the order of its primary rays: place (n,) int32 in the picture, and the light (3, n)
    float64 that has arrived at them; reference like light, local that of the first wave alone.

    Sums are float64, in which those of a pixel's few float32 come out the same in any order: a pixel's rays change
    places with the company they keep, and that is other pixels where a picture is refined progressively."""

    place: NDArray[np.int32]
    light: NDArray[np.float64]
    reference: NDArray[np.float64]
    local: NDArray[np.float64]


def workspace() -> Workspace:
    """For waves of four times as many rays as a tile has pixels; larger ones find memory as they go.

    Of stages' rows (`tracer.culling.stages`) there are none yet."""

    def rows(count: int, n: int, kind: type = np.float32) -> NDArray:
        # A cache line more than whole pages: rows of whole pages would share the same few lines of the cache.
        return np.empty((count, -(-n // 1024) * 1024 + 16), kind)

    n = 4 * TILE * TILE
    return Workspace(
        rows(WAVE_ROWS, n),
        rows(WAVE_ROWS, n),
        rows(POINT_ROWS, n),
        rows(SHADOW_ROWS, n),
        rows(0, n),
        rows(PIXEL_ROWS, n, np.float64),
    )


@inlined
def pixels_in(memory):
    """A tile's pixels, in a workspace's memory for them."""
    return TilePixels(memory[0].view(np.int32), memory[1:4], memory[4:7], memory[7:10])


@inlined
def write(pixels, place, count, rows):
    """The first `count` columns of rows (3, n) become pixels (any, 3)."""
    for i in range(count):
        for c in range(3):
            pixels[place[i], c] = rows[c, i]
