"""The embedded scenes look as they did, and a picture that does not is found out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import tracer.renderer
from tests import scenes
from tests.golden.pictures import (
    FOLDER,
    GOLDEN,
    OF_METHODS,
    SETTINGS,
    Difference,
    Golden,
    OfMethod,
    fault,
    golden_picture,
    light_cube,
)
from tracer.frame import Frame
from tracer.geometry.accelerators import BVH8
from tracer.geometry.world import World
from tracer.scene.model import Scene
from viewer.util.resources import embedded_scenes

FAULTY = Path(__file__).resolve().parent.parent / ".cache" / "golden"
STUDY, FIGURE3, BEFORE, FIGURE4 = GOLDEN


@cache
def world_of(name: str) -> World:
    """An embedded scene with its trees, which what is changed here leaves as they are."""
    return scenes.world_of(embedded_scenes()[name], BVH8)


@cache
def frame_of(of: OfMethod) -> Frame:
    return of.frame(world_of(of.scene))


def off(golden: Golden, frame: Frame) -> dict[str, Difference]:
    """How each view of a frame differs from its golden picture, by what the view shows."""
    found = {}
    for name, made in golden.views(frame):
        expected = golden_picture(name)
        assert expected is not None, f"there is no golden picture {name}; make golden makes it"
        found[name.removeprefix(f"{golden.name}-")] = Difference.between(expected, made)
    return found


def views_out_of_tolerance(golden: Golden, frame: Frame) -> set[str]:
    return {view for view, difference in off(golden, frame).items() if not difference.tolerated(golden.stray)}


@pytest.mark.parametrize("golden", GOLDEN, ids=lambda g: g.name)
def test_the_embedded_scenes_look_as_they_did(golden: Golden) -> None:
    world = world_of(golden.scene)
    faults = [
        fault(name, made, golden.stray, FAULTY) for name, made in golden.views(golden.frame(world.scene, world=world))
    ]
    assert not any(faults), "\n" + "\n".join(filter(None, faults))


@pytest.mark.parametrize("of", OF_METHODS, ids=lambda of: f"{of.name}-{of.method}")
def test_what_methods_show_looks_as_it_did(of: OfMethod) -> None:
    found = fault(of.name, of.picture(frame_of(of)), of.stray, FAULTY)
    assert found is None, f"\n{found}"


def test_what_a_light_sees_looks_as_it_did() -> None:
    found = fault("light-cube", light_cube(), 60, FAULTY)
    assert found is None, f"\n{found}"


def test_a_slice_in_another_layer_is_found_out() -> None:
    of = OF_METHODS[0]
    expected, other = golden_picture(of.name), replace(of, cut=of.cut._replace(at=0.3)).picture(frame_of(of))
    assert expected is not None and not Difference.between(expected, other).tolerated(of.stray)


def test_every_golden_picture_is_looked_at() -> None:
    expected = {
        f"{g.name}-{view}.png" for g in GOLDEN for view in ("color", "occlusion", *(f"shadow-{x}" for x in g.lights))
    }
    expected |= {f"{g.name}-{view.value}.png" for g in GOLDEN for view in g.fates}
    expected |= {f"{of.name}.png" for of in OF_METHODS} | {"light-cube.png"}
    assert {path.name for path in FOLDER.glob("*.png")} == expected


def with_last_bits_changed(scene: Scene) -> Scene:
    """Every coordinate of every triangle one float32 up or down, the same everywhere it occurs."""

    def nudged(corners: np.ndarray) -> np.ndarray:
        up = (corners.view(np.uint32) * np.uint32(2654435761)) >> np.uint32(31)
        return np.nextafter(corners, np.where(up, np.float32(np.inf), np.float32(-np.inf)))

    objects = [replace(o, triangles=replace(o.triangles, corners=nudged(o.triangles.corners))) for o in scene.objects]
    return replace(scene, objects=tuple(objects))


@pytest.mark.parametrize("golden", GOLDEN, ids=lambda g: g.name)
def test_other_last_bits_stay_well_within_the_tolerance(golden: Golden) -> None:
    frame = golden.frame(with_last_bits_changed(world_of(golden.scene).scene))
    for view, difference in off(golden, frame).items():
        assert difference.tolerated(golden.stray // 2), f"{view}: {difference}"


@pytest.mark.parametrize("golden, metres", [(STUDY, 0.01), (FIGURE3, 0.01), (FIGURE4, 0.1)], ids=lambda x: str(x))
def test_a_light_moved_a_little_is_found_out(golden: Golden, metres: float) -> None:
    world = world_of(golden.scene)
    light, *others = world.scene.lights
    x, y, z = light.position
    moved = replace(world.scene, lights=(replace(light, position=(x + metres, y, z)), *others))
    assert "color" in views_out_of_tolerance(golden, golden.frame(moved, world=world))


def test_a_picture_brighter_by_one_level_is_found_out() -> None:
    made = golden_picture("figure3-color")
    assert made is not None
    assert not Difference.between(made, made + np.uint8(1)).tolerated(made.size)


@pytest.mark.parametrize("golden", [STUDY, FIGURE3], ids=lambda g: g.name)
def test_culling_that_takes_no_notice_of_what_is_hidden_is_found_out(golden: Golden, monkeypatch) -> None:
    """With an occlusion test that finds nothing, everything in view counts as seen whole."""
    right = tracer.culling.mode_history.set_occlusion_modes

    def blind(words, hidden, *rest):
        right(words, np.zeros_like(hidden), *rest)

    monkeypatch.setattr(tracer.culling.mode_history, "set_occlusion_modes", blind)
    world = world_of(golden.scene)
    wrong = views_out_of_tolerance(golden, golden.frame(world.scene, world=world))
    assert "occlusion" in wrong
    assert golden is not STUDY or "color" in wrong


def test_culling_that_never_looks_again_is_found_out() -> None:
    """Without the zoom factor the shadow in the fourth figure is never seen."""
    world = world_of("figure4")
    frame = FIGURE4.frame(world.scene, replace(SETTINGS, zoom_factor=1e6), world)
    assert views_out_of_tolerance(FIGURE4, frame) == {"color", "occlusion", "shadow-0"}


def test_culling_that_does_nothing_is_found_out() -> None:
    world = world_of("figure4")
    frame = BEFORE.frame(world.scene, replace(SETTINGS, method="none", modes=True), world)
    assert "color" in views_out_of_tolerance(BEFORE, frame)


def test_what_is_wrong_is_written_and_said(tmp_path: Path) -> None:
    golden = golden_picture("figure3-color")
    assert golden is not None
    made = golden.copy()
    made[10:12, 20:23] ^= 0x40
    assert fault("figure3-color", golden, 2, tmp_path) is None
    assert not any(tmp_path.iterdir())
    said = fault("figure3-color", made, 2, tmp_path / "new")
    assert said is not None and "6 pixels" in said and "make golden" in said
    for name in ("figure3-color.png", "figure3-color-difference.png"):
        assert str(tmp_path / "new" / name) in said
        assert (tmp_path / "new" / name).exists()
