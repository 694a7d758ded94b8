"""What a method is: a class with up to a dozen hooks, called in the order of a frame, and stages that are kernels.

    begin             what will this frame do?
    update            everything that moves has been placed: drop what no longer holds
    prepare           the primary hits are known: do what is worth doing before shading
    begin_shading     a pass over the tiles begins
    stages            what the kernels of each worker are given (`tracer.culling.stages`)
    keep, or discard  the frame is whole, or was cancelled: nothing half-learnt stays
    finish            the frame is done, with its statistics

Every hook does nothing unless a method says otherwise, so that a method names only what it needs.  To add one, write a
file like `tracer/methods/paper.py` and register a `tracer.method.Kind`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cells import primitives_are_units
from tracer.culling.mode_history import ModeHistory
from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.culling.rest import Resting
from tracer.culling.stages import COLUMNS, Stages
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.accelerators import MAX_PACKET_SIZE
from tracer.geometry.camera import Pinhole
from tracer.neighbours.certified.cost_model import CostModel
from tracer.runtime.kernels import NativeCallback
from tracer.shading.buffers import Buffers
from tracer.shading.shading_data import ShadingData
from tracer.simd.records import pack

if TYPE_CHECKING:
    from tracer.geometry.world import World
    from tracer.settings import Settings
    from tracer.statistics import FrameStatistics


@dataclass(frozen=True)
class Services:
    """What methods of a renderer are made with: the world, what shading reads, what certificates are worth, clocks
    (seconds that pass, and seconds of the calling thread on the processor), and the renderer's other methods by name,
    for those that are made of others."""

    world: World
    shading: ShadingData
    cost_model: CostModel
    clock: Callable[[], float]
    thread_clock: Callable[[], float]
    method: Callable[[str], ShadowMethod]


class FrameView(Protocol):
    """What methods see of a frame under way."""

    settings: Settings
    history: ModeHistory
    first: NDArray[np.int32]  # the first unit of each primitive (`tracer.culling.cells`)
    units: NDArray[np.int32]  # (height, width) the unit that each pixel sees, -1 for none
    words: NDArray[np.unsignedinteger]  # of all units, as the last frame left them
    rays: Pinhole
    tiles: NDArray[np.int64]  # (n, 5): left, top, right, bottom, number
    buffers: Buffers
    time: float  # the moment that is shown, in seconds
    sample: int  # of each pixel, which is being shaded: 0 for the first
    shading: ShadingData
    lights: NDArray[np.float32]  # (l, 3) their centres
    resting: Resting
    workers: int
    progressive: bool  # whether the picture is shown before all of it is shaded
    phases: dict[str, float]  # seconds, by the names of phases
    cancel: Callable[[], bool] | None

    @property
    def seconds(self) -> float:
        """Seconds since the frame began."""

    def rehearse(self, stages: list[Stage]) -> None:
        """Shade the whole picture with these stages alone, the same for all workers; nothing is shown or counted."""


@dataclass(frozen=True)
class Stage:
    """Kernels that take part in shadow testing, with the record that they are given: `tracer.culling.stages` says when
    each is called.  `rows` of memory, each with a number for every point, are the stage's own for as long as a wave
    lasts.  `occluders`: it wants to know what blocks the rays that are traced.  `looks`: the bits that `select` writes
    (`tracer.culling.stages.Stages`); where several stages could, the first selects."""

    data: NamedTuple | None = None
    _: KW_ONLY
    find: NativeCallback | None = None
    select: NativeCallback | None = None
    approach: NativeCallback | None = None
    choose: NativeCallback | None = None
    learn: NativeCallback | None = None
    finish: NativeCallback | None = None
    rows: int = 0
    occluders: bool = False
    looks: NDArray[np.int64] | None = None
    shade: NativeCallback | None = None


class ShadowMethod:
    """A way to cull shadow rays.  Instances live as long as their renderer, whose frames take turns."""

    #: Other methods that this one is made of, which live as long as it does.
    parts: tuple[ShadowMethod, ...] = ()
    #: How many rays may go through a tree side by side in its frames (`tracer.geometry.world.World.place`).
    max_packet_size: int = MAX_PACKET_SIZE

    def __init__(self, services: Services) -> None:
        self.services = services

    # Of a method with additions, the hooks `first_units`, `begin_shading` and `shade` are called for the base alone.

    def first_units(self) -> NDArray[np.int32]:
        """(primitives + 1,) int32, the first unit of each primitive where modes belong to cells, else empty."""
        return primitives_are_units()

    def begin(self, frame: FrameView) -> None:
        """Decide what this frame does; nothing has been placed yet."""

    def follows_rest(self) -> bool:
        """Whether objects that rest are to count as static in this frame."""
        return False

    def update(self, frame: FrameView) -> None:
        """Bring what is kept up to date with where objects and lights are now; make it, the first time."""

    def prepare(self, frame: FrameView) -> None:
        """Do what is worth doing before shading; primary hits are in the buffers.  May raise Cancelled."""

    @property
    def finds_first(self) -> bool:
        """Whether stages are to find what is known of all primary hits before any is shaded."""
        return False

    def begin_shading(self, frame: FrameView, tiles: int, first_pass: bool) -> None:
        """A pass over so many tiles begins: the first of a frame, or one of those that refine it or add a sample."""

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        """What one worker's kernels are given; `learns` is false for further samples, which teach nothing."""
        return []

    @property
    def takes_part(self) -> bool:
        """Whether tiles are shaded with the stages of this method in this frame."""
        return True

    def shade(self, shade: Callable[[bool, NDArray[np.int64]], None], tile: int, counts: NDArray[np.int64]) -> None:
        """Shade a tile, in any thread, by calling shade(whether with the stages of this method, counters)."""
        shade(True, counts)

    def keep(self, frame: FrameView) -> None:
        """Keep what the frame, now whole, has taught."""

    def discard(self, frame: FrameView, begun: bool) -> None:
        """Drop what a cancelled frame has gathered; `begun` if any of it was shaded."""

    def layers(self, frame: FrameView) -> dict[str, Any]:
        """Buffers (height, width, ...) for views, by name; "cells" and "certificates" become those of `Frame`.  What is
        no array is something else than pixels that views show, and becomes one of its structures."""
        return {}

    def report(self, statistics: FrameStatistics) -> None:
        """Put what is known so far into the statistics of a frame."""

    def finish(self, frame: FrameView, statistics: FrameStatistics) -> None:
        """The frame is done, and took what its statistics say."""

    def explain(self, primitive: int, point: NDArray[np.float32], light: int) -> tuple[str, tuple[int, ...]]:
        """What is known of a light at a point (3,) above a primitive, in a word, "none" for nothing, and the primitives
        that this rests on."""
        return "none", ()

    def more(self, primitive: int, point: NDArray[np.float32], light: int) -> str:
        """What more there is to say of what is known of a light at a point (3,) above a primitive, or could be: a
        sentence that takes a while to find."""
        return ""

    def because(self, answered: Answered) -> CullReason:
        """Why a stage of this method could answer a shadow ray of the last frame."""
        return CullReason(Verdict.ANSWERED)

    def forget(self) -> None:
        """Forget everything that earlier frames have taught."""

    @property
    def memory_bytes(self) -> int:
        """Memory that this method holds, in bytes, with that of its parts."""
        return sum(part.memory_bytes for part in self.parts)


