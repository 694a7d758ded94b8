"""Why a point is in shadow: the same answers as the frame's own, and what blocks is what blocks in float64."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tracer.frame import Settings
from tracer.inspect.explanation import NO_CERTIFICATE, explain, outline
from tracer.renderer import Renderer
from tracer.scene.load import load_scene

SCENE = """\
b 0.2 0.3 0.4
v from 0.3 2.2 5 at 0 0 0 up 0 1 0 angle 55 hither 1 resolution 32 32
a 0 9 10
l 2 4 3 1 1 1
l -3 4 -2 0.5 0.5 0.5
l 0.5 -3 1 0.5 0.5 0.5
f 0.8 0.6 0.4 0.9 0.1 10 0 1
p 4 -2 -0.5 -2 -2 -0.5 2 2 -0.5 2 2 -0.5 -2
p 3 -1.4 0.4 0 -0.6 0.9 0.2 -1.1 0.2 0.7
f 0.3 0.5 0.8 0.9 0.1 10 0 1
s 0 0 0 0.5
c
1 -0.5 0.4 0.35
1.2 0.3 0.3 0.1
x flyer { p 3 -0.5 0.9 0 0.5 0.9 0 0 1.0 0.9 }
k flyer { transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  9 1 0 0 0 0 0  10 1 0 0 0 0 0 }
"""
WIDTH, HEIGHT = 48, 36


@pytest.fixture(scope="module", params=["bvh8", "kdtree"])
def seen(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """A renderer, a frame of its scene with an object on its way, and all explanations by pixel."""
    path: Path = tmp_path_factory.mktemp("explanation") / "scene.aff"
    path.write_text(SCENE)
    settings = Settings(WIDTH, HEIGHT, method="none", threads=1, accelerator=request.param, record_lights=True)
    renderer = Renderer(load_scene(path), settings)
    frame = renderer.render(6.0)
    return renderer, frame, {(y, x): explain(renderer, frame, x, y) for y in range(HEIGHT) for x in range(WIDTH)}


def test_answers_are_those_of_the_frame(seen) -> None:
    _, frame, explained = seen
    assert all((explained[y, x] == ()) == (frame.primitive[y, x] < 0) for y, x in explained)
    told = [(e, frame.due[at][e.light], frame.lit[at][e.light]) for at, found in explained.items() for e in found]
    assert {(e.due, e.lit) for e, _, _ in told} == {(False, False), (True, False), (True, True)}
    wrong = [e for e, due, lit in told if (e.due, e.lit) != (due, lit)]
    assert len(wrong) <= len(told) / 1000, "but for a few, where rounding decides"
    assert all((e.blocked_at is None) == (e.lit or not e.due) for e, _, _ in told)
    assert all(
        e.certificate == NO_CERTIFICATE and e.named == () and (e.blocker is None) == (e.blocked_at is None)
        for e, _, _ in told
    )


def test_what_blocks_is_the_first_thing_from_the_light(seen) -> None:
    renderer, _, explained = seen
    blocked = [e for found in explained.values() for e in found if e.blocked_at is not None]
    kinds = {_kind(renderer, e.blocker) for e in blocked}
    assert kinds == {"static", "moving", "quadric"}
    for e in blocked:
        start, way = np.array(e.light_position), np.subtract(e.point, e.light_position)
        t = np.linalg.norm(np.subtract(e.blocked_at, start)) / np.linalg.norm(way)
        nearest, which = _first_triangle(renderer, start, way)
        if _kind(renderer, e.blocker) == "quadric":
            assert t < nearest + 1e-4
        else:
            assert t == pytest.approx(nearest, abs=1e-4) and which == e.blocker


def test_points_lie_where_the_pixel_looks_just_above_the_surface(seen) -> None:
    _, frame, explained = seen
    right, up, forward = frame.camera.basis()
    half = np.tan(np.radians(frame.camera.angle) / 2.0)
    for (y, x), found in explained.items():
        for e in found:
            across = half * WIDTH / HEIGHT * (2.0 * (x + 0.5) / WIDTH - 1.0)
            way = forward + across * right + half * (1.0 - 2.0 * (y + 0.5) / HEIGHT) * up
            surface = frame.camera.position + way / np.linalg.norm(way) * frame.depth[y, x]
            assert 1e-6 < np.linalg.norm(surface - e.point) < 5e-4


def test_certificates_are_asked_about_lights_that_are_due(seen) -> None:
    renderer, frame, explained = seen
    asked = []

    def certificates(primitive: int, point: np.ndarray, light: int) -> tuple[str, tuple[int, ...]]:
        asked.append((primitive, tuple(point.tolist()), light))
        return "CANDIDATES", (1, 0, 1)

    renderer.explain = certificates
    try:
        at = next(at for at, found in explained.items() if any(e.blocked_at and e.blocker > 1 for e in found))
        found = explain(renderer, frame, at[1], at[0])
    finally:
        del renderer.explain
    assert asked == [(frame.primitive[at], e.point, e.light) for e in found if e.due]
    for e, before in zip(found, explained[at], strict=True):
        if e.due:
            assert (e.certificate, e.named, e.blocker) == ("CANDIDATES", (1, 0), before.blocker)
        else:
            assert e.certificate == NO_CERTIFICATE and e.named == ()


def test_outlines_lie_on_what_they_outline(seen) -> None:
    renderer, _, _ = seen
    scene, count = renderer.scene, len(renderer.world.placed.triangles)
    sphere, cone = (outline(renderer.world, count + i) for i in range(2))
    assert np.linalg.norm(np.concatenate(sphere), axis=1) == pytest.approx(0.5)
    ends = [np.array((1.0, -0.5, 0.4)), np.array((1.2, 0.3, 0.3))]
    for ring, end, radius in zip(cone[:2], ends, (0.35, 0.1), strict=True):
        assert np.linalg.norm(ring - end, axis=1) == pytest.approx(radius, rel=1e-5)
    assert [len(line) for line in cone[2:]] == [2] * 4
    (flyer,) = outline(renderer.world, scene.triangle_offsets[1])
    moved = (flyer[:3] - scene.objects[1].triangles.corners[0])[:, 0]
    assert np.ptp(moved) < 1e-6 and 0.1 < abs(moved[0]) < 1.0, "it has flown half of its way"
    renderer.world.placed.to_object[1] = 0.0
    assert outline(renderer.world, scene.triangle_offsets[1]) == ()
    renderer.world.place(6.0)


def _kind(renderer: Renderer, primitive: int) -> str:
    if primitive >= len(renderer.world.placed.triangles):
        return "quadric"
    return "moving" if renderer.world.object_of[primitive] else "static"


def _first_triangle(renderer: Renderer, start: np.ndarray, way: np.ndarray) -> tuple[float, int]:
    """Where a segment first meets a triangle, before its end, and which; (inf, -1) for none."""
    best = np.inf, -1
    for primitive in range(len(renderer.world.placed.triangles)):
        a, b, c, _ = outline(renderer.world, primitive)[0]
        t, u, v = np.linalg.solve(np.stack([-way, b - a, c - a], axis=1), start - a)
        if 1e-5 < t < 1.0 and min(u, v, 1.0 - u - v) > -1e-6 and t < best[0]:
            best = float(t), primitive
    return best
