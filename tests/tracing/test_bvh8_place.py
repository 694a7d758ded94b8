"""Placing 8-wide trees: what moves, deforms or hides is where the animation puts it, and in the tree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.scenes import loaded
from tests.sweeps import cases
from tests.tracing.trees8 import NO_BOXES, assert_sound, corners_of, cost, same
from tests.tracing.worlds import affine, moved, quadrics, random_corners, scene
from tracer.geometry.bvh8.build import build_tree
from tracer.scene.animation import Animation, Keys, TrackSet
from tracer.scene.model import CONE, SPHERE, Quadrics, SceneObject, empty_triangles

SCENES = ("kitchen/kitchen.aff", "robot/Robot.aff", "museum/museum5.aff")


def in_world(world: tracer.World, time: float, static: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Where the animation puts what is dynamic, or else what is static; NaN for the others.

    Rows (t, 9) of triangles, and boxes (q, 6) of quadrics, float64, in the scene's numbering.
    """
    content, offsets = world.scene, world.scene.triangle_offsets
    rows, boxes = np.full((offsets[-1], 9), np.nan), []
    for i, item in enumerate(content.objects):
        matrix = content.animation.matrix(item.chain, time)
        there = content.animation.visible(item.chain, time) and np.linalg.det(matrix[:3, :3]) and (i == 0) == static
        if there:
            corners = corners_of(world.placed.triangles[offsets[i] : offsets[i + 1]]) @ matrix[:3, :3].T + matrix[:3, 3]
            edges = corners[:, 1:] - corners[:, :1]
            rows[offsets[i] : offsets[i + 1]] = np.concatenate([corners[:, :1], edges], axis=1).reshape(-1, 9)
        for kind, to_object, radii in zip(item.quadrics.kind, item.quadrics.to_object, item.quadrics.radii):
            if there:
                linear = matrix[:3, :3] @ to_object[:, :3]
                points = extremes(kind, radii, linear) @ linear.T + matrix[:3, :3] @ to_object[:, 3] + matrix[:3, 3]
            boxes.append(np.concatenate([points.min(0), points.max(0)]) if there else np.full(6, np.nan))
    return rows, np.array(boxes).reshape(-1, 6)


def extremes(kind: int, radii: np.ndarray, linear: np.ndarray) -> np.ndarray:
    """Points (n, 3) of a canonical sphere or cone, those among them that a linear map takes furthest along an axis."""
    if kind == CONE:  # on its rims
        angles = np.linspace(0, 2 * np.pi, 2001)
        ring = np.stack([np.cos(angles), np.sin(angles), np.zeros(2001)], axis=1)
        return np.concatenate([ring * radii[0], ring * radii[1] + [0, 0, 1]])
    along = linear / np.linalg.norm(linear, axis=1, keepdims=True)
    return np.concatenate([along, -along])


def assert_placed(world: tracer.World, time: float, rounding: float = 2e-7) -> None:
    """What is dynamic is in the dynamic tree, where it belongs; `rounding` is relative to the largest coordinate."""
    rows, boxes = in_world(world, time)
    extent = max(np.nanmax(np.abs(a), initial=0) for a in (rows, boxes))
    assert_sound(world.structure.dynamic, rows, boxes, rounding * extent)
    assert world.placed.has_dynamic == (not np.isnan(rows).all() or not np.isnan(boxes).all())


@pytest.mark.parametrize("name", cases(SCENES[2:], SCENES))
def test_what_moves_and_deforms_is_where_the_animation_puts_it(bart, name):
    """And the tree is that of a world that never was at any other time."""
    content = loaded(bart / name)
    world = tracer.World(content, accelerator="bvh8")
    assert_sound(world.structure.static, *in_world(world, 0.0, static=True), rounding=1e-6)
    for time in np.linspace(*content.time_range, cases(2, 4)):
        world.place(time)
        assert_placed(world, time)
        assert same(world.structure.dynamic, tracer.World(content, time, "bvh8").structure.dynamic)

    parts = [in_world(world, time, static) for static in (True, False)]
    points = np.concatenate([corners_of(rows).reshape(-1, 3) for rows, _ in parts])
    points = np.concatenate([points, *(boxes.reshape(-1, 3) for _, boxes in parts)])
    exact = np.concatenate([np.nanmin(points, 0), np.nanmax(points, 0)])
    assert np.allclose(world.bounds(), exact, rtol=0, atol=1e-5 * np.abs(exact).max())


