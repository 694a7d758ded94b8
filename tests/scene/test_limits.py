"""How much a file may ask for: it is told by name and line, quickly, and nothing is out of range later."""

from __future__ import annotations

import time

import numpy as np
import pytest

import tracer
from tests.sweeps import ACCELERATORS
from tracer.scene import aff, limits
from tracer.scene.aff import load_aff
from tracer.scene.camera import Camera
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import SceneError

SETTING = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 8 8 l 0 5 5 f 1 1 1 .5 .5 1 0 1\na 0 3 4\n"
TRIANGLE = "p 3 -1 -1 0 1 -1 0 0 1 0\n"
KEYS = "4 {0} 0 0 0  {1} 0 0 0  {2} 0 0 0  {3} 0 0 0"


@pytest.mark.parametrize(
    "text, said",
    [
        ("b 0 0 1e10", ":1: '1e10' in the background is beyond 1e+09; write a smaller number"),
        ("\nl 0 0 1e300", ":2: '1e300' in the position of a light is beyond 1e+09; write a smaller number"),
        ("xs 1 1 1 0 1 0 0 0 0 -2e9 {}", ":1: '-2e9' in a transform is beyond 1e+09; write a smaller number"),
        ("a 0 1 1000001", ":1: 1000001 frames; give at most 1000000"),
        ("x a {" * 300 + "}" * 300, ":1: more than 256 transforms around each other; write fewer"),
    ],
)
def test_too_much_is_refused_by_line(write, text, said):
    with pytest.raises(SceneError) as caught:
        load_aff(write(text))
    assert str(caught.value).endswith("scene.aff" + said)


@pytest.mark.parametrize("text", ["s 3e38 3e38 3e38 3e38", "s 0 0 0 2e9", "c 0 0 0 1 0 2e9 0 1", "c 0 0 0 2e9 0 1 0 1"])
def test_round_shapes_beyond_are_left_out(read, text):
    scene = read(SETTING + text)
    assert scene.primitive_count == 0
    assert "scene.aff:3: a " in scene.warnings[0]
    assert "beyond 1e+09 is dropped" in scene.warnings[0]


def test_a_shape_too_small_is_left_out(read):
    assert read(SETTING + "s 0 0 0 1e-20 s 0 0 0 1e-17").primitive_count == 1


def test_meshes_have_the_same_limit(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e30\nf 1 2 3\nf 1 2 4\n")
    scene = load_scene(tmp_path / "a.obj")
    assert scene.triangle_count == 1
    assert "a corner beyond 1e+09 is dropped" in scene.warnings[0]


def test_a_light_that_transforms_move_beyond_is_left_out(read):
    scene = read(SETTING + "xs 1e9 1 1 0 1 0 0 0 0 0 {\n l 5 0 0 }" + TRIANGLE)
    assert len(scene.lights) == 1
    assert "scene.aff:4: a light beyond 1e+09 is left out" in scene.warnings[0]


@pytest.mark.parametrize("accelerator", ACCELERATORS)
@pytest.mark.parametrize(
    "track",
    [
        "transl " + KEYS.format("0 1e9 0 0", "1 1e9 0 0", "2 9e8 0 0", "3 1e9 1e9 0"),
        "scale " + KEYS.format("0 1 1 1", "1 1e9 1e9 1e9", "2 1e-9 1e9 1", "3 1 1 1"),
        "scale " + KEYS.format("0 1 1 1", "1 1e-30 1 1", "2 1e-30 1 1", "3 1 1 1"),
        "transl 4 0 0 0 0 -1e9 1e9 1e9 1e-300 1e9 0 0 -1e9 1e9 1e9 2 -1e9 0 0 -1e9 1e9 1e9 3 0 0 0 0 0 0",
        "rot " + KEYS.format("0 0 1 0 0", "1 1e9 1 0 1e9", "1 0 1e-9 0 0", "3 0 1 0 5"),
    ],
)
def test_what_tracks_move_beyond_all_numbers_is_nothing_to_hit(read, accelerator, track):
    moving = "x a { x a { " + TRIANGLE + "s 0 0 0 1 } } tpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 "
    moving += "3 1e9 0 0 0 0 1 -1e9 0 0 0 0 1 0 1e9 0 0 0 1 "
    scene = read(SETTING + TRIANGLE + moving + "k a { " + track + " } k camera { " + track + " }")
    scene_info(scene)
    settings = tracer.Settings(8, 8, 2, "certified", threads=1, accelerator=accelerator)
    renderer = tracer.Renderer(scene, settings)
    with np.errstate(all="raise", under="ignore"):
        for moment in (0.0, 1.0, 1.5, 2.0):
            assert renderer.render(moment).primitive.max() < scene.primitive_count


def test_nested_transforms_take_no_longer_each(read, monkeypatch):
    monkeypatch.setattr(aff, "MOST_NESTED", 256)
    names = [f"a{i}" for i in range(250)]
    key = "transl " + KEYS.format("0 0 0 0", "1 0 0 0", "2 0 0 0", "3 0 0 0")
    text = "".join(f"k {n} {{ visibility 1 0 1 {key} }}\n" for n in names)
    text += ("".join(f"x {n} {{ " for n in names) + TRIANGLE + "}" * 250) * 20
    started = time.perf_counter()
    scene = read(SETTING + text)
    tracer.World(scene, 0.0)
    assert time.perf_counter() - started < 8


def test_includes_that_multiply_end(write, monkeypatch):
    monkeypatch.setattr(aff, "MOST_INCLUDES", 1000)
    parts = {f"p{i}": f"i 0 p{i + 1}.aff\n" * 10 for i in range(9)}
    with pytest.raises(SceneError, match="more than 1000 files are included, or 256 by each other; include fewer"):
        load_aff(write(SETTING + "i 0 p0.aff", **parts, p9="b 0 0 0"))


def test_primitives_that_multiply_end(write, monkeypatch):
    monkeypatch.setattr(aff, "MOST_PRIMITIVES", 50)
    with pytest.raises(SceneError, match="more than 50 triangles, spheres and cones; make it simpler"):
        load_aff(write(SETTING + "i 0 p.aff\n" * 10, p=TRIANGLE * 6))


def test_a_camera_has_the_same_limit():
    with pytest.raises(ValueError, match="a camera's position lies within"):
        Camera.from_json({"position": [1e300, 0, 0], "direction": [0, 0, 1]})
    with np.errstate(all="raise"):
        basis = Camera((0, 0, 0), (1e300, 0, 1e300), (0, 1e-200, 0)).basis()
    assert basis @ basis.T == pytest.approx(np.eye(3))


def test_the_limit_is_what_arithmetic_bears():
    edge = np.float32(2) * np.float32(limits.LARGEST)
    normal = np.float32(2) * edge * edge
    assert np.isfinite(np.float32(3) * normal * normal)
