"""Frames traced once more, one after another, by the window's own renderer, so that it knows what it knew then."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tracer.frame import Frame, Settings
from tracer.renderer import Renderer
from tracer.scene.model import Camera, Scene
from viewer.services.render_request import RenderRequest, Traced
from viewer.services.runs import Run
from viewer.state.views import View


@dataclass(frozen=True)
class Past:
    """A frame to be traced once more."""

    time: float
    camera: Camera
    settings: Settings


class Replay(Run[int]):
    """Forgets all modes, and traces the frames; `results` is how many.  What they have taught is taken by
    `take_traced`."""

    name = "replay"
    endings = ()

    def __init__(self, scene: Scene, frames: Sequence[Past], wake: Callable[[], None] = lambda: None) -> None:
        super().__init__(scene, max(len(frames), 1), wake)
        self._frames = tuple(frames)
        self._traced: list[Traced] = []
        self._taking = threading.Lock()
        self._has_reset = False

    def lacks(self, view: View) -> str:
        return "traces what was seen before"

    @property
    def verifies(self) -> bool:
        return False

    def take_reset(self) -> bool:
        """Whether it has forgotten all modes since the last time; what it traced comes after that."""
        with self._taking:
            reset, self._has_reset = self._has_reset, False
            return reset

    def take_traced(self) -> list[Traced]:
        """The frames that were traced since the last time, without their pictures."""
        with self._taking:
            traced, self._traced = self._traced, []
            return traced

    def _steps(self, scene: Scene, renderer: Renderer, cancelled: Callable[[], bool]) -> Iterator[int]:
        renderer.reset_modes()
        with self._taking:
            self._has_reset = True
        for number, past in enumerate(self._frames):
            accelerator = renderer.world.accelerator
            renderer.settings = replace(past.settings, samples=1, accelerator=accelerator)
            frame = renderer.render(past.time, past.camera, cancelled)
            request = RenderRequest(frame.time, frame.camera, frame.settings)
            with self._taking:
                self._traced.append(Traced(request, _without_picture(frame), frame.statistics))
            self._count(f"frame {number + 1} of {len(self._frames)}")
            self._show(frame, wait=False)
            yield self.traced
        if not self._frames:
            self._count("nothing comes before it")
            yield 0

    def write(self, results: int, path: Path) -> None:
        raise ValueError("a replay has nothing to save")


def _without_picture(frame: Frame) -> Frame:
    """What teaches and counts, without what takes room."""
    nothing = np.empty((0, 0, 3), np.float32)
    return replace(
        frame, color=nothing, normal=nothing, depth=nothing[..., 0], reference=None, wrong=None, asked=None,
        reached=None, saved=None, cost=None, due_rays=None, layers={}, structures={},
    )  # fmt: skip
