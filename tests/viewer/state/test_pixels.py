"""Pixels that are watched belong to a scene."""

from __future__ import annotations

from pathlib import Path

from viewer.state.pixels import Pixels, Region


def test_another_scene_is_not_watched_where_the_last_one_was() -> None:
    pixels = Pixels()
    pixels.enter(Path("kitchen.aff"))
    pixels.watched.append((0.25, 0.5))
    pixels.region = Region(0.0, 0.0, 0.5, 0.5)
    pixels.enter(Path("kitchen.aff"))  # as when its file has changed
    assert pixels.watched and pixels.region is not None
    pixels.enter(Path("robot.aff"))
    assert not pixels.watched and pixels.region is None
