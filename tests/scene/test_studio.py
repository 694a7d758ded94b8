"""The studio around a model that brings neither camera nor lights."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tracer.renderer import Renderer, Settings
from tracer.scene.bounds import extent
from tracer.scene.load import load_scene, scene_info
from tracer.scene.mesh_options import IN_STUDIO, UPS, MeshOptions
from tracer.scene.model import Camera
from tracer.scene.studio import FILLED, FLOOR, FLOOR_REACH, build_studio, model_bounds, up_in_studio

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "-x": (-1, 0, 0), "-y": (0, -1, 0), "-z": (0, 0, -1)}
sizes = st.floats(1e-3, 1e3)
clouds = st.builds(
    lambda seed, n, size, at, scale: (
        scale * (np.random.default_rng(seed).uniform(-1, 1, (n, 3, 3)) * size + at)
    ).astype(np.float32),
    st.integers(0, 2**32 - 1),
    st.integers(1, 20),
    st.tuples(sizes, sizes, sizes),
    st.tuples(*[st.floats(-1e3, 1e3)] * 3),
    st.sampled_from((1e-3, 1.0, 1e3)),
)


def in_view(camera: Camera, points: np.ndarray) -> np.ndarray:
    """(n, 2): where points are in a square frame, whose borders are at -1 and 1; NaN behind the camera."""
    seen = (points - camera.position) @ camera.basis().T
    with np.errstate(all="ignore"):
        return np.where(seen[:, 2:] > 0, seen[:, :2] / seen[:, 2:] / np.tan(np.radians(camera.angle) / 2), np.nan)


@given(clouds, st.sampled_from(UPS))
@settings(max_examples=60, deadline=None)
def test_floor_lamps_and_camera_fit_any_model(corners, up):
    studio = build_studio(corners, up, 7)
    points, axis = corners.reshape(-1, 3).astype(np.float64), np.array(AXES[up])
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    rounding = 8 * np.abs(points).max() * 1.2e-7
    heights, floor = points @ axis, studio.floor.corners.astype(np.float64) @ axis
    # The model stands on the floor, not in it.
    gap = heights.min() - floor
    assert (gap > 0).all() and (gap <= 1e-3 * size + rounding + 1e-6 * FLOOR_REACH * size).all()
    assert (studio.floor.normals == axis).all() and (studio.floor.material == 7).all()
    a, b, c = np.moveaxis(studio.floor.corners.astype(np.float64), 1, 0)
    assert (np.cross(b - a, c - a) @ axis > 0).all()
    # Every lamp is clear of the model and of the floor, with all of its samples.
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    for light in studio.lights:
        samples = np.array(light.position) + light.offsets()
        assert (samples @ axis > heights.max()).all() or np.linalg.norm(samples - middle, axis=1).min() > size / 2
        assert (samples @ axis > floor.max()).all()
    # The whole model is in the frame, and fills what it may of its width or height.
    camera = studio.camera
    seen = in_view(camera, points)
    assert camera.up == tuple(AXES[up]) and np.dot(camera.position, axis) > floor.max()
    assert (np.abs(seen) <= FILLED + 0.02).all()
    assert np.ptp(seen, axis=0).max() > 0.7 * 2 * FILLED or size <= 100 * rounding or len(np.unique(points, axis=0)) < 4
    # Floor under all of it.
    assert np.isfinite(studio.background).all()


def test_a_lone_model_gets_a_studio_only_where_that_is_asked_for(tmp_path):
    path = tmp_path / "box.ply"
    trimesh.creation.box((1, 2, 3)).export(path)
    bare, scene = load_scene(path), load_scene(path, meshes=IN_STUDIO)
    assert bare.triangle_count == 12 and len(bare.lights) == 2 and up_in_studio(bare) is None
    assert scene.triangle_count == 14 and [light.name for light in scene.lights] == ["key", "fill", "rim"]
    assert scene.name_of(13) == scene.name_of(12) == FLOOR == scene.material_of(13).name
    assert scene.name_of(11) == bare.name_of(11)
    # The model keeps its numbers and its place, and its bounds do without the floor.
    assert (scene.objects[0].triangles.corners[:12] == bare.objects[0].triangles.corners).all()
    assert model_bounds(scene).tolist() == scene_info(bare)["bounds"] and model_bounds(bare) is None


@pytest.mark.parametrize("has", ["camera", "light"])
def test_what_has_a_camera_or_lights_stays_as_it_is(tmp_path, has):
    model = trimesh.Scene(trimesh.creation.icosphere(subdivisions=1))
    if has == "camera":
        model.camera_transform = trimesh.transformations.translation_matrix((0, 0, 5))
    path = tmp_path / "a.glb"
    data = model.export(file_type="glb", include_normals=False)
    if has == "light":
        declared = {"extensions": {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}}
        tree = trimesh.exchange.gltf.export_glb(model, tree_postprocessor=lambda tree: _lit(tree, declared))
        data = tree
    path.write_bytes(data)
    bare, scene = load_scene(path), load_scene(path, meshes=IN_STUDIO)
    assert up_in_studio(scene) is None
    assert (scene.camera, scene.lights, scene.background) == (bare.camera, bare.lights, bare.background)
    for name in ("corners", "normals", "material"):
        assert (getattr(scene.objects[0].triangles, name) == getattr(bare.objects[0].triangles, name)).all()


def _lit(tree, declared):
    tree.update(declared)
    tree["extensionsUsed"] = ["KHR_lights_punctual"]
    tree["nodes"].append(
        {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 3, 0]}
    )
    tree["nodes"][tree["scenes"][0]["nodes"][0]].setdefault("children", []).append(len(tree["nodes"]) - 1)


def test_up_is_what_was_asked_for(tmp_path):
    path = tmp_path / "box.obj"
    trimesh.creation.box((1, 2, 3)).export(path)
    for up in UPS:
        assert up_in_studio(load_scene(path, meshes=MeshOptions(True, up))) == up
    with pytest.raises(ValueError, match="w"):
        MeshOptions(True, "w")
    with pytest.raises(ValueError, match="181"):
        MeshOptions(crease=181)


def test_the_picture_shows_a_bright_model_on_a_floor_that_fades(tmp_path):
    path = tmp_path / "ball.stl"
    trimesh.creation.icosphere(subdivisions=2).export(path)
    scene = load_scene(path, meshes=IN_STUDIO)
    frame = Renderer(scene, Settings(width=64, height=64, lamp_samples=4, threads=2)).render()
    primitive = frame.primitive
    model = (primitive >= 0) & (primitive < 320)
    assert 0.2 < model.mean() < 0.7
    assert primitive[-1].min() >= 320  # it stands on the floor
    light = np.asarray(frame.color, np.float64).mean(axis=2)
    assert 0.45 < np.median(light[model]) < 0.9 and light[model].max() <= 1.0
    # To the camera's front and back, too, the floor ends in the background without an edge.
    middle, up = model_bounds(scene).mean(axis=0), np.array(AXES[up_in_studio(scene)])
    for way in ((-2.0, 3.0, 0.5), (2.0, -3.0, 0.5)):
        camera = Camera(tuple(middle + way), tuple(way - 0.3 * up), scene.camera.up, 60.0)
        low = Renderer(scene, Settings(width=8, height=64, lamp_samples=4, threads=2)).render(camera=camera)
        edge = np.argmax(low.primitive >= 320, axis=0)
        assert (edge > 8).all() and (low.primitive[edge - 1, np.arange(8)] == -1).all()
        ends = np.asarray(low.color, np.float64)[edge, np.arange(8)]
        assert np.abs(ends - scene.background).max() < 0.06


@pytest.mark.parametrize("n", [1, 63, 64, 65, 1000])
def test_extents_are_those_of_all_points(n):
    points = np.random.default_rng(n).normal(size=(n, 3)).astype(np.float32)
    low, high = extent(points)
    assert np.array_equal(low, points.min(axis=0)) and np.array_equal(high, points.max(axis=0))
