"""The three trees of a placed world as queries get them: of what never moves, of what rests, of what moves."""

from __future__ import annotations

from typing import Any, NamedTuple

from tracer.geometry.bvh8 import tree
from tracer.geometry.queries import DYNAMIC, STATIC
from tracer.kernels import inlined
from tracer.simd import f32_at, load_f32, load_i64

NODE, BLOCK = 4 * tree.NODE_SIZE, 4 * tree.BLOCK_SIZE  # bytes
CHILDREN = 4 * tree.CHILDREN  # offset of the children's codes in a node
NUMBERS, BOX, COUNT = 4 * tree.PRIMITIVES, 4 * tree.BOX, 4 * tree.COUNT  # offsets in a block

# A placed world: of each of its trees the addresses of nodes and blocks, and the number of its root; the address of
# the quadrics as seen from the world, the number of triangles, and which trees are to be asked at all, as bits: the
# first, and of the others those that hold anything.
NODES, BLOCKS, ROOT, TREE = 0, 8, 16, 24
QUADRICS, TRIANGLE_COUNT, TREES = range(3 * TREE, 3 * TREE + 24, 8)
FIXED, RESTING, MOVING = range(3)


class Trees(NamedTuple):
    """One of the trees: addresses of nodes and blocks, the root's number, a pointer to quadrics as seen from the
    world, and the number of triangles, which is that of the first quadric."""

    nodes: Any
    blocks: Any
    root: Any
    quadrics: Any
    triangles: Any


@inlined
def tree_of(data, which):
    """One of the three trees of the world at an address."""
    a = data + TREE * which
    return Trees(
        load_i64(a + NODES),
        load_i64(a + BLOCKS),
        load_i64(a + ROOT),
        f32_at(load_i64(data + QUADRICS)),
        load_i64(data + TRIANGLE_COUNT),
    )


@inlined
def root_of(trees):
    """Address of a tree's root."""
    return trees.nodes + NODE * trees.root


@inlined
def trees_asked(data, which):
    """Bits of the trees that hold STATIC geometry or DYNAMIC objects: what rests counts as static."""
    asked = (which & STATIC) * ((1 << FIXED | 1 << RESTING) // STATIC) | (which & DYNAMIC) * ((1 << MOVING) // DYNAMIC)
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
