"""The BART scenes: their counts, and a few numbers that were looked at by eye."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tracer.scene.deformation import deformed
from tracer.scene.load import load_scene, scene_info

SCENES = {
    "kitchen/kitchen.aff": (110_561, 103_343, 7_218, 0, 6, 233, [0, 20], 800),
    "robot/Robot.aff": (71_708, 9_218, 62_490, 0, 1, 1_849, [0, 50], 800),
    "museum/museum5.aff": (11_308, 10_284, 1_024, 8, 2, 58, [-1, 5], 300),
}


@pytest.fixture(scope="module")
def scenes(bart):
    return {name: load_scene(bart / name) for name in SCENES}


@pytest.mark.parametrize("name", SCENES)
def test_counts(scenes, name):
    info = scene_info(scenes[name])
    keys = ("triangles", "static_triangles", "dynamic_triangles", "cones", "lights", "materials", "time", "frames")
    assert tuple(info[key] for key in keys) == SCENES[name]
    assert info["spheres"] == 0
    json.dumps(info)


@pytest.mark.parametrize("name", SCENES)
def test_everything_is_in_order(scenes, name):
    scene = scenes[name]
    assert scene.objects[0].chain == ()
    assert all(o.chain or o.deformation for o in scene.objects[1:])
    for o in scene.objects:
        t = o.triangles
        assert t.corners.dtype == t.normals.dtype == t.uvs.dtype == np.float32
        assert np.isfinite(t.corners).all()
        assert np.abs(np.linalg.norm(t.normals, axis=2) - 1).max(initial=0) < 1e-5
        assert t.material.min(initial=0) >= 0
        assert t.material.max(initial=0) < len(scene.materials)
        assert t.texture.min(initial=-1) >= -1
        assert t.texture.max(initial=-1) < len(scene.textures)
    assert all(material.ior > 0 for material in scene.materials)
    assert all("not to be found" not in warning for warning in scene.warnings)


def test_kitchen(scenes):
    scene = scenes["kitchen/kitchen.aff"]
    names = ["static", "toycar", *(f"toycar/front_wheel_{s}/rotating_wheel_{s}" for s in ("left", "right"))]
    assert [o.name for o in scene.objects] == [*names, "toycar/rotating_wheel_left", "toycar/rotating_wheel_right"]
    assert scene.camera_at(0).position == pytest.approx((3.75, 2.3, 3.6))
    assert scene.camera_at(12).position == pytest.approx((1.76, 0.21, 1.3))
    assert scene.camera_at(10**9).position == pytest.approx((3.27488, 0.334545, 2.98028))
    # The car stands on the floor, and is half as long just before it hits the door.
    car = scene.objects[1]
    matrix = scene.animation.matrix(car.chain, 3)
    corners = car.triangles.corners.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    assert 0 <= corners[:, 1].min() < 0.05
    assert np.linalg.det(scene.animation.matrix(car.chain, 20)[:3, :3]) == pytest.approx(0.5, abs=0.01)
    # The garden: the sky of the picture is above its lawn.
    garden = next(i for i, t in enumerate(scene.textures) if t.name == "garden.ppm")
    which = scene.objects[0].triangles.texture == garden
    heights, v = scene.objects[0].triangles.corners[which][..., 1], scene.objects[0].triangles.uvs[which][..., 1]
    assert v[heights > 2].min() == 1
    assert v[heights < 0].max() == 0
    assert scene.textures[garden].pixels[0].mean() > scene.textures[garden].pixels[-1].mean()


def test_robot(scenes):
    scene = scenes["robot/Robot.aff"]
    assert len(scene.objects) == 157
    assert scene.camera_at(30).position == pytest.approx((0, 6, 74))
    assert scene.camera_at(40).direction == pytest.approx((0, 0, -1))
    for o in scene.objects[1:]:  # nothing but turns, shifts and the robots' size of 2
        matrix = scene.animation.matrix(o.chain, 17.3)[:3, :3]
        assert matrix @ matrix.T == pytest.approx(np.eye(3) * np.linalg.det(matrix) ** (2 / 3), abs=1e-9)


def test_museum(scenes):
    scene = scenes["museum/museum5.aff"]
    static, art = scene.objects
    assert art.deformation is not None
    assert art.deformation.times.shape == (1024, 5)
    first, _ = deformed(art.deformation, -1)
    between, normals = deformed(art.deformation, 2.5)
    assert np.array_equal(first, art.triangles.corners)
    middle = (art.deformation.corners[:, 2] + art.deformation.corners[:, 3]) / 2
    assert between == pytest.approx(middle, abs=1e-6)
    assert np.linalg.norm(normals, axis=2) == pytest.approx(np.ones((1024, 3)), abs=1e-6)
    assert scene.camera_at(-1).direction == pytest.approx((0, 0, 1))
    # The pillar keeps the material that was current before it was included.
    assert len({scene.materials[m].name for m in static.triangles.material.tolist()}) > 40
