"""Lights: what they may be, and where their samples lie."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tracer.scene.lights import DEFAULT_SAMPLES, Light, as_lamps, sobol

SPHERE = Light("lamp", (1.0, 2.0, 3.0), kind="sphere", radius=2.0, samples=64)
PANEL = Light("panel", (0.0, 0.0, 0.0), kind="rectangle", edges=((2.0, 0.0, 0.0), (0.0, 4.0, 0.0)), samples=64)
DOME = Light("sky", (0.0, 0.0, 0.0), kind="dome", radius=10.0, edges=((0.0, 3.0, 4.0),), samples=256)


@pytest.mark.parametrize("count", [4, 16, 64, 1024])
def test_every_division_of_the_square_has_as_many_samples(count: int):
    """A (0, m, 2)-net: each way to cut the square into `count` equal boxes by halving puts one sample into each."""
    points, halvings = sobol(count), count.bit_length() - 1
    for across in range(halvings + 1):
        boxes = np.floor(points * [2**across, 2 ** (halvings - across)]).astype(int)
        assert len({tuple(box) for box in boxes}) == count


def test_samples_lie_on_the_lamp_and_are_spread_evenly():
    on_sphere = SPHERE.offsets()
    assert np.allclose(np.linalg.norm(on_sphere, axis=1), 2.0)
    assert np.abs(on_sphere.mean(axis=0)).max() < 0.15
    on_panel = PANEL.offsets()
    assert (np.abs(on_panel) <= [1.0, 2.0, 0.0]).all() and len(np.unique(on_panel, axis=0)) == 64
    for axis, half in ((0, 1.0), (1, 2.0)):
        assert np.histogram(on_panel[:, axis], 4, (-half, half))[0].tolist() == pytest.approx([16] * 4, abs=1)
    on_dome = DOME.offsets()
    up = np.array([0.0, 0.6, 0.8])
    assert np.allclose(np.linalg.norm(on_dome, axis=1), 10.0) and (on_dome @ up >= -1e-9).all()
    assert np.allclose(on_dome.mean(axis=0), 5.0 * up, atol=0.3), "the centre of a half of a sphere is half way up"


def test_a_lamp_keeps_its_samples_and_shares_the_first_of_them_with_fewer():
    assert (SPHERE.offsets() == SPHERE.offsets()).all()
    assert (replace(SPHERE, samples=16).offsets() == SPHERE.offsets()[:16]).all()
    assert (replace(SPHERE, name="another").offsets() != SPHERE.offsets()).any(), "lamps do not repeat one another"


def test_a_single_sample_is_the_middle():
    for lamp in (SPHERE, PANEL):
        assert replace(lamp, samples=1).offsets().tolist() == [[0.0, 0.0, 0.0]]
    assert replace(DOME, samples=1).offsets() == pytest.approx(np.array([[0.0, 6.0, 8.0]]))


def test_points_become_lamps_and_spheres_points_again():
    point = Light("point", (0.0, 0.0, 5.0))
    lamp, panel = as_lamps((point, PANEL), 0.5, 16)
    assert (lamp.kind, lamp.radius, lamp.samples) == ("sphere", 0.5, 16)
    assert panel == replace(PANEL, samples=16), "a rectangle has no radius"
    assert as_lamps((lamp, point), 0.0, None) == (replace(point, name="point"), point)
    assert as_lamps((point, SPHERE, PANEL), None, None) == (point, SPHERE, PANEL)
    assert as_lamps((point,), None, 64) == (point,), "a point has no surface to take samples of"
    (alone,) = as_lamps((point,), 0.5, None)
    assert alone.samples == DEFAULT_SAMPLES, "a radius alone makes shadows soft"
    assert as_lamps((SPHERE,), 0.5, None) == (replace(SPHERE, radius=0.5),), "a sphere keeps its samples"


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"kind": "tube"}, "kind is one of"),
        ({"falloff": "linear"}, "falloff is one of"),
        ({"samples": 0}, "1 to 1024 samples"),
        ({"samples": 1025}, "1 to 1024 samples"),
        ({"radius": -1.0}, "radius is 0 or more"),
        ({"radius": float("nan")}, "radius is 0 or more"),
        ({"kind": "rectangle"}, "2 edges, not 0"),
        ({"kind": "point"}, "a point has one sample"),
    ],
)
def test_what_cannot_be_a_light_is_refused(wrong: dict, message: str):
    with pytest.raises(ValueError, match=message):
        replace(SPHERE, **wrong)
