"""What was clicked is found again in other pictures."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.fakes import make_frame, make_scene
from tracer.frame import Frame, Settings
from tracer.scene.model import Camera
from viewer.state.picking import NEARBY, Pick, pick, pixel_of

SIZE = Settings(64, 32)


@pytest.fixture
def frame() -> Frame:
    return make_frame(SIZE)


@pytest.fixture
def kept(frame: Frame) -> Pick:
    return pick(frame, make_scene(), 20.5 / 64, 9.5 / 32)


def showing_only(frame: Frame, kept: Pick, x: int, y: int, beyond: float) -> Frame:
    """The frame with what was clicked at one pixel alone, and something else at another distance around it."""
    here = np.zeros(frame.primitive.shape, bool)
    here[y, x] = True
    primitive = np.where(here, kept.primitive, kept.primitive + 1).astype(np.int32)
    return replace(frame, primitive=primitive, depth=np.where(here, frame.depth, beyond * frame.depth))


def test_what_was_clicked_is_where_the_picture_shows_it(frame: Frame, kept: Pick):
    assert pixel_of(kept, frame) == (kept.x, kept.y) == (20, 9)
    x, y = pixel_of(kept, make_frame(replace(SIZE, width=128, height=64)))
    assert abs(x - 41) <= 1 and abs(y - 19) <= 1
    assert pixel_of(kept, replace(frame, camera=Camera(frame.camera.position, (0.0, 0.0, 1.0)))) is None


@pytest.mark.parametrize("across, down", [(0, 0), (NEARBY, 0), (-1, 1), (-NEARBY, -NEARBY)])
def test_a_pixel_or_two_off_is_near_enough(frame: Frame, kept: Pick, across: int, down: int):
    at = kept.x + across, kept.y + down
    assert pixel_of(kept, showing_only(frame, kept, *at, beyond=0.5)) == at
    assert pixel_of(kept, showing_only(frame, kept, at[0] + 7, at[1], beyond=0.5)) is None, "something is before it"


def test_what_is_smaller_than_a_pixel_is_found_by_its_distance(frame: Frame, kept: Pick):
    elsewhere = showing_only(frame, kept, kept.x + 30, kept.y, beyond=1.0)
    assert math.isclose(math.dist(frame.camera.position, kept.point), kept.depth)
    assert pixel_of(kept, elsewhere) == (kept.x, kept.y)
    assert pixel_of(replace(kept, dynamic=True), elsewhere) is None, "what moves may have gone"
