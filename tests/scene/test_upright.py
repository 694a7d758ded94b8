"""The guess at which way is up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from tracer.scene.up_axis import customary, footing, guess


def block(size, at):
    box = trimesh.creation.box(size)
    box.apply_translation(at)
    return box


def chair():
    legs = [block((0.08, 0.08, 0.9), (x, y, 0.45)) for x in (-0.4, 0.4) for y in (-0.4, 0.4)]
    return trimesh.util.concatenate([*legs, block((1, 1, 0.1), (0, 0, 0.95)), block((1, 0.08, 1), (0, 0.44, 1.5))])


def car():
    wheels = [trimesh.creation.cylinder(0.35, 0.2, 24) for _ in range(4)]
    for wheel, (x, y) in zip(wheels, [(-0.8, -1.3), (0.8, -1.3), (-0.8, 1.3), (0.8, 1.3)], strict=True):
        wheel.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0)))
        wheel.apply_translation((x, y, 0.35))
    return trimesh.util.concatenate([*wheels, block((1.7, 4, 0.5), (0, 0, 0.6)), block((1.5, 2, 0.5), (0, 0, 1.1))])


STANDING = {  # with z up
    "chair": chair(),
    "car": car(),
    "torus": trimesh.creation.torus(1.0, 0.3),
    "cylinder": trimesh.creation.cylinder(0.5, 2.0, sections=16),
    "tower": block((1, 1, 4), (3, 2, 1)),
    "plate": block((5, 4, 0.05), (0, 0, 0)),
    "cone": trimesh.creation.cone(1.0, 2.0),
}


@pytest.mark.parametrize("name", STANDING)
@pytest.mark.parametrize("kind", [".obj", ".ply", ".stl"])
def test_what_stands_is_left_standing_whatever_the_file_is(name, kind):
    corners = np.asarray(STANDING[name].triangles, np.float32)
    y_up = corners[..., [0, 2, 1]] * (1, 1, -1)
    assert guess(Path("a" + kind), b"", y_up.astype(np.float32)) == "y"
    assert guess(Path("a" + kind), b"", corners) == "z"


def test_what_lies_flat_is_not_set_on_its_edge():
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.15)
    ball.apply_translation((1.65, 0, 0))
    limbs = [block((0.85, 0.2, 0.15), (0.425, 0, at)) for at in (-0.11, 0.11)]
    arms = [block((0.7, 0.15, 0.12), (1.08, 0, at)) for at in (-0.28, 0.28)]
    figure = trimesh.util.concatenate([ball, block((0.6, 0.22, 0.4), (1.15, 0, 0)), *limbs, *arms])
    corners = np.asarray(figure.triangles, np.float32)
    # Only its head touches the ground, from which it would settle a little; on an arm, it would stand as it is.
    assert footing(corners, "y")[0] < 0 < footing(corners, "z")[0]
    assert guess(Path("a.obj"), b"", corners) == "y"


@pytest.mark.parametrize("name", ["ball", "cube", "capsule"])
def test_what_could_stand_either_way_is_taken_as_is_usual(name):
    mesh = {
        "ball": trimesh.creation.icosphere(),
        "cube": trimesh.creation.box(),
        "capsule": trimesh.creation.capsule(height=2.0, radius=0.5),
    }[name]
    corners = np.asarray(mesh.triangles, np.float32)
    assert guess(Path("a.obj"), b"", corners) == "y"
    assert guess(Path("a.stl"), b"", corners) == "z"


def test_customs_of_the_formats():
    assert customary(Path("a.STL"), b"") == "z"
    assert customary(Path("a.ply"), b"ply\nformat ascii 1.0\ncomment Created in Blender version 4.1\n") == "z"
    assert customary(Path("a.ply"), b"ply\ncomment zipper output") == "y"
    lying = np.asarray(STANDING["cylinder"].triangles, np.float32)
    assert guess(Path("a.glb"), b"", lying) == "y"  # which glTF says


def test_a_box_tips_over_its_nearest_edge():
    tipping, _ = footing(np.asarray(block((2, 3, 8), (5, 5, 5)).triangles, np.float32), "z")
    assert tipping == pytest.approx(np.degrees(np.arctan(1 / 4)))
    leaning = trimesh.creation.box((1, 1, 8))
    leaning.vertices[:, 0] += 0.5 * leaning.vertices[:, 2]
    assert footing(np.asarray(leaning.triangles, np.float32), "z")[0] < 0
    point = footing(np.zeros((1, 3, 3), np.float32), "y")
    assert np.isfinite(point).all() and point[1] == 0
