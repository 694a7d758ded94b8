"""Every statement of AFF, by what it puts into the scene."""

from __future__ import annotations

import numpy as np
import pytest

from tracer.scene.model import CONE, SPHERE

TRIANGLE = "p 3 0 0 0 1 0 0 0 1 0 "
VIEW = "v from 1 2 3 at 1 2 0 up 0 1 0 angle 40 hither 0.00001 resolution 800 600 "
SETTING = VIEW + "l 0 9 0 fm 0 0 0 1 1 1 0 0 0 1 0 0 "


def moving(name: str, x: float = 5) -> str:
    keys = " ".join(f"{t} {x} 0 0 0 0 0" for t in range(4))
    return f"k {name} {{ transl 4 {keys} }} "


def test_viewpoint_background_ambient_animation(read):
    scene = read(VIEW + "b .1 .2 .3 am 2 2 2.5 a -1 5 300 l 0 9 0 " + TRIANGLE)
    assert scene.camera.position == (1, 2, 3)
    assert scene.camera.direction == (0, 0, -3)
    assert scene.camera.up == (0, 1, 0)
    assert scene.camera.angle == 40
    assert scene.background == (0.1, 0.2, 0.3)
    assert scene.ambient == (2, 2, 2.5)
    assert scene.time_range == (-1, 5)
    assert scene.frames == 300
    assert scene.frame_time(299) == 5
    assert scene.warnings == ()


def test_defaults(read):
    scene = read(VIEW + "l 0 9 0 " + TRIANGLE)
    assert scene.background == (0, 0, 0)
    assert scene.ambient == (1, 1, 1)
    assert scene.frames == 1
    assert scene.frame_time(0) == scene.time_range[0]


def test_lights_look_ahead_for_their_colour(read):
    scene = read("l 1 2 3 l 1 2 3 .5 .6 .7 la lamp 4 5 6 la lamp 4 5 6 .1 .2 .3 " + VIEW + TRIANGLE + moving("lamp"))
    assert [light.position for light in scene.lights] == [(1, 2, 3), (1, 2, 3), (4, 5, 6), (4, 5, 6)]
    assert [light.color for light in scene.lights] == [(1, 1, 1), (0.5, 0.6, 0.7), (1, 1, 1), (0.1, 0.2, 0.3)]
    assert [light.track for light in scene.lights] == [None, None, "lamp", "lamp"]


def test_a_light_whose_name_has_no_track_stands_still(read):
    assert read("la lamp 4 5 6 " + TRIANGLE).lights[0].track is None


def test_lights_stand_under_static_transforms(read):
    scene = read("xs 2 2 2 0 1 0 0 1 1 1 { l 1 0 0 } " + TRIANGLE)
    assert scene.lights[0].position == (3, 1, 1)


def test_a_light_under_a_moving_transform_is_warned_of(read):
    scene = read(VIEW + "x car {\n l 1 0 0 } " + TRIANGLE + moving("car"))
    assert len(scene.warnings) == 1
    assert scene.warnings[0].endswith("scene.aff:2: a light does not move with the transform around it; use 'la'")


def test_forty_lights(read):
    assert len(read("l 1 2 3 " * 40 + TRIANGLE).lights) == 40


def test_extended_material(read):
    scene = read("\nfm .1 .2 .3  .4 .5 .6  .7 .8 .9  25 .5 1.5 " + TRIANGLE)
    (material,) = scene.materials
    assert material.name == "scene:2"
    assert (material.ambient, material.diffuse, material.specular) == (
        (0.1, 0.2, 0.3),
        (0.4, 0.5, 0.6),
        (0.7, 0.8, 0.9),
    )
    assert (material.exponent, material.transmission, material.ior) == (100, 0.5, 1.5)


def test_transparent_without_index_of_refraction(read):
    assert read("fm 0 0 0 0 0 0 0 0 0 1 .5 0 " + TRIANGLE).materials[0].ior == 1


def test_nff_material(read):
    (material,) = read("f 1 .5 .2  .8 .3 20 .4 1.3 " + TRIANGLE).materials
    assert material.diffuse == pytest.approx((0.8, 0.4, 0.16))
    assert material.ambient == pytest.approx((0.08, 0.04, 0.016))
    assert material.specular == (0.3, 0.3, 0.3)
    assert (material.exponent, material.transmission, material.ior) == (20, 0.4, 1.3)


