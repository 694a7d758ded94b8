"""The embedded scenes are what their generator writes: a sound room, a safe flight, two figures."""

from __future__ import annotations

import importlib.util
import io
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image

import tracer
from tests.scenes import loaded, world_of
from tests.sweeps import cases
from tracer.culling.modes import OcclusionMode, ShadowMode, occlusion_mode, shadow_mode

ASSETS = Path(__file__).resolve().parent.parent / "assets"
SCENES = ASSETS / "scenes"


@pytest.fixture(scope="module")
def make_scenes() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_scenes", ASSETS / "make_scenes.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def study() -> tracer.Scene:
    return loaded(SCENES / "default.aff")


@pytest.mark.slow
def test_the_generator_writes_the_committed_files(make_scenes: ModuleType) -> None:
    """All by `make test-all`, the figures and the scenes of many lights in every run."""
    files = make_scenes.make(cases(make_scenes.PARTS[:2], make_scenes.PARTS))
    committed = {p.relative_to(ASSETS).as_posix() for p in SCENES.rglob("*") if p.is_file()} | {"icon.png"}
    assert committed >= set(files) and len(files) >= cases(10, len(committed))
    for path, data in files.items():
        held = (ASSETS / path).read_bytes()
        if path.endswith(".png"):  # zlib may pack the same pixels otherwise
            images = [np.asarray(Image.open(io.BytesIO(d))) for d in (held, data)]
            assert np.array_equal(images[0], images[1]), path
        else:
            assert held == data, f"{path} differs from what assets/make_scenes.py writes"


def test_the_embedded_files_stay_small() -> None:
    assert sum(p.stat().st_size for p in SCENES.rglob("*") if p.is_file()) < 7_000_000


def test_the_study_has_what_a_first_look_needs(study: tracer.Scene) -> None:
    info = tracer.scene_info(study)
    assert info["warnings"] == []
    assert 20_000 <= info["triangles"] <= 100_000
    assert info["dynamic_triangles"] >= 1_000
    assert info["lights"] == 6
    assert info["spheres"] >= 100 and info["cones"] >= 30
    assert info["textures"] == 14
    assert info["frames"] == 200
    assert any(max(m.specular) > 0.8 for m in study.materials), "a mirror"
    assert any(m.transmission > 0.5 and m.ior > 1.4 for m in study.materials), "glass"
    assert len(study.objects) >= 7, "train, airplane, propeller, pendulum"


def test_triangles_are_sound(study: tracer.Scene) -> None:
    for thing in study.objects:
        corners = thing.triangles.corners.astype(np.float64)
        normals = thing.triangles.normals.astype(np.float64)
        assert np.isfinite(corners).all() and np.isfinite(normals).all()
        geometric = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(geometric, axis=1)
        # Corner normals lie on the same side as the face, or textures and glass would turn inside out.
        agree = np.einsum("nck,nk->nc", normals, geometric / np.maximum(length, 1e-20)[:, None]).mean(axis=1)
        assert (agree[length > 1e-9] > 0).mean() > 0.999


@pytest.mark.parametrize(("name", "step"), [("default", 0.2), ("office", 0.4), ("courtyard", 0.4)])
def test_the_flight_is_smooth_and_closes(name: str, step: float) -> None:
    scene = loaded(SCENES / f"{name}.aff")
    cameras = [scene.camera_at(scene.frame_time(i)) for i in range(scene.frames)]
    positions = np.array([c.position for c in cameras])
    views = np.array([c.basis()[2] for c in cameras])
    assert np.isfinite(positions).all() and np.isfinite(views).all()
    if name == "default":
        assert (positions > (0.3, 0.2, 0.3)).all() and (positions < (6.2, 2.6, 5.0)).all(), "in the room"
    assert np.linalg.norm(np.diff(positions, axis=0), axis=1).max() < step
    turn = np.degrees(np.arccos(np.clip((views[1:] * views[:-1]).sum(axis=1), -1, 1)))
    assert turn.max() < 12
    assert np.allclose(positions[0], positions[-1], atol=1e-3), "so that it can loop"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "room"), [("default", 0.12), ("office", 0.3), ("courtyard", 0.3)])
