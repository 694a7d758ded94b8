"""Which pixels of a picture are shaded first, and what the others show until their turn comes.

A picture is refined in parts, which are counted in sixteenths of its pixels.  With 1, 2, 4 or 16 sixteenths, as many
pixels are shaded in each block of 4 x 4; with half a sixteenth, one pixel in every other block.  Pixels beyond these
numbers go to units whose modes are still to be set (`tracer.shading.teaching`), and then to the blocks that are most in
doubt (`tracer.shading.filling`), so that the borders of shadows and reflections are shaded before even surfaces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.runtime.parallel import for_each_chunk
from tracer.shading.blocks import BAYER, BLOCK, EDGE, TURNS, Planes, all_blocks, blocks_in, lanes_of, pixels_of
from tracer.shading.filling import fill_in, nearest

LEVELS = (0.5, 1, 2, 4, TURNS)  # sixteenths that are the same for all blocks
HALVES = 2 * TURNS  # steps of half a sixteenth in a whole picture
BEYOND = 1 / 8  # of a part, by which it may grow rather than be shaded in two steps
FILLED = 4  # rows of blocks that a thread fills in at a time


def level_of(part: float) -> float:
    """The highest level in so many sixteenths."""
    return max(level for level in LEVELS if level <= part)


def after(first: int, part: float) -> int:
    """What comes first in the next picture, if that begins with so many sixteenths: the last one began with `first`."""
    step = int(2 * level_of(part))
    return (first // step + 1) * step % HALVES


class Parts:
    """The pixels of a picture of this size that have been shaded: `shaded` (rows, columns) int32 has the bits of each
    block, edges and all.  `first`, a number of half sixteenths, says which come first (`after`); spread is the width
    of a pixel at distance 1."""

    def __init__(self, width: int, height: int, planes: Planes, spread: float, first: int = 0) -> None:
        self._width, self._height, self._planes, self._spread = width, height, planes, spread
        self._first, self._odd = first // 2, first % 2
        self.shaded = np.zeros(blocks_in(width, height), np.int32)
        self._stale = all_blocks(width, height) > 0  # blocks that are to be filled in, or once more
        self._doubt = np.zeros(self.shaded.shape, np.float32)
        self._filled = np.empty((height, width, 3), np.float32)
        self._mask: NDArray[np.bool_] | None = None
        self._given = False  # whether somebody has what is filled in, who may go on showing it

    @property
    def share(self) -> float:
        """How much of the picture has been shaded, 0 to 1; blocks that its border cuts count as whole."""
        return self._share_of(self.shaded)

    @staticmethod
    def _share_of(lanes: NDArray[np.int32]) -> float:
        inside = lanes[EDGE:-EDGE, EDGE:-EDGE]
        return int(np.bitwise_count(inside).sum()) / (TURNS * inside.size)

    @property
    def pixels(self) -> NDArray[np.bool_] | None:
        """(height, width): which pixels have been shaded; None where all have."""
        return None if self.share >= 1.0 else self._known

    @property
    def _known(self) -> NDArray[np.bool_]:
        """(height, width): which pixels have been shaded; made once for as long as no more are."""
        if self._mask is None:
            self._mask = pixels_of(self.shaded, self._width, self._height)
        return self._mask

    def left_up_to(
        self, part: float, fill: Callable[[], None], untaught: NDArray[np.int32] | None = None
    ) -> Iterator[NDArray[np.int32]]:
        """The pixels of each block that are to be shaded until so many sixteenths are, or a few more, in one step or in
        two, between which `fill` has to fill in the others; those that are `untaught`, like `shaded`, before others:
        where there are many, fewer lie evenly, and of the smallest part up to twice as many are shaded."""
        level, lanes = level_of(part), self._left(level_of(part))
        waiting = np.zeros_like(lanes) if untaught is None else untaught & ~self.shaded
        if TURNS * self._share_of(waiting & ~lanes) > self._room(part, lanes) and level > LEVELS[0]:
            level = LEVELS[LEVELS.index(level) - 1]
            lanes = self._left(level)
        lanes |= self._some_of(waiting & ~lanes, self._room(part, lanes) + part * (part == LEVELS[0]))
        if lanes.any():
            yield self._take(lanes)
        if part - TURNS * self.share > BEYOND * part:
            more = LEVELS[LEVELS.index(level) + 1]
            fill()
            yield self._take(self._most_in_doubt(self._left(more), part))

    def _room(self, part: float, lanes: NDArray[np.int32]) -> float:
        """How many sixteenths may still be shaded besides these pixels and those that are."""
        return max((1 + BEYOND) * part - TURNS * self._share_of(self.shaded | lanes), 0.0)

    def _some_of(self, lanes: NDArray[np.int32], room: float) -> NDArray[np.int32]:
        """So many sixteenths of the picture's pixels, of these, or all: those first whose turn it is first."""
        left, chosen = round(room * lanes[EDGE:-EDGE, EDGE:-EDGE].size), np.zeros_like(lanes)
        for turn in range(TURNS):
            mine = np.flatnonzero(lanes & lanes_of((self._first + turn) % TURNS, 1))
            if len(mine) > left:
                mine = mine[:: -(-len(mine) // max(left, 1))][:left]
            chosen.reshape(-1)[mine] |= lanes_of((self._first + turn) % TURNS, 1)
            left -= len(mine)
            if left <= 0:
                break
        return chosen

    def _left(self, level: float) -> NDArray[np.int32]:
        """What is left to shade before this level is reached."""
        lanes = all_blocks(self._width, self._height, lanes_of(self._first, math.ceil(level)))
        if level < 1:
            rows, columns = np.indices(lanes.shape)
            lanes[(rows + columns) % 2 != self._odd] = 0
        return lanes & ~self.shaded

    def _most_in_doubt(self, lanes: NDArray[np.int32], part: float) -> NDArray[np.int32]:
        """Of these pixels, those of as many blocks as make so many sixteenths with what is shaded already."""
        pixels, blocks = int(np.bitwise_count(lanes).sum()), np.count_nonzero(lanes)
        missing = (part - TURNS * self.share) * lanes[EDGE:-EDGE, EDGE:-EDGE].size
        count = min(max(round(missing * blocks / max(pixels, 1)), 0), blocks)
        doubt = np.where(lanes != 0, self._doubt, np.float32(-1)).reshape(-1)
        chosen = np.zeros_like(lanes)
        which = np.argsort(-doubt, kind="stable")[:count]
        chosen.reshape(-1)[which] = lanes.reshape(-1)[which]
        return chosen

    def _take(self, lanes: NDArray[np.int32]) -> NDArray[np.int32]:
        self.shaded |= lanes
        self._mask = None
        self._stale[1:-1, 1:-1] |= _with_neighbours(lanes != 0)
        return lanes

    def fill(
        self, color: NDArray[np.float32], workers: int, cancel: Callable[[], bool] | None = None
    ) -> NDArray[np.float32]:
        """(height, width, 3): of color, alike, the pixels that have been shaded, the others filled in from them.

        Raises Cancelled once `cancel()` turns true."""
        if not self._stale.any():
            return self._filled
        if self._given:
            self._filled, self._given = self._filled.copy(), False
        rows = self.shaded.shape[0] - 2 * EDGE

        def work(chunk: int, worker: int) -> None:
            some = chunk * FILLED, min(rows, (chunk + 1) * FILLED)
            fill_in(self._planes, self.shaded, self._stale, some, self._spread, color, self._filled, self._doubt)

        for_each_chunk(work, -(-rows // FILLED), workers, cancel)
        self._stale[:] = False
        return self._filled

    def give(self) -> NDArray[np.float32]:
        """What has been filled in last; it stays as it is."""
        self._given = True
        return self._filled

    def sources(self) -> NDArray[np.int32]:
        """(height, width): the number of the pixel whose values each shows, its own where it has been shaded."""
        known = self._known
        y, x = np.argwhere(self._first == BAYER)[0]
        rows, columns = np.ix_(nearest(self._height, int(y)), nearest(self._width, int(x)))
        if self._width > BLOCK:  # every other block may have none: then what the one beside it has
            beside = np.where(columns + BLOCK < self._width, columns + BLOCK, columns - BLOCK)
            columns = np.where(known[rows, columns], columns, beside)
        own = np.arange(known.size, dtype=np.int32).reshape(known.shape)
        return np.where(known, own, (rows * self._width + columns).astype(np.int32))

    def stretch_records(self, frame: Frame, shaded: NDArray[np.float32]) -> None:
        """Let pixels that have not been shaded show the work, and the fates of rays, of the nearest that have, or of
        one that sees the same primitive where these see another.

        What is wrong, due or lit there is not known yet.

        shaded (height, width, 3) are the colours before the others were filled in."""
        frame.shaded = self._known
        if frame.asked is not None and frame.reached is not None:
            frame.asked, frame.reached = frame.asked.copy(), frame.reached.copy()
        if frame.reference is None and frame.fates is None and frame.saved is None:
            return
        sources = _of_own(frame.primitive, frame.shaded, self.sources())
        if frame.reference is not None and frame.wrong is not None:
            frame.reference = frame.color + _taken(frame.reference - shaded, sources)
            frame.wrong = frame.wrong.copy()
        if frame.fates is not None:
            frame.fates = _taken(frame.fates, sources)
        if frame.saved is not None and frame.cost is not None and frame.due_rays is not None:
            frame.saved, frame.cost, frame.due_rays = (
                _taken(work, sources) for work in (frame.saved, frame.cost, frame.due_rays)
            )


def _of_own(primitive: NDArray[np.int32], known: NDArray[np.bool_], sources: NDArray[np.int32]) -> NDArray[np.int32]:
    """The sources, but a known pixel of the same primitive, where there is one, for those that are of another."""
    other = np.flatnonzero((primitive != _taken(primitive, sources)) & (primitive >= 0))
    seen, numbers = np.flatnonzero(known & (primitive >= 0)), primitive.reshape(-1)
    some = np.full(int(numbers.max(initial=-1)) + 1, -1, np.int32)
    some[numbers[seen]] = seen
    found = some[numbers[other]]
    sources.reshape(-1)[other[found >= 0]] = found[found >= 0]
    return sources


def _taken(values: NDArray, sources: NDArray[np.int32]) -> NDArray:
    """values (height, width, ...) of the pixels with these numbers (height, width)."""
    return np.take(values.reshape(-1, *values.shape[2:]), sources, axis=0)


def _with_neighbours(blocks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Of blocks with edges, those inside that are meant, and those around them."""
    rows = blocks[:-2] | blocks[1:-1] | blocks[2:]
    return rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]
