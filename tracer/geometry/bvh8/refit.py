"""Filling a tree whose topology is known: triangles go into blocks, and boxes up from the blocks to the root.

The boxes of blocks and quadrics are padded and stored in their parents.  A node's box is exactly the union of the
boxes in it.  So a stored box always contains its children's stored boxes, and a ray that meets one of those, in
float32 arithmetic, meets it too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.bvh8.layout import BLOCK, BOX, COUNT, EMPTY, NODE, PRIMITIVES
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.simd import (
    address_of,
    f32x8,
    fma,
    largest,
    load_f32,
    load_f32x8,
    load_i32,
    mask8,
    maximum,
    minimum,
    select,
    smallest,
    store,
)

CORNER_BYTES, LANES = 4 * 9 * WIDTH, 4 * WIDTH
ROW = 4 * 9  # bytes of a triangle


class Links(NamedTuple):
    """Where the box of each node, block and quadric is stored: 8 * parent + child, or ~r for row r of `roots`.

    nodes (n,), blocks (m,) and quadrics (q,) int32; roots (r, 6) float32.
    """

    nodes: NDArray[np.int32]
    blocks: NDArray[np.int32]
    quadrics: NDArray[np.int32]
    roots: NDArray[np.float32]


def make_links(nodes: int, blocks: int, quadrics: int, roots: int) -> Links:
    """Uninitialised links for a tree of so many nodes, blocks, quadrics and roots."""
    return Links(
        np.empty(nodes, np.int32),
        np.empty(blocks, np.int32),
        np.empty(quadrics, np.int32),
        np.empty((roots, 6), np.float32),
    )


@kernel
def fill_blocks(blocks, rows, first, last):
    """Copy the triangles that blocks first to last - 1 name from rows (t, 9); their largest absolute coordinate.

    The boxes that are stored are exact.
    """
    extent, triangles = np.float32(0), address_of(rows)
    for block in range(address_of(blocks) + BLOCK * first, address_of(blocks) + BLOCK * last, BLOCK):
        for k in range(3):
            low, high = np.float32(np.inf), np.float32(-np.inf)
            for lane in range(load_i32(block + 4 * COUNT)):
                row = triangles + ROW * load_i32(block + 4 * (PRIMITIVES + lane)) + 4 * k
                a, b, c = load_f32(row), load_f32(row + 12), load_f32(row + 24)
                place = block + LANES * k + 4 * lane
                store(place, a)
                store(place + 3 * LANES, b)
                store(place + 6 * LANES, c)
                low, high = min(low, min(a, min(a + b, a + c))), max(high, max(a, max(a + b, a + c)))
            store(block + 4 * (BOX + k), low)
            store(block + 4 * (BOX + k + 3), high)
            extent = max(extent, max(-low, high))
    return extent


@kernel
def gather_corners(local, blocks, corners, offset, first, last):
    """Copy the corners of the triangles of blocks first to last - 1 to local (m, 72), as structure of arrays.

    Row i of corners (d, 9) are those of triangle offset + i.  Unused lanes repeat the first triangle.
    """
    target = address_of(local) + CORNER_BYTES * first
    for block in range(address_of(blocks) + BLOCK * first, address_of(blocks) + BLOCK * last, BLOCK):
        count = load_i32(block + 4 * COUNT)
        for lane in range(WIDTH):
            number = load_i32(block + 4 * (PRIMITIVES + (lane if lane < count else 0)))
            row = address_of(corners) + ROW * (number - offset)
            for k in range(9):
                store(target + LANES * k + 4 * lane, load_f32(row + 4 * k))
        target += CORNER_BYTES


@inlined
def _image(local, m0, m1, m2, m3):
    """One coordinate of 8 points under an affine map."""
    return fma(m0, load_f32x8(local), fma(m1, load_f32x8(local + LANES), fma(m2, load_f32x8(local + 2 * LANES), m3)))


@subkernel
def move_blocks(blocks, local, matrix, first, last):
    """Move the triangles of blocks first to last - 1 to the world by matrix (12,); the largest absolute coordinate.

    Each corner is moved by itself, so that triangles that share it still do.  Boxes are exact.  All
    arrays are given as addresses.
    """
    extent, nothing = np.float32(0), f32x8(0)
    corners = local + CORNER_BYTES * first
    for block in range(blocks + BLOCK * first, blocks + BLOCK * last, BLOCK):
        used = mask8((1 << load_i32(block + 4 * COUNT)) - 1)
        for k in range(3):
            m = matrix + 16 * k
            m0, m1, m2, m3 = f32x8(load_f32(m)), f32x8(load_f32(m + 4)), f32x8(load_f32(m + 8)), f32x8(load_f32(m + 12))
            a = _image(corners, m0, m1, m2, m3)
            b = _image(corners + 3 * LANES, m0, m1, m2, m3)
            c = _image(corners + 6 * LANES, m0, m1, m2, m3)
            store(block + LANES * k, select(used, a, nothing))
            store(block + LANES * (k + 3), select(used, b - a, nothing))
            store(block + LANES * (k + 6), select(used, c - a, nothing))
            low, high = smallest(minimum(a, minimum(b, c))), largest(maximum(a, maximum(b, c)))
            store(block + 4 * (BOX + k), low)
            store(block + 4 * (BOX + k + 3), high)
            extent = max(extent, max(-low, high))
        corners += CORNER_BYTES
    return extent


@inlined
def _place_of(nodes, roots, link):
    """The address that the box of a link is stored at, and the distance in bytes between its six numbers."""
    if link >= 0:
        return nodes + NODE * (link // WIDTH) + 4 * (link % WIDTH), LANES
    return roots + 24 * ~link, 4


@subkernel
def pad_box(nodes, roots, link, box, padding):
    """Pad a box (6,), and store it in its parent as well."""
    place, stride = _place_of(nodes, roots, link)
    for k in range(6):
        value = load_f32(box + 4 * k) + (padding if k >= 3 else -padding)
        store(box + 4 * k, value)
        store(place + stride * k, value)


@subkernel
def unite(nodes, roots, links, first, last):
    """Store the boxes around nodes first to last - 1 in their parents, children before parents."""
    for i in range(last - 1, first - 1, -1):
        node = nodes + NODE * i
        place, stride = _place_of(nodes, roots, load_i32(links + 4 * i))
        for k in range(3):
            upper = load_f32x8(node + LANES * (k + 3))
            store(place + stride * k, smallest(load_f32x8(node + LANES * k)))
            store(place + stride * (k + 3), largest(select(upper == EMPTY, f32x8(-EMPTY), upper)))


@kernel
def pad_blocks(tree, links, padding, first, last):
    """Pad the boxes of blocks first to last - 1, and store them in their parents as well."""
    nodes, blocks, roots = address_of(tree.nodes), address_of(tree.blocks), address_of(links.roots)
    parents = address_of(links.blocks)
    for i in range(first, last):
        pad_box(nodes, roots, load_i32(parents + 4 * i), blocks + BLOCK * i + 4 * BOX, padding)


@kernel
def pad_quadrics(tree, links, boxes, padding, first, last):
    """Pad boxes first to last - 1 of quadrics (q, 6), and store them in their parents."""
    nodes, roots = address_of(tree.nodes), address_of(links.roots)
    for i in range(first, last):
        pad_box(nodes, roots, links.quadrics[i], address_of(boxes) + 24 * i, padding)


@kernel
def unite_nodes(tree, links, first, last):
    """As `unite`, called from Python; the boxes of all leaves are known."""
    unite(address_of(tree.nodes), address_of(links.roots), address_of(links.nodes), first, last)
