"""Vectors and numbers in memory, against numpy."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.simd.kinds import (
    F32,
    I32,
    Kind,
    N,
    compiled,
    numbers,
    of_each_kind,
    same,
)
from tracer import simd
from tracer.simd import (
    address_of,
    f32_at,
    gather_f32x16,
    gather_i32x16,
    i32_at,
    i64_at,
    load_columns,
    load_f32,
    load_i32,
    load_i64,
    local_memory,
    sort_columns,
    store,
    store_bytes,
    store_where,
    u8_at,
)


def test_masks_and_bytes_in_memory():
    @compiled
    def run(source, bytes_, bools):
        for i in range(0, len(source), 16):
            x = simd.load_i32x16(address_of(source) + 4 * i)
            store_bytes(address_of(bytes_) + i + 3, x + 0x7F00)
            store_bytes(address_of(bools) + i + 3, x < 100)

    source = np.random.default_rng(15).integers(0, 256, N).astype(np.int32)
    bytes_, bools = (np.full(N + 8, 9, np.uint8) for _ in range(2))
    run(source, bytes_, bools)
    for written, right in ((bytes_, source), (bools, source < 100)):
        assert np.array_equal(written[3:-5], right)
        assert (written[:3] == 9).all() and (written[-5:] == 9).all()


@of_each_kind
@pytest.mark.parametrize("first", [0, 1, 3, 5])
def test_vectors_need_no_alignment(kind: Kind, first: int):
    a = np.zeros(N + 16, kind.dtype)
    start = -a.ctypes.data % 64 // 4 + first
    a[:] = numbers(21, kind.dtype, len(a))
    target = np.full(N + 40, 77, kind.dtype)
    count = N - 32
    _copying(kind)(a[start : start + count], target[first:])
    assert same(target[first : first + count], a[start : start + count])
    assert (target[:first] == 77).all() and (target[first + count :] == 77).all()


@cache
def _copying(kind: Kind) -> Any:
    load, lanes = kind.load, kind.lanes

    @compiled
    def run(source, target):
        for i in range(0, len(source), lanes):
            store(address_of(target) + 4 * i, load(address_of(source) + 4 * i))

    return run


@of_each_kind
def test_a_masked_store_leaves_the_other_lanes_memory_alone(kind: Kind):
    load, lanes, mask = kind.load, kind.lanes, kind.mask

    @compiled
    def run(a, bits, target):
        for i in range(0, len(a), lanes):
            store_where(address_of(target) + 4 * i, load(address_of(a) + 4 * i), mask(bits[i // lanes]))

    a, truths = numbers(22, kind.dtype), np.random.default_rng(23).random(N) < 0.4
    bits = np.array([int(row @ (1 << np.arange(kind.lanes))) for row in truths.reshape(-1, kind.lanes)])
    memory = numbers(24, kind.dtype, N + 10)
    before = memory.copy()
    run(a, bits, memory[5 : N + 5])
    assert same(memory[5 : N + 5], np.where(truths, a, before[5 : N + 5]))
    assert same(memory[:5], before[:5]) and same(memory[N + 5 :], before[N + 5 :])


@pytest.mark.parametrize("gather, dtype", [(gather_f32x16, F32), (gather_i32x16, I32)])
def test_gathered_numbers(gather: Any, dtype: type):
    load = simd.load_i32x16

    @compiled
    def run(a, places, out):
        for at in range(0, 4 * len(out), 64):
            store(address_of(out) + at, gather(address_of(a), load(address_of(places) + at)))

    a, out = numbers(27, dtype, 70), np.zeros(N, dtype)
    places = np.random.default_rng(28).integers(0, len(a), N).astype(I32)
    places[:16] = [0, 69] * 8
    run(a, places, out)
    assert same(out, a[places])


@pytest.mark.parametrize("columns", [8, 16])
def test_rows_of_a_table_become_columns(columns: int):
    @compiled
    def run(table, numbers, out):
        for v in range(len(numbers) // 16):
            loaded = load_columns(address_of(table), address_of(numbers) + 64 * v, columns)
            for c in range(columns):
                store(address_of(out) + 4 * (len(numbers) * c + 16 * v), loaded[c])

    table = numbers(29, F32, 50 * columns).reshape(50, columns)
    chosen = np.random.default_rng(30).integers(0, len(table), N).astype(I32)
    chosen[:16] = range(34, 50)
    out = np.zeros((columns, N), F32)
    run(table, chosen, out)
    assert same(out, table[chosen].T.copy())


@pytest.mark.parametrize("rows", [8, 16])
def test_columns_are_sorted(rows: int):
    """Whatever sorts all columns of zeros and ones sorts everything."""

    @compiled
    def run(tables):
        for k in range(len(tables)):
            sort_columns(address_of(tables) + 64 * rows * k, rows)

    bits = np.arange(1 << rows, dtype=I32).reshape(-1, 1, 16) >> np.arange(rows, dtype=I32)[:, None]
    for tables in (bits & 1, numbers(31, I32, 20 * rows * 16).reshape(20, rows, 16)):
        wanted = np.sort(tables, axis=1)
        run(tables)
        assert same(tables, wanted)


def test_single_numbers_in_memory():
    @compiled
    def run(floats, integers, longs, octets, out):
        f, i, k, u = f32_at(address_of(floats)), i32_at(address_of(integers)), i64_at(address_of(longs)), octets
        out[0] = load_f32(address_of(floats) + 4) + f[2]
        out[1] = load_i32(address_of(integers) + 4) + i[2]
        out[2] = load_i64(address_of(longs) + 8) + k[2]
        out[3] = u8_at(address_of(u))[3]
        f[0], i[0], k[0] = 5.5, -5, 1 << 40
        store(address_of(floats) + 12, np.float32(2.25))
        store(address_of(integers) + 12, np.int32(-9))
        store(address_of(longs) + 24, -(np.int64(1) << 50))
        u8_at(address_of(u))[0] = 200

    floats, integers, longs = np.arange(5, dtype=F32), np.arange(5, dtype=I32), np.arange(5, dtype=np.int64)
    octets, out = np.array([1, 2, 3, 250, 4], np.uint8), np.zeros(4)
    run(floats, integers, longs, octets, out)
    assert out.tolist() == [3, 3, 3, 250]
    assert floats.tolist() == [5.5, 1, 2, 2.25, 4]
    assert integers.tolist() == [-5, 1, 2, -9, 4]
    assert longs.tolist() == [1 << 40, 1, 2, -(1 << 50), 4]
    assert octets.tolist() == [200, 2, 3, 250, 4]


def test_local_memory_is_aligned_and_each_ones_own():
    @compiled
    def fill(depth, out):
        a, b = local_memory(192), local_memory(64)
        for i in range(12):
            store(a + 16 * i, np.int64(100 * depth + i))
        for i in range(8):
            store(b + 8 * i, np.int64(-1))
        if depth > 0:
            fill(depth - 1, out)
        out[depth, 12], out[depth, 13] = a % 64, b % 64
        for i in range(12):
            out[depth, i] = load_i64(a + 16 * i)

    out = np.zeros((4, 14), np.int64)
    fill(3, out)
    assert out.tolist() == [[*range(100 * d, 100 * d + 12), 0, 0] for d in range(4)]


# --- memory that ends with the function that has it -----------------------------------------------------


def _returned_memory(function: ast.FunctionDef) -> set[str]:
    """What a function returns that is, or holds, an address of its own `local_memory`."""

    def is_memory(node: ast.AST, names: set[str]) -> bool:
        """Whether a value is such an address, plainly or in a tuple or record; a call that is given one may use it."""
        if isinstance(node, ast.Call):
            called = getattr(node.func, "id", "")
            if called == "local_memory":
                return True
            records = (
                called.endswith("_at") or called[:1].isupper() or (called.startswith("_") and called[1:2].isupper())
            )
            values = [*node.args, *(keyword.value for keyword in node.keywords)]
            return records and any(is_memory(value, names) for value in values)
        if isinstance(node, ast.Tuple):
            return any(is_memory(element, names) for element in node.elts)
        return isinstance(node, ast.Name) and node.id in names

    names: set[str] = set()
    for node in ast.walk(function):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                pairs = [(target, node.value)]
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = list(zip(target.elts, node.value.elts, strict=False))
                names |= {to.id for to, value in pairs if isinstance(to, ast.Name) and is_memory(value, names)}
    returns = [node for node in ast.walk(function) if isinstance(node, ast.Return) and node.value is not None]
    return {ast.unparse(node) for node in returns if is_memory(node.value, names)}


def test_no_function_returns_an_address_of_its_own_memory() -> None:
    """LLVM may end the life of that memory where the function returns, inlined or not."""
    caught = ast.parse("def make():\n    room = Room(local_memory(64))\n    return room\n").body[0]
    assert isinstance(caught, ast.FunctionDef) and _returned_memory(caught)
    for path in (Path(__file__).resolve().parents[2] / "tracer").rglob("*.py"):
        text = path.read_text()
        for node in ast.walk(ast.parse(text)) if "local_memory" in text else ():
            if isinstance(node, ast.FunctionDef):
                assert not _returned_memory(node), f"{path}: {node.name}"
