"""Figure 1 of the paper as a list of phases: `Renderer.render`.

The phases see whole frames, the kernels below them tiles or rows.  Culling decisions read the modes
as the last frame left them, and whatever threads learn is merged by OR and by sums of integers, so
that pictures, modes and counters are the same for any number of threads and on every run.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from tracer.culling.cache import NO_CACHE, OccluderCache
from tracer.culling.cells import first_units, primitives_are_units, units_of
from tracer.culling.certified.certificates import Budget, Certificates, Effort
from tracer.culling.certified.certify import CERTIFICATES, STEPS, TESTS
from tracer.culling.certified.certify import COUNTERS as CERTIFYING
from tracer.culling.certified.lookup import Certified, Wanted, nothing_told, nothing_wanted
from tracer.culling.memory import Memory
from tracer.culling.modes import MAX_CULLED_LIGHTS, merge_words, word_type
from tracer.culling.occlusion import count_pixels, occlusion_testing, set_occlusion_modes
from tracer.culling.rest import Rest
from tracer.culling.shadow import Knowledge
from tracer.frame import Frame, Settings
from tracer.geometry.camera import Pinhole, pinhole
from tracer.geometry.world import World
from tracer.method import base_of, culls_by_modes, takes
from tracer.parallel import for_each_chunk, thread_count
from tracer.scene.animation import light_positions
from tracer.scene.model import Camera, Progress, Scene
from tracer.shading.look import SHINE, TRANSMISSION, make_look
from tracer.shading.whitted import (
    COUNTERS,
    TILE,
    Buffers,
    Workspace,
    seek_in_tiles,
    shade_tile,
    trace_primary,
    workspace,
)
from tracer.statistics import gather

ROWS = 32  # of pixels, which a thread tests for occlusion at a time
MEMORIES = 16  # resolutions whose modes are kept, of primitives or of cells, those used last
SHARES, SHARE = 8, 6  # of all tiles that each thread takes to look for what is wanted; tiles of one, at least
SEEKING = 0.5  # of the time for certificates, at most, is spent on looking for what primary hits want
# What certifying is worth, by what a shadow ray costs: some 250 ns, and 50.
EFFORT = {"kdtree": Effort(4, 12, 6, 48, True, 4), "bvh8": Effort(8, 32, 0, 48, False, 16)}
Cancel = Callable[[], bool] | None


class Renderer:
    """Renders a scene frame by frame and remembers the modes between frames.

    `settings` may be replaced at any time between frames.  Renderers of one scene may share a
    `world`, as long as they take turns; each has a `rest` of its own, which follows its frames.  Raises
    Cancelled if `progress` does while trees are built, ValueError for settings out of range.
    """

    def __init__(
        self,
        scene: Scene,
        settings: Settings | None = None,
        progress: Progress | None = None,
        world: World | None = None,
    ) -> None:
        self.scene = scene
        self.settings = (settings or Settings()).validated()
        self.world = world or World(scene, scene.time_range[0], self.settings.accelerator, progress)
        self.rest = Rest(len(scene.objects))
        self._look = make_look(scene, self.world.facets)
        self._memories: dict[tuple[int, int, bool], Memory] = {}
        self._first_units = {False: primitives_are_units()}
        self._workspaces: list[Workspace] = []
        self.certificates: Certificates | None = None
        self._cache: OccluderCache | None = None

    def reset_modes(self) -> None:
        """Forget all modes, at every resolution, all certificates and all occluders."""
        self._memories.clear()
        self._cache = None
        self.certificates = None

    def render(self, time: float = 0.0, camera: Camera | None = None, cancel: Cancel = None) -> Frame:
        """The frame at `time` seconds; the scene's own camera where none is given.

        Raises Cancelled, with nothing learnt from this frame, once `cancel()` turns true.
        """
        frame = self.begin(time, camera, cancel)
        try:
            with frame.phase("place"):
                frame.place_objects_and_lights()
            with frame.phase("primary"):
                frame.trace_primary_rays()
            with frame.phase("occlusion testing"):
                frame.test_occlusion()
            with frame.phase("certification"):
                frame.certify_cells()
            with frame.phase("shading"):
                frame.shade()  # with shadow testing and shadow-mode setting
            with frame.phase("mode setting"):
                frame.set_modes()
        except BaseException:
            frame.memory.discard_frame()
            if frame.cache is not None:
                frame.cache.discard_found()
            raise
        return frame.finished()

    def begin(self, time: float, camera: Camera | None = None, cancel: Cancel = None) -> UnfinishedFrame:
        """A frame whose phases are still to come."""
        return UnfinishedFrame(self, self.settings.validated(), camera or self.scene.camera_at(time), time, cancel)

    def workspaces(self, workers: int) -> list[Workspace]:
        """One for each worker at least."""
        self._workspaces += [workspace() for _ in range(len(self._workspaces), workers)]
        return self._workspaces

    def _memory(self, settings: Settings, workers: int) -> Memory:
        """The modes at this resolution, of primitives or of cells; made, or given room for more workers, where need
        be."""
        key = (settings.width, settings.height, _has_cells(settings))
        memory = self._memories.pop(key, None) or self._new_memory(settings, workers)
        self._memories[key] = memory  # the newest last
        if len(self._memories) > MEMORIES:
            del self._memories[next(iter(self._memories))]
        if len(memory.gained) < workers:
            memory.gained = np.zeros((workers, len(memory.words)), memory.words.dtype)
        return memory

    def _new_memory(self, settings: Settings, workers: int) -> Memory:
        return Memory(self.world.object_of, len(self.scene.lights), workers, self._first(settings))

    def _occluder_cache(self, settings: Settings, workers: int) -> OccluderCache | None:
        """The cache, where the method takes one along."""
        if not takes(settings.method, "cache"):
            return None
        if self._cache is None:
            triangles = self.world.placed.triangles
            self._cache = OccluderCache(triangles, int((self.world.object_of[: len(triangles)] == 0).sum()))
        self._cache.make_room(workers)
        return self._cache

    def _effort(self) -> Effort:
        """What certifying is worth in this world: where rays are cheap and nothing reflects, nobody asks candidates."""
        effort, materials = EFFORT[self.world.accelerator], self._look.materials
        bounces = (materials[:, SHINE] > 0.0).any() or (materials[:, TRANSMISSION] > 0.0).any()
        return effort if effort.dear or bounces else effort._replace(asked=0)

    def _first(self, settings: Settings) -> np.ndarray:
        """The first unit of each primitive (`tracer.culling.cells`)."""
        if _has_cells(settings) and True not in self._first_units:
            self._first_units[True] = first_units(self.world.placed.triangles, self.world.object_of)
        return self._first_units[_has_cells(settings)]


def _has_cells(settings: Settings) -> bool:
    return base_of(settings.method) == "cells"


_NOT_CERTIFIED = {np.dtype(word_type(lights)).itemsize: nothing_told(lights) for lights in (1, MAX_CULLED_LIGHTS)}


class UnfinishedFrame:
    """A frame under way: the phases of `Renderer.render` over its buffers."""

    def __init__(self, renderer: Renderer, settings: Settings, camera: Camera, time: float, cancel: Cancel) -> None:
        self._renderer, self._settings = renderer, settings
        self._camera, self._time, self._cancel = camera, time, cancel
        self._workers = thread_count(settings.threads)
        self.memory, self._first = renderer._memory(settings, self._workers), renderer._first(settings)
        self.cache = renderer._occluder_cache(settings, self._workers)
        self._spaces = renderer.workspaces(self._workers)
        self._counts = np.zeros((self._workers, COUNTERS), np.int64)
        self._occlusion_tests = np.zeros(self._workers, np.int64)
        self._phases: dict[str, float] = {}
        self._started = clock.perf_counter()
        self._certificates: Certificates | None = None
        self._words_seen: np.ndarray | None = None
        self._wanted = nothing_wanted()
        self._base = base_of(settings.method)
        self._certifying = np.zeros(CERTIFYING, np.int64)
        self._rays = pinhole(camera, settings.width, settings.height)
        self._buffers = self._empty_buffers()
        self._units = np.empty_like(self._buffers.primitive) if _has_cells(settings) else self._buffers.primitive
        across, down = -(-settings.width // TILE), -(-settings.height // TILE)
        self._tiles = [
            (x * TILE, y * TILE, min((x + 1) * TILE, settings.width), min((y + 1) * TILE, settings.height))
            for y in range(down)
            for x in range(across)
        ]

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time one phase."""
        start = clock.perf_counter()
        yield
        self._phases[name] = clock.perf_counter() - start

    def _empty_buffers(self) -> Buffers:
        width, height = self._settings.width, self._settings.height
        lights = len(self._renderer.scene.lights)
        rows = width * height if self._settings.record_lights else 0
        verified = width * height if self._settings.verify else 0
        worked = width * height if self._settings.record_work else 0
        return Buffers(
            color=np.zeros((width * height, 3), np.float32),
            normal=np.zeros((width * height, 3), np.float32),
            depth=np.empty((height, width), np.float32),
            primitive=np.empty((height, width), np.int32),
            u=np.empty((height, width), np.float32),
            v=np.empty((height, width), np.float32),
            due=np.zeros((rows, lights), np.bool_),
            lit=np.zeros((rows, lights), np.bool_),
            reference=np.zeros((verified, 3), np.float32),
            wrong=np.zeros(verified, np.int32),
            cell=np.zeros(width * height if self._base == "certified" else 0, np.int32),
            saved=np.zeros(worked, np.int32),
            cost=np.zeros(worked, np.int32),
            due_rays=np.zeros(worked, np.int32),
        )

    def _for_each_tile(self, work: Callable[[int, tuple[int, int, int, int], int], None]) -> None:
        """Call work(number, tile, worker) for every tile."""
        for_each_chunk(
            lambda number, worker: work(number, self._tiles[number], worker),
            len(self._tiles),
            self._workers,
            self._cancel,
        )

    def place_objects_and_lights(self) -> None:
        """Where is everything that moves?  What is known of a light that moved is forgotten, and what depends on an
        object that has come to rest, or rests no longer."""
        renderer = self._renderer
        world, rest, lights = renderer.world, renderer.rest, renderer._look.lights
        certified = self._base == "certified"
        beside = self._settings.modes and not culls_by_modes(self._settings.method)
        if certified or beside or takes(self._settings.method, "rest"):
            world.place(self._time, rest)
        else:
            rest.forget()
            world.place(self._time)
        lights[:] = light_positions(renderer.scene, self._time)
        self.memory.follow_lights(lights)
        self.memory.follow_rest(rest.now, world.outlines, self._workers)
        if certified:
            if renderer.certificates is None:
                renderer.certificates = Certificates(world, len(lights), self._workers, renderer._effort())
            self._certificates = renderer.certificates
            self._certificates.follow(lights, rest.now, self._workers)

    def trace_primary_rays(self) -> None:
        """What does each pixel see?"""
        self._trace_primary(self._rays, self._buffers, self._counts)
        if len(self._first) > 0:
            seen = (self._buffers.primitive, self._buffers.u, self._buffers.v, self._units)
            units_of(self._first, *(pixels.reshape(-1) for pixels in seen))

    def _trace_primary(self, rays: Pinhole, buffers: Buffers, counts: np.ndarray) -> None:
        placed, spaces = self._renderer.world.placed, self._spaces
        self._for_each_tile(
            lambda _, tile, worker: trace_primary(placed, rays, tile, buffers, counts[worker], spaces[worker])
        )

    def test_occlusion(self) -> None:
        """§2.3: what does a neighbouring pixel show to be hidden?"""
        if not self._settings.keeps_modes:
            return
        height, memory = self._settings.height, self.memory
        units = self._buffers.primitive, self._first, self._units
        seen = self._renderer.world.placed, self._rays, *units, self._settings.symmetric

        def work(chunk: int, worker: int) -> None:
            rows = chunk * ROWS, min(height, (chunk + 1) * ROWS)
            self._occlusion_tests[worker] += occlusion_testing(*seen, *rows, memory.words, memory.hidden)

        for_each_chunk(work, -(-height // ROWS), self._workers, self._cancel)

    def certify_cells(self) -> None:
        """Certify what these primary hits are about to want, and what else rays wanted in the last frame."""
        certificates = self._certificates
        if certificates is None:
            return
        start, seconds = clock.perf_counter(), self._settings.certificate_seconds
        sought, lights = certificates.wanted(len(self._tiles)), self._renderer._look.lights
        tiles = np.array(self._tiles)
        certified = certificates.told(nothing_wanted(), len(tiles))
        order = (certificates.next_tile + np.arange(len(tiles))) % len(tiles)
        shares = np.array_split(order, max(1, min(SHARES * self._workers, len(tiles) // SHARE)))
        looked_at: list[int] = []

        def work(chunk: int, worker: int) -> None:
            if clock.perf_counter() - start < SEEKING * seconds:
                seek_in_tiles(self._rays, tiles, shares[chunk], certified, sought, lights, self._buffers)
                looked_at.append(len(shares[chunk]))

        for_each_chunk(work, len(shares), self._workers, self._cancel)
        certificates.next_tile += sum(looked_at)  # where time was short, others are the first in the next frame
        budget = Budget(self._settings.certificates, start + seconds)
        wanted, certificates.left = [sought, *certificates.left], []
        self._certifying = certificates.certify(wanted, budget, certificates.effort, self._cancel)
        self._wanted = certificates.wanted(len(self._tiles))

    def shade(self) -> None:
        """§2.4, §2.5: Whitted shading, with shadow testing and shadow-mode setting."""
        self._shade(self._rays, self._buffers, self._counts)
        if self._settings.samples > 1:
            self._average_samples()

    def _certified(self, certificates: Certificates | None, wanted: Wanted, tile: int) -> Certified:
        """What a tile knows of certified cells, and where it says what it wants."""
        if certificates is None:
            return _NOT_CERTIFIED[self.memory.words.dtype.itemsize]
        return certificates.told(Wanted(*(a[tile] for a in wanted)), len(self._tiles))

    def _shade(self, rays: Pinhole, buffers: Buffers, counts: np.ndarray, first: bool = True) -> None:
        placed, look, memory = self._renderer.world.placed, self._renderer._look, self.memory
        depth, verify, base = self._settings.depth, self._settings.verify, self._base
        certificates = self._certificates
        words = memory.words if certificates is None else certificates.cells.words

        def work(number: int, tile: tuple[int, int, int, int], worker: int) -> None:
            knowledge = Knowledge(
                words,
                memory.words,
                memory.gained[worker],
                first=self._first,
                cull=base != "none",
                learn=self._settings.keeps_modes,
                verify=verify,
                certify=certificates is not None,
                certified=self._certified(certificates, self._wanted, number),
                cache=NO_CACHE if self.cache is None else self.cache.of_worker(worker, learns=first),
            )
            shade_tile(placed, look, rays, tile, depth, knowledge, buffers, counts[worker], self._spaces[worker])

        self._for_each_tile(work)

    def _average_samples(self) -> None:
        """Mix in further samples a pixel, placed by the R2 sequence; they use modes but count nothing."""
        samples = self._settings.samples
        golden = 1.32471795724474602596  # its powers step through the plane evenly (Roberts 2018)
        gained = self.memory.gained.copy()
        for k in range(1, samples):
            shift = ((0.5 + k / golden) % 1.0, (0.5 + k / golden**2) % 1.0)
            rays = pinhole(self._camera, self._settings.width, self._settings.height, shift)
            buffers, counts = self._empty_buffers(), np.zeros_like(self._counts)
            self._trace_primary(rays, buffers, counts)
            self._shade(rays, buffers, counts, first=False)
            for sum_, sample in ((self._buffers.color, buffers.color), (self._buffers.reference, buffers.reference)):
                sum_ += sample
            self._buffers.wrong[:] += buffers.wrong
        self._buffers.color[:] /= np.float32(samples)
        self._buffers.reference[:] /= np.float32(samples)
        self.memory.gained[:] = gained

    def set_modes(self) -> None:
        """§2.5, §2.6: keep what was learnt, and say what has been seen whole."""
        memory = self.memory
        if self.cache is not None:
            self.cache.keep_found()
        count_pixels(self._units, memory.pixel_count)
        if self._settings.keeps_modes:
            merge_words(memory.words, memory.gained)
            zoom = np.float64(self._settings.zoom_factor)
            set_occlusion_modes(memory.words, memory.hidden, memory.pixel_count, memory.highest_count, zoom)
        else:
            memory.discard_frame()
        if self._certificates is not None:
            self._words_seen = self._certificates.at_pixels(self._buffers.cell)  # cells may get other numbers now
            self._certificates.left = [self._wanted]
            self._certificates.keep_within(1e6 * self._settings.certificate_memory, self._buffers.cell)

    def _cells_seen(self) -> np.ndarray | None:
        """The cell at each pixel, -1 for none, where the method has such."""
        if self._certificates is not None:
            cell = self._buffers.cell.reshape(self._buffers.primitive.shape)
            return np.where(cell > 0, cell, np.int32(-1))
        return self._units if _has_cells(self._settings) else None

    def finished(self) -> Frame:
        buffers, memory = self._buffers, self.memory
        shape = buffers.primitive.shape
        lights = len(self._renderer.scene.lights)
        statistics = gather(self._counts, int(self._occlusion_tests.sum()), lights if self._settings.keeps_modes else 0)
        statistics.phases = self._phases
        statistics.certificates = int(self._certifying[CERTIFICATES])
        statistics.certificate_steps = int(self._certifying[STEPS])
        statistics.certificate_tests = int(self._certifying[TESTS])
        if self._certificates is not None:
            self._certificates.finish_frame(statistics.certificates, statistics.shadow.due)
        statistics.seconds = clock.perf_counter() - self._started
        recorded = self._settings.record_lights
        return Frame(
            time=self._time,
            camera=self._camera,
            settings=replace(self._settings),
            color=buffers.color.reshape(*shape, 3),
            depth=buffers.depth,
            primitive=buffers.primitive,
            normal=buffers.normal.reshape(*shape, 3),
            modes=memory.words.copy(),
            pixel_count=memory.pixel_count.copy(),
            highest_count=memory.highest_count.copy(),
            lights=lights,
            due=buffers.due.reshape(*shape, lights) if recorded else None,
            lit=buffers.lit.reshape(*shape, lights) if recorded else None,
            reference=buffers.reference.reshape(*shape, 3) if self._settings.verify else None,
            wrong=buffers.wrong.reshape(shape) if self._settings.verify else None,
            cells=self._cells_seen(),
            certificates=None if self._words_seen is None else self._words_seen.reshape(shape),
            saved=buffers.saved.reshape(shape) if self._settings.record_work else None,
            cost=buffers.cost.reshape(shape) if self._settings.record_work else None,
            due_rays=buffers.due_rays.reshape(shape) if self._settings.record_work else None,
            statistics=statistics,
        )
