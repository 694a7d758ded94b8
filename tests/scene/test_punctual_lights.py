"""Lights of glTF files (KHR_lights_punctual); each file is written here: a square, and nodes with lights."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tracer.scene import punctual_lights
from tracer.scene.lights import Light
from tracer.scene.load import load_scene
from tracer.scene.model import Scene, SceneObject, empty_quadrics, empty_triangles

EXTENSION = "KHR_lights_punctual"
SIDE = 2.0
CENTER = np.array([0.0, 0.0, 0.0])


def document(lights: list[Any], nodes: list[dict[str, Any]], roots: list[int] | None = None) -> dict[str, Any]:
    """A square in the plane z = 0, whose node comes after the others."""
    h = SIDE / 2
    corners = np.array([(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], np.float32)
    data = corners.tobytes() + np.array([0, 1, 2, 0, 2, 3], np.uint16).tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": [EXTENSION],
        "extensions": {EXTENSION: {"lights": lights}},
        "scene": 0,
        "scenes": [{"nodes": [*(range(len(nodes)) if roots is None else roots), len(nodes)]}],
        "nodes": [*nodes, {"name": "square", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": corners.min(0).tolist(),
                "max": corners.max(0).tolist(),
            },
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [{"uri": uri, "byteLength": len(data)}],
    }


def bearing(light: int, **fields: Any) -> dict[str, Any]:
    """A node with a light."""
    return {**fields, "extensions": {EXTENSION: {"light": light}}}


def load(folder: Path, *arguments: Any) -> Scene:
    path = folder / "lights.gltf"
    path.write_text(json.dumps(document(*arguments)))
    return load_scene(path)


def arriving(scene: Scene) -> np.ndarray:
    """(triangles,): what the middle of each triangle gets, were nothing in between, of white lights."""
    middles = scene.objects[0].triangles.corners.mean(axis=1)
    total = np.zeros(len(middles))
    for light in scene.lights:
        squares = np.sum((middles - light.position) ** 2, axis=1) if light.falloff != "none" else 1.0
        total += light.color[0] / squares
    return total


def test_a_point_falls_off_and_takes_the_place_of_ours(tmp_path):
    lights = [{"type": "point", "color": [1, 0.5, 0.25], "intensity": 800.0}]
    scene = load(tmp_path, lights, [bearing(0, name="bulb", translation=[0, 0, 3])])
    (light,) = scene.lights
    assert (light.name, light.kind, light.falloff, light.position) == ("bulb", "point", "inverse square", (0, 0, 3))
    assert np.array(light.color) / light.color[0] == pytest.approx((1, 0.5, 0.25))
    assert scene.warnings == ()


def test_binary_files_have_lights_too(tmp_path):
    text = json.dumps(document([{"type": "point"}], [bearing(0, translation=[0, 0, 3])])).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text)) + struct.pack("<I4s", len(text), b"JSON")
    (tmp_path / "lights.glb").write_bytes(head + text)
    (light,) = load_scene(tmp_path / "lights.glb").lights
    assert light.name == "light 0" and light.position == (0, 0, 3)


def test_lights_are_exposed_alike(tmp_path):
    """Whatever a file's units come to, what half of the triangles get is 1, and lights keep their ratios."""
    lights = [{"type": "point", "intensity": 54351.4}, {"type": "directional", "intensity": 1000.0}]
    nodes = [bearing(0, name="a", translation=[0.3, 0, 2]), bearing(1, name="b")]
    scene = load(tmp_path, lights, nodes)
    assert np.median(arriving(scene)) == pytest.approx(1.0)
    a, b = scene.lights
    assert a.color[0] / b.color[0] == pytest.approx(54.3514)


def test_a_light_within_the_model_leaves_numbers_finite(tmp_path):
    (light,) = load(tmp_path, [{"type": "point"}], [bearing(0, translation=[1 / 3, -1 / 3, 0])]).lights
    assert np.isfinite(light.color).all()


def test_lights_that_are_off_stay_dark(tmp_path):
    (light,) = load(tmp_path, [{"type": "point", "intensity": 0.0}], [bearing(0)]).lights
    assert light.color == (0, 0, 0)


def test_nodes_are_placed_by_those_above_them(tmp_path):
    """A quarter turn about x, of twice the size, around a node that turns nothing."""
    turned = {"name": "arm", "rotation": [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], "scale": [2, 2, 2], "children": [1]}
    (light,) = load(tmp_path, [{"type": "point"}], [turned, bearing(0, translation=[0, 1, 0])], [0]).lights
    assert light.position == pytest.approx((0, 0, 2), abs=1e-12)


