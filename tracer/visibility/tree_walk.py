"""The walk down the occluders' tree to what a shaft or a beam may meet, some primitives at a time."""

from __future__ import annotations

import numpy as np

from tracer.geometry.wide_tree.topology import WIDTH
from tracer.runtime.kernels import inlined, subkernel
from tracer.simd import address_of, bits_of, i64_at, load_f32x8, lowest_bit
from tracer.visibility.budget import STEPS
from tracer.visibility.occluders import BLOCK, BOXES, STACK
from tracer.visibility.shaft import box_outside, triangle_outside

# Where a walk is: the next root, how many nodes are pending, the node at hand, and which of its children are left; the
# pending nodes follow.
ROOT, PENDING, AT, LEFT, NODES = range(5)
WALK = 8 * NODES + STACK  # bytes


@inlined
def _children_met(box, shaft):
    """Bits of the eight boxes at an address that may meet a shaft."""
    low = load_f32x8(box), load_f32x8(box + 32), load_f32x8(box + 64)
    high = load_f32x8(box + 96), load_f32x8(box + 128), load_f32x8(box + 160)
    return bits_of(~box_outside(shaft, low, high))


@inlined
def _triangles_met(block, leaf_radii, shaft):
    """Bits of the eight triangles of a block that may meet a shaft when enlarged by their error radii.

    Block and radii, leaf_radii, are at addresses."""
    corner = load_f32x8(block), load_f32x8(block + 32), load_f32x8(block + 64)
    e1 = load_f32x8(block + 96), load_f32x8(block + 128), load_f32x8(block + 160)
    e2 = load_f32x8(block + 192), load_f32x8(block + 224), load_f32x8(block + 256)
    return bits_of(~triangle_outside(shaft, corner, e1, e2, load_f32x8(leaf_radii)))


@inlined
def begin_walk(memory):
    """A walk that is to begin, in WALK bytes at an address."""
    walk = i64_at(memory)
    walk[ROOT] = walk[PENDING] = walk[AT] = walk[LEFT] = 0
    return walk


@subkernel
def walk_on(walk, o, number, shaft, numbers, n, enough, counts):
    """Go on until `enough` primitives that the shaft may meet are there, or all: then there are fewer.

    o are the `Occluders`, enlarged for light `number`; shaft is a `Shaft`, or the like.  Numbers of primitives join
    the n that numbers, int32, have room for, with room for WIDTH - 1 more than enough.  Steps are added to counts."""
    boxes, blocks, leaf_radii = address_of(o.boxes[number]), address_of(o.blocks), address_of(o.leaf_radii[number])
    root, pending, node, left = walk[ROOT], walk[PENDING], walk[AT], walk[LEFT]
    while n < enough:
        if left == 0:
            # Enter the newest of the pending nodes, or the next root.
            if pending > 0:
                pending -= 1
                node = walk[NODES + pending]
            elif root < len(o.roots):
                node = np.int64(o.roots[root])
                root += 1
            else:
                break
            counts[STEPS] += 1
            left = np.int64(_children_met(boxes + 4 * BOXES * node, shaft))
            continue
        child = lowest_bit(left)
        left &= left - 1
        code = np.int64(o.children[node, child])
        if code >= 0:
            walk[NODES + pending] = code
            pending += 1
            continue
        counts[STEPS] += 1
        leaf, those = ~code, np.int64(1)
        if o.numbers[leaf, 0] < o.first_quadric:
            those = np.int64(_triangles_met(blocks + 4 * BLOCK * leaf, leaf_radii + 4 * WIDTH * leaf, shaft))
        while those != 0:
            numbers[n] = o.numbers[leaf, lowest_bit(those)]
            those &= those - 1
            n += 1
    walk[ROOT], walk[PENDING], walk[AT], walk[LEFT] = root, pending, node, left
    return n
