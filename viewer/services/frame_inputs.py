"""What should be seen, and what follows from it for the next frame: its size, its settings, its time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from tracer.compiling.compilation import is_first
from tracer.experiments.runner import Run
from tracer.frame import Settings
from tracer.method import Method
from tracer.scene.model import Camera, Scene
from viewer.state.methods import NO_CULLING
from viewer.state.session import NOWHERE
from viewer.state.view_state import ViewState
from viewer.state.views import recording


@dataclass(frozen=True)
class FrameInputs:
    """What decides which frame comes next.

    The `state` that should be seen, of a `scene` (None: nothing is open) from a `camera`; the `size`, in pixels, that
    there is room for (0 where it is hidden); whether anything is `moving`, time is `playing`, and rays are to be
    counted in any view; the `run` that is under way, whether the scene is being `edited`, whether the kernels of all
    methods are `ready`, the `second` method that traces each frame once more (none where it is empty), the
    point of the picture that matters most, its `focus`, and whether time plays while a pixel is `inspected`, so that
    something is asked about each frame before the next may begin."""

    state: ViewState = field(default_factory=ViewState)
    scene: Scene | None = None
    camera: Camera = NOWHERE
    size: tuple[int, int] = (0, 0)
    moving: bool = False
    playing: bool = False
    counting: bool = False
    run: Run | None = None
    edited: bool = False
    ready: bool = True
    second: str = ""
    focus: tuple[float, float] | None = None
    inspected: bool = False

    @property
    def at_rest(self) -> bool:
        return not self.moving and not self.playing

    @property
    def full_size(self) -> tuple[int, int]:
        """The resolution at rest: the window's, or the fixed one (0, 0 while there is nowhere to show it)."""
        pace = self.state.pace
        return (pace.width, pace.height) if pace.fixed_size and min(self.size) > 0 else self.size

    @property
    def each_is_whole(self) -> bool:
        """Whether no frame is shown before all of it has been traced."""
        pace = self.state.pace
        return not pace.progressive or (self.playing and pace.every_frame)

    @property
    def frame_seconds(self) -> float:
        """That a frame may take until some of it is shown: half of it where each is traced twice."""
        return (0.5 if self.second else 1.0) / self.state.pace.target_fps

    @property
    def second_method(self) -> str:
        """The second method by which frames can be traced now."""
        return self._until_ready(self.second)

    @cached_property
    def settings(self) -> Settings:
        """What the user has set, with modes; verified, and with more recorded, where the view needs that and there is
        memory for it."""
        chosen, view, (width, height) = self.state.settings, self.state.draw.view, self.full_size
        lights = len(self.scene.lights) if self.scene is not None else 0
        method = self._until_ready(chosen.method)
        recorded = recording(view, width * height, lights)
        recorded["verify"] |= chosen.verify
        recorded["record_work"] |= self.counting
        return replace(
            chosen,
            **recorded,
            method=method,
            modes=not Method.parse(method).clusters,  # which would look at single lights for these alone
            certificate_seconds=self.state.pace.certificate_share * self.frame_seconds,
        )

    def _until_ready(self, method: str) -> str:
        """The method, or the one without culling until that has been compiled, if it comes after the first picture."""
        waits = bool(method) and not self.ready and not is_first(method)
        return NO_CULLING if waits else method
