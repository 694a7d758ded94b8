"""Frames that were traced before a picture, from which its modes were learnt: when and from where each was seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from tracer.scene.model import Camera

MOST_WARMUP_FRAMES = 100_000
"""Frames before one picture."""
MAX_TIME = 1e300
"""Seconds; JSON may hold numbers that are no finite float."""


class WarmupFrame(NamedTuple):
    """A frame's time in seconds and its camera, the scene's own at that time where that is None."""

    time: float
    camera: Camera | None = None


def to_json(frames: Sequence[WarmupFrame]) -> list[Any]:
    """`[time, camera]` for each, as JSON has it: null is the scene's own camera."""
    return [[frame.time, None if frame.camera is None else frame.camera.to_json()] for frame in frames]


def from_json(data: Any) -> tuple[WarmupFrame, ...]:
    """The inverse of `to_json`, also of an object that has it as "before", such as the JSON of a find; raises
    ValueError, in one line, on anything else."""
    if isinstance(data, Mapping):
        data = data.get("before")
    if not isinstance(data, list) or len(data) > MOST_WARMUP_FRAMES:
        raise ValueError("these are no frames before: a list of [time, camera], with null for the scene's own camera")
    frames = []
    for item in data:
        if not (isinstance(item, list) and len(item) == 2 and type(item[0]) in (int, float)):
            raise ValueError("a frame before is not understood: give [time, camera]")
        if not abs(item[0]) <= MAX_TIME:
            raise ValueError("the time of a frame before is not a finite number")
        frames.append(WarmupFrame(float(item[0]), None if item[1] is None else Camera.from_json(item[1])))
    return tuple(frames)
