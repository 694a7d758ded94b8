"""A frame that begins with the modes of another's beginning is that frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.scenes import loaded
from viewer.util.resources import embedded_scenes

SETTINGS = tracer.Settings(48, 40, depth=1, threads=2)


@pytest.mark.parametrize("method", ["paper", "cells"])
def test_a_frame_that_begins_with_the_modes_of_another_is_the_same_and_examines_nothing_anew(method: str) -> None:
    scene = loaded(embedded_scenes()["default"])
    settings = replace(SETTINGS, method=method)
    taught, other = tracer.Renderer(scene, settings), tracer.Renderer(scene, settings)
    for number in range(4):
        frame = taught.render(1.0 + number / 30.0)
    other.render(4.0)  # is forgotten, with where its lights were
    assert other.units == len(frame.modes)
    other.begin_with(frame.modes_before)
    again = other.render(frame.time)
    assert np.array_equal(again.modes_before, frame.modes_before) and np.array_equal(again.color, frame.color)
    assert again.statistics.shadow == frame.statistics.shadow and frame.statistics.shadow.saved > 0
    assert again.statistics.mode_changes is not None and again.statistics.mode_changes.examined_anew == 0
    assert np.array_equal(again.modes, frame.modes)


def test_modes_of_another_size_are_refused_and_nothing_is_forgotten() -> None:
    renderer = tracer.Renderer(loaded(embedded_scenes()["default"]), SETTINGS)
    for _ in range(2):
        frame = renderer.render(1.0)
    for modes in (frame.modes[:-1], frame.modes.astype(np.uint64)):
        with pytest.raises(ValueError, match="modes are [0-9,]+ of uint32, not"):
            renderer.begin_with(modes)
    assert renderer.render(1.0).statistics.shadow.saved > 0
