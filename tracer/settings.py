"""How to render: what is asked of a renderer, checked, before anything that renders is loaded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from tracer.geometry.accelerators import ACCELERATORS
from tracer.method import DEFAULT_METHOD, Method
from tracer.scene.lights import MAX_SAMPLES

MAX_SIDE = 16384
MAX_NODES = 65536  # of a cut: each takes a kilobyte for each thread
RECORDS = ("verify", "record_lights", "record_fates", "record_work")
"""Settings that only add to what a frame holds: the picture is the same."""
LIGHT_BUFFER_SIDES = (16, 32, 64, 128, 256, 512, 1024)


@dataclass(frozen=True)
class Settings:
    """How to render.

    Parameters
    ----------
    width, height : int
        Size of the picture in pixels.
    depth : int
        Bounces of a ray, at most.
    method : str
        What culls shadow rays, by its name (see `tracer.method`).
    symmetric : bool
        Run the occlusion test in both directions between neighbouring pixels, not in one as published (§2.3).
    zoom_factor : float
        A primitive that covers more than this many times its highest pixel count is judged again (§2.6).
    modes : bool
        Keep the paper's modes also beside a method that does not cull by them: exactly those that "paper" would have,
        or "paper+rest" beside methods for which objects that rest count as static.
    verify : bool
        Trace every culled answer as well, count the wrong ones, and fill `Frame.reference` and `Frame.wrong`.
    lamp_radius : float or None
        Every point light and sphere of the scene becomes a sphere of this radius, or a point with 0; None leaves them.
    lamp_samples : int or None
        Points from which each lamp shines (`tracer.scene.lights`). None leaves what the scene says, and gives 16 to a
        point that becomes a sphere.
    samples : int
        Rays per pixel, averaged. Modes and statistics are those of the first, which goes through the pixel's centre.
    threads : int
        Threads that work at once; 0 for one on each core.
    accelerator : str
        "bvh8", the fast structure, which counts steps and tests for whole packets of rays; "kdtree", the paper's, which
        counts them ray by ray; or "kdtree-lazy", one kd-tree over everything, which is built where rays arrive.
    record_lights : bool
        Fill `Frame.due` and `Frame.lit`.
    record_fates : bool
        Fill `Frame.fates`, what became of each shadow ray.
    record_work : bool
        Fill `Frame.saved`, `Frame.cost` and `Frame.due_rays`.
    certificates : int
        Certificates that a frame makes, at most.
    certificate_seconds : float
        Seconds that a frame spends on certificates, at most; a quarter of them is reserved for making them. With a
        limit, chance decides how many are made. Without one (inf), counters repeat exactly.
    patient : bool
        Nobody waits for the frame, so that "auto" may spend the whole budget and not only what certificates are worth.
    certificate_memory : float
        Megabytes that certificates take, at most.
    lightcuts_error : float
        The part of the light of a point that a cluster of lights may be wrong by, for methods that shade by cuts of
        lights. With 0 every light is looked at.
    lightcuts_nodes : int
        Clusters of a cut, at most.
    light_buffer_side : int
        Cells along an edge of the cube around a light, a power of two from 16 to 1024; for the method "lightbuffer".
    light_buffer_memory : float
        Megabytes that all cubes take, at most. Where these are too few for a light, its cells are made larger, and at
        last the light is traced.
    """

    width: int = 512
    height: int = 512
    depth: int = 10
    method: str = DEFAULT_METHOD
    symmetric: bool = False
    zoom_factor: float = 4.0
    modes: bool = False
    verify: bool = False
    samples: int = 1
    lamp_radius: float | None = None
    lamp_samples: int | None = None
    threads: int = 0
    accelerator: str = "bvh8"
    record_lights: bool = False
    record_fates: bool = False
    record_work: bool = False
    certificates: int = 100_000
    certificate_seconds: float = math.inf
    patient: bool = False
    certificate_memory: float = 256.0
    lightcuts_error: float = 0.02
    lightcuts_nodes: int = 1000
    light_buffer_side: int = 256
    light_buffer_memory: float = 256.0

    @property
    def keeps_modes(self) -> bool:
        """Whether frames keep modes. Frames of methods that cull by modes always do."""
        return self.modes or Method.parse(self.method).uses_modes

    @property
    def modes_beside(self) -> bool:
        """Whether frames keep modes only to be looked at, beside a method that does not cull by them."""
        return self.modes and not Method.parse(self.method).uses_modes

    @property
    def records_fates(self) -> bool:
        """Whether frames hold what became of each shadow ray. Those of methods that cluster lights never do."""
        return self.record_fates and not Method.parse(self.method).clusters

    def recording_only(self, *names: str) -> Settings:
        """Return these settings with the `RECORDS` of these names and no others."""
        recorded: dict[str, Any] = {name: name in names for name in RECORDS}
        return replace(self, **recorded)

    def validated(self) -> Settings:
        """Return these settings, checked.

        Raises
        ------
        ValueError
            If a value is out of range; the message is one line.
        """
        Method.parse(self.method)
        checks = (
            (1 <= self.width <= MAX_SIDE and 1 <= self.height <= MAX_SIDE, f"width and height lie in 1 to {MAX_SIDE}"),
            (0 <= self.depth <= 100, "depth lies in 0 to 100"),
            (math.isfinite(self.zoom_factor) and self.zoom_factor >= 1.0, "zoom_factor is a finite number from 1 up"),
            (self.accelerator in ACCELERATORS, f"accelerator is one of {', '.join(ACCELERATORS)}"),
            (1 <= self.samples <= 4096, "samples lie in 1 to 4096"),
            (
                self.lamp_radius is None or (math.isfinite(self.lamp_radius) and self.lamp_radius >= 0),
                "lamp_radius is 0 or more",
            ),
            (
                self.lamp_samples is None or 1 <= self.lamp_samples <= MAX_SAMPLES,
                f"lamp_samples lie in 1 to {MAX_SAMPLES}",
            ),
            (0 <= self.threads <= 1024, "threads lie in 0 to 1024"),
            (
                self.light_buffer_side in LIGHT_BUFFER_SIDES,
                "light_buffer_side is a power of two from 16 to 1024",
            ),
            (self.light_buffer_memory >= 0, "light_buffer_memory is 0 or more"),
            (
                all(budget >= 0 for budget in (self.certificates, self.certificate_seconds, self.certificate_memory)),
                "budgets of certificates are 0 or more",
            ),
            (
                math.isfinite(self.lightcuts_error) and self.lightcuts_error >= 0,
                "lightcuts_error is a finite number from 0 up",
            ),
            (1 <= self.lightcuts_nodes <= MAX_NODES, f"lightcuts_nodes lie in 1 to {MAX_NODES}"),
        )
        for holds, message in checks:
            if not holds:
                raise ValueError(message)
        return self