def test_the_camera_never_touches_anything(name: str, room: float) -> None:
    directions = np.random.default_rng(0).normal(size=(120, 3))
    directions = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).astype(np.float32)
    world = world_of(SCENES / f"{name}.aff", "bvh8")
    scene = world.scene
    for frame in range(0, scene.frames, cases(20, 2)):
        time = scene.frame_time(frame)
        world.place(time)
        origin = np.asarray(scene.camera_at(time).position, np.float32)
        rays = tracer.RayBatch(np.broadcast_to(origin, directions.shape), directions)
        assert world.closest_hits(rays).t.min() > room, f"frame {frame}"


def test_the_office_has_256_panels_of_16_samples() -> None:
    info = tracer.scene_info(loaded(SCENES / "office.aff"))
    panels = {"kind": "rectangle", "samples": 16, "falloff": "inverse square", "lights": 256}
    assert info["light_kinds"] == [panels]
    assert info["warnings"] == [] and info["triangles"] < 400_000


def test_the_courtyard_has_10_000_coloured_bulbs() -> None:
    scene = loaded(SCENES / "courtyard.aff")
    info = tracer.scene_info(scene)
    assert info["light_kinds"] == [{"kind": "point", "samples": 1, "falloff": "inverse square", "lights": 10_000}]
    assert info["warnings"] == [] and info["triangles"] < 100_000
    assert len({light.color for light in scene.lights}) == 6
    distinct = {tuple(np.round(light.position, 3)) for light in scene.lights}
    assert len(distinct) == 10_000


def test_files_with_many_lights_are_small() -> None:
    for name in ("office", "courtyard"):
        sizes = [p.stat().st_size for p in [SCENES / f"{name}.aff", *(SCENES / name).iterdir()]]
        assert max(sizes) < 64_000 and sum(sizes) < 400_000


@pytest.mark.parametrize(
    ("size", "symmetric", "expected"),
    [
        (3, False, "PFiiii"),
        (9, False, "PFPFFF"),
        (9, True, "PFPFPF"),
    ],
)
def test_figure_3_marks_what_goes_on_behind_something(size: int, symmetric: bool, expected: str) -> None:
    scene = loaded(SCENES / "figure3.aff")
    renderer = tracer.Renderer(scene, tracer.Settings(width=size, height=size, symmetric=symmetric))
    modes = occlusion_mode(renderer.render(0.0).modes)
    names = {
        "i": OcclusionMode.INIT,
        "P": OcclusionMode.PARTIALLY_OCCLUDED,
        "F": OcclusionMode.FULLY_RENDERED,
    }
    assert [OcclusionMode(int(m)) for m in modes] == [names[letter] for letter in expected]


def test_figure_4_shows_its_shadow_only_after_zooming_in() -> None:
    scene = loaded(SCENES / "figure4.aff")
    world = tracer.World(scene)
    culled = tracer.Renderer(scene, tracer.Settings(width=128, height=128), world=world)
    traced = tracer.Renderer(scene, tracer.Settings(width=128, height=128, method="none"), world=world)
    modes: list[int] = []
    shadow: list[int] = []
    truth: list[int] = []
    for i in range(40):
        time = scene.frame_time(i)
        frame, reference = culled.render(time), traced.render(time)
        modes.append(int(shadow_mode(frame.modes[0], 0)))
        for counts, picture in ((shadow, frame), (truth, reference)):
            counts.append(int(((picture.primitive == 0) & (picture.color.max(axis=2) < 0.25)).sum()))
    assert truth[:12] == [0] * 12 and min(truth[13:]) > 0
    assert shadow[:27] == [0] * 27 and set(modes[:27]) == {ShadowMode.NON_SHADOW}
    assert shadow[27:] == truth[27:] and set(modes[27:]) == {ShadowMode.PARTIAL_SHADOW}
