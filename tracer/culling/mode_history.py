"""The modes and pixel counts of all units, from one frame to the next (§2.2 of the paper).

A pixel count means something at one resolution only, so each resolution has a history of its own.  A coarser one takes
over what a finer one has seen whole: more pixels have spoken for it than the coarser picture has.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import NamedTuple

import numpy as np

from tracer.culling import modes
from tracer.culling.dependence import drop_dependent
from tracer.culling.occlusion import set_occlusion_modes
from tracer.culling.rest import Resting, changes, nothing_rests
from tracer.geometry.primitives import Outlines
from tracer.scene.lights import LampTable


class Learnt(NamedTuple):
    """What one frame hands on to the next: see `ModeHistory`."""

    words: np.ndarray
    pixel_count: np.ndarray
    highest_count: np.ndarray
    taught: np.ndarray


class ModeHistory:
    """Modes and counts of all units at one resolution.

    words (units,) uint32 or uint64 (`tracer.culling.modes`); pixel_count and highest_count (units,) int32;
    taught (units,) int32, the pixels that have set modes of a unit that is not FULLY_RENDERED yet
    (`tracer.culling.occlusion.set_occlusion_modes`).  Of the frame under way: hidden (units,) bool, gained
    (workers, units) like words.
    """

    def __init__(self, object_of: np.ndarray, lights: int, workers: int, first: np.ndarray) -> None:
        """object_of (primitives,) tells whose each is: object 0 is static; first (primitives + 1,) is each one's first
        unit (`tracer.culling.cells`), or nothing where primitives are units."""
        self._units_of = np.diff(first) if len(first) else np.ones(len(object_of), np.int32)
        object_of = np.repeat(object_of, self._units_of)
        units, word = len(object_of), modes.word_type(lights)
        self.words = np.where(object_of != 0, word(modes.DYNAMIC), word(modes.INIT)).astype(word)
        self.pixel_count = np.zeros(units, np.int32)
        self.highest_count = np.zeros(units, np.int32)
        self.taught = np.zeros(units, np.int32)
        self.hidden = np.zeros(units, np.bool_)
        self.gained = np.zeros((workers, units), word)
        self.light_positions: np.ndarray | None = None
        self._lamps: LampTable | None = None
        self._object_of, self._resting = object_of, nothing_rests(0)

    def copied(self) -> ModeHistory:
        """The same, for another renderer of the same world: what either learns from here on, it knows alone."""
        copied = copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                setattr(copied, name, value.copy())
        return copied

    def take_finer(self, finer: ModeHistory, ratio: float) -> None:
        """Know what a finer resolution, used just before, has seen whole; `ratio` is how many of its pixels, a number
        below 1, a unit covers here for each there."""
        highest = np.maximum(np.rint(finer.highest_count * ratio), 1).astype(np.int32)
        if not self._knows_of_the_same(finer):
            self.words, self.highest_count, self.taught = finer.words.copy(), highest, np.zeros_like(self.taught)
            self.light_positions, self._lamps, self._resting = finer.light_positions, finer._lamps, finer._resting
            return
        whole = modes.occlusion_mode(finer.words) == modes.FULLY_RENDERED
        known = modes.occlusion_mode(self.words) == modes.FULLY_RENDERED
        highest = np.where(known, np.maximum(highest, self.highest_count), highest)
        self.highest_count = np.where(whole, highest, self.highest_count)  # anew: frames have the array that was
        self.words[whole] = (self.words[whole] & ~self.words.dtype.type(3)) | finer.words[whole]

    def _knows_of_the_same(self, other: ModeHistory) -> bool:
        """Whether lights, and what rests, were alike when the last frames of both were rendered."""
        if self.light_positions is None or other.light_positions is None or self._lamps is not other._lamps:
            return False
        same = np.array_equal(self._resting.since, other._resting.since)
        return same and np.array_equal(self.light_positions, other.light_positions)

    def make_room(self, workers: int) -> None:
        """For what so many workers gain."""
        if len(self.gained) < workers:
            self.gained = np.zeros((workers, len(self.words)), self.words.dtype)

    def follow_lights(self, positions: np.ndarray, lamps: LampTable) -> None:
        """Forget what is known of lights that are not where the last frame had them, or of another shape or with other
        samples; positions (lights, 3) are their centres."""
        before, self.light_positions = self.light_positions, positions.copy()
        shapes, self._lamps = self._lamps, lamps
        if before is not None and shapes is not None:
            moved = (before != positions).any(axis=1)
            if shapes is not lamps:
                moved |= [a != b for a, b in zip(shapes.lights, lamps.lights, strict=True)]
            if moved.any():
                modes.forget_lights(self.words, np.flatnonzero(moved).tolist())
                self.taught = np.zeros_like(self.taught)

    def follow_rest(self, resting: Resting, outlines: Callable[[], Outlines], threads: int) -> None:
        """Let the units of what rests carry modes, and no others of dynamic objects; after `follow_lights`.

        What depends on objects that have started or stopped since the last frame is forgotten."""
        before = self._resting if len(self._resting.since) else nothing_rests(len(resting.since))
        started, stopped = changes(before, resting)
        self._resting = resting
        if not len(started.which) and not len(stopped.which):
            return
        for changed, mode in ((started, modes.DYNAMIC), (stopped, modes.INIT)):
            concerned = np.zeros(len(resting.since), np.bool_)
            concerned[changed.which] = True
            self.words[concerned[self._object_of]] = mode
        for changed, mode in ((started, modes.FULL_SHADOW), (stopped, modes.NON_SHADOW)):
            self._drop_dependent(outlines(), changed.boxes, mode, threads)
        self.taught = np.zeros_like(self.taught)
        # What lies between a unit and a lamp of several samples is not looked into.
        assert self._lamps is not None
        modes.forget_lights(self.words, np.flatnonzero(~self._lamps.single).tolist())

    def _drop_dependent(self, outlines: Outlines, boxes: np.ndarray, mode: int, threads: int) -> None:
        """Drop a shadow mode of what may depend on boxes (k, 6); the cells of a primitive as one."""
        assert self.light_positions is not None
        if len(self.words) == len(self._units_of):
            drop_dependent(self.words, outlines, self.light_positions, boxes, mode, threads)
            return
        word = self.words.dtype.type
        kept = np.full(len(self._units_of), ~word(0) ^ word(modes.FULLY_RENDERED ^ 3), word)
        drop_dependent(kept, outlines, self.light_positions, boxes, mode, threads)
        lost = self.words & ~np.repeat(kept | word(3), self._units_of)
        self.words ^= lost
        self.words[(lost != 0) & (modes.occlusion_mode(self.words) == modes.FULLY_RENDERED)] &= ~word(3)

    def learnt(self, pixel_count: np.ndarray, shaded_count: np.ndarray, zoom_factor: float) -> Learnt:
        """What is known if the frame ends here (§2.5, §2.6); the history itself stays as it is until it keeps that.

        pixel_count and shaded_count (units,) int32 are the frame's primary pixels, and those of them that are shaded.
        """
        learnt = Learnt(self.words.copy(), pixel_count, self.highest_count.copy(), self.taught.copy())
        modes.merge_words(learnt.words, self.gained)
        counts = pixel_count, shaded_count, np.float64(zoom_factor), learnt.highest_count, learnt.taught
        set_occlusion_modes(learnt.words, self.hidden, *counts)
        return learnt

    def keep(self, learnt: Learnt) -> None:
        """The frame has ended: this is what the next one begins with."""
        self.words, self.pixel_count, self.highest_count, self.taught = learnt
        self.discard_frame()

    def discard_frame(self) -> None:
        """Drop what the frame under way has gathered."""
        self.hidden[:] = False
        self.gained[:] = 0
