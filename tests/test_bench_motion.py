"""The benchmark of motion: both ways plan as the window asks them to, and what is compared has the window's size."""

from __future__ import annotations

import numpy as np
import pytest

from tests.bench.motion_server import WAYS, on_screen
from tracer.statistics import FrameStatistics


@pytest.mark.parametrize("way", WAYS)
def test_each_way_is_coarse_in_motion_alone(way: str):
    budget = WAYS[way]()
    budget.observe(FrameStatistics(seconds=2.0, phases={"primary": 0.5, "surfaces": 0.5, "shading": 1.0}), 400_000)
    assert budget.plan(800, 500, 0.05).divisor > 1
    assert budget.plan(800, 500, 0.05, False).divisor == 1
    assert budget.plan(800, 500, 9.0).parts[-1] == 16


def test_a_coarse_picture_is_enlarged_smoothly():
    small = np.zeros((4, 6, 3), np.uint8)
    small[:, 3:] = 200
    shown = on_screen(small, (12, 8))
    assert shown.shape == (8, 12, 3) and set(np.unique(shown)) > {0, 200}
    assert on_screen(small, (6, 4)) is small