def test_every_material_statement_counts_when_run(read):
    scene = read("i 0 m.aff i 0 m.aff " + TRIANGLE, m="fm 0 0 0 0 0 0 0 0 0 1 0 0 ")
    assert len(scene.materials) == 2


def test_geometry_without_material_gets_a_default(read):
    scene = read(TRIANGLE + "fm 0 0 0 0 0 0 0 0 0 1 0 0 " + TRIANGLE)
    assert scene.material_of(0).name == "default"
    assert scene.material_of(1).name == "scene:1"


def test_the_material_is_global(read):
    red, blue = "fm 1 0 0 1 0 0 0 0 0 1 0 0 ", "fm 0 0 1 0 0 1 0 0 0 1 0 0 "
    scene = read(
        red + TRIANGLE + "xs 1 1 1 0 1 0 0 0 0 0 { i 0 other.aff " + TRIANGLE + "} " + TRIANGLE, other=blue + TRIANGLE
    )
    assert [scene.material_of(i).diffuse for i in range(4)] == [(1, 0, 0), (0, 0, 1), (0, 0, 1), (0, 0, 1)]


def test_polygons_are_fans(read):
    scene = read("p 5  0 0 0  2 0 0  3 1 0  2 2 0  0 2 0 " + "pp 3 0 0 0 1 0 0  1 0 0 0 1 0  0 1 0 0 0 3 ")
    corners, normals = scene.objects[0].triangles.corners, scene.objects[0].triangles.normals
    assert len(corners) == 4
    assert np.array_equal(corners[1], [(0, 0, 0), (3, 1, 0), (2, 2, 0)])
    assert np.array_equal(normals[0], [(0, 0, 1)] * 3)
    assert np.array_equal(normals[3], [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
    assert corners.dtype == normals.dtype == np.float32


def test_mesh_sections(read):
    vertices, normals = "vertices 3 0 0 0 1 0 0 0 1 0 ", "normals 2 0 0 2 0 1 0 "
    coordinates = "texturecoords 2 no.ppm 0 0 1 .25 "
    scene = read(
        SETTING
        + f"m {vertices} triangles 1 0 1 2 "
        + f"m {vertices} {normals} triangles 1 0 1 2 0 1 0 "
        + f"m {vertices} {coordinates} triangles 1 0 1 2 1 0 0 "
        + f"m {vertices} {normals} {coordinates} triangles 1 2 0 1 1 1 1 0 1 1 "
        + "m vertices 0 triangles 0 "
    )
    triangles = scene.objects[0].triangles
    assert np.array_equal(triangles.normals[0], [(0, 0, 1)] * 3)
    assert np.array_equal(triangles.normals[1], [(0, 0, 1), (0, 1, 0), (0, 0, 1)])
    assert np.array_equal(triangles.corners[3], [(0, 1, 0), (0, 0, 0), (1, 0, 0)])
    assert np.array_equal(triangles.uvs[0], np.zeros((3, 2)))
    # AFF counts v from the top of the image.
    assert np.array_equal(triangles.uvs[2], [(1, 0.75), (0, 1), (0, 1)])
    assert np.array_equal(triangles.uvs[3], [(0, 1), (1, 0.75), (1, 0.75)])
    assert len(scene.warnings) == 1


def test_textured_triangles(read, tmp_path):
    (tmp_path / "two.ppm").write_bytes(b"P6 1 2 255\n" + bytes([255, 0, 0, 0, 0, 255]))
    scene = read(
        SETTING
        + "tt two.ppm  0 0 0 0 1  1 0 0 1 1  0 1 0 0 0 "
        + "ttp two.ppm  0 0 0 0 0 1 0 1  1 0 0 0 0 1 1 1  0 1 0 0 3 4 0 0 "
        + TRIANGLE
    )
    triangles = scene.objects[0].triangles
    assert triangles.texture.tolist() == [0, 0, -1]
    assert len(scene.textures) == 1
    assert scene.textures[0].pixels.tolist() == [[[255, 0, 0]], [[0, 0, 255]]]
    assert np.array_equal(triangles.uvs[0], [(0, 0), (1, 0), (0, 1)])
    assert triangles.normals[1, 2] == pytest.approx((0, 0.6, 0.8))


def test_spheres_and_cones(read):
    scene = read("s 1 2 3 4  s 0 0 0 -2  c 0 0 0 2  0 3 0 1  c 0 0 0 -1 0 0 1 -1 ")
    quadrics = scene.objects[0].quadrics
    assert quadrics.kind.tolist() == [SPHERE, SPHERE, CONE, CONE]
    assert quadrics.inside.tolist() == [False, True, False, True]
    assert np.array_equal(quadrics.to_object[0], [(4, 0, 0, 1), (0, 4, 0, 2), (0, 0, 4, 3)])
    assert quadrics.radii.tolist()[2:] == [[2, 1], [1, 1]]
    for i, base, apex in ((2, (0, 0, 0), (0, 3, 0)), (3, (0, 0, 0), (0, 0, 1))):
        m = quadrics.to_object[i]
        assert m[:, 3] == pytest.approx(base)
        assert m[:, 2] + m[:, 3] == pytest.approx(apex)
        assert m[:, :2].T @ m[:, :2] == pytest.approx(np.eye(2))
        assert m[:, :2].T @ m[:, 2] == pytest.approx((0, 0))
        assert np.linalg.det(m[:, :3]) > 0
    assert scene.primitive_count == 4


def test_quadrics_are_transformed(read):
    scene = read("xs 1 2 3 0 0 1 90 5 0 0 { s 1 0 0 2 }")
    assert scene.objects[0].quadrics.to_object[0] == pytest.approx(
        np.array([(0, -4, 0, 5), (2, 0, 0, 1), (0, 0, 6, 0)])
    )


def test_includes_and_detail(read):
    other = {"low": TRIANGLE, "high": TRIANGLE * 10}
    assert read("i 0 low.aff i 1 high.aff", **other).triangle_count == 1
    assert read("d 1 i 0 low.aff i 1 high.aff", **other).triangle_count == 11


def test_detail_can_be_overridden(write):
    from tracer.scene.aff import load_aff

    path = write("d 0 i 1 high.aff i 2 high.aff", high=TRIANGLE)
    assert load_aff(path, detail=1).triangle_count == 1
    assert load_aff(path, detail=2).triangle_count == 2


def test_includes_are_relative_to_the_including_file(write, tmp_path):
    from tracer.scene.aff import load_aff

    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "a.aff").write_text("i 0 b.aff")
    (tmp_path / "parts" / "b.aff").write_text(TRIANGLE)
    assert load_aff(write("i 0 parts/a.aff")).triangle_count == 1


def test_writing_style(read):
    """Comments of any bytes, touching braces, several statements on a line, any line ends."""
    text = (
        b"# caf\xe9 %\r\n%\xff\xfe\rxs 1 1 1 0 1 0 0 0 0 1{p 3 0 0 0 1 0 0#}\n0 1 0}x nobody{"
        + TRIANGLE.encode()
        + b"}"
    )
    scene = read(text)
    assert scene.triangle_count == 2
    assert scene.objects[0].triangles.corners[:, 0, 2].tolist() == [1, 0]


def test_animated_triangles(read):
    keys = " ".join(f"{t}  {t} 0 0 0 0 1  {t + 1} 0 0 0 0 1  {t} 1 0 0 0 2 " for t in (0, 2, 1))
    scene = read(SETTING + f"tpa 3 {keys} tpa 3 {keys} tpa 1 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 " + TRIANGLE)
    assert [len(o.triangles) for o in scene.objects] == [1, 2, 1]
    three = scene.objects[1]
    assert three.chain == ()
    assert three.deformation is not None
    assert three.deformation.times.tolist() == [[0, 1, 2]] * 2
    assert three.deformation.corners[0, :, 0, 0].tolist() == [0, 1, 2]
    assert np.array_equal(three.triangles.corners, three.deformation.corners[:, 0])
    assert np.linalg.norm(three.triangles.normals, axis=2) == pytest.approx(np.ones((2, 3)))
