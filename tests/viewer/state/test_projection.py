"""Lines of the world on the picture: where they are, what is cut off, and what is hidden."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.viewer.fakes import make_frame
from tracer.frame import Frame, Settings
from tracer.inspect.projection import place, strokes
from tracer.scene.model import Camera
from viewer.state.picking import point_at

CAMERA = Camera((1.0, 2.0, 3.0), (0.3, -0.2, -1.0), (0.1, 1.0, 0.0), 50.0)


def frame_of(depth: np.ndarray | float, width: int = 64, height: int = 32) -> Frame:
    """A frame that shows something at such distances everywhere."""
    frame = make_frame(Settings(width=width, height=height), camera=CAMERA)
    return replace(frame, depth=np.broadcast_to(np.float32(depth), (height, width)).copy())


def world(right: float, up: float, ahead: float) -> np.ndarray:
    """A point so far to the right of the camera, above it and ahead."""
    return CAMERA.position + np.array([right, up, ahead]) @ CAMERA.basis()


@pytest.mark.parametrize("at", [(0.1, 0.9), (0.5, 0.5), (0.97, 0.03)])
def test_a_point_lies_where_it_was_picked(at):
    frame = frame_of(7.0)
    u, v = place(frame, point_at(frame, *at))
    assert (u - at[0], v - at[1]) == pytest.approx((0.0, 0.0), abs=0.5 / 32)
    assert place(frame, point_at(frame, u, v)) == pytest.approx((u, v))


def test_what_is_behind_the_camera_has_no_place():
    assert place(frame_of(1.0), world(0.1, 0.1, -1.0)) is None
    assert strokes(frame_of(1.0), [world(0.1, 0.0, -1.0), world(0.2, 0.3, -0.01)]) == []
    assert strokes(frame_of(np.inf), [world(5.0, 0.0, 1.0), world(9.0, 3.0, 2.0)]) == [], "nor what is beside it"


@pytest.mark.parametrize("start", [world(0.3, 0.1, -5.0), world(0.0, 0.0, 0.0), world(40.0, -30.0, 1.0)])
def test_a_line_from_behind_or_beside_is_cut_where_it_comes_in(start):
    frame = frame_of(np.inf)
    end = world(0.2, -0.1, 2.0)
    found = strokes(frame, [start, end])
    assert all(stroke.seen for stroke in found) and found[-1].end == pytest.approx(place(frame, end))
    assert all(-1e-9 <= c <= 1.0 + 1e-9 for stroke in found for c in (*stroke.start, *stroke.end))
    first = np.array(found[0].start)
    if not np.allclose(start, world(0.0, 0.0, 0.0)):
        assert min(*first, *(1.0 - first)) == pytest.approx(0.0, abs=1e-9), "it does not come in at an edge"
    for fraction in (0.3, 0.9):  # the cut line is the same line
        between = place(frame, start + (1.0 - (1.0 - fraction) * 1e-3) * (end - start))
        way, other = np.subtract(found[-1].end, first), np.subtract(between, first)
        assert way[0] * other[1] - way[1] * other[0] == pytest.approx(0.0, abs=1e-9)


def test_hidden_parts_are_dashed_and_begin_where_the_line_goes_behind():
    frame = frame_of(4.0)
    line = np.array([world(-1.0, 0.1, 2.0), world(1.0, 0.1, 6.0)])
    found = strokes(frame, line)
    seen = [stroke for stroke in found if stroke.seen]
    hidden = [stroke for stroke in found if not stroke.seen]
    assert len(seen) == 1 and seen[0].start == pytest.approx(place(frame, line[0]))
    assert len(hidden) > 3
    assert all(b.start[0] - a.end[0] == pytest.approx(a.end[0] - a.start[0]) for a, b in pairwise(hidden))
    points = line[0] + np.linspace(0.0, 1.0, 1001)[:, None] * (line[1] - line[0])
    turned = points[np.argmin(np.abs(np.linalg.norm(points - CAMERA.position, axis=1) - 4.0))]
    assert seen[0].end[0] == pytest.approx(place(frame, turned)[0], abs=0.03)


def test_lines_on_what_is_seen_are_seen():
    """Along an edge, where the pixel beside shows something nearer, too."""
    depth = np.full((32, 64), 5.0)
    depth[:, 32:] = 2.0
    frame = frame_of(depth)
    points = [point_at(frame_of(5.0), 0.1 + 0.39 * k / 5, 0.4) for k in range(6)]
    assert all(stroke.seen for stroke in strokes(frame, points))
