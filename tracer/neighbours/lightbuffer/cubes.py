"""Building cubes: what is static, or rests, as a light sees it, face by face in parallel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import aligned_rows
from tracer.geometry.primitives import Outlines
from tracer.geometry.world import World
from tracer.neighbours.lightbuffer.cube import COUNT, FACES, FIRST, ITEM, RECORD, SPAN, WIDTH_BITS
from tracer.neighbours.lightbuffer.divide import (
    CAME_TO,
    FOUND,
    LISTED,
    LOOKED_AT,
    LOOKED_FOR,
    RECORDS_USED,
    divide_face,
)
from tracer.neighbours.lightbuffer.items import put_error_radii, put_items, put_rows_of_light
from tracer.runtime.parallel import for_each_chunk
from tracer.visibility.error_bounds import BOX, LANES, LONGEST, ROW, SureHitLength
from tracer.visibility.light_space import LIGHT_ROW
from tracer.visibility.occluders import ROUNDED
from tracer.visibility.static_geometry import put_rows

LEAST_SIDE = 16  # cells: a light for whose cube this is too many is traced
LARGE = 1e12  # of lengths

Cancel = Callable[[], bool] | None


class Items(NamedTuple):
    """What cubes are made of: rows (n, ROW) float32 in the world, their primitives' numbers (n,) int32, and how long a
    ray may be to be certain of a hit."""

    rows: NDArray[np.float32]
    numbers: NDArray[np.int32]
    sure: float

    @property
    def largest(self) -> float:
        """Their largest coordinate."""
        return float(np.abs(self.rows[:, BOX:]).max(initial=0.0))


def items_of(world: World, objects: list[int], outlines: Outlines) -> Items:
    """Those of objects that are present: of object 0, which never moves, or of others, which rest."""
    primitives, first_quadric = world.primitives, len(world.primitives.triangles)
    numbers = []
    for index in objects:
        triangles, quadrics = primitives.triangles_of(index), primitives.quadrics_of(index)
        numbers += [
            np.arange(triangles.start, triangles.stop),
            first_quadric + np.arange(quadrics.start, quadrics.stop),
        ]
    which = np.concatenate([np.empty(0, np.int64), *numbers]).astype(np.int32)
    rows, start = aligned_rows(len(which), ROW), 0
    rows[:] = 0.0
    for index, first, second in zip(objects, numbers[::2], numbers[1::2], strict=True):
        middle, end = start + len(first), start + len(first) + len(second)
        put_rows(world, index, outlines, rows[start:middle], rows[middle:end])
        start = end
    ends = np.concatenate([rows[:, :3], rows[:, :3] + rows[:, 3:6], rows[:, :3] + rows[:, 6:9]])
    extent = float(np.abs(ends).max(initial=0.0))
    return Items(rows, which, min(LARGE, world.hit_padding / LONGEST * extent))


@dataclass(frozen=True)
class Cube:
    """What a light sees.

    cells (6, side, side) int32 name records (r, RECORD) float32 (`cube`), whose candidates lists (l,)
    int32 name by rows (k, LIGHT_ROW) float32 prepared for the light, of the primitives of these numbers (k,) int32.
    `every` (n,) int32 are the numbers of all primitives, which records name that have no candidates.
    `reach`: how long rays may be that ask, and `sure`: how long to be sure of a hit on what covers their cell."""

    cells: NDArray[np.int32]
    records: NDArray[np.float32]
    lists: NDArray[np.int32]
    rows: NDArray[np.float32]
    numbers: NDArray[np.int32]
    every: NDArray[np.int32]
    reach: float
    sure: float

    @property
    def side(self) -> int:
        return self.cells.shape[1]

    @property
    def bytes(self) -> int:
        arrays = self.cells, self.records, self.lists, self.rows, self.numbers
        return sum(array.nbytes for array in arrays)


class _Scratch:
    """What a worker divides faces in."""

    def __init__(self, items: int, side: int, longest: int) -> None:
        self.items, self.spans = aligned_rows(items, ITEM), aligned_rows(items, SPAN)
        self.numbers, self.alone = np.empty(items + LANES, np.int32), np.empty(items, np.int32)
        self.arena = np.empty((side.bit_length() + 2) * (items + 2 * LANES), np.int32)
        self.found = np.empty((FOUND, items + 2 * LANES), np.float32)
        self.records = np.empty((side * side, RECORD), np.float32)
        self.lists = np.empty(side * side * longest, np.int32)


class _Face(NamedTuple):
    records: NDArray[np.float32]
    lists: NDArray[np.int32]


class CubeMaker:
    """Makes the cubes of items for many lights, with `longest` candidates in a list at most."""

    def __init__(self, items: Items, reach: Callable[[NDArray[np.float32]], float], longest: int) -> None:
        self._items, self._reach, self._longest = items, reach, longest
        self.steps = self.tests = 0  # regions looked at, and items of theirs

    def make(
        self, lights: NDArray[np.float32], side: int, most: float, threads: int, cancel: Cancel = None
    ) -> list[Cube | None]:
        """Cubes for lights (k, 3), with `side` cells along an edge, or half of that, and so on, where one takes more
        than `most` bytes; None where it takes more in any case.  Raises Cancelled."""
        found: list[Cube | None] = [None] * len(lights)
        todo = list(range(len(lights)))
        while todo and side >= LEAST_SIDE:
            for k, cube in zip(todo, self._make(lights[todo], side, most, threads, cancel), strict=True):
                found[k] = cube if cube is not None and cube.bytes <= most else None
            todo, side = [k for k in todo if found[k] is None], side // 2
        return found

    def _make(
        self, lights: NDArray[np.float32], side: int, most: float, threads: int, cancel: Cancel
    ) -> list[Cube | None]:
        """Cubes for lights (k, 3), None for one of which some faces take more than `most` bytes already: the others are
        not made, nor is its work counted, which would depend on the turns of threads."""
        rows, sure = self._items.rows, self._items.sure
        n, reaches = len(rows), [self._reach(light) for light in lights]
        radii = np.empty((len(lights), -(-n // LANES) * LANES), np.float32)
        cells = np.zeros((len(lights), FACES, side, side), np.int32)
        faces: list[list[_Face | None]] = [[None] * FACES for _ in lights]
        taken = [cells[0].nbytes] * len(lights)  # bytes
        scratch: list[_Scratch | None] = [None] * threads
        states = np.zeros((len(lights), FACES, CAME_TO), np.int64)

        def find_radii(k: int, worker: int) -> None:
            rounded = ROUNDED * (self._items.largest + float(np.abs(lights[k]).max()))
            put_error_radii(rows, lights[k], reaches[k], rounded, radii[k])

        def divide(chunk: int, worker: int) -> None:
            k, face = divmod(chunk, FACES)
            if taken[k] > most:
                return
            if scratch[worker] is None:
                scratch[worker] = _Scratch(n, side, self._longest)
            room, state = scratch[worker], states[k, face]
            assert room is not None
            count = put_items(
                rows, radii[k], lights[k], face, sure, reaches[k], room.numbers, room.items, room.spans
            )  # fmt: skip
            divide_face(
                room.items, room.spans, count, face, side, self._longest, cells[k, face], room.records, room.lists,
                room.arena, room.found, room.alone, state,
            )  # fmt: skip
            made = _Face(room.records[: state[RECORDS_USED]].copy(), room.lists[: state[LISTED]].copy())
            faces[k][face] = made
            taken[k] += made.records.nbytes + made.lists.nbytes

        if n:
            for_each_chunk(find_radii, len(lights), threads, cancel)
            for_each_chunk(divide, FACES * len(lights), threads, cancel)
        kept = [k for k in range(len(lights)) if taken[k] <= most and (not n or None not in faces[k])]
        self.steps += int(states[kept, :, LOOKED_AT].sum())
        self.tests += int(states[kept, :, LOOKED_FOR].sum())
        made: list[Cube | None] = [None] * len(lights)

        def join(chunk: int, worker: int) -> None:
            k = kept[chunk]
            made[k] = self._joined(lights[k], reaches[k], cells[k], faces[k])

        for_each_chunk(join, len(kept), threads, cancel)
        return made

    def _joined(
        self, light: NDArray[np.float32], reach: float, cells: NDArray[np.int32], faces: list[_Face | None]
    ) -> Cube:
        """One cube of six faces."""
        there = [_Face(np.empty((0, RECORD), np.float32), np.empty(0, np.int32)) if f is None else f for f in faces]
        records = aligned_rows(1 + sum(len(face.records) for face in there), RECORD)
        records[0] = 0.0
        used, listed = 1, 0
        for face, numbers in zip(there, cells, strict=True):
            numbers += (numbers >= 1 << WIDTH_BITS) * np.int32((used - 1) << WIDTH_BITS)
            target = records[used : used + len(face.records)]
            target[:] = face.records
            numbers_of = target.view(np.int32)
            numbers_of[:, FIRST] += listed * (numbers_of[:, COUNT] > 0)
            used, listed = used + len(face.records), listed + len(face.lists)
        lists = np.concatenate([face.lists for face in there])
        mark = np.zeros(len(self._items.rows), np.int32)
        mark[lists] = 1
        which = np.flatnonzero(mark)
        mark[which] = np.arange(len(which), dtype=np.int32)
        rows, light_space = aligned_rows(len(which), ROW), aligned_rows(len(which), LIGHT_ROW)
        rows[:] = self._items.rows[which]
        if len(which):
            put_rows_of_light(rows, SureHitLength(len(which), self._items.sure, 0.0), light, light_space)
        numbers = self._items.numbers
        return Cube(cells, records, mark[lists], light_space, numbers[which], numbers, reach, self._items.sure)
