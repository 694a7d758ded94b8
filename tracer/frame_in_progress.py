"""A frame under way: what each phase of Figure 1 does, over whole pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.culling.cells import units_of
from tracer.culling.counters import COUNTERS, SHADOW, SHADOW_COUNTERS
from tracer.culling.mode_changes import mode_changes
from tracer.culling.mode_history import Learnt
from tracer.culling.occlusion import count_pixels, occlusion_testing
from tracer.frame import Frame
from tracer.geometry.camera import Pinhole, pinhole
from tracer.geometry.rays import MISS
from tracer.method import Method
from tracer.methods.interface import ShadowMethod, Stage, StageTable
from tracer.methods.method_limits import remark
from tracer.progressive import Parts
from tracer.runtime.parallel import for_each_chunk, thread_count
from tracer.scene.lights import Lamps
from tracer.scene.model import Camera
from tracer.settings import Settings
from tracer.shading.blocks import NO_PLANES, TURNS, all_blocks
from tracer.shading.buffers import Buffers, empty_buffers
from tracer.shading.primary import BLOCK, EDGE
from tracer.shading.surfaces import see_surfaces
from tracer.shading.teaching import find_untaught
from tracer.shading.tiles import Tile, nearest_first, tiles_of, tiles_to_shade
from tracer.shading.whitted import find_in_tile, shade_tile, trace_primary
from tracer.state import State
from tracer.statistics import WrongCounts, gather, sample_counts, shadow_counts

ROWS = 32  # of pixels, which a thread tests for occlusion at a time
GOLDEN = 1.32471795724474602596  # the powers of its inverse step through the plane evenly (Roberts 2018)

OF_MODES = ("occlusion testing", "mode setting")  # phases

Cancel = Callable[[], bool] | None


class FrameInProgress:
    """The phases of `tracer.Renderer`, each a method, and the buffers that they fill.

    Public attributes are what methods may read (`tracer.methods.interface.FrameView`).  The frames of a renderer take
    turns: one that is discarded or finished is over.
    """

    def __init__(
        self, state: State, settings: Settings, camera: Camera, time: float, cancel: Cancel, progressive: bool = False
    ) -> None:
        self._state, self._camera, self.time, self.sample = state, camera, time, 0
        self.settings, self.cancel = settings, cancel
        self.workers = thread_count(settings.threads)
        self._started, self._paused = state.clock(), 0.0
        self.over = False  # finished, or discarded
        self.phases: dict[str, float] = {}
        self.progressive = progressive
        self.methods = state.methods(settings, time)
        self._base, *self._others = self.methods

        # What is seen, and by which rays.
        self.rays = pinhole(camera, settings.width, settings.height)
        self._tiles = tiles_of(settings.width, settings.height)
        self.tiles = np.array(self._tiles, np.int64)
        self._everywhere = all_blocks(settings.width, settings.height)
        self._focus: tuple[float, float] | None = None
        self._records = settings.record_lights or settings.record_work or settings.records_fates
        self.buffers = self._empty_buffers(progressive)

        # What is known, and learnt.
        self.first = self._base.first_units()
        self.history = state.history(settings, self.first, self.workers)
        self.words = self.history.words
        self.units = np.empty_like(self.buffers.primitive) if len(self.first) else self.buffers.primitive
        self._lamps = state.lamps(settings)
        self._use_lamps(state.shading.lamps)
        self.resting = state.rest.now
        self._counts = np.zeros((self.workers, COUNTERS), np.int64)
        self._verified = np.zeros(SHADOW_COUNTERS, np.int64)  # shadow counters of further samples
        self._occlusion_tests = np.zeros(self.workers, np.int64)
        self._learnt: Learnt | None = None  # if the frame ended here
        self._pixel_count: NDArray[np.int32] | None = None
        self._begun = False  # shading
        self._passes: list[NDArray[np.int32]] = []  # the pixels that each pass over the tiles has shaded
        self._parts: Parts | None = None
        for method in self.methods:
            method.begin(self)

    @property
    def seconds(self) -> float:
        """Seconds since the frame began, without those in which it was shown to somebody."""
        return self._state.clock() - self._started - self._paused

    @contextmanager
    def shown(self) -> Iterator[None]:
        """The time that whoever is shown the picture so far takes is not the frame's."""
        start = self._state.clock()
        try:
            yield
        finally:
            self._paused += self._state.clock() - start

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time one phase, which may come in several parts; what only makes modes to look at is not the frame's time."""
        start = self._state.clock()
        yield
        seconds = self._state.clock() - start
        self.phases[name] = self.phases.get(name, 0.0) + seconds
        if name in OF_MODES and self.settings.modes_beside:
            self._paused += seconds

    def _empty_buffers(self, progressive: bool = False, records: bool = True) -> Buffers:
        """Those of the first sample of each pixel, or of others, of which there are no `records` of lights and work."""
        s = self.settings
        planes = self._state.planes(s.width, s.height) if progressive else NO_PLANES
        asked = {
            "record_lights": s.record_lights and records,
            "record_fates": s.records_fates and records,
            "verify": s.verify,
            "record_work": s.record_work and records,
        }
        return empty_buffers(s.width, s.height, len(self._state.scene.lights), planes=planes, **asked)

    def _use_lamps(self, lamps: Lamps) -> None:
        self.shading = self._state.shading._replace(lamps=lamps)
        self.lights = lamps.places

    # --- phases, in the order of Figure 1 ------------------------------------------------------------

    def place_objects_and_lights(self) -> None:
        """Where is everything that moves?  Drop what is known of a light that moved, and what depends on an object that
        has come to rest, or rests no longer."""
        state = self._state
        world = state.world
        poses = world.pose(self.time)
        max_packet_size = min(method.max_packet_size for method in self.methods)
        if any([method.follows_rest() for method in self.methods]):
            world.place(poses, state.rest.update(poses, world.primitives, world.certain(poses)), max_packet_size)
        else:
            state.rest.forget()
            world.place(poses, max_packet_size=max_packet_size)
        self._use_lamps(self._lamps.at(state.scene.light_positions(self.time)))
        self.resting = state.rest.now
        self.history.follow_lights(self.lights, self._lamps)
        self.history.follow_rest(self.resting, state.world.outlines, self.workers)
        for method in self.methods:
            method.update(self)

    def trace_primary_rays(self) -> None:
        """What does each pixel see?"""
        self._trace_primary(self.rays, self.buffers, self._counts)
        if len(self.first) > 0:
            seen = (self.buffers.primitive, self.buffers.u, self.buffers.v, self.units)
            units_of(self.first, *(pixels.reshape(-1) for pixels in seen))

    def _trace_primary(self, rays: Pinhole, buffers: Buffers, counts: NDArray[np.int64]) -> None:
        placed, spaces = self._state.world.placed, self._state.workspaces(self.workers)

        def work(tile: Tile, worker: int) -> None:
            trace_primary(placed, rays, tile, self._everywhere, buffers, counts[worker], spaces[worker])

        self._for_each_tile(work)

    def test_occlusion(self) -> None:
        """§2.3: what does a neighbouring pixel show to be hidden?"""
        if not self.settings.keeps_modes:
            return
        height, history = self.settings.height, self.history
        units = self.buffers.primitive, self.first, self.units
        seen = self._state.world.placed, self.rays, *units, self.settings.symmetric

        def work(chunk: int, worker: int) -> None:
            rows = chunk * ROWS, min(height, (chunk + 1) * ROWS)
            self._occlusion_tests[worker] += occlusion_testing(*seen, *rows, history.words, history.hidden)

        for_each_chunk(work, -(-height // ROWS), self.workers, self.cancel)

    def prepare_culling(self) -> None:
        """What methods do before shading: certify cells, say."""
        for method in self.methods:
            method.prepare(self)

    def shade(self, lanes: NDArray[np.int32] | None = None) -> None:
        """§2.4, §2.5: Whitted shading, with shadow testing and shadow-mode setting; of these pixels of each block
        (`tracer.shading.primary`), or of all."""
        lanes = self._everywhere if lanes is None else lanes
        self._shade(self.rays, self.buffers, self._counts, lanes)
        self._passes.append(lanes)
        self._begun = True
        for sample in range(1, self.settings.samples):
            self.add_sample(sample)

    def _shade(
        self, rays: Pinhole, buffers: Buffers, counts: NDArray[np.int64], lanes: NDArray[np.int32], learns: bool = True
    ) -> None:
        tables = self._stage_tables(learns)

        tiles = tiles_to_shade(self.settings.width, self.settings.height, lanes, self.workers)
        first_pass = learns and not self._begun and not self._records  # what is shaded twice would count twice
        self._base.begin_shading(self, len(tiles), first_pass)
        shade_one = self._tile_shader(rays, lanes, buffers, tables[True])

        def work(tile: Tile, worker: int) -> None:
            def shade(culls: bool, counts: NDArray[np.int64]) -> None:
                shade_one(tile, worker, tables[culls][worker], counts)

            self._base.shade(shade, tile[4], counts[worker])

        self._for_each_tile(work, tiles)

    def _tile_shader(
        self, rays: Pinhole, lanes: NDArray[np.int32], buffers: Buffers, tables: list[StageTable]
    ) -> Callable[[Tile, int, StageTable, NDArray[np.int64]], None]:
        """What shades a tile, with a table of stages that needs no more memory than these."""
        placed, shading, depth = self._state.world.placed, self.shading, self.settings.depth
        spaces = self._state.workspaces(self.workers, max(table.given.rows for table in tables))

        def shade(tile: Tile, worker: int, table: StageTable, counts: NDArray[np.int64]) -> None:
            shade_tile(placed, shading, rays, tile, lanes, depth, table.given, buffers, counts, spaces[worker])

        return shade

    def rehearse(self, stages: list[Stage]) -> None:
        """Shade the whole picture with these stages alone; nothing is shown or counted."""
        shade, uncounted = self._reshader(stages, self._everywhere), np.zeros_like(self._counts)
        self._for_each_tile(lambda tile, worker: shade(tile, worker, uncounted[worker]))

    def _reshader(
        self, stages: list[Stage], lanes: NDArray[np.int32]
    ) -> Callable[[Tile, int, NDArray[np.int64]], None]:
        """What shades a tile once more, with these stages alone, in buffers of its own."""
        seen = {name: getattr(self.buffers, name) for name in ("depth", "primitive", "u", "v")}
        table = StageTable(stages, verify=False, records=True)
        buffers = self._empty_buffers(records=False)._replace(**seen)
        shade = self._tile_shader(self.rays, lanes, buffers, [table])
        return lambda tile, worker, counts: shade(tile, worker, table, counts)

    def _stage_tables(self, learns: bool) -> dict[bool, list[StageTable]]:
        """The stages of each worker, with those of the base and without."""
        tables: dict[bool, list[StageTable]] = {True: [], False: []}
        for worker in range(self.workers):
            others = [stage for method in self._others for stage in method.stages(self, worker, learns)]
            base = self._base.stages(self, worker, learns)
            tables[True].append(StageTable([*base, *others], self.settings.verify, self._records))
            tables[False].append(StageTable(others, self.settings.verify, self._records))
        return tables

    def set_modes(self) -> None:
        """§2.5, §2.6: keep what was learnt, and say what has been seen whole."""
        self.learn()
        assert self._learnt is not None
        self.history.keep(self._learnt)
        for method in self.methods:
            method.keep(self)

    def learn(self) -> None:
        """§2.5, §2.6: what will be known if no more of the frame is shaded than is by now."""
        if self._pixel_count is None:
            self._pixel_count = self._count(self.units)
        counts, history = self._pixel_count, self.history
        if not self.settings.keeps_modes:
            self._learnt = Learnt(history.words, counts, history.highest_count, history.taught)
            return
        shaded = self._shaded
        of_shaded = counts if shaded is None else self._count(np.where(shaded, self.units, np.int32(MISS)))
        self._learnt = history.learnt(counts, of_shaded, self.settings.zoom_factor)

    def _count(self, units: NDArray[np.int32]) -> NDArray[np.int32]:
        """How many of these pixels (height, width) see each unit."""
        counts = np.empty(len(self.history.words), np.int32)
        count_pixels(units, counts)
        return counts

    def discard(self) -> None:
        """Learn nothing more from this frame, unless it is over: no more than the last picture of it that was shown
        has taught."""
        if self.over:
            return
        self.over = True
        if self._learnt is not None:
            self.history.keep(self._learnt)
        else:
            self.history.discard_frame()
        for method in self.methods:
            method.discard(self, self._begun)

    # --- pictures that are refined progressively -------------------------------------------------------

    def begin_at(self, focus: tuple[float, float] | None) -> None:
        """Let tiles near this point of the picture come first; it is given in parts of width and height."""
        if focus is not None:
            self._focus = focus[0] * self.settings.width, focus[1] * self.settings.height

    def see_surfaces(self, first: int = 0) -> None:
        """What do all primary hits look like before any shadow ray is traced?  `first` says which pixels
        are to be shaded first (`tracer.progressive`)."""
        placed, shading, rays, buffers = self._state.world.placed, self.shading, self.rays, self.buffers
        self._parts = Parts(self.settings.width, self.settings.height, buffers.planes, float(rays.spread), first)
        self._for_each_tile(lambda tile, worker: see_surfaces(placed, shading, rays, tile, buffers))
        if any(method.finds_first for method in self.methods):
            self.find_first()

    def find_first(self) -> None:
        """Let methods find out what they know of all primary hits, before any is shaded."""
        placed, shading, rays, buffers = self._state.world.placed, self.shading, self.rays, self.buffers
        tables = self._stage_tables(learns=True)[True]
        spaces = self._state.workspaces(self.workers, max(table.given.rows for table in tables))

        def work(tile: Tile, worker: int) -> None:
            stages = tables[worker].given
            find_in_tile(placed, shading, rays, tile, self._everywhere, stages, buffers, spaces[worker])

        self._for_each_tile(work)

    def shade_part(self, part: float) -> None:
        """Shade what is left until so many sixteenths of the pixels are shaded.

        Raises RuntimeError where the frame is over, as another one has begun."""
        if self.over:
            raise RuntimeError("another frame of this renderer has begun: this one cannot go on")
        if self._parts is None:
            with self.phase("shading"):
                self.shade()
            return
        if part == TURNS:  # nobody will be filled in
            self.buffers = self.buffers._replace(planes=NO_PLANES)
        for lanes in self._parts.left_up_to(part, self._fill, self._untaught() if part < TURNS else None):
            with self.phase("shading"):
                self.shade(lanes)

    @property
    def _shaded(self) -> NDArray[np.bool_] | None:
        """(height, width): which pixels have been shaded by now; None where all have, or all are at once."""
        return None if self._parts is None else self._parts.pixels

    def _untaught(self) -> NDArray[np.int32] | None:
        """The pixels of each block that are to be shaded first, as they would teach; None where modes are not kept."""
        if not self.settings.keeps_modes:
            return None
        lanes = all_blocks(self.settings.width, self.settings.height, 0)
        find_untaught(self.units, self.words, self.history.hidden, lanes)
        return lanes

    def _fill(self) -> None:
        """Fill in the pixels that have not been shaded."""
        if self._parts is not None:
            with self.phase("filling"):
                color = self.buffers.color.reshape(*self.buffers.primitive.shape, 3)
                self._parts.fill(color, self.workers, self.cancel)

    def so_far(self) -> Frame:
        """A frame of which some pixels have not been shaded: these are filled in from the others.  What it has learnt
        is kept if it is left now."""
        assert self._parts is not None, "a progressive picture"
        with self.phase("mode setting"):
            self.learn()
        self._fill()
        frame = self._frame()
        shaded, frame.color = frame.color, self._parts.give()
        with self.phase("filling"):
            self._parts.stretch_records(frame, shaded)
        frame.statistics.phases["filling"] = self.phases["filling"]
        return frame

    # --- further samples -------------------------------------------------------------------------------

    def add_sample(self, number: int) -> None:
        """Mix in a further sample of each pixel, placed by the R2 sequence; it uses modes but counts nothing."""
        shift = ((0.5 + number / GOLDEN) % 1.0, (0.5 + number / GOLDEN**2) % 1.0)
        rays = pinhole(self._camera, self.settings.width, self.settings.height, shift)
        buffers, counts, self.sample = self._empty_buffers(records=False), np.zeros_like(self._counts), number
        self._trace_primary(rays, buffers, counts)
        self._shade(rays, buffers, counts, self._everywhere, learns=False)
        if number == 1:
            self._sum, self._reference_sum = self.buffers.color, self.buffers.reference
        self._sum, self._reference_sum = self._sum + buffers.color, self._reference_sum + buffers.reference
        self._verified += counts[:, SHADOW:].sum(0)
        taken = np.float32(number + 1)
        self.buffers = self.buffers._replace(
            color=self._sum / taken, reference=self._reference_sum / taken, wrong=self.buffers.wrong + buffers.wrong
        )

    def sampled(self, whole: Frame, samples: int) -> Iterator[Frame]:
        """The finished frame, `whole`, with 2, 3, ... samples a pixel."""
        for number in range(1, samples):
            self.add_sample(number)
            yield replace(
                whole,
                settings=replace(self.settings, samples=number + 1),
                color=self.buffers.color.reshape(whole.color.shape),
                reference=None if whole.reference is None else self.buffers.reference.reshape(whole.color.shape),
                wrong=None if whole.wrong is None else self.buffers.wrong.reshape(whole.wrong.shape),
                statistics=replace(whole.statistics, wrong=self._wrong()),
            )

    # --- what became of one pixel's rays (`tracer.inspect`) ----------------------------------------------

    def has_shaded(self, x: int, y: int) -> bool:
        """Whether a pixel has been shaded by now."""
        return self._shaded is None or bool(self._shaded[y, x])

    def taught(self, unit: int) -> int:
        """How many pixels have set modes of a unit that is seen whole, and not FULLY_RENDERED yet."""
        return int((self.history.taught if self._learnt is None else self._learnt.taught)[unit])

    def stages_now(self) -> list[tuple[ShadowMethod, Stage]]:
        """The stages that answered shadow rays of this frame, with the methods that they are of; they learn nothing any
        more.  Those that shade are left out: then every ray is traced."""
        chosen = self._others if not self._base.takes_part else self.methods
        stages = [(method, stage) for method in chosen for stage in method.stages(self, 0, learns=False)]
        return [(method, stage) for method, stage in stages if stage.shade is None]

    def shade_again(self, x: int, y: int, stages: list[Stage]) -> None:
        """Shade the tile of a pixel once more, with these stages, in the company in which it was shaded; alone if it
        has not been shaded yet."""
        width, height = self.settings.width, self.settings.height
        block, lane = (y // BLOCK + EDGE, x // BLOCK + EDGE), 1 << (y % BLOCK * BLOCK + x % BLOCK)
        alone = all_blocks(width, height, 0)
        alone[block] = lane
        lanes = next((one for one in self._passes if one[block] & lane), alone)
        tiles = tiles_to_shade(width, height, lanes, self.workers)
        tile = next(tile for tile in tiles if tile[0] <= x < tile[2] and tile[1] <= y < tile[3])
        self._reshader(stages, lanes)(tile, 0, np.zeros_like(self._counts[0]))

    # --- the result --------------------------------------------------------------------------------------

    def finished(self) -> Frame:
        """The frame, all phases of which are done."""
        frame, self.over = self._frame(), True
        for method in self.methods:
            method.finish(self, frame.statistics)
        return frame

    def _frame(self) -> Frame:
        buffers, settings, learnt = self.buffers, self.settings, self._learnt
        assert learnt is not None
        shape, lights = buffers.primitive.shape, len(self._state.scene.lights)
        tests = int(self._occlusion_tests.sum()) if not settings.modes_beside else 0
        statistics = gather(self._counts, tests, lights if settings.keeps_modes else 0)
        statistics.part = 1.0 if self._parts is None else self._parts.share
        statistics.phases, statistics.seconds = dict(self.phases), self.seconds  # counting is none of the frame's work
        if settings.keeps_modes:
            statistics.mode_changes = mode_changes(self.words, learnt.words, self.workers)
        statistics.resting = self._resting_primitives()
        if settings.record_lights:
            statistics.samples = sample_counts(buffers.asked, buffers.reached)
        statistics.built = self._state.world.built()
        layers: dict[str, Any] = {}
        for method in self.methods:
            method.report(statistics)
            layers |= method.layers(self)
        lamps = int((np.diff(self.shading.lamps.first) > 1).sum())
        statistics.wrong = self._wrong()
        statistics.say(remark(Method.parse(settings.method), lights, lamps))
        structures = {name: layers.pop(name) for name in list(layers) if not isinstance(layers[name], np.ndarray)}

        def per_pixel(rows: NDArray, recorded: bool) -> NDArray | None:
            return rows.reshape(*shape, *rows.shape[1:]) if recorded else None

        return Frame(
            time=self.time,
            camera=self._camera,
            settings=replace(settings),
            color=buffers.color.reshape(*shape, 3),
            depth=buffers.depth,
            primitive=buffers.primitive,
            normal=buffers.normal.reshape(*shape, 3),
            modes=learnt.words.copy(),  # those of the history change when lights move
            modes_before=self.words,
            pixel_count=learnt.pixel_count,
            highest_count=learnt.highest_count,
            lights=lights,
            asked=per_pixel(buffers.asked, settings.record_lights),
            reached=per_pixel(buffers.reached, settings.record_lights),
            fates=per_pixel(buffers.fates, settings.records_fates),
            reference=per_pixel(buffers.reference, settings.verify),
            wrong=per_pixel(buffers.wrong, settings.verify),
            cells=layers.pop("cells", None),
            certificates=layers.pop("certificates", None),
            saved=per_pixel(buffers.saved, settings.record_work),
            cost=per_pixel(buffers.cost, settings.record_work),
            due_rays=per_pixel(buffers.due_rays, settings.record_work),
            layers=layers,
            structures=structures,
            statistics=statistics,
        )

    def _resting_primitives(self) -> int:
        primitives, rests = self._state.world.primitives, self.resting.since > 0
        return int((np.diff(primitives.triangle_starts) + np.diff(primitives.quadric_starts))[rests].sum())

    def _wrong(self) -> WrongCounts | None:
        """What verifying has found in all samples so far."""
        if not self.settings.verify:
            return None
        found, wrong = shadow_counts(self._verified + self._counts[:, SHADOW:].sum(0)), self.buffers.wrong
        shaded = self._shaded
        return WrongCounts(
            answers=int(wrong.sum()),
            due=found.due,
            untraced=found.due - found.traced,
            pixels=int(np.count_nonzero(wrong)),
            shaded=wrong.size if shaded is None else int(np.count_nonzero(shaded)),
            samples=self.sample + 1,
        )

    def _for_each_tile(self, work: Callable[[Tile, int], None], tiles: list[Tile] | None = None) -> None:
        """Call work(tile, worker) for every tile, those near the focus first, where there is one."""
        tiles = tiles or self._tiles
        if self._focus is not None:
            tiles = nearest_first(tiles, *self._focus)
        for_each_chunk(lambda chunk, worker: work(tiles[chunk], worker), len(tiles), self.workers, self.cancel)
