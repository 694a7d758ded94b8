"""What verifying tells: the picture with every answer right, and where answers were wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import tracer
from tests.scenes import loaded, world_of
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.same import assert_verified

SCENES = Path(__file__).resolve().parents[2] / "assets" / "scenes"
SETTINGS = tracer.Settings(width=128, height=128, depth=10, verify=True)


@pytest.mark.parametrize("accelerator", ACCELERATORS)
def test_the_reference_of_kitchen_is_the_picture_without_culling(bart: Path, accelerator: str):
    world = world_of(bart / "kitchen" / "kitchen.aff", accelerator)
    scene = world.scene
    settings = replace(SETTINGS, accelerator=accelerator)
    paper = tracer.Renderer(scene, settings, world=world)
    none = tracer.Renderer(scene, replace(settings, method="none"), world=world)
    wrong = 0
    for number in range(395, cases(401, 405)):
        time = scene.frame_time(number)
        frame = paper.render(time)
        assert_verified(frame, none.render(time))
        wrong += frame.statistics.shadow.wrong
    assert wrong > 0, "nothing was wrong: this shows nothing"
    assert (frame.color != frame.reference).any()


@pytest.mark.parametrize("method", ["none", "paper", "certified+cache"])
def test_the_work_at_pixels_adds_up_to_that_of_the_frame(method: str):
    scene = loaded(SCENES / "default.aff")
    renderer = tracer.Renderer(scene, tracer.Settings(width=96, height=64, depth=3, method=method, record_work=True))
    for number in range(20, 24):
        frame = renderer.render(scene.frame_time(number))
    shadow = frame.statistics.shadow
    assert frame.due_rays.sum() == shadow.due and (frame.saved <= frame.due_rays).all()
    spared = shadow.culled + shadow.dynamic_only + shadow.candidates_only + shadow.cache_hits
    assert frame.saved.sum() == spared and (spared > 0) == (method != "none")
    rays = frame.statistics.primary.rays + frame.statistics.secondary.rays
    assert frame.saved.sum() + frame.cost.sum() == rays + shadow.due
