"""OBJ, PLY, STL, glTF and GLB: geometry, surfaces, camera and lights."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
import trimesh
from PIL import Image

from tracer.scene.load import load_scene
from tracer.scene.model import SceneError

OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
UV = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"


def obj(tmp_path, text, mtl=""):
    (tmp_path / "a.mtl").write_text(mtl)
    (tmp_path / "a.obj").write_text("mtllib a.mtl\n" + text)
    return load_scene(tmp_path / "a.obj")


@pytest.mark.parametrize(
    "name, text", [("a.obj", "# M\xfcller\n" + OBJ + "f 1 2 3\n"), ("a.stl", "solid M\xfcller\n{}endsolid\n")]
)
def test_text_that_is_not_utf8_is_read_all_the_same(tmp_path, name, text):
    facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    (tmp_path / name).write_bytes(text.format(facet).encode("latin-1"))
    assert load_scene(tmp_path / name).triangle_count == 1


@pytest.mark.parametrize("extension", ["obj", "ply", "stl", "gltf", "glb"])
def test_every_kind(tmp_path, extension):
    box = trimesh.creation.box((1, 2, 3))
    path = tmp_path / f"box.{extension}"
    if extension == "gltf":
        for name, data in trimesh.exchange.gltf.export_gltf(trimesh.Scene(box)).items():
            (tmp_path / name).write_bytes(data)
        (tmp_path / "model.gltf").rename(path)
    else:
        box.export(path)
    scene = load_scene(path)
    assert scene.triangle_count == 12
    corners = scene.objects[0].triangles.corners
    assert corners.reshape(-1, 3).max(axis=0) == pytest.approx((0.5, 1, 1.5))
    a, b, c = np.moveaxis(corners, 1, 0)
    outward = np.cross(b - a, c - a)
    assert (np.sum(outward * corners.mean(axis=1), axis=1) > 0).all()
    assert scene.warnings == ()
    # The camera sees every corner, from the outside; both lights stand outside too.
    camera, box_corners = scene.camera, corners.reshape(-1, 3)
    seen = (box_corners - camera.position) @ camera.basis().T
    half = np.tan(np.radians(camera.angle) / 2)
    assert (np.abs(seen[:, :2]) < half * seen[:, 2:]).all()
    assert len(scene.lights) == 2
    assert all(np.linalg.norm(light.position) > 2 for light in scene.lights)


def test_edges_stay_sharp_where_the_file_has_no_normals(tmp_path):
    trimesh.creation.box().export(tmp_path / "box.stl")
    normals = load_scene(tmp_path / "box.stl").objects[0].triangles.normals
    assert np.sort(np.abs(normals), axis=2) == pytest.approx(np.broadcast_to((0, 0, 1), normals.shape))


def test_obj_with_normals_quads_and_groups(tmp_path):
    scene = obj(tmp_path, OBJ + "vn 0 0.6 0.8\nf 1//1 2//1 3//1 4//1\n")
    assert scene.triangle_count == 2
    assert scene.objects[0].triangles.normals[0, 0] == pytest.approx((0, 0.6, 0.8))


def test_ply_normals(tmp_path):
    (tmp_path / "a.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\n"
        + "".join(f"property float {p}\n" for p in ("x", "y", "z", "nx", "ny", "nz"))
        + "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        + "0 0 0 0 0.6 0.8\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"
    )
    assert load_scene(tmp_path / "a.ply").objects[0].triangles.normals[0, 0] == pytest.approx((0, 0.6, 0.8))


def test_ply_vertex_colours(tmp_path):
    mesh = trimesh.creation.box()
    mesh.visual.vertex_colors = [(255, 0, 0, 255)] * 8
    mesh.export(tmp_path / "a.ply")
    (material,) = load_scene(tmp_path / "a.ply").materials
    assert material.diffuse == (1, 0, 0)


def test_many_colours_share_materials(tmp_path):
    sphere = trimesh.creation.icosphere(subdivisions=4)
    sphere.visual.vertex_colors = np.random.default_rng(1).integers(0, 256, (len(sphere.vertices), 4), np.uint8)
    sphere.export(tmp_path / "a.ply")
    scene = load_scene(tmp_path / "a.ply")
    assert scene.triangle_count == len(sphere.faces)
    assert len(scene.materials) <= 4096


def test_obj_materials(tmp_path):
    mtl = (
        "newmtl red\nKd 1 0 0\nKs 1 1 1\nNs 50\nillum 2\n"
        "newmtl mirror\nKd 0 0 0\nKs .8 .8 .8\nillum 3\n"
        "newmtl glass\nKd 0 0 0\nd 0.25\nNi 1.5\n"
    )
    faces = "".join(f"usemtl {m}\nf 1 2 3\n" for m in ("red", "mirror", "glass"))
    materials = {m.name: m for m in obj(tmp_path, OBJ + faces, mtl).materials}
    assert materials["red"].diffuse == (1, 0, 0)
    assert materials["red"].exponent == 50
    assert max(materials["red"].specular) <= 0.1
    assert materials["mirror"].specular == pytest.approx((0.8, 0.8, 0.8), abs=0.01)
    assert materials["glass"].transmission == 0.75
    assert materials["glass"].ior == 1.5


def test_obj_texture_is_the_right_way_up(tmp_path):
    Image.fromarray(np.array([[[255, 0, 0]], [[0, 0, 255]]], np.uint8)).save(tmp_path / "a.png")
    scene = obj(tmp_path, OBJ + UV + "usemtl t\nf 1/1 2/2 3/3 4/4\n", "newmtl t\nmap_Kd a.png\n")
    triangles = scene.objects[0].triangles
    assert scene.textures[0].name == "a.png"
    assert scene.textures[0].pixels[0, 0].tolist() == [255, 0, 0]
    assert triangles.texture.tolist() == [0, 0]
    assert np.array_equal(triangles.uvs, triangles.corners[..., :2])  # v = 0 at the bottom


@pytest.mark.parametrize("named", ["", "usemtl nowhere\n"])
def test_texture_coordinates_without_a_material_leave_the_surface_as_without_them(tmp_path, named):
    """The reader puts a dark texture of its own there."""
    with_uvs = obj(tmp_path, OBJ + UV + named + "f 1/1 2/2 3/3 4/4\n")
    without = obj(tmp_path, OBJ + named + "f 1 2 3 4\n")
    assert with_uvs.textures == () and with_uvs.objects[0].triangles.texture.tolist() == [-1, -1]
    assert with_uvs.materials == without.materials and min(with_uvs.materials[0].diffuse) > 0.5


def test_a_missing_obj_texture_is_a_warning(tmp_path):
    scene = obj(tmp_path, OBJ + UV + "usemtl t\nf 1/1 2/2 3/3\n", "newmtl t\nmap_Kd no.png\n")
    assert scene.triangle_count == 1
    assert any("'no.png'" in warning for warning in scene.warnings)


def test_an_enormous_obj_texture_is_a_warning(tmp_path):
    (tmp_path / "a.ppm").write_bytes(b"P6\n17000 17000\n255\n")
    scene = obj(tmp_path, OBJ + UV + "usemtl t\nf 1/1 2/2 3/3\n", "newmtl t\nmap_Kd a.ppm\n")
    assert scene.objects[0].triangles.texture.tolist() == [-1]
    assert any("too large" in warning for warning in scene.warnings)


def test_gltf_materials_camera_and_instances(tmp_path):
    material = trimesh.visual.material.PBRMaterial(
        name="gold", baseColorFactor=(255, 200, 0, 255), metallicFactor=1.0, roughnessFactor=0.25
    )
    box = trimesh.creation.box()
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=material)
    model = trimesh.Scene({"box": box})
    mirrored = np.diag([-1.0, 1, 1, 1])
    mirrored[0, 3] = 5
    model.add_geometry(box, geom_name="box", transform=mirrored)
    model.camera = trimesh.scene.Camera(fov=(60, 40))
    model.camera_transform = trimesh.transformations.translation_matrix((1, 2, 10))
    model.export(tmp_path / "a.glb")
    scene = load_scene(tmp_path / "a.glb")
    assert scene.triangle_count == 24
    assert len(scene.materials) == 1
    assert scene.materials[0].specular[0] == pytest.approx(0.75)
    assert scene.materials[0].diffuse[0] == pytest.approx(0.25)
    assert scene.camera.position == pytest.approx((1, 2, 10))
    assert scene.camera.direction == pytest.approx((0, 0, -1))
    assert scene.camera.angle == pytest.approx(40)
    corners = scene.objects[0].triangles.corners
    for centre, which in (((0, 0, 0), corners[:, 0, 0] < 2), ((5, 0, 0), corners[:, 0, 0] > 2)):
        assert which.sum() == 12
        a, b, c = np.moveaxis(corners[which], 1, 0)
        assert (np.sum(np.cross(b - a, c - a) * ((a + b + c) / 3 - centre), axis=1) > 0).all()


def test_gltf_colours_are_made_for_display(tmp_path):
    box = trimesh.creation.box()
    grey = trimesh.visual.material.PBRMaterial(baseColorFactor=(55, 55, 55, 255))
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=grey)
    box.export(tmp_path / "a.glb")
    assert load_scene(tmp_path / "a.glb").materials[0].diffuse[0] == pytest.approx(0.5, abs=0.01)


BROKEN = {
    "a.obj": b"v 0 0 0\nf 1 2 3\n",
    "b.obj": b"v 0 0 zero\nf 1 1 1\n",
    "a.ply": b"ply\nformat ascii 1.0\nelement vertex 3\n",
    "b.ply": b"nothing",
    "a.stl": b"\0" * 80 + struct.pack("<I", 1000),
    "a.gltf": json.dumps(
        {"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]}
    ).encode(),
    "b.gltf": b"{",
    "a.glb": b"glTF" + b"\xff" * 40,
    "c.obj": b"",
    "c.stl": b"",
    "c.glb": b"",
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files(tmp_path, name):
    """An error in one line, or a scene that says what it lacks."""
    (tmp_path / name).write_bytes(BROKEN[name])
    try:
        scene = load_scene(tmp_path / name)
    except SceneError as error:
        assert str(error).startswith(str(tmp_path / name))
        assert "\n" not in str(error)
    else:
        assert any("no triangle" in warning for warning in scene.warnings)


def test_degenerate_and_nan_triangles(tmp_path):
    scene = obj(tmp_path, OBJ + "v nan 0 0\nf 1 2 3\nf 1 2 5\nf 1 1 2\n")
    assert scene.triangle_count == 2
    assert len(scene.warnings) == 2
    assert "is not a finite number is dropped" in " ".join(scene.warnings)


@pytest.mark.parametrize("texture", [1, "a", [], {"index": 7}])
def test_a_texture_that_is_none_leaves_the_material(tmp_path, texture):
    files = trimesh.exchange.gltf.export_gltf(trimesh.Scene(trimesh.creation.box()))
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    tree = json.loads(files["model.gltf"])
    tree["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": texture}}]
    for primitive in tree["meshes"][0]["primitives"]:
        primitive["material"] = 0
    (tmp_path / "model.gltf").write_text(json.dumps(tree))
    scene = load_scene(tmp_path / "model.gltf")
    assert scene.triangle_count == 12 and not scene.textures
