"""Lights are found by their names, and told in words."""

from __future__ import annotations

import pytest

from tracer.scene.lights import Light
from viewer.window.panels.lights import description, matching

LIGHTS = (
    Light("Desk lamp", (1.0, 2.0, 3.0), kind="sphere", radius=0.125, samples=16),
    Light("Window", (0.0, 0.0, 0.0), kind="rectangle", edges=((2.0, 0.0, 0.0), (0.0, 3.0, 4.0)), samples=64),
    Light("lamp 2 of the hall", (0.0, 0.0, 0.0), falloff="inverse square"),
)


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("", [0, 1, 2]), (" lamp", [0, 2]), ("LAMP hall", [2]), ("rectangle", [1]), ("1", [1]), ("light 0", [0]),
     ("7", []), ("nothing", [])],
)  # fmt: skip
def test_lights_are_found_by_words_and_by_number(text: str, numbers: list[int]):
    assert list(matching(LIGHTS, text)) == numbers


def test_a_light_is_told_in_words():
    sphere, rectangle, point = map(description, LIGHTS)
    assert sphere.startswith("sphere of radius 0.125, 16 samples; no falloff; at (1, 2, 3)")
    assert rectangle.startswith("rectangle of 2 x 5, 64 samples; no falloff")
    assert point.startswith("point; falls off with the square of the distance; at")
