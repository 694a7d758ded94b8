"""How a tree that is built while rays arrive lies in memory, and the walk of a ray to what hangs in it.

A node is four int64: what it is, the plane's bits, and two addresses.

- INNER + axis: the addresses are those of the lower and of the upper child.
- UNBUILT or CLAIMED: the first address is that of its references (`references`).  The first ray to arrive has it split
  (`tracer.geometry.shared_memory`).
- SUBTREE: few primitives, whose whole tree, of the kind in `tracer.geometry.kdtree.tree`, is at the first address: the
  numbers of its words and of its items, int64 each, and then the words and the items, int32 each.
- OBJECTS: the first address is that of the node of what never moves; the second that of a list of objects, int32 each,
  of which the first is how many they are.

Of an INNER node the flags LOWER_MOVES and UPPER_MOVES say that something moves below that child: rays that ask for what
moves go nowhere else (section 2.4 of the paper).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from tracer.geometry.boxes import inverse
from tracer.geometry.intersect import ZERO
from tracer.geometry.kdtree.tree import at_plane, push
from tracer.geometry.shared_memory import built
from tracer.runtime.kernels import inlined
from tracer.simd import load_f32, load_i64
from tracer.simd.records import block_size, offset_of

INNER, SUBTREE, OBJECTS = 0, 3, 4
KIND, LOWER_MOVES, UPPER_MOVES = 7, 8, 16  # a mask, and flags beside it
STATIC_VISITED = 1  # added to the address of a node of OBJECTS on the stack: what never moves has been asked there
DEPTH = 40  # levels of such nodes in a tree; a tree over objects has as many again
STACK = 2 * DEPTH + 8


class Node(NamedTuple):
    """A node in memory, 8 bytes each."""

    word: int
    plane: int
    first: int
    second: int


class Subtree(NamedTuple):
    """What stands before the words and the items of a SUBTREE: how many there are."""

    words: int
    items: int


NODE, HEADER = block_size(Node), block_size(Subtree)  # bytes
PLANE, FIRST, SECOND = (offset_of(Node, name) for name in ("plane", "first", "second"))


class Building(NamedTuple):
    """Addresses of what builds a node, and of what lets other threads go on while one waits for it."""

    open_node: int
    pause: int


class Met(NamedTuple):
    """A node with something in it that a ray enters: its address, what it is, the ray's interval of t in it, the steps
    taken on the way, and how many nodes are pending then."""

    node: Any
    kind: Any
    enter: Any
    leave: Any
    steps: Any
    pending: Any


@inlined
def word_of(node, building):
    """The first word of a node that rays can go on from: one that is not built yet is built now."""
    return built(node, building.open_node, node, building.pause)


@inlined
def next_node(ray, stack, pending, building, moving):
    """Enter the newest of the pending nodes and walk down to one that holds something, nearer child first.

    `moving`: the ray asks for what moves alone.  The root of a SUBTREE is no step, as the walk in it begins there.
    """
    # Take the newest pending node, with the ray's interval in it.
    pending -= 1
    node, enter, leave = stack.node[pending], stack.enter[pending], stack.leave[pending]
    steps = 0
    if node & STATIC_VISITED:
        return Met(node, OBJECTS, enter, leave, steps, pending)
    inverse_x, inverse_y, inverse_z = inverse(ray.dx), inverse(ray.dy), inverse(ray.dz)
    while True:
        word = word_of(node, building)
        axis = word & KIND
        if axis >= SUBTREE:
            return Met(node, axis, enter, leave, steps + (axis == OBJECTS), pending)
        steps += 1
        t, lower_first = at_plane(ray, inverse_x, inverse_y, inverse_z, axis, load_f32(node + PLANE))
        near = load_i64(node + (FIRST if lower_first else SECOND))
        far = load_i64(node + (SECOND if lower_first else FIRST))
        near_asked = not moving or (word & (LOWER_MOVES if lower_first else UPPER_MOVES)) != 0
        far_asked = not moving or (word & (UPPER_MOVES if lower_first else LOWER_MOVES)) != 0
        # Go on to the only child that the ray meets; or to the nearer one, with the other pending.
        if t > leave or t <= ZERO:
            far_asked = False
        elif t < enter:
            near_asked = False
        else:
            if near_asked and far_asked:
                pending = push(stack, pending, far, t, leave)
                far_asked = False
            if near_asked:
                leave = t
            else:
                enter = t
        if near_asked:
            node = near
        elif far_asked:
            node = far
        else:
            return Met(node, INNER, enter, leave, steps, pending)
