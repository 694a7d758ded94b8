"""A controller at work without a window, as far as runs go."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from tracer.frame import Frame
from tracer.renderer import Renderer
from tracer.scene.load import load_scene, scene_info
from tracer.scene.model import Camera
from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.services.runs import ExperimentPlan
from viewer.state.preferences import Preferences
from viewer.window.app import advance

SIZE = (64, 48)
ELSEWHERE = Camera((0.0, 2.0, 8.0), (0.0, -0.2, -1.0))


class Desk:
    """A controller at work on a scene in a file, without a window."""

    def __init__(self, path: Path, folder: Path) -> None:
        preferences = Preferences(
            state={"pace": {"progressive": False}, "settings": {"samples": 1, "threads": 1}},
            screenshot_folder=str(folder),
        )
        self.c = Controller(preferences)
        self.runs = self.c.runs
        self.came: list[Frame] = []
        self.open(path)
        self.runs.experiment_plan = ExperimentPlan({"paper"}, frames=5, size=(32, 24), depth=1)
        self.runs.zoom_plan = replace(self.runs.zoom_plan, steps=4, size=(32, 24))

    def open(self, path: Path) -> None:
        scene = load_scene(path)
        self.c.show(Renderer(scene, self.c.session.settings), scene_info(scene))
        self.rest()

    def tick(self) -> None:
        before = self.c.frame
        advance(self.c, SIZE)
        if self.c.frame is not None and self.c.frame is not before:
            self.came.append(self.c.frame)
        time.sleep(0.001)

    def until(self, happens: Callable[[], object]) -> None:
        end = time.monotonic() + 60.0
        while not happens():
            assert time.monotonic() < end, f"waited in vain; the status says {self.c.notices.message}"
            self.tick()

    def rest(self) -> None:
        quiet = 0

        def rested() -> bool:
            nonlocal quiet
            rests = not self.c.active and self.c.scheduler.activity is Activity.RESTING  # all samples have come
            quiet = quiet + 1 if rests else 0
            return quiet > 10

        self.until(rested)

    def run_to_its_end(self) -> None:
        self.until(lambda: self.runs.current is None)
        self.rest()

    @property
    def said(self) -> str:
        assert self.c.notices.message is not None
        return self.c.notices.message.text


def is_the_same_picture(one: Frame, other: Frame) -> bool:
    """Of the same place, traced alike."""
    same = (one.time, one.camera, one.settings) == (other.time, other.camera, other.settings)
    return same and np.array_equal(one.primitive, other.primitive)
