"""Figure 1 of the paper as a list of phases: `Renderer.render`.

The phases see whole frames (`tracer.frame_in_progress`), the kernels below them tiles or rows.  Culling decisions read
the modes as the last frame left them, and whatever threads learn is merged by OR and by sums of integers, so that
pictures, modes and counters are the same for any number of threads and on every run.
"""

from __future__ import annotations

import time as clocks
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULLY_RENDERED, occlusion_mode, word_type
from tracer.frame import Frame
from tracer.frame_in_progress import Cancel, FrameInProgress
from tracer.geometry.world import World
from tracer.methods.interface import ShadowMethod
from tracer.neighbours.certified.cost_model import CostModel
from tracer.progressive import LEVELS, after
from tracer.scene.model import Camera, Progress, Scene
from tracer.settings import Settings
from tracer.shading.blocks import TURNS
from tracer.state import State, open_world


class Renderer:
    """Renders a scene frame by frame, and remembers modes and certificates between frames.

    `settings` may be replaced between frames. If they name another accelerator, the renderer builds another world,
    unless the world was given: then its accelerator is used, and `Frame.settings` says so.

    Parameters
    ----------
    scene : Scene
        What to render.
    settings : Settings, optional
        How to render it.
    progress : callable, optional
        Called with what is done and the fraction done, while trees are built; it may raise Cancelled.
    world : World, optional
        The geometry of the scene. Several renderers may share one, as long as they take turns.
    clock, thread_clock : callable
        Give the seconds that time frames, and the seconds of the calling thread that budget certificates.
    cost_model : CostModel, optional
        What certificates are worth, instead of what is usual for the accelerator.

    Raises
    ------
    ValueError
        If a setting is out of range.
    Cancelled
        If `progress` raises it.
    """

    def __init__(
        self,
        scene: Scene,
        settings: Settings | None = None,
        progress: Progress | None = None,
        world: World | None = None,
        *,
        clock: Callable[[], float] = clocks.perf_counter,
        thread_clock: Callable[[], float] = clocks.thread_time,
        cost_model: CostModel | None = None,
    ) -> None:
        self.settings = (settings or Settings()).validated()
        self._shared, self._measures = world is not None, (clock, thread_clock, cost_model)
        self.world = world or open_world(scene, self.settings, progress)
        self.state = State(scene, self.world, *self._measures)
        self._turn = 0
        self._last: Sequence[ShadowMethod] = ()
        self._unfinished: FrameInProgress | None = None
        # (units,) the pixels that each covered when it was examined last, as the last frame found them.
        self.highest_before: NDArray[np.int32] = np.empty(0, np.int32)
        self._done: FrameInProgress | None = None

    @property
    def scene(self) -> Scene:
        """What is rendered: may be exchanged for a scene of the same objects and lights that moves them otherwise."""
        return self.state.scene

    @scene.setter
    def scene(self, scene: Scene) -> None:
        self.state.scene = scene

    def reset_modes(self) -> None:
        """Forget all modes, at every resolution, and everything that methods have learnt."""
        self.state.forget()

    @property
    def units(self) -> int:
        """How many units carry modes by these settings: primitives, or cells of them."""
        first = self.state.method(self.settings.method).first_units()
        return int(first[-1]) if len(first) else self.scene.primitive_count

    def begin_with(self, modes: NDArray[np.unsignedinteger]) -> None:
        """Forget all modes and what methods have learnt, and let the next frame begin with these modes.

        It is by these settings that they are taken. A picture depends on no more than its modes before it, if its
        method learns nothing else. Over how many pixels a unit has been examined they do not tell: none of them is
        examined anew, and the modes that later frames leave may differ from those that were.

        Parameters
        ----------
        modes : (units,) uint32 or uint64
            Such as `Frame.modes_before` of a picture by the same settings.

        Raises
        ------
        ValueError
            If the scene has not so many units, or its lights have modes of another size.
        """
        words = word_type(len(self.scene.lights))
        if modes.shape != (self.units,) or modes.dtype != words:
            raise ValueError(f"modes are {self.units:,} of {np.dtype(words).name}, not {modes.shape} of {modes.dtype}")
        self.reset_modes()
        history = self.state.history(self.settings, self.state.method(self.settings.method).first_units(), 1)
        history.words[:] = modes
        history.highest_count[occlusion_mode(modes) == FULLY_RENDERED] = np.iinfo(history.highest_count.dtype).max

    def render(self, time: float = 0.0, camera: Camera | None = None, cancel: Cancel = None) -> Frame:
        """Render one frame.

        Parameters
        ----------
        time : float
            The moment to render, in seconds.
        camera : Camera, optional
            The scene's own camera at that time, if none is given.
        cancel : callable, optional
            Asked now and then; once it returns true, the frame ends.

        Returns
        -------
        Frame
            The picture with its buffers and statistics.

        Raises
        ------
        Cancelled
            If the frame was cancelled. The renderer has learnt nothing from it, except for certificates that it made
            while `Settings.certificate_seconds` limited the time for them.
        """
        frame = self.begin(time, camera, cancel)
        with _discarded_unless_done(frame):
            with frame.phase("place"):
                frame.place_objects_and_lights()
            with frame.phase("primary"):
                frame.trace_primary_rays()
            with frame.phase("occlusion testing"):
                frame.test_occlusion()
            with frame.phase("certification"):
                frame.prepare_culling()
            with frame.phase("shading"):
                frame.shade()  # with shadow testing and shadow-mode setting
            with frame.phase("mode setting"):
                frame.set_modes()
        return self._finished(frame)

    def refine(
        self,
        time: float = 0.0,
        camera: Camera | None = None,
        cancel: Cancel = None,
        parts: Sequence[float] = (1, 4, 8, 16),
        samples: int = 1,
        focus: tuple[float, float] | None = None,
    ) -> Generator[Frame, None, None]:
        """Render one picture step by step, finer each time.

        Each step shades more of the pixels, those first where it helps the most (`tracer.progressive`), and fills in
        the others from shaded pixels on the same surfaces. The whole picture is that of `render`, bit for bit. So are
        the modes that it leaves. A generator that is closed, or cancelled, before it leaves those that its last frame
        has: all primary rays have been traced, and shadow modes are set by the pixels that have been shaded
        (`tracer.culling.occlusion.set_occlusion_modes`). Frames with 2 to `samples` samples per pixel follow; the last
        is that of `render` with so many samples.

        Parameters
        ----------
        time, camera, cancel
            As for `render`.
        parts : sequence of float
            How many sixteenths of the pixels are shaded in each step, increasing up to 16.
        samples : int
            Samples per pixel of the last frame.
        focus : (float, float), optional
            A point of the picture, in parts of its width and height. Pixels near it come first.

        Yields
        ------
        Frame
            The picture so far.

        Raises
        ------
        ValueError
            If `parts` do not increase up to 16.
        Cancelled
            If the frame was cancelled. What the last frame that was yielded has taught stays.
        """
        if list(parts) != sorted(set(parts)) or not parts or parts[0] < LEVELS[0] or parts[-1] != TURNS:
            raise ValueError(f"parts increase from {LEVELS[0]} at least to {TURNS}")
        frame = self.begin(time, camera, cancel, replace(self.settings, samples=1), progressive=parts[0] < TURNS)
        frame.begin_at(focus)
        with _discarded_unless_done(frame):
            with frame.phase("place"):
                frame.place_objects_and_lights()
            with frame.phase("primary"):
                frame.trace_primary_rays()
            with frame.phase("occlusion testing"):
                frame.test_occlusion()
            with frame.phase("certification"):
                frame.prepare_culling()
            if parts[0] < TURNS:
                with frame.phase("surfaces"):
                    frame.see_surfaces(self._next_turn(parts[0]))
            for part in parts:
                frame.shade_part(part)
                if part < TURNS:
                    so_far = frame.so_far()
                    with frame.shown():
                        yield so_far
            with frame.phase("mode setting"):
                frame.set_modes()
        whole = self._finished(frame)
        yield whole
        yield from frame.sampled(whole, samples)

    def begin(
        self,
        time: float,
        camera: Camera | None = None,
        cancel: Cancel = None,
        settings: Settings | None = None,
        progressive: bool = False,
    ) -> FrameInProgress:
        """A frame whose phases are still to come."""
        settings = self._fitted((settings or self.settings).validated())
        camera = camera or self.scene.camera_at(time)
        if self._unfinished is not None:
            self._unfinished.discard()  # somebody has left it half done
        self._unfinished = frame = FrameInProgress(self.state, settings, camera, time, cancel, progressive)
        self._last, self._done = frame.methods, None
        self.highest_before = frame.history.highest_count
        return frame

    def _finished(self, frame: FrameInProgress) -> Frame:
        """The frame, all phases of which are done."""
        self._unfinished, self._done = None, frame
        return frame.finished()

    def work_on(self, frame: Frame, in_part: bool = False) -> FrameInProgress:
        """How the last frame was made, as long as no other has begun; `in_part` also one that is shaded in part so far.

        Raises
        ------
        LookupError
            If this is not the last frame, or not all of it.
        """
        for work in (self._done, self._unfinished if in_part else None):
            if work is not None and frame.primitive is work.buffers.primitive:
                return work
        raise LookupError("another frame has begun: what became of the rays of this one is no longer known")

    def _fitted(self, settings: Settings) -> Settings:
        """Let world and settings have the same accelerator."""
        if self._shared:
            return replace(settings, accelerator=self.world.accelerator)
        if settings.accelerator != self.world.accelerator:
            self.world = open_world(self.scene, settings)
            self.state = State(self.scene, self.world, *self._measures)
        return settings

    def _next_turn(self, part: float) -> int:
        """Whose turn it is first: consecutive pictures, of which so many sixteenths are shaded, begin at others."""
        self._turn = after(self._turn, part)
        return self._turn

    def beside(self) -> Renderer:
        """Make another renderer of the same world, with modes and counters of its own.

        Returns
        -------
        Renderer
            To be used in turn with this one, frame by frame; within a frame, each must first `take_turn`.
        """
        return Renderer(self.scene, self.settings, world=self.world)

    def take_scene(self, other: Renderer) -> None:
        """Let the next picture that is refined be of the scene of another renderer, and begin with the same pixels.

        Parameters
        ----------
        other : Renderer
            A renderer of the same world, whose next picture has not begun yet.
        """
        self.scene, self._turn = other.scene, other._turn

    def take_modes(self, other: Renderer) -> None:
        """Begin the next frame with the modes that another renderer of the same world knows now, of frames by the
        settings that this one has: of this size and with these lamps.

        Parameters
        ----------
        other : Renderer
            A renderer none of whose frames is under way. It is left as it is.
        """
        self.state.take_modes(other.state, self.settings)

    def take_turn(self, time: float) -> None:
        """Place the world once more as the frame that this renderer has begun needs it.

        Parameters
        ----------
        time : float
            The moment of that frame, in seconds.
        """
        self.world.place(self.world.pose(time), self.state.rest.now.since > 0)

    @property
    def memory_bytes(self) -> int:
        """Memory that the methods of the last frame hold, in bytes."""
        return sum(method.memory_bytes for method in self._last)


@contextmanager
def _discarded_unless_done(frame: FrameInProgress) -> Iterator[None]:
    """Learn nothing from a frame whose phases do not all come to an end."""
    try:
        yield
    except BaseException:
        frame.discard()
        raise
