"""The three trees of a placed world as queries get them: of what never moves, of what rests, and of what moves."""

from __future__ import annotations

from typing import Any, NamedTuple

from tracer.geometry.bvh8 import layout
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY
from tracer.geometry.triangle_test import Triangle
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import call_entry, f32_at, load_f32, load_f32x8, load_i64

NODE, BLOCK = 4 * layout.NODE_SIZE, 4 * layout.BLOCK_SIZE  # bytes
CHILDREN = 4 * layout.CHILDREN  # offset of the children's codes in a node
NUMBERS, BOX, COUNT = 4 * layout.PRIMITIVES, 4 * layout.BOX, 4 * layout.COUNT  # offsets in a block

# A placed world, as offsets in bytes: for each of its trees the addresses of nodes and blocks and the number of the
# root; then the address of the quadrics as seen from the world, the number of triangles, the trees that are worth
# asking, as bits: the static one, and those of the others that hold anything; how many rays may go together; and the
# address of the static tree's table of pieces, or 0.
NODES, BLOCKS, ROOT, TREE = 0, 8, 16, 24
QUADRICS, TRIANGLE_COUNT, TREES, TOGETHER, PIECES = range(3 * TREE, 3 * TREE + 40, 8)
STATIC_TREE, RESTING_TREE, MOVING_TREE = range(3)
STATIC_TREES, DYNAMIC_TREES = 1 << STATIC_TREE | 1 << RESTING_TREE, 1 << MOVING_TREE  # as bits, by what is asked for


class PlacedTree(NamedTuple):
    """One of the three trees: the addresses of its nodes and blocks, its root's number, a pointer to the quadrics as
    seen from the world, the number of triangles, which is also the number of the first quadric, and the address of the
    table of pieces."""

    nodes: Any
    blocks: Any
    root: Any
    quadrics: Any
    triangles: Any
    pieces: Any


@inlined
def tree_of(data, which):
    """One of the three trees of the world that `data` is the address of."""
    a = data + TREE * which
    return PlacedTree(
        load_i64(a + NODES),
        load_i64(a + BLOCKS),
        load_i64(a + ROOT),
        f32_at(load_i64(data + QUADRICS)),
        load_i64(data + TRIANGLE_COUNT),
        load_i64(data + PIECES),
    )


@inlined
def root_of(tree):
    """Address of a tree's root."""
    return tree.nodes + NODE * tree.root


@subkernel
def root_of_piece(pieces, piece):
    """The number of the root of a piece, which is built now if it was not; `pieces` is the address of a table, int64:
    the address of what builds a piece, and then of each piece the number of its root, or -1."""
    place = pieces + 8 * (1 + piece)
    if load_i64(place) < 0:
        call_entry(load_i64(pieces), piece, 0, 0, 0, 0)
    return load_i64(place)


@inlined
def opened(pieces, code):
    """The number of the node that the code of a child that is no leaf stands for (see `layout.PIECE`)."""
    return root_of_piece(pieces, code - layout.PIECE) if code >= layout.PIECE else code


@inlined
def trees_asked(data, which):
    """Bits of the trees that hold STATIC_GEOMETRY or DYNAMIC_OBJECTS: an object that rests counts as static."""
    static, moving = which & STATIC_GEOMETRY, which & DYNAMIC_OBJECTS
    asked = static * (STATIC_TREES // STATIC_GEOMETRY) | moving * (DYNAMIC_TREES // DYNAMIC_OBJECTS)
    return load_i64(data + TREES) & asked


@inlined
def child_planes(box):
    """Planes of the box of a node's child: lower x, y and z, then upper; `box` is the address of the first of them."""
    return (
        load_f32(box), load_f32(box + 32), load_f32(box + 64),
        load_f32(box + 96), load_f32(box + 128), load_f32(box + 160),
    )  # fmt: skip


@inlined
def block_planes(block):
    """Planes of a block's box."""
    a = block + BOX
    return load_f32(a), load_f32(a + 4), load_f32(a + 8), load_f32(a + 12), load_f32(a + 16), load_f32(a + 20)


@inlined
def triangle_of(block, k):
    """The k-th triangle of the block at an address."""
    a = block + 4 * k
    return Triangle(
        load_f32(a), load_f32(a + 32), load_f32(a + 64),
        load_f32(a + 96), load_f32(a + 128), load_f32(a + 160),
        load_f32(a + 192), load_f32(a + 224), load_f32(a + 256),
    )  # fmt: skip


@inlined
def triangles_of(block):
    """All eight triangles of the block at an address."""
    return Triangle(
        load_f32x8(block), load_f32x8(block + 32), load_f32x8(block + 64),
        load_f32x8(block + 96), load_f32x8(block + 128), load_f32x8(block + 160),
        load_f32x8(block + 192), load_f32x8(block + 224), load_f32x8(block + 256),
    )  # fmt: skip
