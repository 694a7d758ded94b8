"""The frames before a picture, as JSON."""

from __future__ import annotations

import pytest

from tracer.experiments import warmup_frames
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.scene.model import Camera


def test_frames_before_a_picture_are_json() -> None:
    frames = (WarmupFrame(0.1), WarmupFrame(1 / 3, Camera((1, 2, 3), (0, 0, -1), angle=33.0)))
    data = warmup_frames.to_json(frames)
    assert warmup_frames.from_json(data) == frames == warmup_frames.from_json({"before": data})
    for wrong in ("x", {}, [[1]], [["a", None]], [[float("nan"), None]], [[0.0, {"position": 1}]]):
        with pytest.raises(ValueError) as raised:
            warmup_frames.from_json(wrong)
        assert "\n" not in str(raised.value)
