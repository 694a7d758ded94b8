"""What a renderer keeps from one frame to the next: the world, modes, methods, and memory to work in."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from copy import copy

import numpy as np
from numpy.typing import NDArray

from tracer.culling.mode_history import ModeHistory
from tracer.culling.rest import Rest
from tracer.geometry.world import World
from tracer.method import Kind, Method
from tracer.methods.interface import Services, ShadowMethod
from tracer.methods.paper import ModesBeside
from tracer.neighbours.certified.cost_model import CostModel, cost_model_for
from tracer.scene.lights import LampTable, Light, as_lamps
from tracer.scene.model import Progress, Scene
from tracer.settings import Settings
from tracer.shading.blocks import Planes, make_planes
from tracer.shading.buffers import Workspace, workspace
from tracer.shading.shading_data import SHINE, TRANSMISSION, make_shading_data

ModeKey = tuple[int, int, bool, float | None, int | None]
HISTORIES = 16  # resolutions and lamps whose modes are kept, of primitives or of cells, those used last

MODES_BESIDE = Kind("modes", "Keeps the paper's modes.", ModesBeside, addition=True)


class State:
    """Made with the clocks that it measures by, `clock` of seconds that pass, `thread_clock` of seconds that the
    calling thread has had a processor; and with what certificates are worth, if not what is usual for the world."""

    def __init__(
        self,
        scene: Scene,
        world: World,
        clock: Callable[[], float],
        thread_clock: Callable[[], float],
        cost_model: CostModel | None,
    ) -> None:
        self.scene, self.world, self.clock = scene, world, clock
        self.rest = Rest(len(scene.objects))
        self.shading = make_shading_data(scene, world.attributes)
        materials = self.shading.materials
        bounces = bool((materials[:, SHINE] > 0.0).any() or (materials[:, TRANSMISSION] > 0.0).any())
        model = cost_model or cost_model_for(world.accelerator, bounces)
        itself = weakref.proxy(self)  # a circle of references would keep the world alive
        by_name = lambda name: itself.method(name)  # noqa: E731
        self._services = Services(world, self.shading, model, clock, thread_clock, by_name)
        self._methods: dict[Kind, ShadowMethod] = {}
        self.histories: dict[ModeKey, ModeHistory] = {}
        self._workspaces: list[Workspace] = []
        self._lamps: LampTable | None = None
        self._lamps_made_of: tuple[tuple[Light, ...], float | None, int | None] | None = None
        self._planes: tuple[tuple[int, int], Planes] | None = None
        self._time: float | None = None

    def forget(self) -> None:
        """Forget all modes, at every resolution, and all that methods have learnt."""
        self.histories.clear()
        for method in self._methods.values():
            method.forget()

    def take_modes(self, other: State, settings: Settings) -> None:
        """Know what rests, and the modes of frames by these settings, as another state of the same world knows them
        now."""
        key = mode_key(settings, Method.parse(settings.method).uses_cells)
        known = other.histories.get(key) if settings.keeps_modes else None
        self.histories = {key: known.copied()} if known is not None else {}
        self.rest = copy(other.rest)

    def method(self, name: str) -> ShadowMethod:
        """The base of this name, with all that it has learnt."""
        return self._of_kind(Method.parse(name).kind)

    def _of_kind(self, kind: Kind) -> ShadowMethod:
        if kind not in self._methods:
            self._methods[kind] = kind.load()(self._services)
        return self._methods[kind]

    def methods(self, settings: Settings, time: float) -> list[ShadowMethod]:
        """The base, its additions, and what keeps modes beside them, for a frame at `time`.

        Methods that are not used are dropped, with all that they know, once the scene has moved on: what they know is
        no longer true, and would hold memory."""
        method = Method.parse(settings.method)
        beside = (MODES_BESIDE,) if settings.modes_beside else ()
        chosen = [self._of_kind(kind) for kind in (*method.kinds, *beside)]
        if time != self._time:
            used = {*chosen, *(part for one in chosen for part in one.parts)}
            self._methods = {kind: one for kind, one in self._methods.items() if one in used}
            self._time = time
        return chosen

    def history(self, settings: Settings, first: NDArray[np.int32], workers: int) -> ModeHistory:
        """The modes at this resolution and by these lamps, of primitives or of cells; made, or given room for more
        workers, where need be.  first (primitives + 1,) are the first units of primitives, or empty.  They begin with
        what is known at the resolution of the last frame, if that was finer."""
        key = mode_key(settings, len(first) > 0)
        last = next(reversed(self.histories), key)
        history = self.histories.pop(key, None)
        if history is None:
            history = ModeHistory(self.world.object_of, len(self.scene.lights), workers, first)
        if last[2:] == key[2:] and last[1] > key[1] and self.histories[last].light_positions is not None:
            history.take_finer(self.histories[last], (key[1] / last[1]) ** 2)
        self.histories[key] = history  # the newest last
        if len(self.histories) > HISTORIES:
            del self.histories[next(iter(self.histories))]
        history.make_room(workers)
        return history

    def lamps(self, settings: Settings) -> LampTable:
        """The scene's lights, made lamps as the settings say; the same table until these say otherwise."""
        made_of = self.scene.lights, settings.lamp_radius, settings.lamp_samples
        if self._lamps is None or self._lamps_made_of != made_of:
            self._lamps, self._lamps_made_of = LampTable(as_lamps(*made_of)), made_of
        return self._lamps

    def workspaces(self, workers: int, stage_rows: int = 0) -> list[Workspace]:
        """One for each worker at least, with so many rows for stages."""
        self._workspaces += [workspace() for _ in range(len(self._workspaces), workers)]
        for number, space in enumerate(self._workspaces):
            if len(space.scratch) < stage_rows:
                self._workspaces[number] = space._replace(
                    scratch=np.empty((stage_rows, space.scratch.shape[1]), np.float32)
                )
        return self._workspaces

    def planes(self, width: int, height: int) -> Planes:
        """Room for what pixels know of each other, the same for every progressive frame of a size."""
        if self._planes is None or self._planes[0] != (width, height):
            self._planes = (width, height), make_planes(width, height)
        return self._planes[1]


def mode_key(settings: Settings, in_cells: bool) -> ModeKey:
    """Return what tells mode histories apart: size, primitives or cells, and what lamps are made of lights."""
    return settings.width, settings.height, in_cells, settings.lamp_radius, settings.lamp_samples


def open_world(scene: Scene, settings: Settings, progress: Progress | None = None) -> World:
    """A world for a scene at its start, with the accelerator that the settings name."""
    return World(scene, scene.time_range[0], settings.accelerator, progress, lazy=True)
