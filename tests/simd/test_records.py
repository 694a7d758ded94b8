"""Records: what is declared is what lies in memory, for rows and for blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from tracer.runtime.kernels import kernel
from tracer.simd import local_memory
from tracer.simd.records import (
    F32,
    I32,
    Bytes,
    F32At,
    F32x2D,
    F32x3D,
    I32x2D,
    IntRow,
    Memory,
    Row,
    Row3,
    block_size,
    offset_of,
    pack,
    reading,
    row_count,
    row_number,
    rows_of,
    writing,
)


class Rays(NamedTuple):
    memory: Memory
    origin: Row3
    length: Row
    pixel: IntRow
    size: int


rays_in = rows_of(Rays)


@kernel
def _rows(memory):
    rays = rays_in(memory, 7)
    rays.pixel[2] = 5
    return rays.origin[2, 1], rays.length[1], rays.pixel.shape[0], rays.size, rays.memory.shape[0]


def test_rows_lie_in_the_order_in_which_they_are_declared():
    assert row_count(Rays) == 5
    assert [row_number(Rays, field) for field in ("origin", "length", "pixel")] == [0, 3, 4]
    memory = np.arange(15, dtype=np.float32).reshape(5, 3)
    assert _rows(memory) == (7.0, 10.0, 3, 7, 5)
    assert memory[4].view(np.int32)[2] == 5, "rows are views"
    with pytest.raises(KeyError):
        row_number(Rays, "size")


class Inner(NamedTuple):
    values: F32
    number: int


class Block(NamedTuple):
    inner: Inner
    flags: Bytes
    pairs: I32x2D
    cube: F32x3D
    flat: F32At
    factor: float
    chosen: bool


block_at = reading(Block)


@kernel
def _block(address):
    block = block_at(address)
    block.pairs[1, 0] = -1
    cube, inner = block.cube, block.inner
    return (
        inner.values[1],
        inner.number,
        block.flags[1],
        cube[1, 2, 0],
        cube.shape,
        block.flat[6],
        block.factor,
        block.chosen,
    )


def _some_block() -> Block:
    pairs, cube = np.zeros((3, 2), np.int32), np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    inner = Inner(np.array([1, 2.5], np.float32), -7)
    return Block(inner, np.array([False, True]), pairs, cube, cube, 0.1, True)


def test_a_block_is_read_as_it_was_packed():
    block = _some_block()
    packed = pack(block)
    assert packed.nbytes == block_size(Block)
    assert _block(packed.ctypes.data) == (2.5, -7, 1, 20.0, (2, 3, 4), 6.0, 0.1, True)
    assert block.pairs.tolist() == [[0, 0], [-1, 0], [0, 0]], "arrays are not copied"
    assert _block(pack(block._replace(chosen=False)).ctypes.data)[-1] is False


@pytest.mark.parametrize(
    "pairs",
    [np.zeros(3, np.int32), np.zeros((3, 2), np.int64), np.zeros((2, 3), np.int32).T, np.zeros((3, 2), np.int8)],
)
def test_an_array_that_is_not_what_was_declared_is_refused(pairs: np.ndarray):
    with pytest.raises(TypeError, match=r"Block\.pairs is not"):
        pack(_some_block()._replace(pairs=pairs))


class Call(NamedTuple):
    first: int
    rows: F32x2D
    tile: int


class Pair(NamedTuple):
    one: int
    other: int


call_at, write_call, CALL = reading(Call), writing(Call), block_size(Call)


@kernel
def _through_memory(rows):
    call = local_memory(CALL)
    write_call(call, Call(3, rows, 9))
    given = call_at(call)
    return given.first, given.rows[1, 2], given.rows.shape, given.tile


def test_a_kernel_writes_a_block_for_another():
    assert _through_memory(np.arange(12, dtype=np.float32).reshape(3, 4)) == (3, 6.0, (3, 4), 9)


def test_a_field_of_whole_numbers_has_its_place():
    assert (offset_of(Pair, "one"), offset_of(Pair, "other"), block_size(Pair)) == (0, 8, 16)


def test_an_array_and_a_row_of_the_same_type_are_told_apart():
    """Python before 3.11.3 takes hints for the same whose marks are equal, whatever their types."""
    assert I32.__metadata__ != IntRow.__metadata__
