"""What verifying tells: the picture with every answer right, and where answers were wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import tracer
from tracer.geometry.world import ACCELERATORS

SETTINGS = tracer.Settings(width=128, height=128, depth=10, verify=True)


def assert_verified(frame: tracer.Frame, none: tracer.Frame) -> None:
    """A frame by method paper against the same one by method none."""
    assert frame.reference.tobytes() == none.color.tobytes()
    assert frame.wrong.sum() == frame.statistics.shadow.wrong
    assert (frame.color[frame.wrong == 0] == none.color[frame.wrong == 0]).all()
    assert none.reference.tobytes() == none.color.tobytes()
    assert none.statistics.shadow.wrong == 0 == none.wrong.sum()


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_the_reference_of_kitchen_is_the_picture_without_culling(bart: Path, accelerator: str):
    scene = tracer.load_scene(bart / "kitchen" / "kitchen.aff")
    settings = replace(SETTINGS, accelerator=accelerator)
    paper = tracer.Renderer(scene, settings)
    none = tracer.Renderer(scene, replace(settings, method="none"), world=paper.world)
    wrong = 0
    for number in range(395, 405):
        time = scene.frame_time(number)
        frame = paper.render(time)
        assert_verified(frame, none.render(time))
        wrong += frame.statistics.shadow.wrong
    assert wrong > 0, "nothing was wrong: this shows nothing"
    assert (frame.color != frame.reference).any()
