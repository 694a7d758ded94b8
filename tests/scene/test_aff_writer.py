"""A scene that is written is the same when it is read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.sweeps import cases
from tracer.editing.edits import Edits, edited
from tracer.scene.aff_writer import aff_text
from tracer.scene.load import load_scene
from tracer.scene.model import Scene
from viewer.util.resources import embedded_scenes

MOVING = """\
v from 0 0 5 at 0 0 0
a 1 4 10
k still { transl 4 -1 0 0 0 0 0 0  0 0 0 0 0 0 0  9 1 0 2 0 0 0  10 1 0 0 0 0 0  visibility 1 2 1
  rot 4 -1 1 1 0 0 0 0 0  0 1 1 0 20 0 0 0  9 0 1 0 170 0 0.5 0  10 0 1 0 180 0 0 0 }
la still 1 2 3 0.1 0.2 0.3
lamp dome at 0 5 0 radius 2 up 1 1 0 samples 4 color 1 2 3 falloff inverse-square name dome
fm 0.1 0.1 0.1 0.7 0.6 0.5 0.2 0.2 0.2 3 0.25 1.3
x fixed { xs 1 -2 0.5 1 2 3 190 0.1 0.2 0.3 { s 0 1 0 -0.5 c 0 0 0 0.5 1 1 1 0.1
  pp 3 0 0 0 1 0 0  1 0 0 0 1 0  0 1 0 0 0 1 } }
xs 1 2 3 0 0 1 180 1 0 0 { x still { xs 2 -1 1 1 0 0 33 0 0 1 { x still { p 3 0 0 0 1 0 0 0 1 0  s 0 0 0 1 } } } }
x still { tpa 2 1 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1  3 0 0 0 0 0 1 2 0 0 0 0 1 0 2 0 0 0 1 }
"""


def again(scene: Scene, folder: Path) -> Scene:
    path = folder / "again.aff"
    path.write_text(aff_text(scene))
    return load_scene(path)


def check_same(one: Scene, other: Scene) -> None:
    assert other.warnings == () and one.primitive_count == other.primitive_count
    assert (one.time_range, one.frames, one.ambient, one.background) == (
        other.time_range, other.frames, other.ambient, other.background,
    )  # fmt: skip
    assert [replace(light, name="") for light in one.lights] == [replace(light, name="") for light in other.lights]
    shown = [o for o in one.objects if len(o.triangles) or len(o.quadrics) or o is one.objects[0]]
    for here, there in zip(shown, other.objects, strict=True):
        assert np.array_equal(here.triangles.corners, there.triangles.corners)
        assert np.allclose(here.triangles.normals, there.triangles.normals, atol=1e-5)
        for time in np.linspace(*one.time_range, 4):
            place, again = one.animation.matrix(here.chain, time), other.animation.matrix(there.chain, time)
            assert np.allclose(place, again, rtol=1e-9, atol=1e-9)
            assert one.animation.visible(here.chain, time) == other.animation.visible(there.chain, time)
        forms = [
            q.to_object[:, :, :3] @ q.to_object[:, :, :3].transpose(0, 2, 1) for q in (here.quadrics, there.quadrics)
        ]
        assert np.allclose(*forms) and np.allclose(here.quadrics.to_object[:, :, 3], there.quadrics.to_object[:, :, 3])
        assert np.array_equal(here.quadrics.inside, there.quadrics.inside)
        assert (here.deformation is None) == (there.deformation is None)
    for number in range(0, one.primitive_count, max(1, one.primitive_count // 99)):
        assert replace(one.material_of(number), name="") == replace(other.material_of(number), name="")
        assert one.name_of(number) == other.name_of(number)


@pytest.mark.parametrize("name", cases(["figure4"], ["figure4", "courtyard", "default"]))
def test_scenes_of_the_program(name: str, tmp_path: Path) -> None:
    scene = load_scene(embedded_scenes()[name])
    check_same(scene, again(scene, tmp_path))


def test_transforms_tracks_and_lamps(tmp_path: Path) -> None:
    path = tmp_path / "moving.aff"
    path.write_text(MOVING)
    scene = load_scene(path)
    assert len(scene.objects) == 3 and scene.lights[0].track == "still"
    check_same(scene, again(scene, tmp_path))
    freed = again(edited(scene, Edits(moving=frozenset(["fixed"]))).scene, tmp_path)
    assert len(freed.objects) == 4, "what could move stays no part of what never moves"
