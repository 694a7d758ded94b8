"""The pixels that set a mode: those of the clicked primitive in the frames in which its modes were set.

The frames were not kept.  So when a primitive is clicked, their primary rays are traced once more, with shadow rays to
all lights and without culling: what the primitive's pixels meet is what they met then.  A mode that none of them can
have set was set by reflected or refracted rays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tracer.culling.modes import FULL_SHADOW, NON_SHADOW, shadow_mode
from tracer.explanation import explain
from tracer.frame import Frame
from tracer.mode_origins import NEVER, Origins
from tracer.reasons import TaughtBy, Why
from tracer.renderer import Renderer
from tracer.scene.model import Camera
from tracer.settings import Settings
from viewer.services.frame_history import FrameHistory
from viewer.services.queries import Ask, Newest
from viewer.services.render_request import Traced
from viewer.services.selection import Selection
from viewer.state.history import FrameRecord
from viewer.state.picking import Pick
from viewer.state.readings import can_record_lights

_LOOKED_INTO = 6  # pixels in shadow of which one may be in that of something static
MOST_PIXELS = 1 << 22
"""Of frames that are traced once more; larger ones are not."""
Cancel = Callable[[], bool] | None


@dataclass(frozen=True)
class OriginPixels:
    """The pixels of a frame that met one answer of one light: how many, and one of them (x, y), None where only
    reflected or refracted rays did."""

    count: int
    pixel: tuple[int, int] | None


Found = dict[tuple[int, bool], OriginPixels]
"""By light, and whether it is lit."""


def trace_once_more(
    renderer: Renderer,
    time: float,
    camera: Camera | None,
    settings: Settings,
    unit: int,
    in_cells: bool,
    cancel: Cancel = None,
) -> Found:
    """Trace a frame once more, in the world of a renderer, and return what the pixels of a unit met in it."""
    settings = replace(
        settings.recording_only("record_lights"), method="cells" if in_cells else "paper", depth=0, samples=1,
        modes=False, certificate_seconds=math.inf,
    )  # fmt: skip
    alone = Renderer(renderer.scene, settings, world=renderer.world)
    return _met_in(alone, alone.render(time, camera, cancel), unit)


def can_trace_once_more(settings: Settings, lights: int) -> bool:
    """Return whether a frame is small enough to be traced once more with what reaches each pixel."""
    pixels = settings.width * settings.height
    return pixels <= MOST_PIXELS and can_record_lights(pixels, lights)


def find_pixels(
    renderer: Renderer,
    frame: Frame,
    number: int,
    time: float,
    camera: Camera,
    settings: Settings,
    unit: int,
    in_cells: bool,
    cancelled: Callable[[], bool],
) -> tuple[int, Found]:
    """Return the number of an earlier frame and what the pixels of a unit met in it; the world is left as it is."""
    try:
        return number, trace_once_more(renderer, time, camera, settings, unit, in_cells, cancelled)
    finally:
        renderer.take_turn(frame.time)


def with_origins(
    found: Why, origins: Origins, of: Callable[[int, int, bool], OriginPixels | None], name: Callable[[int], str]
) -> Why:
    """Return reasons that say which frames set the modes, and which pixels of these as far as `of` knows them, by the
    frame's number, the light, and whether it was seen lit; `name` names a frame."""
    coverage = found.coverage
    if coverage is not None and origins.whole != NEVER:
        coverage = replace(coverage, taught=TaughtBy(origins.whole, name(origins.whole)))
    reasons = []
    for one in found.reasons:
        by = []
        for lit, number in origins.lights[one.light].met() if one.light < len(origins.lights) else ():
            pixels = of(number, one.light, lit)
            by.append(TaughtBy(number, name(number), None if pixels is None else pixels.pixel, lit, pixels is not None))
        instead = None if one.instead is None else replace(one.instead, taught=tuple(by))
        reasons.append(replace(one, taught=tuple(by), instead=instead))
    return replace(found, coverage=coverage, reasons=tuple(reasons))


def _met_in(renderer: Renderer, frame: Frame, unit: int) -> Found:
    """Return what the pixels of a unit met in a frame that was traced without knowing anything before."""
    assert frame.asked is not None and frame.reached is not None
    here, found = frame.cell == unit, Found()
    moves = renderer.world.placed.has_dynamic
    for light in range(frame.lights):
        mode = int(shadow_mode(frame.modes[unit], light))
        for lit, bit in ((False, FULL_SHADOW), (True, NON_SHADOW)):
            if not mode & bit:
                continue
            asked, reached = frame.asked[..., light], frame.reached[..., light]
            met = here & (asked > 0) & ((reached > 0) if lit else (reached == 0))
            rows, columns = np.nonzero(met)
            if not len(rows):
                continue
            order = np.argsort(np.hypot(rows - rows.mean(), columns - columns.mean()), kind="stable")
            at = [(int(columns[i]), int(rows[i])) for i in order[:_LOOKED_INTO]]
            static = at if lit or not moves else [p for p in at if _is_static(renderer, frame, *p, light)]
            found[light, lit] = OriginPixels(len(rows), (static or at)[0])
    return found


def _is_static(renderer: Renderer, frame: Frame, x: int, y: int, light: int) -> bool:
    """Return whether what blocks a light first there never moves."""
    blocker = explain(renderer, frame, x, y)[light].blocker
    return blocker is not None and renderer.scene.object_of(blocker) == 0


class OriginFinder:
    """Looks into the frames that set the modes of what was clicked, one by one; `of` is what is known."""

    def __init__(self, selection: Selection, history: FrameHistory, query: Ask) -> None:
        self._selection, self._history, self._query = selection, history, query
        self._newest = Newest()
        self._frame: Frame | None = None  # with which the newest was asked
        self._subject: tuple[object, object] | None = None
        self._known: dict[int, Found] = {}

    def of(self, number: int, light: int, lit: bool) -> OriginPixels | None:
        """Return who met an answer of a light in a frame, by its number; None while that is not known."""
        known = self._known.get(number)
        return None if known is None else known.get((light, lit), OriginPixels(0, None))

    @property
    def answered(self) -> int:
        """How many frames have been looked into."""
        return len(self._known)

    def update(self, scene: object, shown: Traced | None) -> None:
        """Take up what was found, and look into the next frame; `shown` is None where nothing may be asked now."""
        pick = self._selection.picked
        subject = None if pick is None else (pick.unit, pick.in_cells)
        if self._subject is None or self._subject[0] is not scene or self._subject[1] != subject:
            self._newest.forget()
            self._subject, self._known = (scene, subject), {}
        if pick is None or shown is None or not shown.whole:
            self._newest.forget()  # one that is under way gives way to what moves
            return
        if self._frame is None or not self._newest.pending or self._frame.time != shown.frame.time:
            self._frame = shown.frame
        record = self._next(pick)
        if record is not None:
            asked = record.number, record.state.time, record.camera, record.settings, pick.unit, pick.in_cells
            self._newest.take(self._query(find_pixels, self._frame, *asked))
            if self._newest.answer is not None:
                number, found = self._newest.answer
                self._known[number] = found

    def _next(self, pick: Pick) -> FrameRecord | None:
        """Return a frame that set modes of the unit, and has not been looked into."""
        origins = self._history.origins_of(pick)
        if origins is None or self._newest.problem:
            return None
        for number in sorted({number for one in origins.lights for _, number in one.met()} - self._known.keys()):
            record = self._history.records.get(number)
            # Of a picture that was left before it was whole, nobody knows any more which of its pixels were shaded.
            if record is not None and record.whole and can_trace_once_more(record.settings, len(pick.shadows)):
                return record
        return None
