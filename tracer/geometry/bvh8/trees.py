"""The two trees of a placed world as queries get them: all that lies still, and all that moves."""

from __future__ import annotations

from typing import Any, NamedTuple

from tracer.geometry.bvh8 import tree
from tracer.kernels import inlined
from tracer.simd import f32_at, load_f32, load_i64

NODE, BLOCK = 4 * tree.NODE_SIZE, 4 * tree.BLOCK_SIZE  # bytes
CHILDREN = 4 * tree.CHILDREN  # offset of the children's codes in a node
NUMBERS, BOX, COUNT = 4 * tree.PRIMITIVES, 4 * tree.BOX, 4 * tree.COUNT  # offsets in a block

# A placed world: addresses of both trees' nodes and blocks and of the quadrics as seen from the world, the number of
# triangles, and 1 where the second tree holds anything, else 0.
STATIC_NODES, STATIC_BLOCKS, DYNAMIC_NODES, DYNAMIC_BLOCKS, QUADRICS, TRIANGLE_COUNT, HAS_DYNAMIC = range(0, 56, 8)


class Trees(NamedTuple):
    """One of the trees: addresses of nodes and blocks, a pointer to quadrics as seen from the world, and
    the number of triangles, which is that of the first quadric."""

    nodes: Any
    blocks: Any
    quadrics: Any
    triangles: Any


@inlined
def tree_of(data, dynamic):
    """The static tree of the world at an address for 0, the dynamic one for 1."""
    return Trees(
        load_i64(data + STATIC_NODES + 16 * dynamic),
        load_i64(data + STATIC_BLOCKS + 16 * dynamic),
        f32_at(load_i64(data + QUADRICS)),
        load_i64(data + TRIANGLE_COUNT),
    )


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
