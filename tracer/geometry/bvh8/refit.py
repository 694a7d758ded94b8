"""Filling a tree whose shape is known: triangles into blocks, and boxes from the blocks up to the root.

Triangles are taken to world space in float64 and rounded once.  The box of a block or quadric is
padded and written where its parent holds it; a node's is the union of what the node holds, exactly.
So a parent's box always contains its children's as they are stored, and a ray that meets those, in
float32 arithmetic, meets the parent's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.bvh8.tree import (
    BLOCK_SIZE,
    BOX,
    CHILDREN,
    COUNT,
    EMPTY,
    NO_PRIMITIVE,
    NODE_SIZE,
    PRIMITIVES,
    WIDTH,
)
from tracer.kernels import kernel, subkernel
from tracer.simd import address_of, f32x8, i32x8, largest, load_f32x8, load_i32, select, smallest, store

NODE_BYTES, BLOCK_BYTES = 4 * NODE_SIZE, 4 * BLOCK_SIZE


class Links(NamedTuple):
    """Where the box of each node, block and quadric of a tree is stored: 8 * parent + child, or ~r in row r of `roots`.

    nodes (n,), blocks (m,) and quadrics (q,) int32; roots (r, 6) float32.
    """

    nodes: NDArray[np.int32]
    blocks: NDArray[np.int32]
    quadrics: NDArray[np.int32]
    roots: NDArray[np.float32]


def make_links(nodes: int, blocks: int, quadrics: int, roots: int) -> Links:
    """Uninitialised links of a tree with so many of each."""
    numbers = [np.empty(n, np.int32) for n in (nodes, blocks, quadrics)]
    return Links(*numbers, np.empty((roots, 6), np.float32))


@subkernel
def clear_nodes(nodes, first, last):
    """Nodes with eight empty slots."""
    for i in range(first, last):
        node = address_of(nodes) + NODE_BYTES * i
        for k in range(6):
            store(node + 32 * k, f32x8(EMPTY))
        store(node + 4 * CHILDREN, i32x8(~0))
        store(node + 4 * CHILDREN + 32, i32x8(0))


@subkernel
def clear_blocks(blocks, first, last):
    """Blocks without triangles."""
    for i in range(first, last):
        block = address_of(blocks) + BLOCK_BYTES * i
        for k in range(9):
            store(block + 32 * k, f32x8(0))
        store(block + 4 * PRIMITIVES, i32x8(NO_PRIMITIVE))
        store(block + 4 * BOX, f32x8(0))
        store(block + 4 * BOX + 32, f32x8(0))


@kernel
def clear(tree):
    """Make all nodes and blocks empty ones."""
    clear_nodes(tree.nodes, 0, len(tree.nodes))
    clear_blocks(tree.blocks, 0, len(tree.blocks))


@subkernel
def set_child(nodes, node, slot, code):
    store(address_of(nodes) + NODE_BYTES * node + 4 * (CHILDREN + slot), np.int32(code))


@subkernel
def set_triangles(blocks, b, order, first, count, offset):
    """Give a block the triangles offset + order[first], and so on."""
    block = address_of(blocks) + BLOCK_BYTES * b
    for lane in range(count):
        store(block + 4 * (PRIMITIVES + lane), np.int32(offset + order[first + lane]))
    store(block + 4 * COUNT, np.int32(count))


@kernel
def fill_blocks(blocks, rows, matrix, first, last):
    """Take triangles from rows (t, 9) to blocks first to last - 1, by their numbers and through matrix (12,) float64.

    Stores exact boxes, and returns their largest absolute coordinate.
    """
    extent = np.float32(0)
    m = matrix
    box = np.empty(6, np.float32)
    for b in range(first, last):
        block = address_of(blocks) + BLOCK_BYTES * b
        box[:3], box[3:] = np.inf, -np.inf
        for lane in range(load_i32(block + 4 * COUNT)):
            row = rows[load_i32(block + 4 * (PRIMITIVES + lane))]
            for k in range(3):
                i = 4 * k
                corner = np.float32(m[i] * row[0] + m[i + 1] * row[1] + m[i + 2] * row[2] + m[i + 3])
                edge1 = np.float32(m[i] * row[3] + m[i + 1] * row[4] + m[i + 2] * row[5])
                edge2 = np.float32(m[i] * row[6] + m[i + 1] * row[7] + m[i + 2] * row[8])
                blocks[b, 8 * k + lane] = corner
                blocks[b, 8 * (k + 3) + lane] = edge1
                blocks[b, 8 * (k + 6) + lane] = edge2
                box[k] = min(box[k], min(corner, min(corner + edge1, corner + edge2)))
                box[k + 3] = max(box[k + 3], max(corner, max(corner + edge1, corner + edge2)))
        for k in range(6):
            blocks[b, BOX + k] = box[k]
            extent = max(extent, abs(box[k]))
    return extent


@subkernel
def _store_box(tree, links, link, k, value):
    if link >= 0:
        tree.nodes[link // WIDTH, WIDTH * k + link % WIDTH] = value
    else:
        links.roots[~link, k] = value


@kernel
def pad_blocks(tree, links, padding, first, last):
    """Let the boxes of blocks first to last - 1 grow, and hand them to their parents."""
    for b in range(first, last):
        for k in range(6):
            value = tree.blocks[b, BOX + k] + (padding if k >= 3 else -padding)
            tree.blocks[b, BOX + k] = value
            _store_box(tree, links, links.blocks[b], k, value)


@kernel
def pad_quadrics(tree, links, boxes, padding, first, last):
    """Hand the boxes (q, 6) of quadrics first to last - 1, a little larger, to their parents."""
    for q in range(first, last):
        for k in range(6):
            _store_box(tree, links, links.quadrics[q], k, boxes[q, k] + (padding if k >= 3 else -padding))


@kernel
def refit_nodes(tree, links, first, last):
    """Hand the boxes of nodes first to last - 1 to their parents, children before parents."""
    for i in range(last - 1, first - 1, -1):
        node = address_of(tree.nodes) + NODE_BYTES * i
        for k in range(3):
            upper = load_f32x8(node + 32 * (k + 3))
            _store_box(tree, links, links.nodes[i], k, smallest(load_f32x8(node + 32 * k)))
            _store_box(tree, links, links.nodes[i], k + 3, largest(select(upper == EMPTY, f32x8(-EMPTY), upper)))
