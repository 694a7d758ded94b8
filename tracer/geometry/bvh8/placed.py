"""The three trees of a placed world as queries get them: of what never moves, of what rests, and of what moves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.bvh8.layout import BOX, CHILDREN, NODE, SUBTREE
from tracer.geometry.queries import DYNAMIC_OBJECTS, STATIC_GEOMETRY
from tracer.geometry.shared_memory import built
from tracer.geometry.triangle_test import Triangle
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import load_f32, load_f32x8, load_i32, load_i64
from tracer.simd.records import F32At, block_size, pack, reading

STATIC_TREE, RESTING_TREE, MOVING_TREE = range(3)
STATIC_TREES, DYNAMIC_TREES = 1 << STATIC_TREE | 1 << RESTING_TREE, 1 << MOVING_TREE  # as bits, by what is asked for


class PlacedTree(NamedTuple):
    """One of the three trees: the addresses of its nodes and blocks, and its root's number; the quadrics as seen from
    the world; the number of triangles, which is also the number of the first quadric; and the address of the table of
    subtrees, or 0."""

    nodes: int
    blocks: int
    root: int
    quadrics: F32At
    triangles: int
    subtrees: int


class World8(NamedTuple):
    """A placed world: the trees that are worth asking, as bits, which are the static one and those of the others that
    hold anything; and how many rays may go together.  The three trees follow it in memory."""

    trees: int
    max_packet_size: int


WORLD, TREE = block_size(World8), block_size(PlacedTree)
read_world, _read_tree = reading(World8), reading(PlacedTree)


def pack_world(world: World8, trees: Sequence[PlacedTree]) -> NDArray[np.int64]:
    """A placed world as a block; whoever keeps it keeps all that has an address in it."""
    return np.concatenate([pack(world), *(pack(tree) for tree in trees)])


@inlined
def tree_of(data, which):
    """One of the three trees of the world that `data` is the address of."""
    return _read_tree(data + WORLD + TREE * which)


@inlined
def root_of(tree):
    """Address of a tree's root."""
    return tree.nodes + NODE * tree.root


@subkernel
def root_of_subtree(subtrees, number):
    """The number of the root of a subtree, which is built now if it was not; `subtrees` is the address of a table of
    int64: the address of what builds a subtree, and then of each the number of its root, or UNBUILT."""
    return built(subtrees + 8 * (1 + number), load_i64(subtrees), number, 0)


@inlined
def opened(subtrees, code):
    """The number of the node that the code of a child that is no leaf stands for (see `layout.SUBTREE`)."""
    return root_of_subtree(subtrees, code - SUBTREE) if code >= SUBTREE else code


@inlined
def trees_asked(data, which):
    """Bits of the trees that hold STATIC_GEOMETRY or DYNAMIC_OBJECTS: an object that rests counts as static."""
    static, moving = which & STATIC_GEOMETRY, which & DYNAMIC_OBJECTS
    asked = static * (STATIC_TREES // STATIC_GEOMETRY) | moving * (DYNAMIC_TREES // DYNAMIC_OBJECTS)
    return read_world(data).trees & asked


@inlined
def code_of(node, c):
    """The code of a node's c-th child."""
    return np.int64(load_i32(node + 4 * (CHILDREN + c)))


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
    a = block + 4 * BOX
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
