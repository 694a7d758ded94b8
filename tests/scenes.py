"""Scenes from files, each read once for all tests of a process: none of them changes a scene in place."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import tracer
from tracer.scene.load import load_scene


@cache
def loaded(path: Path) -> tracer.Scene:
    return load_scene(path)


@cache
def world_of(path: Path, accelerator: str) -> tracer.World:
    """A scene with its trees: each frame puts in place what it shows, whatever was shown before."""
    return tracer.World(loaded(path), accelerator=accelerator)
