"""What the files of a scene may reach: nothing but its own folder, and no program."""

from __future__ import annotations

import base64
import io
import json
import os

import pytest
from PIL import EpsImagePlugin, Image

from tests.platforms import posix_only
from tracer.scene import files
from tracer.scene.files import SceneFiles, read_regular
from tracer.scene.load import load_scene
from tracer.scene.model import SceneError

SETTING = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 8 8 l 0 9 0 fm 0 0 0 1 1 1 0 0 0 1 0 0\n"
MESH = "m vertices 3 0 0 0 1 0 0 0 1 0 texturecoords 1 {} 0 0\ntriangles 1 0 1 2 0 0 0\n"
OBJ = "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n"
EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n"
SECRET = "TOP-SECRET words"


@pytest.fixture
def secret(tmp_path):
    """A file beside the scene's folder, which is `tmp_path / scene`."""
    (tmp_path / "scene").mkdir()
    (tmp_path / "secret.aff").write_text(SECRET)
    return tmp_path / "secret.aff"


@pytest.fixture
def no_ghostscript(monkeypatch):
    started = []
    monkeypatch.setattr(EpsImagePlugin, "Ghostscript", lambda *_, **__: started.append(1))
    yield
    assert not started


def refused(path):
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    text = str(caught.value)
    assert "TOP" not in text and "\n" not in text
    return text


@pytest.mark.parametrize("name", ["../secret.aff", "{}", "link.aff", "folder/secret.aff"])
@posix_only
def test_an_include_from_elsewhere_is_not_read(secret, name):
    folder = secret.parent / "scene"
    (folder / "link.aff").symlink_to(secret)
    (folder / "folder").symlink_to(secret.parent)
    (folder / "a.aff").write_text(f"{SETTING}i 0 {name.format(secret)}")
    assert "lies outside of the scene's folder" in refused(folder / "a.aff")


def test_a_folder_that_the_user_names_is_allowed(secret):
    (secret.parent / "part.aff").write_text("s 0 0 0 1")
    path = secret.parent / "scene" / "a.aff"
    path.write_text(SETTING + "i 0 ../part.aff")
    assert load_scene(path, folders=[secret.parent]).primitive_count == 1


@posix_only
def test_a_linked_scene_has_its_parts_beside_the_link_or_the_file(tmp_path):
    for folder in ("true", "links"):
        (tmp_path / folder).mkdir()
    (tmp_path / "true" / "a.aff").write_text(SETTING + "i 0 part.aff")
    (tmp_path / "true" / "part.aff").write_text("s 0 0 0 1")
    for name in ("a.aff", "part.aff"):
        (tmp_path / "links" / name).symlink_to(tmp_path / "true" / name)
    assert load_scene(tmp_path / "links" / "a.aff").primitive_count == 1


@posix_only
@pytest.mark.parametrize("path", ["/dev/zero", "/dev/kmsg"])
def test_devices_and_pipes_are_not_read(tmp_path, path):
    os.mkfifo(tmp_path / "pipe.aff")
    for name in (path, "pipe.aff"):
        (tmp_path / "a.aff").write_text(f"{SETTING}i 0 {name}")
        refused(tmp_path / "a.aff")
    with pytest.raises(OSError, match="not a regular file"):
        read_regular(tmp_path / "pipe.aff")


def test_files_are_read_up_to_a_size(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "MOST_BYTES", 3 << 20)
    for name in "ab":
        (tmp_path / name).write_bytes(b"#" * (2 << 20))
    reader = SceneFiles(tmp_path / "scene.aff")
    assert len(reader.read(tmp_path / "a")) == 2 << 20
    with pytest.raises(OSError, match="too large; 1 MiB are read at most"):
        reader.read(tmp_path / "b")


def test_a_texture_from_elsewhere_is_not_read(secret):
    Image.new("RGB", (2, 2)).save(secret.parent / "a.png")
    path = secret.parent / "scene" / "a.aff"
    path.write_text(SETTING + MESH.format("../a.png"))
    scene = load_scene(path)
    assert len(scene.textures) == 0
    assert "'../a.png' is not to be found" in scene.warnings[0]
    assert len(load_scene(path, folders=[secret.parent]).textures) == 1


def test_the_way_out_of_a_folder_of_textures_is_closed(secret):
    (secret.parent / "textures").mkdir()
    Image.new("RGB", (2, 2)).save(secret.parent / "a.png")
    path = secret.parent / "scene" / "a.aff"
    path.write_text(SETTING + MESH.format("../a.png"))
    assert len(load_scene(path).textures) == 0


def test_a_program_named_like_an_image_is_not_run(tmp_path, no_ghostscript):
    (tmp_path / "innocent.png").write_bytes(EPS)
    (tmp_path / "a.aff").write_text(SETTING + MESH.format("innocent.png"))
    scene = load_scene(tmp_path / "a.aff")
    assert len(scene.textures) == 0
    assert "innocent.png: not an image that can be read" in scene.warnings[0]


