"""Whether frames are the same, bit for bit."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import Any

import numpy as np

import tracer

NOT_COMPARED = "settings", "statistics", "layers", "structures"


def contents(frame: tracer.Frame) -> dict[str, Any]:
    """Everything a frame holds but how long it took and on how many threads."""
    held = {f.name: getattr(frame, f.name) for f in fields(frame) if f.name not in NOT_COMPARED}
    held |= {f"layer {name}": layer for name, layer in frame.layers.items()}
    counted = frame.statistics.to_dict()
    del counted["seconds"], counted["phases"], counted["built"]  # of trees, by rays of earlier frames as well
    return held | {"occlusion_mode": frame.occlusion_mode, "shadow_mode": frame.shadow_mode, "counters": counted}


def assert_same(expected: tracer.Frame, frame: tracer.Frame, where: str) -> None:
    a, b = contents(expected), contents(frame)
    for name, value in a.items():
        if isinstance(value, np.ndarray):
            assert value.dtype == b[name].dtype and value.shape == b[name].shape, f"{name} {where}"
            assert value.tobytes() == b[name].tobytes(), f"{name} {where}"
        else:
            assert value == b[name], f"{name} {where}"


def assert_verified(frame: tracer.Frame, none: tracer.Frame) -> None:
    """A frame by method paper against the same one by method none."""
    assert frame.reference.tobytes() == none.color.tobytes()
    assert frame.wrong.sum() == frame.statistics.shadow.wrong
    assert (frame.color[frame.wrong == 0] == none.color[frame.wrong == 0]).all()
    assert none.reference.tobytes() == none.color.tobytes()
    assert none.statistics.shadow.wrong == 0 == none.wrong.sum()


def assert_only_asked_less(frame: tracer.Frame, without: tracer.Frame) -> None:
    """Everything is the same, bit for bit, but that hits of the cache are not traced."""
    for name in ("color", "primitive", "modes", "pixel_count", "highest_count", "due", "lit", "reference", "wrong"):
        assert getattr(frame, name).tobytes() == getattr(without, name).tobytes(), name
    shadow, before = asdict(frame.statistics.shadow), asdict(without.statistics.shadow)
    assert shadow["rays"] + shadow["cache_hits"] == before["rays"]
    for name in ("due", "culled", "dynamic_only", "wrong"):
        assert shadow[name] == before[name], name
    assert before["cache_hits"] == 0
