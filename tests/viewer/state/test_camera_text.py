"""Cameras as text of other programs, and back."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from tracer.scene.model import Camera
from viewer.state.camera_text import as_embree, as_json, as_pbrt, read

NOW = Camera((0.0, 0.0, 5.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 40.0)
FAR = Camera((-1234.5678, 0.25, 1e-3), (0.3, -0.2, 0.9), (0.1, 1.0, 0.0), 57.25)


def rays(camera: Camera) -> np.ndarray:
    return np.vstack([camera.position, camera.basis(), np.full(3, camera.angle)])


@pytest.mark.parametrize("aspect", [1.6, 1.0, 0.5])
@pytest.mark.parametrize("camera", [NOW, FAR])
def test_a_camera_comes_back_as_it_was(camera: Camera, aspect: float):
    for text, kind in ((as_json(camera), "JSON"), (as_pbrt(camera, aspect), "pbrt's statements"),
                       (as_embree(camera), "Embree's arguments")):  # fmt: skip
        pasted = read(f"\n{text}\n", Camera((9.0, 9.0, 9.0), (1.0, 0.0, 0.0)), aspect)
        assert pasted.kind == kind and pasted.unused == ()
        assert np.allclose(rays(pasted.camera), rays(camera), rtol=0.0, atol=1e-7)


def test_json_is_what_the_command_line_takes():
    assert Camera.from_json(json.loads(as_json(FAR))) == FAR


def test_pbrt_sees_the_same_picture():
    """Its own arithmetic: a point seen at the right of our picture is at the right of its picture, as far out."""
    lines = as_pbrt(FAR, 2.0).split("Camera")[0]
    assert lines.startswith("Scale -1 1 1")
    eye, at, up = np.array([float(x) for x in lines.split("LookAt")[1].split()]).reshape(3, 3)
    forward = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(up / np.linalg.norm(up), forward)  # pbrt's, which Scale -1 1 1 turns around
    hand, head, view = FAR.basis()
    point = np.asarray(FAR.position) + 3.0 * view + 0.5 * hand + 0.25 * head
    x = -(point - eye) @ (right / np.linalg.norm(right)) / ((point - eye) @ forward)
    assert x == pytest.approx(0.5 / 3.0, abs=1e-7)


def test_the_angle_of_pbrt_is_that_of_the_shorter_side():
    half = math.tan(math.radians(20.0))
    text = 'LookAt 0 0 5  0 0 0  0 1 0\nCamera "perspective" "float fov" 40'
    assert read(text, NOW, 2.0).camera.angle == pytest.approx(40.0)
    assert read(text, NOW, 0.5).camera.angle == pytest.approx(math.degrees(2.0 * math.atan(2.0 * half)))
    film = text + '\nFilm "rgb" "integer xresolution" [100] "integer yresolution" [200]'
    assert read(film, NOW, 2.0).camera.angle == pytest.approx(math.degrees(2.0 * math.atan(2.0 * half)))


def test_what_could_not_be_used_is_told():
    text = (
        "Rotate 5 0 0 1  # tilted\nLookAt 0 0 5\n 0 0 0\n 0 1 0\n"
        'Camera "perspective" "float fov" [ 30 ] "float lensradius" [ 0.1 ] "float focaldistance" [ 3 ]'
    )
    unused = read(text, NOW, 1.0).unused
    assert unused[:3] == ("lensradius", "focaldistance", "Rotate") and "Scale -1 1 1" in unused[3]
    pasted = read("viewer -c scene.ecs --vp 1 2 3 --vi 1 2 0 --size 512 512 --fov 33", NOW, 1.0)
    assert pasted.unused == ("-c", "--size") and pasted.camera.up == NOW.up
    assert (pasted.camera.position, pasted.camera.direction, pasted.camera.angle) == ((1, 2, 3), (0, 0, -1), 33)
    assert read('{"position": [1, 2, 3], "lens": 4}', NOW, 1.0).unused == ("lens",)
    assert 'Camera "orthographic"' in read('LookAt 0 0 5 0 0 0 0 1 0 Camera "orthographic"', NOW, 1.0).unused


def test_what_is_left_open_stays():
    assert read("--fov 20 --vp 1 1 1", NOW, 1.0).camera == Camera((1.0, 1.0, 1.0), NOW.direction, NOW.up, 20.0)
    assert read("-vp 1 1 1 -vd 1 0 0 -vu 0 0 1", NOW, 1.0).camera == Camera((1, 1, 1), (1, 0, 0), (0, 0, 1), 40.0)
    assert read("--fov 33", NOW, 1.0).camera.angle == 33.0
    assert read('{"camera": {"position": [1, 2, 3]}}', NOW, 1.0).camera.direction == NOW.direction
    assert read("LookAt 1 0 5 1 0 0 0 1 0", NOW, 1.0).camera.angle == NOW.angle
    assert read('Camera "perspective"', NOW, 1.0).camera.angle == pytest.approx(90.0), "pbrt's own"


@pytest.mark.parametrize(
    "text",
    [
        "", "hello", "{", "[1, 2]", '{"lens": 1}', '{"position": [1, 2]}', "--vp 1 2", "--vp a b c",
        "--fov nan --vp 0 0 0", "--vp 1 1 1 --vi 1 1 1", "LookAt 1 2 3", "LookAt 0 0 0 0 0 0 0 1 0",
        "--vp 0 0 0 --vi 0 0 1 --vu 0 0 0",
        'Camera "perspective" "float fov" 190', "Scale 2 2 2", "--vp 1e99 0 0 --vi 0 0 0",
    ],
)  # fmt: skip
def test_anything_else_is_one_line(text: str):
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        read(text, NOW, 1.0)
