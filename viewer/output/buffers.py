"""What was found at each pixel of a frame, as arrays by name: for `--buffers`, EXR and other programs."""

from __future__ import annotations

import numpy as np

from tracer.culling import modes
from tracer.frame import Frame


def buffers(frame: Frame) -> dict[str, np.ndarray]:
    """The arrays of `--buffers`, by name: `lit` and `due` of a frame that was rendered with `record_lights`.

    A verified frame has `reference` and `wrong` as well, one with certificates `certificate`, and one that recorded
    its work `saved`, `cost` and `due_rays`."""
    arrays: dict[str, np.ndarray] = {
        "color": frame.color,
        "depth": frame.depth,
        "primitive": frame.primitive,
        "cell": frame.cell,
        "occlusion_mode": frame.occlusion_mode,
        "shadow_mode": frame.shadow_mode,
    }
    if frame.lit is not None and frame.due is not None:
        arrays |= {"lit": frame.lit, "due": frame.due}
    if frame.reference is not None and frame.wrong is not None:
        arrays |= {"reference": frame.reference, "wrong": frame.wrong}
    if frame.certificates is not None:
        planes = [modes.shadow_mode(frame.certificates, light) for light in range(frame.lights)]
        arrays["certificate"] = np.stack(planes, axis=-1) if planes else np.empty((*frame.primitive.shape, 0), np.uint8)
    work = {"saved": frame.saved, "cost": frame.cost, "due_rays": frame.due_rays}
    arrays |= {name: array for name, array in work.items() if array is not None}
    return arrays
