"""What is clicked tells what is there, and is found again in other pictures."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.viewer.drawn import units_in
from tests.viewer.fakes import in_cells, make_frame, make_scene, with_certificates
from tracer.culling.modes import ShadowMode
from tracer.frame import Frame, Settings
from tracer.scene.model import Camera
from viewer.state.picking import NEARBY, Pick, extent_at, pick, pixel_of, point_at, shadow_mode_of, unit_of, wrong_at
from viewer.state.pixels import pixel_at
from viewer.state.views import View

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
    assert math.isclose(math.dist(frame.camera.position, kept.point), frame.depth[kept.y, kept.x])
    assert pixel_of(kept, elsewhere) == (kept.x, kept.y)
    assert pixel_of(replace(kept, dynamic=True), elsewhere) is None, "what moves may have gone"


def test_wide_words_reach_light_30():
    frame = make_frame()
    words = frame.modes.astype(np.uint64) | (np.uint64(2) << np.uint64(62))
    frame = replace(frame, modes=words)
    rows = units_in(frame, View.SHADOW, 30)
    assert rows["non-shadow"] + rows["non-shadow, untrusted"] == 5
    assert shadow_mode_of(frame, 0, 30) is ShadowMode.NON_SHADOW
    assert shadow_mode_of(frame, 0, 31) is None


def test_a_pick_says_what_the_pixel_shows():
    frame, scene = make_frame(), make_scene()
    found = pick(frame, scene, (2 * 3 + 0.5) / 16, 0.5)  # the fourth primitive
    assert (found.primitive, found.kind, found.object_name, found.dynamic) == (3, "triangle", "static", False)
    assert math.dist(found.point, frame.camera.position) == pytest.approx(2.0)
    assert pick(frame, scene, (2 * 4 + 0.5) / 16, 0.5).object_name == "train"
    assert pick(frame, scene, (2 * 6 + 0.5) / 16, 0.5).kind == "sphere"
    assert pick(frame, scene, 0.99, 0.5).primitive == -1
    assert point_at(frame, 0.99, 0.5) is None and extent_at(frame, 0.99, 0.5) is None
    assert extent_at(frame, 0.1, 0.5) > 0.0 and pixel_at(frame, -1.0, 7.0) == (0, 7), "clamped to the picture"


def test_the_modes_of_a_pixel_are_its_cells_where_those_carry_them():
    frame, at = make_frame(), (7, 4)  # the fourth primitive's second column
    assert unit_of(frame, 3, at) == unit_of(frame, 3, None) == 3
    assert unit_of(with_certificates(frame), 3, at) == 3, "certificates are no modes"
    assert unit_of(in_cells(frame), 3, at) == 7
    assert unit_of(in_cells(frame), 3, None) == -1, "which cell it is cannot be known"


def test_wrong_answers_are_known_of_shaded_pixels_of_verified_frames():
    verified = make_frame(Settings(width=16, height=8, verify=True))
    assert wrong_at(verified, 5, 6) == 2 and wrong_at(verified, 0, 6) == 0 and wrong_at(make_frame(), 5, 6) is None
    assert wrong_at(replace(verified, shaded=np.zeros((8, 16), bool)), 5, 6) is None
