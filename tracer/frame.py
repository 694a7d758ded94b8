"""What is asked of a renderer, and what it gives back."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import choice, culls_by_modes, is_method
from tracer.scene.model import Camera
from tracer.statistics import FrameStatistics

MAX_SIDE = 16384


@dataclass(frozen=True)
class Settings:
    """How to render.  Sizes in pixels; depth is the most bounces; threads 0 means all cores.

    `method` is "none", "paper" or "cells", which is the paper's with cells of large triangles for primitives
    (`tracer.culling.cells`); `symmetric` and `zoom_factor` belong to the latter two (§2.3, §2.6).  "certified"
    culls by what is proven of cells (`tracer.culling.certified`), and "auto" is whichever of "none" and "certified"
    it measures to be quicker (`tracer.investor`).
    `verify` traces each culled answer too, counts the wrong ones, and fills Frame.reference and
    Frame.wrong.  `samples` rays a pixel are averaged; all modes and statistics are those of the
    first, through the pixel's centre.
    `modes` keeps the paper's modes beside a method that does not cull by them: those that "paper+rest" would have,
    whichever method it is; with them, objects that rest are static to any (`tracer.culling.rest`).
    `accelerator` is "bvh8", fast, whose steps and tests are those of whole packets of rays where these are
    coherent, or "kdtree", the paper's, which counts them ray by ray.  `record_lights` fills Frame.due
    and Frame.lit, `record_work` Frame.saved, Frame.cost
    and Frame.due_rays.

    In a frame of method "certified" at most so many `certificates` are made, in at most so many
    `certificate_seconds` (which leaves it to chance how many: inf for counters that repeat exactly), of which a quarter
    at least is left for making them.  "auto" takes no more than that, and no more than they are worth; unless it is
    `patient`, as nobody waits for the frame.  They take about `certificate_memory` megabytes at most.
    """

    width: int = 512
    height: int = 512
    depth: int = 10
    method: str = "paper"
    symmetric: bool = False
    zoom_factor: float = 4.0
    modes: bool = False
    verify: bool = False
    samples: int = 1
    threads: int = 0
    accelerator: str = "bvh8"
    record_lights: bool = False
    record_work: bool = False
    certificates: int = 100_000
    certificate_seconds: float = math.inf
    patient: bool = False
    certificate_memory: float = 256.0

    @property
    def keeps_modes(self) -> bool:
        """Whether frames learn modes: those of methods that cull by them always do."""
        return self.modes or culls_by_modes(self.method)

    def validated(self) -> Settings:
        """Itself; raises ValueError, in one line, where a value is out of range."""
        checks = (
            (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE, f"width and height lie in 1 to {MAX_SIDE}"),
            (0 <= self.depth <= 100, "depth lies in 0 to 100"),
            (is_method(self.method), f"method is {choice()}, not {self.method!r}"),
            (math.isfinite(self.zoom_factor) and self.zoom_factor >= 1.0, "zoom_factor is a finite number from 1 up"),
            (self.accelerator in ACCELERATORS, f"accelerator is one of {', '.join(ACCELERATORS)}"),
            (1 <= self.samples <= 4096, "samples lie in 1 to 4096"),
            (0 <= self.threads <= 1024, "threads lie in 0 to 1024"),
            (
                all(budget >= 0 for budget in (self.certificates, self.certificate_seconds, self.certificate_memory)),
                "budgets of certificates are 0 or more",
            ),
        )
        for holds, message in checks:
            if not holds:
                raise ValueError(message)
        return self


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
    due: without culling, saved + cost rays would have been traced.
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
