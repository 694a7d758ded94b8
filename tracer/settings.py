"""How to render: what is asked of a renderer, checked, before anything that renders is loaded."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Any

from tracer.geometry.accelerators import BVH8, KD_TREE, LAZY
from tracer.method import DEFAULT_METHOD, Method, title_of
from tracer.scene.lights import MAX_SAMPLES
from tracer.scene.limits import LARGEST
from tracer.util.setting import NEVER, PICTURES, check_all, documented, setting

MAX_SIDE = 16384
MAX_NODES = 65536  # of a cut: each takes a kilobyte for each thread
RECORDS = ("verify", "record_lights", "record_fates", "record_work")
"""Settings that only add to what a frame holds: the picture is the same."""
LIGHT_BUFFER_SIDES = (16, 32, 64, 128, 256, 512, 1024)
TREES = {
    BVH8: "the fast one, which counts steps and tests for whole packets of rays",
    KD_TREE: "the paper's, whose steps are those that it counts, ray by ray",
    LAZY: "one kd-tree over everything, built where rays arrive",
}
"""What rays are traced through, and what it is."""


def _keeps_modes(settings: Settings) -> bool:
    return not _clusters(settings)  # methods by clusters of lights keep none


def _clusters(settings: Settings) -> bool:
    return Method.parse(settings.method).clusters


@documented
@dataclass(frozen=True)
class Settings:
    """How to render."""

    width: int = setting(
        512, "Width", "Pixels from left to right.", low=1, high=MAX_SIDE, stored=PICTURES, remembered=False
    )
    height: int = setting(
        512, "Height", "Pixels from top to bottom.", low=1, high=MAX_SIDE, stored=PICTURES, remembered=False
    )
    depth: int = setting(
        10, "Bounces", "How often a ray is reflected or refracted, at most.", low=0, high=100, slider=(0, 20),
        option="--depth", panel="Rendering",
    )  # fmt: skip
    method: str = setting(
        DEFAULT_METHOD, "Method", "Which shadow rays are not traced, and what that trusts.", check=Method.parse,
        called=title_of, option="--method",
    )  # fmt: skip
    symmetric: bool = setting(
        False, "Symmetric occlusion test",
        "Test two neighbouring pixels both ways, not one way as published (§2.3): each one's ray against the other's "
        "primitive.", option="--symmetric", panel="Culling", applies=_keeps_modes,
    )  # fmt: skip
    zoom_factor: float = setting(
        4.0, "Zoom factor",
        "Examine a primitive anew once it covers this many times the pixels of its last examination (§2.6).",
        low=1.0, slider=(1.0, 64.0), log=True, digits=1, option="--zoom-factor", panel="Culling", applies=_keeps_modes,
    )  # fmt: skip
    modes: bool = setting(
        False, "Modes beside the method",
        "Keep the paper's modes also beside a method that does not cull by them: exactly those that paper would have, "
        "or paper+rest beside methods for which objects that rest count as static.", stored=NEVER,
    )  # fmt: skip
    verify: bool = setting(
        False, "Verify",
        "Trace every culled shadow ray as well, and count wrong answers.", option="--verify", panel="Culling",
    )  # fmt: skip
    samples: int = setting(
        1, "Samples per pixel",
        "Rays per pixel, averaged; modes and statistics are those of the first, which goes through the pixel's centre.",
        low=1, high=4096, slider=(1, 64), log=True, option="--samples", panel="Rendering", in_window=16,
    )  # fmt: skip
    lamp_radius: float | None = setting(
        None, "Lamp radius",
        "Make every point light and sphere a lamp of this radius, in the scene's units, with soft shadows; 0: points.",
        low=0.0, high=LARGEST, unset="scene", option="--lamp-radius", panel="Lamps", remembered=False,
    )  # fmt: skip
    lamp_samples: int | None = setting(
        None, "Lamp samples",
        "Points from which each lamp shines; a point that became a sphere has 16 unless this says more or fewer.",
        low=1, high=MAX_SAMPLES, unset="scene", option="--lamp-samples", panel="Lamps",
    )  # fmt: skip
    threads: int = setting(
        0, "Threads", "Threads that work at once, 0 for one on each core: the picture and the counters stay the same.",
        low=0, high=1024, slider=(0, os.cpu_count() or 1), option="--threads", panel="Rendering", stored=PICTURES,
    )  # fmt: skip
    accelerator: str = setting(
        BVH8, "Tree",
        "The tree that rays are traced through; modes and certificates are learnt anew in another.",
        choices=TREES, option="--accelerator", panel="Rendering", stored=PICTURES, remembered=False,
    )  # fmt: skip
    record_lights: bool = setting(False, "Record lights", "Fill `Frame.due` and `Frame.lit`.", stored=NEVER)
    record_fates: bool = setting(
        False, "Record fates", "Fill `Frame.fates`, what became of each shadow ray.", stored=NEVER
    )
    record_work: bool = setting(
        False, "Record work", "Fill `Frame.saved`, `Frame.cost` and `Frame.due_rays`.", stored=NEVER
    )
    certificates: int = setting(
        100_000, "Certificates", "Certificates that a frame makes, at most.", low=0, stored=NEVER
    )
    certificate_seconds: float = setting(
        math.inf, "Seconds for certificates",
        "Seconds that a frame spends on certificates, at most; a quarter of them is reserved for making them. With a "
        "limit, chance decides how many are made; without one (inf), counters repeat exactly.", low=0.0, stored=NEVER,
    )  # fmt: skip
    patient: bool = setting(
        False, "Patient",
        "Nobody waits for the frame, so that auto may spend the whole budget and not only what certificates are worth.",
        stored=NEVER,
    )  # fmt: skip
    certificate_memory: float = setting(
        256.0, "Memory for certificates", "Megabytes that certificates take, at most.", low=0.0, unit=" MB"
    )
    lightcuts_error: float = setting(
        0.02, "Error of clusters",
        "The part of a point's light that a cluster of lights may be wrong by; 0 looks at every light.",
        low=0.0, slider=(0.0, 1.0), percent=True, log=True, option="--lightcuts-error", panel="Culling",
        applies=_clusters,
    )  # fmt: skip
    lightcuts_nodes: int = setting(
        1000, "Clusters at most", "Clusters of lights for a point, at most.", low=1, high=MAX_NODES, log=True,
        option="--lightcuts-nodes", panel="Culling", applies=_clusters,
    )  # fmt: skip
    light_buffer_side: int = setting(
        256, "Cells of a light buffer",
        "Cells along an edge of the cube around a light, for the method lightbuffer.", choices=LIGHT_BUFFER_SIDES,
    )  # fmt: skip
    light_buffer_memory: float = setting(
        256.0, "Memory for light buffers",
        "Megabytes that all cubes take, at most. Where these are too few for a light, its cells are made larger, and "
        "at last the light is traced.", low=0.0, unit=" MB",
    )  # fmt: skip

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
        return check_all(self)