def test_a_directional_light_stands_far_away_behind_its_direction(tmp_path):
    """It shines along -z of its node; rays are parallel within six degrees all over the model."""
    down = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # -z becomes -y
    node = bearing(0, name="sun", rotation=down, translation=[5, 5, 5], scale=[3, 3, 3])
    scene = load(tmp_path, [{"type": "directional", "intensity": 3.0}], [node])
    (sun,) = scene.lights
    assert (sun.falloff, sun.kind) == ("none", "point")
    away = np.array(sun.position) - CENTER
    assert away / np.linalg.norm(away) == pytest.approx((0, 1, 0), abs=1e-9)
    rays = scene.objects[0].triangles.corners.reshape(-1, 3) - sun.position
    cosines = -rays[:, 1] / np.linalg.norm(rays, axis=1)
    assert cosines.min() > np.cos(np.radians(6))


def test_a_spot_is_a_point_and_says_so(tmp_path):
    spot = {"type": "spot", "spot": {"outerConeAngle": 0.3}}
    scene = load(tmp_path, [spot], [bearing(0, name="torch", translation=[0, 0, 3])])
    (light,) = scene.lights
    assert (light.position, light.falloff) == ((0, 0, 3), "inverse square")
    (warning,) = scene.warnings
    assert warning == f"{scene.path}: the light 'torch': a spot shines in all directions here; its cone is left out"


def test_a_light_that_several_nodes_bear_is_several(tmp_path):
    scene = load(
        tmp_path, [{"type": "point"}], [bearing(0, name=n, translation=[x, 0, 2]) for n, x in (("b", 1), ("a", 2))]
    )
    assert [(light.name, light.position) for light in scene.lights] == [("a", (2, 0, 2)), ("b", (1, 0, 2))]


def test_a_node_with_a_light_and_a_mesh_of_parts_has_one_light(tmp_path):
    file = document([{"type": "point"}], [])
    file["nodes"] = [bearing(0, name="shade", mesh=0)]
    file["meshes"][0]["primitives"] *= 2
    (tmp_path / "a.gltf").write_text(json.dumps(file))
    scene = load_scene(tmp_path / "a.gltf")
    assert len(scene.lights) == 1 and scene.triangle_count == 4


@pytest.mark.parametrize(
    "declared, node, said",
    [
        ({"type": "laser"}, {}, "'laser' is no type of light"),
        ({}, {}, "'' is no type of light"),
        (7, {}, "'' is no type of light"),
        (
            {"type": "point", "color": [1, 1]},
            {},
            "its colour and intensity are not three numbers and one, of 0 or more",
        ),
        ({"type": "point", "color": "red"}, {}, "its colour or intensity is not made of numbers"),
        (
            {"type": "point", "intensity": -1},
            {},
            "its colour and intensity are not three numbers and one, of 0 or more",
        ),
        ({"type": "directional"}, {"scale": [0, 0, 0]}, "its node is scaled to nothing"),
    ],
)
def test_a_light_that_is_no_good_is_left_out_and_ours_are_used(tmp_path, declared, node, said):
    scene = load(tmp_path, [declared], [bearing(0, name="n", **node)])
    assert scene.warnings == (f"{scene.path}: the light of node 'n': {said}; it is left out",)
    assert [light.name for light in scene.lights] == ["key", "fill"]


@pytest.mark.parametrize("number", [1, -1, "0", None])
def test_a_light_that_is_not_there_is_warned_of(tmp_path, number):
    scene = load(tmp_path, [{"type": "point"}], [bearing(number, name="n")])
    assert scene.warnings == (f"{scene.path}: the light of node 'n': the file has no such light; it is left out",)


def test_a_light_below_the_camera_is_left_out(tmp_path):
    file = document([{"type": "point"}], [{"name": "eye", "camera": 0, "children": [1]}, bearing(0, name="lamp")], [0])
    file["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.0}}]
    (tmp_path / "a.gltf").write_text(json.dumps(file))
    scene = load_scene(tmp_path / "a.gltf")
    assert scene.warnings == (f"{scene.path}: the light of node 'lamp': its place is not known; it is left out",)


@pytest.mark.parametrize("extensions", [{EXTENSION: []}, {EXTENSION: {"lights": {}}}, {EXTENSION: {"lights": []}}, {}])
def test_an_extension_without_lights_leaves_ours(tmp_path, extensions):
    file = document([], []) | {"extensions": extensions}
    (tmp_path / "a.gltf").write_text(json.dumps(file))
    scene = load_scene(tmp_path / "a.gltf")
    assert [light.name for light in scene.lights] == ["key", "fill"] and scene.warnings == ()


def test_of_many_triangles_every_nth_of_all_objects_judges_the_exposure(monkeypatch):
    rng = np.random.default_rng(4)
    corners = [rng.random((count, 3, 3)).astype(np.float32) for count in (7, 0, 11, 1)]
    objects = [SceneObject("", replace(empty_triangles(), corners=c), empty_quadrics()) for c in corners]
    monkeypatch.setattr(punctual_lights, "_MOST_TRIANGLES", 5)
    (light,) = punctual_lights._exposed([Light("a", (9, 9, 9), (2, 2, 2), falloff="inverse square")], objects)
    seen = np.concatenate(corners).mean(axis=1)[::3]
    usual = np.median(2 / np.sum((seen - 9.0) ** 2, axis=1))
    assert light.color == pytest.approx((2 / usual,) * 3)
