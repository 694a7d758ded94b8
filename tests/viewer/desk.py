"""A controller at work without a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from tracer.editing.edits import Edits
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

    def until(self, happens: Callable[[], object], ticks: int = 1) -> None:
        """Go on until it happens, and has for so many ticks."""
        end, held = time.monotonic() + 60.0, 0
        while held < ticks:
            held = held + 1 if happens() else 0
            assert time.monotonic() < end, f"waited in vain; the status says {self.c.notices.message}"
            if held < ticks:
                self.tick()

    def rest(self) -> None:
        """Go on until all is loaded, edited, traced with all its samples, and written."""
        c = self.c
        self.until(lambda: not (c.active or c.editing.under_way) and c.scheduler.activity is Activity.RESTING, ticks=11)

    def edit(self, edits: Edits) -> None:
        """Have the scene edited, and wait for the picture of it."""
        self.c.editing.change(edits)
        self.rest()

    def run_to_its_end(self) -> None:
        self.until(lambda: self.runs.current is None)
        self.rest()

    @property
    def said(self) -> str:
        assert self.c.notices.message is not None
        return self.c.notices.message.text


def place_of(c: Controller, lit: bool, near: int = 4) -> tuple[float, float]:
    """A pixel of the square that all lights which are due reach, or not all of them, and so those `near` it."""
    renderer = Renderer(c.session.scene, replace(c.frame.settings, method="none", record_lights=True))
    frame = renderer.render(c.frame.time, c.frame.camera)
    here = (frame.primitive >= 0) & (frame.primitive < c.session.scene.triangle_count)
    here &= (frame.lit == frame.due).all(-1) if lit else (frame.due & ~frame.lit).any(-1)
    inner = here.copy()
    for shift in (-near, near):
        inner &= np.roll(here, shift, 0) & np.roll(here, shift, 1)
    y, x = np.argwhere(inner)[inner.sum() // 2]
    return (x + 0.5) / frame.width, (y + 0.5) / frame.height


def is_the_same_picture(one: Frame, other: Frame) -> bool:
    """Of the same place, traced alike."""
    same = (one.time, one.camera, one.settings) == (other.time, other.camera, other.settings)
    return same and np.array_equal(one.primitive, other.primitive)
