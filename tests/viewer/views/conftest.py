"""What tests of views share: a frame that holds whatever any of them shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.commands import ROOM
from tests.viewer.fakes import with_everything
from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.load import load_scene


@pytest.fixture(scope="package")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    """The third frame of a small scene, with a sphere that hides a part of the floor and a triangle that moves."""
    path = tmp_path_factory.mktemp("pictures") / "scene.aff"
    path.write_text(ROOM)
    renderer = Renderer(load_scene(path), Settings(width=96, height=64, threads=1))
    return [renderer.render(time) for time in (1.0, 2.0, 3.0)][-1]


@pytest.fixture(scope="package")
def frame(plain: Frame) -> Frame:
    """The same with all else by lot: cells and their certificates, work, lamps, fates, clusters, voxels, a tree; and
    with wrong answers at a pixel alone, two in corners, and a block, whose colours differ."""
    wrong = np.zeros((plain.height, plain.width), np.int32)
    wrong[20, 30] = 1
    wrong[0, 0] = wrong[-1, -1] = 2
    wrong[40:46, 60:75] = 3
    reference = plain.color.copy()
    reference[wrong > 0] = 1.0 - reference[wrong > 0]
    verified = replace(plain, settings=replace(plain.settings, verify=True), wrong=wrong, reference=reference)
    return with_everything(verified)
