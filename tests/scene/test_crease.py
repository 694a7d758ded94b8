"""Normals by crease angle, where a file has none."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from tracer.scene.crease import creased_normals
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import IN_STUDIO, MeshOptions


def unit(normals):
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def test_a_cube_stays_sharp_whether_its_triangles_share_vertices_or_not():
    cube = trimesh.creation.box()
    for vertices, faces in ((cube.vertices, cube.faces), (cube.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3))):
        normals = unit(creased_normals(vertices, faces, 40.0))
        assert normals == pytest.approx(np.repeat(cube.face_normals[:, None], 3, axis=1), abs=1e-6)
        assert len(np.unique(normals.round(6).reshape(-1, 3), axis=0)) == 6
    round_ones = unit(creased_normals(cube.vertices, cube.faces, 100.0))
    assert len(np.unique(round_ones.round(6).reshape(-1, 3), axis=0)) == 8
    # Weighted by angles: the diagonals of the sides do not matter.
    assert np.abs(round_ones) == pytest.approx(np.full((12, 3, 3), 1 / np.sqrt(3)))


def test_a_sphere_is_smooth_with_one_normal_a_vertex():
    ball = trimesh.creation.icosphere(subdivisions=3)
    soup = ball.triangles.reshape(-1, 3)
    normals = unit(creased_normals(soup, np.arange(len(soup)).reshape(-1, 3), 40.0)).reshape(-1, 3)
    assert np.einsum("ij,ij->i", normals, soup).min() > np.cos(np.radians(0.5))
    assert len(np.unique(normals.round(6), axis=0)) == len(ball.vertices)
    faceted = unit(creased_normals(ball.vertices, ball.faces, 0.0))
    assert faceted == pytest.approx(np.repeat(ball.face_normals[:, None], 3, axis=1), abs=1e-6)


def test_a_cylinder_has_round_walls_and_sharp_rims():
    rod = trimesh.creation.cylinder(1.0, 2.0, sections=24)
    normals = unit(creased_normals(rod.vertices, rod.faces, 40.0))
    lid = np.abs(rod.face_normals[:, 2]) > 0.5
    assert np.abs(normals[lid][..., 2]) == pytest.approx(1.0)
    walls, corners = normals[~lid].reshape(-1, 3), rod.triangles[~lid].reshape(-1, 3)
    assert np.einsum("ij,ij->i", walls[:, :2], corners[:, :2]).min() > np.cos(np.radians(4.0))


def test_hubs_of_many_triangles_and_triangles_without_area_are_no_trouble():
    turns = np.linspace(0, 2 * np.pi, 5000, endpoint=False)
    rim = np.stack([np.cos(turns), np.sin(turns), np.zeros(5000)], axis=1)
    faces = np.stack([np.zeros(5000, int), 1 + np.arange(5000), 1 + (np.arange(5000) + 1) % 5000], axis=1)
    cone = unit(creased_normals(np.concatenate([[(0, 0, 1.0)], rim]), faces, 40.0))
    assert np.isfinite(cone).all()
    outward = np.cross(*(rim[faces[:, i] - 1] - (0, 0, 1) for i in (1, 2)))
    assert np.einsum("nij,nj->ni", cone, unit(outward)).min() > 0.99  # the hub's too: each of its own side
    flat = creased_normals(np.array([(0.0, 0, 0), (1, 0, 0), (2, 0, 0)]), np.array([[0, 1, 2], [0, 0, 0]]), 40.0)
    assert (flat == 0).all()
    assert creased_normals(np.empty((0, 3)), np.empty((0, 3), int), 40.0).shape == (0, 3, 3)


@pytest.mark.parametrize("options, smooth", [
    (MeshOptions(), False), (IN_STUDIO, True), (MeshOptions(crease=40.0), True), (MeshOptions(True, crease=0.0), False),
])  # fmt: skip
def test_files_are_smoothed_as_the_options_say(tmp_path, options, smooth):
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.export(tmp_path / "ball.stl")
    triangles = load_scene(tmp_path / "ball.stl", meshes=options).objects[0].triangles
    along = np.einsum("nij,nij->ni", triangles.normals[:320], triangles.corners[:320])
    assert bool(along.min() > 0.999) is smooth


def test_normals_of_the_file_and_the_word_of_gltf_come_first(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.export(tmp_path / "ball.glb", include_normals=False)
    normals = load_scene(tmp_path / "ball.glb", meshes=IN_STUDIO).objects[0].triangles.normals
    assert (normals[:, 0] == normals[:, 1]).all()
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 .6 .8\nf 1//1 2//1 3//1\n")
    given = load_scene(tmp_path / "a.obj", meshes=IN_STUDIO).objects[0].triangles.normals
    assert given[0] == pytest.approx(np.broadcast_to((0, 0.6, 0.8), (3, 3)))


def test_coordinates_beyond_float32_are_named_in_silence(tmp_path, recwarn):
    """The triangle is dropped, and numpy says nothing to the terminal on the way."""
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 4 3\n")
    scene = load_scene(tmp_path / "a.obj", meshes=IN_STUDIO)
    assert "a triangle with a corner beyond 1e+09 is dropped" in scene.warnings[0] and not recwarn.list