@pytest.mark.parametrize("name", ["innocent.png", "innocent.mtl", "innocent.bin"])
def test_nor_by_a_material(tmp_path, no_ghostscript, name):
    (tmp_path / name).write_bytes(EPS)
    (tmp_path / "a.mtl").write_text(f"newmtl a\nmap_Kd {name}\n")
    (tmp_path / "a.obj").write_text(OBJ.format("a.mtl"))
    assert len(load_scene(tmp_path / "a.obj").textures) == 0


def gltf(**changed):
    """One triangle, with the parts of the file that are given."""
    data = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": data_uri(bytes(36))}],
    }
    return json.dumps(data | changed)


def data_uri(data):
    return "data:application/octet-stream;base64," + base64.b64encode(data).decode()


@pytest.mark.parametrize("extension", ["", "KHR_materials_pbrSpecularGlossiness"])
def test_nor_within_a_mesh_file(tmp_path, no_ghostscript, extension):
    texture = {"index": 0}
    material = {"pbrMetallicRoughness": {"baseColorTexture": texture}}
    if extension:
        material = {"extensions": {extension: {"diffuseTexture": texture, "specularGlossinessTexture": texture}}}
    mesh = {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 0}, "material": 0}]}
    before = Image.open
    text = gltf(meshes=[mesh], materials=[material], textures=[{"source": 0}], images=[{"uri": data_uri(EPS)}])
    (tmp_path / "a.gltf").write_text(text)
    assert len(load_scene(tmp_path / "a.gltf").textures) == 0
    assert Image.open is before


@pytest.mark.parametrize(
    "changed",
    [
        {"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAA"}]},
        {"bufferViews": [{"buffer": 0, "byteLength": 36, "byteOffset": -5}]},
        {"bufferViews": [{"buffer": 0, "byteLength": 36, "byteStride": 10**12}]},
        {"accessors": [{"componentType": 5126, "count": 10**13, "type": "VEC3"}]},
    ],
)
def test_a_damaged_mesh_file_is_called_that(tmp_path, changed):
    (tmp_path / "a.gltf").write_text(gltf(**changed))
    assert refused(tmp_path / "a.gltf").endswith(
        "a.gltf: cannot be read as GLTF: it is damaged or incomplete; repair or convert the file"
    )


def test_nodes_nested_too_deep(tmp_path):
    (tmp_path / "a.gltf").write_text(
        gltf(nodes=[{"mesh": 0, "children": [i + 1]} for i in range(1000)] + [{"mesh": 0}])
    )
    assert refused(tmp_path / "a.gltf").endswith("more than 256 nodes around each other; make it simpler")


def test_what_is_no_json_is_no_gltf(tmp_path):
    (tmp_path / "a.gltf").write_text("[" * 100_000)
    assert "cannot be read as GLTF: it is damaged" in refused(tmp_path / "a.gltf")


def test_data_from_elsewhere(secret):
    path = secret.parent / "scene" / "a.gltf"
    path.write_text(gltf(buffers=[{"byteLength": 36, "uri": "../secret.aff"}]))
    assert "'../secret.aff', which it refers to, cannot be read" in refused(path)


def test_vertices_of_two_coordinates(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n")
    assert refused(tmp_path / "a.obj").endswith("a.obj: a vertex has not three coordinates; repair the file")


def test_what_trimesh_says_stays_in_the_program(tmp_path, capfd, caplog):
    header = "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\n"
    header += "".join(f"property float {axis}\n" for axis in "xyzst")
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "a.ply").write_text(header + "0 0 0 0 0\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n")
    (tmp_path / "a.png").write_bytes(EPS)
    assert load_scene(tmp_path / "a.ply").triangle_count == 1
    assert capfd.readouterr() == ("", "")
    assert caplog.records == []


def test_all_images_together_have_a_limit(tmp_path, monkeypatch):
    monkeypatch.setattr("tracer.scene.textures.MOST_PIXELS", 30)
    for name in "ab":
        Image.new("RGB", (5, 5)).save(tmp_path / f"{name}.png")
    (tmp_path / "a.aff").write_text(SETTING + MESH.format("a.png") + MESH.format("b.png"))
    scene = load_scene(tmp_path / "a.aff")
    assert len(scene.textures) == 1
    assert "the scene's images together have more than" in scene.warnings[0]


def test_an_image_within_a_mesh_file_is_judged_by_its_header(tmp_path, monkeypatch):
    monkeypatch.setattr("tracer.scene.textures.MOST_PIXELS", 30)
    file = io.BytesIO()
    Image.new("RGB", (50, 50)).save(file, "PNG")
    mesh = {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 0}, "material": 0}]}
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    text = gltf(
        meshes=[mesh], materials=[material], textures=[{"source": 0}], images=[{"uri": data_uri(file.getvalue())}]
    )
    (tmp_path / "a.gltf").write_text(text)
    scene = load_scene(tmp_path / "a.gltf")
    assert len(scene.textures) == 0
