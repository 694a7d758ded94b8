"""The cells of a scene: for each side of each static triangle a quadtree, made where rays have requested it.

`quadtree` tells how a cell is divided.  A cell's word is packed like that of a primitive (`tracer.culling.modes`):
occlusion bits FULLY_RENDERED, for what it says can be trusted, then FULL, LIT or CANDIDATES for each light, or UNTRIED.
Parts take over what is certified of the whole, so that a leaf's word says everything.  Cell 0 stands for none.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import FULL_SHADOW, FULLY_RENDERED, NON_SHADOW, word_type
from tracer.geometry.memory import aligned_rows
from tracer.neighbours.certified.cell_prism import slack_of
from tracer.runtime.kernels import kernel, subkernel
from tracer.visibility.error_bounds import EPSILON, cross, length, row_of

UNTRIED, FULL, LIT, CANDIDATES = 0, FULL_SHADOW, NON_SHADOW, 3
LEAF, FINAL, CONTENT = -1, -2, -3  # instead of children: none yet, none ever, and none needed as far as is known
TOO_MANY = 255  # instead of a list's length
SETTLED = 64  # added to that where rays will test these, so that the cell need not be divided for the light
OVERFLOW, NOBODY = 0, 1  # the lists of TOO_MANY and of none
# Columns of a receiver's row: a corner, the dual vectors that give u and v, the normal, by how much u and v may lie
# outside, and, as the bits of int32, the roots of both sides.
CORNER, ALONG_U, ALONG_V, NORMAL, BEYOND_U, BEYOND_V, ROOTS = 0, 3, 6, 9, 12, 13, 14
RECEIVER = 16
ARRAYS = 7  # of `Cells`, the first ones: those with a row for each cell


class Cells(NamedTuple):
    """n cells, of which `used` (1,) int64 are in use.

    Attributes:
        words: (n,) uint32 or uint64, a state for each light.
        child: (n,) int32, the first of four, LEAF, CONTENT or FINAL.
        parent: (n,) int32, 0 for a root.
        owner: (n,) int32, twice the triangle's number, plus 1 for its back.
        place: (n, 3) float32, u, v and size in the triangle.
        requests: (n,) int32, points that have requested more of a leaf.
        lists: (n, lights) int32, where in `names` the list of primitives begins that a certificate names.
        names: (m,) int32, lists, each after its length.
        used, named: (1,) int64, how many cells, and how much of `names`, are in use.
        receivers: (primitives, RECEIVER) float32, rows that lead rays to the roots; 0 where there are no cells.
        waiting: (2 primitives,) int32, points that have requested a root that has not been made, by owner.
        rooted: (primitives,) int32, 1 where there is a root.
    """

    words: NDArray[np.unsignedinteger]
    child: NDArray[np.int32]
    parent: NDArray[np.int32]
    owner: NDArray[np.int32]
    place: NDArray[np.float32]
    requests: NDArray[np.int32]
    lists: NDArray[np.int32]
    names: NDArray[np.int32]
    used: NDArray[np.int64]
    named: NDArray[np.int64]
    receivers: NDArray[np.float32]
    waiting: NDArray[np.int32]
    rooted: NDArray[np.int32]


def make_cells(primitives: int, lights: int, room: int = 1 << 22) -> Cells:
    """Memory for `room` cells of so many primitives: none yet, and all primitives without a row.

    Room that is not used takes no memory, as its pages are those that nobody has written to."""
    receivers = aligned_rows(max(primitives, 1), RECEIVER)
    receivers[:] = 0
    cells = Cells(
        np.zeros(room, word_type(lights)),
        np.zeros(room, np.int32),
        np.zeros(room, np.int32),
        np.zeros(room, np.int32),
        np.zeros((room, 3), np.float32),
        np.zeros(room, np.int32),
        np.zeros((room, lights), np.int32),
        np.zeros(2 + 4 * room, np.int32),
        np.ones(1, np.int64),
        np.full(1, 2, np.int64),
        receivers,
        np.zeros(2 * len(receivers), np.int32),
        np.zeros(len(receivers), np.int32),
    )
    cells.child[0], cells.lists[0] = FINAL, NOBODY
    cells.names[OVERFLOW], cells.names[NOBODY] = TOO_MANY, 0
    return cells


def bytes_of(cells: Cells) -> int:
    """Memory that the cells in use take, in bytes."""
    each = sum(a.itemsize * (a.shape[1] if a.ndim > 1 else 1) for a in cells[:ARRAYS])
    return int(cells.used[0]) * each + 4 * int(cells.named[0])


def _longer(array: NDArray, size: int) -> NDArray:
    """A copy of an array with so many rows, the further ones 0."""
    result = np.zeros((size, *array.shape[1:]), array.dtype)
    result[: len(array)] = array
    return result


def with_room(cells: Cells, more: int, names: int) -> Cells:
    """The same cells with room for so many more of them, and of names."""
    need, size = int(cells.used[0]) + more, len(cells.words)
    if need > size:
        size = max(need, 2 * size)
        cells = Cells._make([*(_longer(a, size) for a in cells[:ARRAYS]), *cells[ARRAYS:]])
    need = int(cells.named[0]) + names
    if need > len(cells.names):
        cells = cells._replace(names=_longer(cells.names, max(need, 2 * len(cells.names))))
    return cells


@subkernel
def _put_receiver(rows, i, max_coordinate, row):
    """Put the row (RECEIVER,) of triangle i of rows (n, ROW); False where it is too thin to have one."""
    a, e1, e2 = row_of(rows, i)
    n = cross(e1, e2)
    across = length(n)
    if not across > 0.0:
        return False
    along_u, along_v = cross(e2, n), cross(n, e1)
    du, dv, _ = slack_of(e1, e2, max_coordinate)
    if not (du < 0.01 and dv < 0.01):
        return False
    for axis in range(3):
        row[CORNER + axis] = a[axis]
        row[ALONG_U + axis] = along_u[axis] / (across * across)
        row[ALONG_V + axis] = along_v[axis] / (across * across)
        row[NORMAL + axis] = n[axis] / across
    row[BEYOND_U] = 3 * EPSILON * max_coordinate * length(e2) / across
    row[BEYOND_V] = 3 * EPSILON * max_coordinate * length(e1) / across
    return True


@kernel
def put_receivers(rows, first, last, max_coordinate, receivers):
    """Put the rows of triangles first to last - 1 of rows (n, ROW) into receivers (p, RECEIVER), without roots.

    No coordinate of the scene is larger than max_coordinate."""
    for i in range(first, last):
        receivers[i, :] = 0
        if not _put_receiver(rows, i, max_coordinate, receivers[i]):
            receivers[i, :] = 0


@subkernel
def add_cell(cells, parent, owner, u, v, size):
    """Make a new leaf; its number.  There must be room."""
    number = cells.used[0]
    cells.used[0] = number + 1
    cells.words[number] = FULLY_RENDERED
    cells.child[number], cells.parent[number], cells.owner[number] = LEAF, parent, owner
    cells.place[number, 0], cells.place[number, 1], cells.place[number, 2] = u, v, size
    cells.requests[number] = 0
    cells.lists[number, :] = NOBODY
    return number


@subkernel
def state_of(word, light):
    """The state of a light in a word: UNTRIED, FULL, LIT or CANDIDATES."""
    return (np.int64(word) >> (2 + 2 * light)) & 3


@subkernel
def set_state(cells, number, light, state):
    """Put the state of a light into a cell's word."""
    shift = np.uint64(2 + 2 * light)
    word = np.uint64(cells.words[number]) & ~(np.uint64(3) << shift)
    cells.words[number] = word | (np.uint64(state) << shift)


@subkernel
def set_below(cells, number, light, stack):
    """Let all cells that a cell is divided into take over its certificate for a light.

    Where that is CANDIDATES, only those take it that have none.  stack (256,) int64 is memory."""
    state, named = state_of(cells.words[number], light), cells.lists[number, light]
    stack[0], pending = number, 1
    while pending > 0:
        pending -= 1
        child = np.int64(cells.child[stack[pending]])
        if child >= 0:
            for k in range(4):
                if state != CANDIDATES or state_of(cells.words[child + k], light) == UNTRIED:
                    set_state(cells, child + k, light, state)
                    cells.lists[child + k, light] = named if state == CANDIDATES else NOBODY
                stack[pending] = child + k
                pending += 1


def named_by(cells: Cells, number: int, light: int) -> NDArray[np.int32] | None:
    """The primitives (k,) int32 that a cell's certificate for a light names; None for too many.

    A certificate that is FULL and names nobody is taken over from the cell that this one is a part of."""
    at = int(cells.lists[number, light])
    return None if at == OVERFLOW else cells.names[at + 1 : at + 1 + (cells.names[at] & (SETTLED - 1))]
