"""Finding images, and surviving them."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from tracer.scene import textures
from tracer.scene.model import SceneError
from tracer.scene.textures import find_texture, load_texture

PIXELS = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
PPM = b"P6\n# a comment\n3 2\n255\n" + PIXELS.tobytes()
MESH = "m vertices 3 0 0 0 1 0 0 0 1 0 texturecoords 1 {} 0 0\ntriangles 1 0 1 2 0 0 0\n"
SETTING = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 8 8 l 0 9 0 fm 0 0 0 1 1 1 0 0 0 1 0 0\n"


def test_binary_ppm(tmp_path):
    (tmp_path / "a.ppm").write_bytes(PPM)
    texture = load_texture(tmp_path / "a.ppm")
    assert texture.name == "a.ppm"
    assert texture.pixels.dtype == np.uint8
    assert texture.pixels.flags.c_contiguous
    assert np.array_equal(texture.pixels, PIXELS)


@pytest.mark.parametrize("mode", ["L", "1", "P", "RGBA", "LA", "I;16", "CMYK"])
def test_any_kind_of_pixels_becomes_rgb(tmp_path, mode):
    Image.new(mode, (4, 5)).save(tmp_path / "a.tif")
    assert load_texture(tmp_path / "a.tif").pixels.shape == (5, 4, 3)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"P6\n",
        b"P6\n-1 3\n255\n",
        b"P6\n3 2\n255\nshort",
        b"not an image",
        b"P6\n0 0\n255\n",
        b"\x89PNG\r\n\x1a\n0",
    ],
)
def test_what_cannot_be_read_is_one_line(tmp_path, content):
    (tmp_path / "a.ppm").write_bytes(content)
    with pytest.raises(SceneError, match=r"^[^\n]*a\.ppm: [^\n]+; [^\n]+$"):
        load_texture(tmp_path / "a.ppm")


def test_an_enormous_image_is_refused_by_its_header(tmp_path):
    (tmp_path / "a.ppm").write_bytes(b"P6\n100000 100000\n255\nno pixels")
    with pytest.raises(SceneError, match=r"a\.ppm: .*too large; scale it down to 128 million pixels or fewer"):
        load_texture(tmp_path / "a.ppm")


def test_a_large_image_is_scaled_down(tmp_path, monkeypatch):
    monkeypatch.setattr(textures, "KEPT_PIXELS", 200)
    Image.new("RGB", (80, 40), (10, 20, 30)).save(tmp_path / "a.png")
    texture = load_texture(tmp_path / "a.png")
    assert texture.pixels.shape == (10, 20, 3)
    assert (texture.pixels == (10, 20, 30)).all()


@pytest.mark.parametrize("folder", [".", "TextureFiles", "textures", "../TEXTURES"])
def test_where_textures_are_looked_for(tmp_path, folder):
    scene = tmp_path / "scenes"
    scene.mkdir()
    (scene / folder).mkdir(exist_ok=True)
    (scene / folder / "a.ppm").write_bytes(PPM)
    found = find_texture("a.ppm", scene / "part.aff", scene / "scene.aff")
    assert found is not None
    assert found.samefile(scene / folder / "a.ppm")


def test_beside_the_naming_file_comes_first(tmp_path):
    for folder in ("parts", "textures"):
        (tmp_path / folder).mkdir()
    part, scene = tmp_path / "parts" / "part.aff", tmp_path / "scene.aff"
    for place in ("textures", ".", "parts"):
        (tmp_path / place / "a.ppm").write_bytes(PPM)
        assert find_texture("a.ppm", part, scene) == tmp_path / place / "a.ppm"


@pytest.mark.parametrize("name", ["a.ppm", "x" * 9999, "\0", ".", "textures"])
def test_what_is_not_there(tmp_path, name):
    (tmp_path / "textures").mkdir()
    assert find_texture(name, tmp_path / "a.aff", tmp_path / "a.aff") is None


def test_backslashes_are_folders_too(tmp_path):
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "a.ppm").write_bytes(PPM)
    assert find_texture("images\\a.ppm", tmp_path / "a.aff", tmp_path / "a.aff") == tmp_path / "images" / "a.ppm"


def test_a_missing_texture_is_one_warning(read):
    scene = read(SETTING + MESH.format("no.ppm") * 3)
    assert scene.objects[0].triangles.texture.tolist() == [-1] * 3
    assert len(scene.warnings) == 1
    expected = "scene.aff:2: texture 'no.ppm' is not to be found; the surface keeps its material colour"
    assert scene.warnings[0].endswith(expected)


def test_a_broken_texture_is_one_warning(read, tmp_path):
    (tmp_path / "a.ppm").write_bytes(b"P6\n900000 900000\n255\n")
    scene = read(SETTING + MESH.format("a.ppm") + MESH.format("./a.ppm"))
    assert scene.objects[0].triangles.texture.tolist() == [-1, -1]
    assert len(scene.warnings) == 1
    assert "scene.aff:2: texture" in scene.warnings[0]
    assert "too large" in scene.warnings[0]


def test_a_texture_is_loaded_once_whatever_it_is_called(read, tmp_path):
    (tmp_path / "a.ppm").write_bytes(PPM)
    scene = read(SETTING + MESH.format("a.ppm") + MESH.format("./a.ppm"))
    assert len(scene.textures) == 1
    assert scene.objects[0].triangles.texture.tolist() == [0, 0]