def test_a_tree_of_what_deforms_stays_good(bart):
    """Between the times for which shapes are made, too: not much worse than one built for the moment."""
    content = loaded(bart / "museum/museum5.aff")
    world = tracer.World(content, accelerator="bvh8")
    for time in np.linspace(0.02, 3.98, cases(15, 40)):
        world.place(time)
        fresh = build_tree(world.placed.triangles[content.triangle_offsets[1] :].copy(), NO_BOXES)
        assert cost(world.structure.dynamic) - 1 < 1.25 * cost(fresh)  # but for the node above all objects


def spinning(rng: np.random.Generator, n: int) -> tuple[np.ndarray, ...]:
    """Matrices (n, 4, 4) that turn, scale and move."""
    matrices = np.tile(np.eye(4), (n, 1, 1))
    matrices[:, :3, :3] = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0] * rng.uniform(0.2, 3, size=(n, 1, 1))
    matrices[:, :3, 3] = rng.normal(size=(n, 3))
    return tuple(matrices)


def round_things(rng: np.random.Generator, n: int) -> Quadrics:
    maps = [
        affine(rng.uniform(0.01, 0.5), rng.normal(size=3)) @ np.vstack([m[:3], [0, 0, 0, 1]]) for m in spinning(rng, n)
    ]
    return quadrics([(CONE if i % 2 else SPHERE, m, tuple(rng.uniform(-1, 1, 2))) for i, m in enumerate(maps)])


@pytest.mark.parametrize("objects", [0, 1, 8, 9, 60])
def test_objects_of_triangles_and_quadrics_are_placed(objects):
    rng = np.random.default_rng(objects)
    parts = []
    for i, matrix in enumerate(spinning(rng, objects)):
        item = moved(f"part {i}", random_corners(rng, int(rng.integers(0, 40)), 0.2), matrix)
        parts.append(replace(item, quadrics=round_things(rng, int(rng.integers(0, 5)))))
    content = scene(random_corners(rng, 30, 0.1), round_things(rng, 5), tuple(parts))
    world = tracer.World(content, accelerator="bvh8")
    assert_sound(world.structure.static, *in_world(world, 0.0, static=True), rounding=1e-5)
    assert_placed(world, 0.0, rounding=1e-5)


def test_maps_of_quadrics_lead_from_the_world_to_canonical_space():
    rng = np.random.default_rng(3)
    (matrix,) = spinning(rng, 1)
    ball = SceneObject("ball", empty_triangles(), round_things(rng, 6), (matrix,))
    content = scene(random_corners(rng, 30, 0.1), round_things(rng, 4), (ball,))
    world = tracer.World(content, accelerator="bvh8")
    maps = world.structure.world_quadrics[:, :12].reshape(-1, 3, 4).astype(np.float64)
    for i, back in enumerate(maps):
        item, k = content.objects[i // 4 > 0], i if i < 4 else i - 4
        there = np.vstack([item.quadrics.to_object[k], [0, 0, 0, 1]])
        there = (matrix if i >= 4 else np.eye(4)) @ there
        assert np.allclose(back @ there, np.eye(4)[:3], atol=1e-4)
    assert np.array_equal(world.structure.world_quadrics[:, 12:], world.placed.quadrics[:, 12:])


def test_what_is_hidden_or_scaled_to_nothing_is_not_in_the_tree():
    rng = np.random.default_rng(4)
    blinking = TrackSet(visibility=np.array([[1.0, 0.0], [2.0, 1.0]]))
    times, zeros = np.array([0.0, 1.0, 2.0, 3.0]), np.zeros((4, 3))
    shrinking = TrackSet(scale=Keys(times, np.array([[1.0] * 3, [1.0] * 3, [0.0] * 3, [0.0] * 3]), zeros))
    parts = [
        replace(moved(name, random_corners(rng, 20, 0.2), np.eye(4)), chain=(name,)) for name in ("blink", "shrink")
    ]
    animation = Animation({"blink": blinking, "shrink": shrinking})
    world = tracer.World(scene(dynamic=tuple(parts), animation=animation), accelerator="bvh8")
    seen = []
    for time in (0.5, 1.5, 2.5):
        world.place(time)
        assert_placed(world, time)
        seen.append((~np.isnan(in_world(world, time)[0][:, 0])).reshape(2, 20).all(1).tolist())
    assert seen == [[True, True], [False, True], [True, False]]


def test_a_world_without_anything_dynamic_says_so():
    world = tracer.World(scene(random_corners(np.random.default_rng(5), 30, 0.1)), accelerator="bvh8")
    assert not world.placed.has_dynamic
    assert_sound(world.structure.dynamic, np.empty((0, 9)))
    empty = tracer.World(scene(), accelerator="bvh8")
    assert (empty.bounds()[:3] > empty.bounds()[3:]).all()
