"""Figure 1 of the paper as a list of phases: `Renderer.render`.

The phases see whole frames, the kernels below them tiles or rows.  Culling decisions read the modes
as the last frame left them, and whatever threads learn is merged by OR and by sums of integers, so
that pictures, modes and counters are the same for any number of threads and on every run.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from tracer.culling.cache import NO_CACHE, OccluderCache
from tracer.culling.cells import first_units, primitives_are_units, units_of
from tracer.culling.certified.certify import CERTIFICATES, STEPS, TESTS
from tracer.culling.certified.certify import COUNTERS as CERTIFYING
from tracer.culling.certified.cost_model import CostModel, cost_model_for
from tracer.culling.certified.requests import Requests, make_requests, no_requests
from tracer.culling.certified.store import Budget, CertificateStore
from tracer.culling.certified.view import CertificateView, empty_view
from tracer.culling.memory import Memory
from tracer.culling.modes import MAX_CULLED_LIGHTS, merge_words, word_type
from tracer.culling.occlusion import count_pixels, occlusion_testing, set_occlusion_modes
from tracer.culling.rest import Rest
from tracer.culling.shadow import Knowledge
from tracer.frame import Frame, Settings
from tracer.geometry.camera import Pinhole, pinhole
from tracer.geometry.world import World
from tracer.investor import Investor, Plan, Trial
from tracer.method import base_of, culls_by_modes, takes
from tracer.parallel import for_each_chunk, thread_count
from tracer.parts import LEVELS, Parts, after
from tracer.scene.model import Camera, Progress, Scene
from tracer.shading.blocks import NO_PLANES, TURNS, Planes, all_blocks, make_planes
from tracer.shading.look import SHINE, TRANSMISSION, make_look
from tracer.shading.surfaces import see_cells, see_surfaces
from tracer.shading.whitted import (
    COUNTERS,
    TILE,
    Buffers,
    Workspace,
    request_in_tiles,
    shade_tile,
    trace_primary,
    workspace,
)
from tracer.statistics import gather

FEW = 4  # pixels of each block, at most, that are shaded in larger tiles
EACH = 3  # larger tiles, at least, for each thread
GOLDEN = 0.618033988749895  # steps of it visit all tiles evenly
ROWS = 32  # of pixels, which a thread tests for occlusion at a time
MEMORIES = 16  # resolutions whose modes are kept, of primitives or of cells, those used last
SHARES, SHARE = 8, 6  # of all tiles that each thread takes to look for requests; tiles of one, at least
SEEKING = 0.5  # of the time for certificates, at most, is spent on looking for what primary hits want
PRICE = 2e-6, 2e-7  # seconds, about, that setting certificates up takes for each primitive, and each light besides
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
        self._look = make_look(scene, self.world.attributes)
        self._memories: dict[tuple[int, int, bool], Memory] = {}
        self._first_units = {False: primitives_are_units()}
        self._workspaces: list[Workspace] = []
        self.certificates: CertificateStore | None = None
        self.certificates_hold = False  # whether they have followed what moved into the last frame
        self._investor: Investor | None = None
        self._cache: OccluderCache | None = None
        self.next_trial = 0  # of the tiles that are shaded both ways
        self._turn = 0
        self._planes: tuple[tuple[int, int], Planes] | None = None

    def reset_modes(self) -> None:
        """Forget all modes, at every resolution, all certificates and all occluders."""
        self._memories.clear()
        self._cache = None
        self.certificates = self._investor = None

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
            frame.discard()
            raise
        return frame.finished()

    def refine(
        self,
        time: float = 0.0,
        camera: Camera | None = None,
        cancel: Cancel = None,
        parts: Sequence[float] = (1, 4, 8, 16),
        samples: int = 1,
        focus: tuple[float, float] | None = None,
    ) -> Generator[Frame, None, None]:
        """Frames of one picture that becomes finer: so many sixteenths of its pixels are shaded in each, the most where
        it helps the most (`tracer.parts`), the others filled in from these, the same surfaces at all of them.

        The frame that is whole is that of `render`, bit for bit, and only with it anything is learnt: whoever closes
        the generator before has seen a picture and taught nothing.  After it come frames of 2 to `samples` samples a
        pixel; the last is that of `render` with so many.  `parts` increase up to 16.  Pixels near `focus`, parts of
        the width and height, come first where not all come at once.  Raises Cancelled as `render` does.
        """
        if list(parts) != sorted(set(parts)) or not parts or parts[0] < LEVELS[0] or parts[-1] != TURNS:
            raise ValueError(f"parts increase from {LEVELS[0]} at least to {TURNS}")
        settings = replace(self.settings, samples=1)
        frame = self.begin(time, camera, cancel, settings, in_parts=parts[0] < TURNS)
        frame.begin_at(focus)
        try:
            yield from frame.refined(parts)
        except BaseException:
            frame.discard()
            raise
        whole = frame.finished()
        yield whole
        yield from frame.sampled(whole, samples)

    def next_turn(self, part: float) -> int:
        """Whose turn it is first: consecutive pictures, of which so many sixteenths are shaded, begin at others."""
        self._turn = after(self._turn, part)
        return self._turn

    def begin(
        self,
        time: float,
        camera: Camera | None = None,
        cancel: Cancel = None,
        settings: Settings | None = None,
        in_parts: bool = False,
    ) -> UnfinishedFrame:
        """A frame whose phases are still to come."""
        settings = (settings or self.settings).validated()
        return UnfinishedFrame(self, settings, camera or self.scene.camera_at(time), time, cancel, in_parts)

    def workspaces(self, workers: int) -> list[Workspace]:
        """One for each worker at least."""
        self._workspaces += [workspace() for _ in range(len(self._workspaces), workers)]
        return self._workspaces

    def planes(self, width: int, height: int) -> Planes:
        """Room for what pixels know of each other, the same for every frame of a size that is shaded in parts."""
        if self._planes is None or self._planes[0] != (width, height):
            self._planes = (width, height), make_planes(width, height)
        return self._planes[1]

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

    def _cost_model(self) -> CostModel:
        """What certifying is worth in this world."""
        materials = self._look.materials
        bounces = (materials[:, SHINE] > 0.0).any() or (materials[:, TRANSMISSION] > 0.0).any()
        return cost_model_for(self.world.accelerator, bool(bounces))

    def _invests(self, settings: Settings) -> Investor | None:
        """Who decides for the method "auto"; nobody for others."""
        if base_of(settings.method) != "auto":
            return None
        if self._investor is None:
            price = (PRICE[0] + PRICE[1] * len(self.scene.lights)) * len(self.world.object_of)
            self._investor = Investor(price, self._cost_model().costly_rays)
        return self._investor

    def _first(self, settings: Settings) -> np.ndarray:
        """The first unit of each primitive (`tracer.culling.cells`)."""
        if _has_cells(settings) and True not in self._first_units:
            self._first_units[True] = first_units(self.world.placed.triangles, self.world.object_of)
        return self._first_units[_has_cells(settings)]


def _has_cells(settings: Settings) -> bool:
    return base_of(settings.method) == "cells"


_NOT_CERTIFIED = {np.dtype(word_type(lights)).itemsize: empty_view(lights) for lights in (1, MAX_CULLED_LIGHTS)}


class UnfinishedFrame:
    """A frame under way: the phases of `Renderer.render` over its buffers."""

    def __init__(
        self,
        renderer: Renderer,
        settings: Settings,
        camera: Camera,
        time: float,
        cancel: Cancel,
        in_parts: bool = False,
    ) -> None:
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
        self._certificates: CertificateStore | None = None
        self._words_seen: np.ndarray | None = None
        self._requests = no_requests()
        self._base = base_of(settings.method)
        self._trials: list[Trial] = []
        self._investor = renderer._invests(settings)
        self._tiles = self._tiles_of(TILE)
        self._plan = self._planned()
        self._certifying = np.zeros(CERTIFYING, np.int64)
        self._rays = pinhole(camera, settings.width, settings.height)
        self._in_parts, self._everywhere = in_parts, all_blocks(settings.width, settings.height)
        self._parts: Parts | None = None
        self._begun = False  # shading
        self._buffers = self._empty_buffers(in_parts)
        self._words: np.ndarray | None = None  # those to shade further samples by
        self._units = np.empty_like(self._buffers.primitive) if _has_cells(settings) else self._buffers.primitive
        self._focus: tuple[float, float] | None = None

    def _planned(self) -> Plan:
        """What this frame does about certificates."""
        settings, investor = self._settings, self._investor
        if investor is None:
            return Plan(True, settings.certificate_seconds) if self._base == "certified" else Plan()
        plan = investor.plan(len(self._tiles), settings.certificate_seconds if settings.patient else 0.0)
        counts_all = settings.verify or settings.record_work
        seconds = min(plan.seconds, settings.certificate_seconds)
        return replace(plan, seconds=seconds, trials=0 if counts_all else plan.trials)

    def _tiles_of(self, side: int) -> list[tuple[int, int, int, int]]:
        """Left, top, right and bottom of the squares that make the picture."""
        width, height = self._settings.width, self._settings.height
        return [
            (x, y, min(x + side, width), min(y + side, height))
            for y in range(0, height, side)
            for x in range(0, width, side)
        ]

    def begin_at(self, focus: tuple[float, float] | None) -> None:
        """Let tiles near this point of the picture come first; it is given in parts of width and height."""
        if focus is not None:
            self._focus = focus[0] * self._settings.width, focus[1] * self._settings.height

    def _order_of(self, tiles: list[tuple[int, int, int, int]]) -> list[int]:
        """Numbers of tiles, those near the focus first, where there is one."""
        if self._focus is None:
            return list(range(len(tiles)))
        x, y = self._focus[0] - TILE / 2, self._focus[1] - TILE / 2
        return sorted(range(len(tiles)), key=lambda n: math.hypot(tiles[n][0] - x, tiles[n][1] - y))

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time one phase, which may come in several parts."""
        start = clock.perf_counter()
        yield
        self._phases[name] = self._phases.get(name, 0.0) + clock.perf_counter() - start

    def refined(self, parts: Sequence[float]) -> Iterator[Frame]:
        """All phases: frames of which so many sixteenths are shaded, until none is left out."""
        with self.phase("place"):
            self.place_objects_and_lights()
        with self.phase("primary"):
            self.trace_primary_rays()
        with self.phase("certification"):
            self.certify_cells()
        if self._in_parts:
            with self.phase("surfaces"):
                self.see_surfaces(self._renderer.next_turn(parts[0]))
        for part in parts:
            self.shade_part(part)
            if part < TURNS:
                yield self.so_far()
        with self.phase("occlusion testing"):
            self.test_occlusion()
        self._words = self.memory.words.copy()
        with self.phase("mode setting"):
            self.set_modes()

    def shade_part(self, part: float) -> None:
        """Shade what is left until so many sixteenths of the pixels are shaded."""
        if self._parts is None:
            with self.phase("shading"):
                self.shade()
            return
        if part == TURNS:  # nobody will be filled in
            self._buffers = self._buffers._replace(planes=NO_PLANES)
        for lanes in self._parts.left_up_to(part, self._fill):
            with self.phase("shading"):
                self.shade(lanes)

    def discard(self) -> None:
        """Learn nothing from this frame; but what its rays requested stays requested."""
        self.memory.discard_frame()
        if self.cache is not None:
            self.cache.discard_found()
        if self._certificates is not None and self._begun:
            self._certificates.pending = [self._requests]
            self._certificates.keep_within(1e6 * self._settings.certificate_memory, self._buffers.cell)
        if self._begun:
            self._settle()
        elif self._investor is not None:
            self._investor.abandon(free=self._settings.patient)

    def _settle(self) -> None:
        """Tell who invests what this frame has cost."""
        if self._investor is None:
            return
        others = sum(trial.plain if self._plan.looks_up else trial.told for trial in self._trials) / self._workers
        self._investor.spend(others, trying=True)
        seconds, shading = clock.perf_counter() - self._started, self._phases.get("shading", 0.0)
        self._investor.finish(seconds, max(0.0, shading - others), self._trials, free=self._settings.patient)
        self._trials = []

    @contextmanager
    def _invested(self) -> Iterator[None]:
        """What takes time for certificates, which who invests must know."""
        start = clock.perf_counter()
        yield
        if self._investor is not None:
            self._investor.spend(clock.perf_counter() - start)

    def _empty_buffers(self, in_parts: bool = False) -> Buffers:
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
            cell=np.zeros(width * height if self._plan.needs_certificates else 0, np.int32),
            saved=np.zeros(worked, np.int32),
            cost=np.zeros(worked, np.int32),
            due_rays=np.zeros(worked, np.int32),
            planes=self._renderer.planes(width, height) if in_parts else NO_PLANES,
        )

    def _for_each_tile(self, work: Callable[[int, tuple[int, int, int, int], int], None], side: int = TILE) -> None:
        """Call work(number, tile, worker) for every tile."""
        tiles = self._tiles if side == TILE else self._tiles_of(side)
        order = self._order_of(tiles)

        def in_order(chunk: int, worker: int) -> None:
            work(order[chunk], tiles[order[chunk]], worker)

        for_each_chunk(in_order, len(tiles), self._workers, self._cancel)

    def place_objects_and_lights(self) -> None:
        """Where is everything that moves?  What is known of a light that moved is forgotten, and what depends on an
        object that has come to rest, or rests no longer."""
        renderer = self._renderer
        world, rest, lights = renderer.world, renderer.rest, renderer._look.lights
        poses = world.pose(self._time)
        certified = self._plan.needs_certificates
        follows = self._investor is not None and renderer.certificates is not None
        beside = self._settings.modes and not culls_by_modes(self._settings.method)
        if certified or follows or beside or takes(self._settings.method, "rest"):
            world.place(poses, rest.follow(poses, world.primitives))
        else:
            rest.forget()
            world.place(poses)
        lights[:] = renderer.scene.light_positions(self._time)
        self.memory.follow_lights(lights)
        self.memory.follow_rest(rest.now, world.outlines, self._workers)
        renderer.certificates_hold = certified
        if certified:
            with self._invested():
                self._follow_certificates(lights)

    def _follow_certificates(self, lights: np.ndarray) -> None:
        """Drop the certificates that no longer hold; set them up, where there are none."""
        renderer = self._renderer
        if renderer.certificates is None:
            renderer.certificates = CertificateStore(renderer.world, len(lights), self._workers, renderer._cost_model())
            if self._investor is not None:
                self._investor.made_ready()
        self._certificates = renderer.certificates
        self._certificates.follow(lights, renderer.rest.now, self._workers)

    def trace_primary_rays(self) -> None:
        """What does each pixel see?"""
        self._trace_primary(self._rays, self._buffers, self._counts)
        if len(self._first) > 0:
            seen = (self._buffers.primitive, self._buffers.u, self._buffers.v, self._units)
            units_of(self._first, *(pixels.reshape(-1) for pixels in seen))

    def _trace_primary(self, rays: Pinhole, buffers: Buffers, counts: np.ndarray) -> None:
        placed, spaces = self._renderer.world.placed, self._spaces
        self._for_each_tile(
            lambda _, tile, worker: trace_primary(
                placed, rays, tile, self._everywhere, buffers, counts[worker], spaces[worker]
            )
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
        """Certify what these primary hits are about to need, and what other rays requested in the last frame."""
        certificates = self._certificates
        if certificates is None:
            return
        if self._investor is None or self._plan.seconds > 0.0:
            with self._invested():
                self._certify(certificates)
        self._requests = make_requests(len(self._tiles))

    def _certify(self, certificates: CertificateStore) -> None:
        start, seconds = clock.perf_counter(), self._plan.seconds
        requests, lights = make_requests(len(self._tiles)), self._renderer._look.lights
        tiles = np.array(self._tiles)
        certified = certificates.view(no_requests(), len(tiles))
        order = (certificates.next_tile + np.arange(len(tiles))) % len(tiles)
        shares = np.array_split(order, max(1, min(SHARES * self._workers, len(tiles) // SHARE)))
        looked_at: list[int] = []

        def work(chunk: int, worker: int) -> None:
            if clock.perf_counter() - start < SEEKING * seconds:
                request_in_tiles(self._rays, tiles, shares[chunk], certified, requests, lights, self._buffers)
                looked_at.append(len(shares[chunk]))

        for_each_chunk(work, len(shares), self._workers, self._cancel)
        certificates.next_tile += sum(looked_at)  # where time was short, others are the first in the next frame
        budget = Budget(self._settings.certificates, start + seconds)
        lists, certificates.pending = [requests, *certificates.pending], []
        self._certifying = certificates.certify(lists, budget, certificates.cost_model, self._cancel)

    def see_surfaces(self, first: int = 0) -> None:
        """What do all primary hits look like before any shadow ray is traced?  `first` says which pixels
        are to be shaded first (`tracer.parts`)."""
        placed, look, rays, buffers = self._renderer.world.placed, self._renderer._look, self._rays, self._buffers
        width, height = self._settings.width, self._settings.height
        self._parts = Parts(width, height, buffers.planes, float(rays.spread), first)

        self._for_each_tile(lambda _, tile, worker: see_surfaces(placed, look, rays, tile, buffers))
        if self._plan.looks_up:
            self.see_cells()

    def see_cells(self) -> None:
        """Which certified cells do the primary hits lie in?"""
        placed, look, rays, buffers = self._renderer.world.placed, self._renderer._look, self._rays, self._buffers
        nothing, spaces = no_requests(), self._spaces

        def work(_: int, tile: tuple[int, int, int, int], worker: int) -> None:
            knowledge = self._knowledge(worker, nothing, looks_up=True, learns=False)
            see_cells(placed, look, rays, tile, self._everywhere, knowledge, buffers, spaces[worker])

        self._for_each_tile(work)

    def shade(self, lanes: np.ndarray | None = None) -> None:
        """§2.4, §2.5: Whitted shading, with shadow testing and shadow-mode setting; of these pixels of each block
        (`tracer.shading.primary`), or of all."""
        self._shade(self._rays, self._buffers, self._counts, self._everywhere if lanes is None else lanes)
        self._begun = True
        for sample in range(1, self._settings.samples):
            self.add_sample(sample)

    def _certified(self, certificates: CertificateStore | None, requests: Requests) -> CertificateView:
        """What a tile knows of certified cells, and where it says what it wants."""
        if certificates is None:
            return _NOT_CERTIFIED[self.memory.words.dtype.itemsize]
        return certificates.view(requests, len(self._tiles))

    def _knowledge(self, worker: int, requests: Requests, looks_up: bool, learns: bool) -> Knowledge:
        """What culling goes by, certificates where it is to look them up, and where it says what it wants; the cache
        `learns` in a pixel's first sample alone."""
        memory, certificates = self.memory, self._certificates if looks_up else None
        words = self._words if self._words is not None else memory.words
        return Knowledge(
            words if certificates is None else certificates.cells.words,
            words,
            memory.gained[worker],
            first=self._first,
            cull=certificates is not None or culls_by_modes(self._settings.method),
            learn=self._settings.keeps_modes,
            verify=self._settings.verify,
            certify=certificates is not None,
            certified=self._certified(certificates, requests),
            cache=NO_CACHE if self.cache is None else self.cache.of_worker(worker, learns=learns),
        )

    def _shade(
        self, rays: Pinhole, buffers: Buffers, counts: np.ndarray, lanes: np.ndarray, first: bool = True
    ) -> None:
        placed, look, depth = self._renderer.world.placed, self._renderer._look, self._settings.depth
        spaces, requests = self._spaces, self._requests
        if not first and self._certificates is not None:  # what further samples want is forgotten
            requests = make_requests(len(self._tiles))
        for_tile = [
            Requests(*(a[tile] for a in requests)) if len(requests.key) else requests
            for tile in range(len(self._tiles))
        ]

        # Of larger tiles where few of their pixels are shaded, lest packets of rays remain half empty, unless there are
        # too few for all threads.
        few = int(np.bitwise_count(lanes).sum()) <= FEW * np.count_nonzero(lanes)
        side = 2 * TILE if few and len(self._tiles) >= 4 * EACH * self._workers else TILE
        tried = self._tried(side) if first and not self._begun else frozenset()

        def work(number: int, tile: tuple[int, int, int, int], worker: int) -> None:
            def shade(looks_up: bool, counts: np.ndarray) -> None:
                knowledge = self._knowledge(worker, for_tile[number], looks_up, learns=first)
                shade_tile(placed, look, rays, tile, lanes, depth, knowledge, buffers, counts, spaces[worker])

            if number in tried:
                self._try(shade, counts[worker], number % 2 == 0)
            else:
                shade(self._plan.looks_up, counts[worker])

        self._for_each_tile(work, side)

    def _tried(self, side: int) -> frozenset[int]:
        """Numbers of the tiles that are shaded both ways: others in each frame."""
        count, first = len(self._tiles_of(side)), self._renderer.next_trial
        self._renderer.next_trial += self._plan.trials
        return frozenset(int((first + k) * GOLDEN % 1.0 * count) for k in range(self._plan.trials))

    def _try(self, shade: Callable[[bool, np.ndarray], None], counts: np.ndarray, plain_first: bool) -> None:
        """Shade a tile both ways, one after the other, and note what each took; the picture is the same.

        Of what is counted only that of the way that the whole frame is shaded in is kept."""
        seconds, counted = {}, {}
        for looks_up in (False, True) if plain_first else (True, False):
            counted[looks_up] = np.zeros_like(counts)
            start = clock.thread_time()
            shade(looks_up, counted[looks_up])
            seconds[looks_up] = clock.thread_time() - start
        counts += counted[self._plan.looks_up]
        told = gather(counted[True][None], 0, 0).shadow
        known = told.culled + told.dynamic_only + told.candidates_only
        self._trials.append(Trial(seconds[False], seconds[True], told.due, known))

    def add_sample(self, number: int) -> None:
        """Mix in a further sample of each pixel, placed by the R2 sequence; it uses modes but counts nothing."""
        golden = 1.32471795724474602596  # its powers step through the plane evenly (Roberts 2018)
        gained = self.memory.gained.copy()
        shift = ((0.5 + number / golden) % 1.0, (0.5 + number / golden**2) % 1.0)
        rays = pinhole(self._camera, self._settings.width, self._settings.height, shift)
        buffers, counts = self._empty_buffers(), np.zeros_like(self._counts)
        try:
            self._trace_primary(rays, buffers, counts)
            self._shade(rays, buffers, counts, self._everywhere, first=False)
        finally:
            self.memory.gained[:] = gained
        if number == 1:
            self._sum, self._reference_sum = self._buffers.color, self._buffers.reference
        self._sum, self._reference_sum = self._sum + buffers.color, self._reference_sum + buffers.reference
        taken = np.float32(number + 1)
        self._buffers = self._buffers._replace(
            color=self._sum / taken, reference=self._reference_sum / taken, wrong=self._buffers.wrong + buffers.wrong
        )

    def sampled(self, whole: Frame, samples: int) -> Iterator[Frame]:
        """The finished frame, `whole`, with 2, 3, ... samples a pixel."""
        for number in range(1, samples):
            self.add_sample(number)
            yield replace(
                whole,
                settings=replace(self._settings, samples=number + 1),
                color=self._buffers.color.reshape(whole.color.shape),
                reference=None if whole.reference is None else self._buffers.reference.reshape(whole.color.shape),
                wrong=None if whole.wrong is None else self._buffers.wrong.reshape(whole.wrong.shape),
            )

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
            cell = self._buffers.cell
            if self._plan.looks_up:
                self._words_seen = self._certificates.at_pixels(cell)  # cells may get other numbers now
            self._certificates.pending = [self._requests]
            self._certificates.keep_within(1e6 * self._settings.certificate_memory, cell)

    def _cells_seen(self) -> np.ndarray | None:
        """The cell at each pixel, -1 for none, where the method has such."""
        if self._plan.looks_up:
            cell = self._buffers.cell.reshape(self._buffers.primitive.shape)
            return np.where(cell > 0, cell, np.int32(-1))
        return self._units if _has_cells(self._settings) else None

    def _fill(self) -> None:
        """Fill in the pixels that have not been shaded."""
        if self._parts is not None:
            with self.phase("filling"):
                color = self._buffers.color.reshape(*self._buffers.primitive.shape, 3)
                self._parts.fill(color, self._workers, self._cancel)

    def so_far(self) -> Frame:
        """A frame of which some pixels have not been shaded: these are filled in from the others."""
        assert self._parts is not None, "a picture in parts"
        self._fill()
        if self._certificates is not None and self._plan.looks_up:
            self._words_seen = self._certificates.at_pixels(self._buffers.cell)
        frame = self._frame()
        frame.color = self._parts.give()
        with self.phase("filling"):
            self._stretch_records(frame, self._parts)
        frame.statistics.phases = dict(self._phases)
        return frame

    def _stretch_records(self, frame: Frame, parts: Parts) -> None:
        """Let pixels that have not been shaded show what is recorded of the nearest that have; wrong ones do not."""
        if frame.reference is not None and frame.wrong is not None:
            right = (self._buffers.reference - self._buffers.color).reshape(frame.color.shape)
            frame.reference = frame.color + parts.stretched(right)
            frame.wrong = frame.wrong.copy()
        if frame.saved is not None and frame.cost is not None and frame.due_rays is not None:
            frame.saved, frame.cost, frame.due_rays = (
                parts.stretched(work) for work in (frame.saved, frame.cost, frame.due_rays)
            )

    def finished(self) -> Frame:
        """The frame, all phases of which are done."""
        frame = self._frame()
        if self._certificates is not None:
            self._certificates.finish_frame(frame.statistics.certificates, frame.statistics.shadow.due)
        self._settle()
        return frame

    def _frame(self) -> Frame:
        buffers, memory = self._buffers, self.memory
        shape = buffers.primitive.shape
        lights = len(self._renderer.scene.lights)
        statistics = gather(self._counts, int(self._occlusion_tests.sum()), lights if self._settings.keeps_modes else 0)
        statistics.decision = "" if self._investor is None else self._investor.reason
        statistics.part = 1.0 if self._parts is None else self._parts.share
        statistics.phases = dict(self._phases)
        statistics.certificates = int(self._certifying[CERTIFICATES])
        statistics.certificate_steps = int(self._certifying[STEPS])
        statistics.certificate_tests = int(self._certifying[TESTS])
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
