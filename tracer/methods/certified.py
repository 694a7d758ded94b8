"""Certified cells: shadow rays are culled by what is proved of the cells in which they end (docs/certified-cells.md).

Before shading, certificates are made for what the primary hits are about to need and what other rays requested in the
last frame (`tracer.neighbours.certified`).  In shadow testing `find` leads each point to its cell, `choose` answers the
rays that the cell's certificates say all about, and tests the candidates of those that they say much about; rays of
lamps, which have no certificates, it answers for all samples at once.  `finish` notes what reflected and refracted rays
have missed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import MAX_CULLED_LIGHTS
from tracer.culling.shadow_testing import shadow_batch_in
from tracer.culling.stages import call_at, scratch_of
from tracer.culling.verdicts import Answered, CullReason, Verdict
from tracer.geometry.memory import without_refcount
from tracer.methods.certified_lights import CertifiedLights
from tracer.methods.interface import FrameView, Services, Stage
from tracer.methods.spatial_cache import NOWHERE, WithStore
from tracer.neighbours.area_lights.find_lamp_answers import find_answers
from tracer.neighbours.area_lights.lamp_answers import LAMP_ANSWER_ROWS, answer_sample, lamp_answers_in
from tracer.neighbours.cells_of_space import record_cells
from tracer.neighbours.certified.lookup import CELL_POINT_ROWS, cell_points_in, cull_by_certificates, find_cells
from tracer.neighbours.certified.requests import (
    Requests,
    make_requests,
    request_at_hits,
    request_at_points,
    requests_of,
)
from tracer.neighbours.certified.scheduler import CertificateScheduler
from tracer.neighbours.certified.slack import SlackFinder, proved_cells
from tracer.neighbours.certified.store import CertificateStore
from tracer.neighbours.certified.view import view_at
from tracer.runtime.kernels import kernel, native_callback
from tracer.shading.points import points_in
from tracer.shading.primary import block_at, blocks_of
from tracer.shading.wave import wave_in
from tracer.simd import any_lane, i32x16, i64_at, select
from tracer.simd.records import pack
from tracer.statistics import FrameStatistics
from tracer.visibility.budget import Budget

SET_UP, SET_UP_LIGHT = 2e-6, 2e-7  # seconds for each primitive, and for each of these and each light


@native_callback
def find(data, call, light, count, counts):
    """In which cell does the shadow ray of each point end?"""
    given, certified = call_at(call), view_at(data)
    found = cell_points_in(scratch_of(given))
    find_cells(certified, points_in(given.points), count, found)
    if given.bounce == 0:
        record_cells(certified.cell, given.place, wave_in(given.rays, count), found.unit)


@native_callback
def choose(data, call, light, count, counts):
    """Answer rays by certificates, and those of lamps by beams; candidates are asked where packets of primary hits'
    rays are not quicker."""
    given, certified = call_at(call), view_at(data)
    points, batch, found = points_in(given.points), shadow_batch_in(given.shadows), cell_points_in(scratch_of(given))
    lamps = certified.lamps
    if light < len(lamps.known) and lamps.known[light] != 0:
        answers = lamp_answers_in(scratch_of(given)[CELL_POINT_ROWS:])
        if given.nth == 0:
            find_answers(lamps, points, answers, batch, given.samples, given.sample, light, count, i64_at(counts))
        answer_sample(answers, given.nth, count, batch, i64_at(counts))
        return
    asks, position = given.bounce >= certified.first_asking, given.samples[given.sample]
    cull_by_certificates(certified, points, found, position, light, count, asks, batch, i64_at(counts))


@native_callback
def finish(data, call, light, count, counts):
    """Note what a wave has missed; what primary hits miss is requested before they are shaded."""
    given, certified = call_at(call), view_at(data)
    if given.bounce > 0:
        found = cell_points_in(scratch_of(given))
        request_at_points(certified, requests_of(certified.requests, given.tile), found, count)


@kernel
def request_in_tiles(view, camera, tiles, numbers, lights, buffers):
    """Request the certificates that the primary hits of some tiles are about to need.

    Tiles have `numbers` (k,) among all (n, 5); their hits are in the buffers; `view` is the address of the
    certificates (`CertificateView`)."""
    certified, buffers = view_at(view), without_refcount(buffers)
    width, hits = np.int32(buffers.primitive.shape[1]), (buffers.primitive, buffers.u, buffers.v)
    for number in numbers:
        tile = tiles[number]
        requests = requests_of(certified.requests, number)
        for block in range(certified.first_vector, blocks_of(tile), certified.stride):
            x, y, inside = block_at(tile, block)
            if any_lane(inside):
                place = select(inside, y * width + x, i32x16(0))
                request_at_hits(certified, requests, lights, camera.origin, hits, place, inside)


class CertifiedCells(WithStore):
    """Makes certificates, within a budget, and culls by them."""

    store: CertificateStore | None

    def __init__(self, services: Services) -> None:
        super().__init__(services)
        self.scheduler: CertificateScheduler | None = None
        self._requests: Requests | None = None
        self._slack: SlackFinder | None = None
        self._cell = NOWHERE
        self._words: NDArray[np.unsignedinteger] | None = None

    def begin(self, frame: FrameView) -> None:
        super().begin(frame)
        self._requests = self._words = None
        self._cell = np.zeros(frame.settings.width * frame.settings.height, np.int32)

    def follows_rest(self) -> bool:
        return True

    def update(self, frame: FrameView) -> None:
        self.made_now = self.store is None
        if self.store is None:
            self.store = CertificateStore(
                self.services.world, len(frame.lights), frame.workers, self.services.cost_model
            )
            self.scheduler = CertificateScheduler(self.store, self.services.clock)
        self.store.update(frame.shading.lamps, frame.resting, frame.workers)

    def prepare(self, frame: FrameView) -> None:
        self.take_requests(frame, frame.settings.certificate_seconds)
        self.certify(frame, frame.settings.certificate_seconds)

    def take_requests(self, frame: FrameView, seconds: float) -> None:
        """Make room for what this frame's rays request; it may certify for so many seconds."""
        assert self.scheduler is not None, "updated before"
        self._requests = self.scheduler.begin(len(frame.tiles), Budget(frame.settings.certificates, seconds))

    def certify(self, frame: FrameView, seconds: float) -> None:
        """Certify for so many seconds, at most, what is requested."""
        store, tiles = self.store, frame.tiles
        assert store is not None and self.scheduler is not None, "updated before"
        if not store.certified.any():
            return

        def request(numbers: NDArray[np.int64], requests: Requests) -> None:
            view = store.view(len(tiles), requests, NOWHERE)
            block = pack(view)  # which holds addresses of arrays that only the view keeps
            request_in_tiles(block.ctypes.data, frame.rays, tiles, numbers, frame.lights, frame.buffers)

        budget = Budget(frame.settings.certificates, seconds)
        self._counts = self.scheduler.run(len(tiles), request, budget, frame.cancel)

    @property
    def finds_first(self) -> bool:
        return True

    def stages(self, frame: FrameView, worker: int, learns: bool) -> list[Stage]:
        assert self.store is not None, "updated before"
        requests = self._requests if learns and self._requests is not None else make_requests(0)
        view = self.store.view(len(frame.tiles), requests, self._cell if learns else NOWHERE)
        rows = CELL_POINT_ROWS + (LAMP_ANSWER_ROWS if view.lamps.known.any() else 0)
        asks = finish if len(requests.key) else None
        return [Stage(view, find=find, choose=choose, finish=asks, rows=rows)]

    def keep(self, frame: FrameView) -> None:
        self._words = self._words_seen()  # cells may get other numbers now
        if self.scheduler is not None and self._requests is not None:
            self.scheduler.keep(self._requests)
            self._keep_within(frame)

    def discard(self, frame: FrameView, begun: bool) -> None:
        """Drop what was certified, or keep it where time is short (`CertificateScheduler.cancel`)."""
        if self.scheduler is not None and self._requests is not None:
            if self.scheduler.cancel(self._requests, begun) and begun:
                self._keep_within(frame)

    def _keep_within(self, frame: FrameView) -> None:
        assert self.store is not None, "updated before"
        self.store.keep_within(1e6 * frame.settings.certificate_memory, self._cell)

    def _words_seen(self) -> NDArray[np.unsignedinteger]:
        assert self.store is not None, "updated before"
        return self.store.at_pixels(self._cell)

    def layers(self, frame: FrameView) -> dict[str, NDArray]:
        shape = frame.buffers.primitive.shape
        cell, words = self._cell.reshape(shape), self._words_seen() if self._words is None else self._words
        return {"cells": np.where(cell > 0, cell, np.int32(-1)), "certificates": words.reshape(shape)}

    def finish(self, frame: FrameView, statistics: FrameStatistics) -> None:
        if self.scheduler is not None:
            self.scheduler.finish(self._counts.certificates, statistics.shadow.due)

    def because(self, answered: Answered) -> CullReason:
        state, named = self.explain(answered.primitive, np.array(answered.point, np.float32), answered.light)
        if state == "candidates":
            return CullReason(Verdict.CANDIDATES, named)
        if state == ("lit" if answered.lit else "full"):
            return CullReason(Verdict.CERTIFIED_LIT if answered.lit else Verdict.CERTIFIED_FULL, named)
        return CullReason(Verdict.BEAM)  # of a lamp, or where a point lies between two cells

    @property
    def slack(self) -> SlackFinder:
        """What finds how far lights may move before certificates fail."""
        assert self.store is not None, "updated before"
        if self._slack is None or self._slack.store is not self.store:
            self._slack = SlackFinder(self.store)
        return self._slack

    def more(self, primitive: int, point: NDArray[np.float32], light: int) -> str:
        store = self.store
        if store is None or light >= store.count or not store.certified[light]:
            return ""
        owner, u, v, number = store.place_of(primitive, point)
        proved = proved_cells(store.cells, np.array([number], np.int32), light)
        if proved[0]:
            slack, most = float(self.slack.of_cells(proved, light)[0]), self.slack.most
            return f"That stays so while the light moves by less than {slack:.3g}{'' if slack < most else ', or more'}."
        one = np.ones(1, np.int32)
        if owner >= 0 and self.slack.are_provable(owner * one, [u], [v], light * one)[0]:
            return "Regret: a cell that is small enough can be proved here."
        return ""

    def forget(self) -> None:
        super().forget()
        self.scheduler = None

    @property
    def price(self) -> float:
        """Seconds, about, that it takes to set the store up."""
        services = self.services
        lights = min(len(services.shading.lamps.places), MAX_CULLED_LIGHTS)
        return (SET_UP + SET_UP_LIGHT * lights) * len(services.world.object_of)

    @property
    def pays_as_a_rule(self) -> bool:
        """Whether certificates can be expected to save time."""
        return self.services.cost_model.costly_rays


def certified(services: Services) -> CertifiedCells | CertifiedLights:
    """The method: of cells where their words have room for all lights, else of lights."""
    few = len(services.shading.lamps.places) <= MAX_CULLED_LIGHTS
    return CertifiedCells(services) if few else CertifiedLights(services)