ALL_LOOK, ALL_LIGHTS = np.empty((0, 1), np.int64), 1 << 31


class StageTable:
    """The stages of one worker as kernels get them; keeps what they point to."""

    def __init__(self, stages: list[Stage], verify: bool, records: bool = False) -> None:
        self._stages = stages
        self._blocks = [np.zeros(1, np.int64) if stage.data is None else pack(stage.data) for stage in stages]
        table, rows = np.zeros((len(stages), COLUMNS), np.int64), 0
        selecting = next((stage for stage in stages if stage.looks is not None), None)
        for row, stage, block in zip(table, stages, self._blocks, strict=True):
            select = stage.select if stage is selecting else None
            first: list[Any] = [stage.find, select, stage.approach, stage.choose]
            kernels = [*first, stage.learn, stage.finish, stage.shade]
            row[:] = *(0 if kernel is None else kernel.address for kernel in kernels), block.ctypes.data, rows
            rows += stage.rows
        # One stage selects, the first that can; what a later one would pass over it answers itself.
        looks = [stage.looks for stage in stages if stage.looks is not None][:1]
        learns = any(stage.learn is not None for stage in stages)  # from all rays to lights that have modes
        everything = ALL_LIGHTS if verify or records else MAX_CULLED_LIGHTS if learns else 0
        self.given = Stages(
            table,
            rows,
            any(stage.occluders for stage in stages),
            verify,
            everything,
            looks[0] if looks else ALL_LOOK,
            any(stage.shade is not None for stage in stages),
        )
