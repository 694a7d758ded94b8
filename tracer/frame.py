"""What a renderer gives back."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.scene.model import Camera
from tracer.settings import Settings
from tracer.statistics import FrameStatistics


@dataclass
class Frame:
    """One picture and what was learnt from it; arrays are C-contiguous, row 0 at the top.

    color (h, w, 3) float32, linear and not clamped; depth (h, w) float32, distance along the unit
    ray, inf for a miss; primitive and cell (h, w) int32, -1 for a miss; normal (h, w, 3) float32,
    the shading normal towards the viewer.  modes (units,) uint32 or uint64 are the packed words as this
    frame leaves them, which say nothing of it where `settings.keeps_modes` does not hold; pixel_count and highest_count
    (units,) int32.  due and lit (h, w, lights) bool where they were asked for: whether each shadow ray of the primary
    hit is due, and its answer.
    Where verified, reference like color is the picture with every shadow answer right, which is that
    of method "none" bit for bit, and wrong (h, w) int32 the number of wrong answers that count for
    each pixel, at all bounces and of all samples.

    cells (h, w) int32 are the units of virtual cells at each pixel, -1 for none, where the method has such;
    certificates (h, w) packed words like modes, of which the shadow bits are the certificates of the pixel's
    cell, 0 where it has none.  saved, cost and due_rays (h, w) int32 count, at all bounces, the shadow rays of
    each pixel that asked no tree of static geometry, all rays that were traced for it, and the shadow rays that were
    due: without culling, saved + cost rays would have been traced.  layers are what else the method shows of each
    pixel, by name.
    """

    time: float
    camera: Camera
    settings: Settings
    color: NDArray[np.float32]
    depth: NDArray[np.float32]
    primitive: NDArray[np.int32]
    normal: NDArray[np.float32]
    modes: NDArray[np.unsignedinteger]
    pixel_count: NDArray[np.int32]
    highest_count: NDArray[np.int32]
    lights: int
    due: NDArray[np.bool_] | None = None
    lit: NDArray[np.bool_] | None = None
    reference: NDArray[np.float32] | None = None
    wrong: NDArray[np.int32] | None = None
    cells: NDArray[np.int32] | None = None
    certificates: NDArray[np.unsignedinteger] | None = None
    saved: NDArray[np.int32] | None = None
    cost: NDArray[np.int32] | None = None
    due_rays: NDArray[np.int32] | None = None
    layers: dict[str, NDArray] = field(default_factory=dict)
    statistics: FrameStatistics = field(default_factory=FrameStatistics)

    @property
    def width(self) -> int:
        return self.primitive.shape[1]

    @property
    def height(self) -> int:
        return self.primitive.shape[0]

    @property
    def cell(self) -> NDArray[np.int32]:
        """The unit that carries modes at each pixel: a virtual cell, or the primitive itself."""
        return self.primitive if self.cells is None else self.cells

    @property
    def occlusion_mode(self) -> NDArray[np.uint8]:
        """(h, w) OcclusionMode of each pixel's unit, 255 for a miss."""
        return self._per_pixel(modes.occlusion_mode(self.modes))

    @property
    def shadow_mode(self) -> NDArray[np.uint8]:
        """(h, w, lights) ShadowMode of each pixel's unit, 255 for a miss."""
        planes = [self._per_pixel(modes.shadow_mode(self.modes, light)) for light in range(self.lights)]
        return np.stack(planes, axis=-1) if planes else np.empty((*self.primitive.shape, 0), np.uint8)

    def _per_pixel(self, values: NDArray[np.uint8]) -> NDArray[np.uint8]:
        units = self.cell if self.certificates is None else self.primitive  # cells with certificates have no modes
        hit = units >= 0
        result = np.full(units.shape, 255, np.uint8)
        result[hit] = values[units[hit]]
        return result
