"""A large tree: a top tree over subtrees of some thousand triangles each, all built at once, or each when the first ray
reaches it.

Triangles are sorted into cells of a grid, and the top tree is built over the cells by the surface area heuristic, down
to subtrees: it costs three passes over the triangles, and takes no look at any of them again.

What is in a subtree follows from its triangles alone, and the code of its root in the top tree never changes
(`layout.SUBTREE`).  So rays meet the same in the same order whenever, and by whomever, a subtree is built: who watches
answers and counters cannot tell.  A ray that reaches one that is not there calls back, and waits until it is built, by
its own thread or by another that came first (`tracer.geometry.shared_memory`).
"""

from __future__ import annotations

import ctypes
import mmap
import sys
import threading
import weakref
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import NO_BOX, PADDING
from tracer.geometry.building import CANCELLED, DONE
from tracer.geometry.bvh8.build import count_blocks
from tracer.geometry.bvh8.layout import BLOCK_SIZE, CHILDREN, NODE_SIZE, SUBTREE, Offsets, Tree, clear, write_topology
from tracer.geometry.bvh8.refit import Links, fill_blocks, make_links, pad_blocks, pad_quadrics, unite_nodes
from tracer.geometry.shared_memory import UNBUILT, publish_word
from tracer.geometry.wide_tree.binary import WEIGHT, grow, make_items, put_boxes
from tracer.geometry.wide_tree.build import ALL, build_topology, collapsed
from tracer.geometry.wide_tree.cells import Cells, cells_over
from tracer.geometry.wide_tree.topology import TOP_LEVEL_DEPTH, VACANT, WIDTH, Topology
from tracer.runtime.parallel import for_each_chunk
from tracer.scene import memory_check
from tracer.scene.arrays import Float32
from tracer.scene.model import Cancelled

LARGE = 500_000  # triangles and quadrics: a tree over more is made of subtrees
SUBTREE_SIZE = 1 << 13  # triangles of a subtree at most
_CALLED = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 5)


class TopTree(NamedTuple):
    """children (n, 8) int32 as in a `Topology`, whose leaves are p subtrees; boxes (p, 6) float32 around these; items,
    the numbers of each one's triangles and, counted from their number on, quadrics."""

    children: NDArray[np.int32]
    boxes: Float32
    items: list[NDArray[np.int32]]


def top_tree_over(rows: Float32, boxes: Float32, subtree: int, control: NDArray[np.int64], threads: int = 1) -> TopTree:
    """The top tree over triangles (t, 9), corner and edges, and boxes (q, 6) of quadrics, with subtrees of at most so
    many triangles (WIDTH at least) where their centres differ.

    control (2,) int64: raises Cancelled once control[CANCELLED] is set."""
    cells = cells_over(rows, subtree, control, threads)
    # Grow a binary tree over the cells and the quadrics.
    count = len(cells.boxes) + len(boxes)
    around = np.concatenate([cells.boxes, boxes])
    items = make_items(count)
    put_boxes(items, around, 0)
    items.items[0, : len(cells.boxes)].view(np.int32)[:, WEIGHT // 4] = np.diff(cells.starts)
    stack = np.zeros((TOP_LEVEL_DEPTH + 2, 5), np.int64)
    stack[0, 1] = count
    grow(items, stack, 1, ALL, TOP_LEVEL_DEPTH, subtree, control)
    if control[CANCELLED]:
        raise Cancelled
    # Give it eight children a node; its leaves are the subtrees.
    children, leaves = collapsed(items, TOP_LEVEL_DEPTH)
    first = leaves[:, 0]
    ends = np.append(np.sort(first), count)
    last = ends[np.searchsorted(ends, first) + 1]
    parts = [items.order[a:b] for a, b in zip(first.tolist(), last.tolist(), strict=True)]
    subtree_boxes = [np.concatenate([around[part, :3].min(0), around[part, 3:].max(0)]) for part in parts]
    return TopTree(
        children,
        np.stack(subtree_boxes),
        [_items_of(cells, part, len(rows)) for part in parts],
    )


def _items_of(cells: Cells, part: NDArray[np.int32], triangles: int) -> NDArray[np.int32]:
    """The numbers of what is in some cells and quadrics, triangles first."""
    known = len(cells.boxes)
    inside = [cells.order[cells.starts[c] : cells.starts[c + 1]] for c in np.sort(part[part < known])]
    quadrics = np.sort(part[part >= known]) - known + triangles
    return np.concatenate([*inside, quadrics.astype(np.int32)])


def write_top_tree(tree: Tree, top: TopTree, padding: np.float32) -> None:
    """Write a top tree into the first nodes of a tree; boxes are padded."""
    count = len(top.children)
    clear(Tree(tree.nodes[:count], tree.blocks[:1]))
    padded = np.concatenate([top.boxes[:, :3] - padding, top.boxes[:, 3:] + padding], axis=1)
    around = np.tile(NO_BOX, (count, 1))
    codes = tree.nodes.view(np.int32)
    for node in range(count - 1, -1, -1):
        slots = np.flatnonzero(top.children[node] != VACANT)
        children = top.children[node, slots]
        inner = children >= 0
        boxes = np.where(inner[:, None], around[children * inner], padded[~children * ~inner])
        tree.nodes[node, : 6 * WIDTH].reshape(6, WIDTH)[:, slots] = boxes.T
        codes[node, CHILDREN + slots] = np.where(inner, children, SUBTREE + ~children)
        around[node] = np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)])


class LargeTree:
    """The tree over triangles (t, 9), corner and edges, and boxes (q, 6) of quadrics, whose subtrees may wait for rays.

    `tree` has room for all that may come, which takes memory only where something is, but 640 addresses a triangle.
    Where these are few, as `ulimit -v` makes them, subtrees are built once before, to see what they need.  `table` is
    what rays read (`placed.root_of_subtree`), and is of use while this object lives; `boxes` (p, 6) lie around subtrees
    of so many triangles and quadrics, `sizes` (p,).  control (2,) int64: the build ends with Cancelled once
    control[CANCELLED] is set.  Raises MemoryError."""

    def __init__(self, rows: Float32, boxes: Float32, control: NDArray[np.int64], threads: int) -> None:
        self._rows, self._boxes, self._padded = rows, boxes, boxes.copy()
        top = top_tree_over(rows, boxes, SUBTREE_SIZE, control, threads)
        self._items, count = top.items, len(top.items)
        self.sizes = np.array([len(items) for items in top.items])
        self.boxes = top.boxes
        self.padding = np.float32(PADDING * np.abs(top.boxes).max(initial=0))
        first = len(top.children) + 1, 1
        try:
            self.tree, self._links = self._with_room(*first, int(np.maximum(self.sizes, 1).sum()), len(rows), True)
        except MemoryError:  # of addresses: what is never used takes no memory
            self.tree, self._links = self._with_room(*first, *self._needed(control, threads))
        write_top_tree(self.tree, top, self.padding)
        nothing = len(top.children)  # a node for subtrees that cannot be built
        clear(Tree(self.tree.nodes[nothing : nothing + 1], self.tree.blocks[:1]))
        self._nothing, self._nodes, self._blocks = nothing, nothing + 1, 1
        self._locks, self._room = [threading.Lock() for _ in range(count)], threading.Lock()
        self._raised: BaseException | None = None
        self._broken = False
        self.table = table = np.full(1 + count, UNBUILT, np.int64)
        this = weakref.ref(self)

        def called(number: int, _a: int, _b: int, _c: int, _d: int) -> None:
            try:
                tree = this()
                if tree is not None:
                    tree.ask_for(number)
            finally:  # the ray goes on with whatever stands there
                if table[1 + number] < 0:
                    publish_word(table, 1 + number, nothing)

        self._called = _CALLED(called)
        publish_word(table, 0, ctypes.cast(self._called, ctypes.c_void_p).value or 0)

    def _with_room(self, node: int, block: int, nodes: int, blocks: int, sparing: bool = False) -> tuple[Tree, Links]:
        """A tree with room for `nodes` and `blocks` from these numbers on; raises MemoryError, where it is `sparing`
        also if more than half of the addresses that this process may take were gone."""
        nodes, blocks = node + nodes, block + blocks
        left = memory_check.of_limit()
        if sparing and left is not None and 4 * (nodes * NODE_SIZE + blocks * BLOCK_SIZE) > left / 2:
            raise MemoryError("few addresses")
        tree = Tree(_reserved_rows(nodes, NODE_SIZE), _reserved_rows(blocks, BLOCK_SIZE))
        return tree, make_links(nodes, blocks, len(self._boxes), len(self._items))

    def _needed(self, control: NDArray[np.int64], threads: int) -> NDArray[np.int64]:
        """How many nodes and blocks subtrees will have, (2,), and some for builds that are interrupted: found out by
        building them, without room for them."""
        found = np.zeros((len(self._items), 2), np.int64)

        def one(subtree: int, worker: int) -> None:
            topology = self._topology(subtree)
            found[subtree] = len(topology.children), count_blocks(topology, len(self._rows))

        for_each_chunk(one, len(found), threads, lambda: bool(control[CANCELLED]))
        return found.sum(0) + 2 * found.max(0, initial=0)

    def _topology(self, subtree: int) -> Topology:
        """The topology of a subtree, with the numbers of the whole tree's triangles and quadrics."""
        items, triangles = self._items[subtree], len(self._rows)
        flat = int(np.searchsorted(items, triangles)) if len(self._boxes) else len(items)
        boxes = self._boxes[items[flat:] - triangles]
        topology = build_topology(self._rows[items[:flat]], boxes, np.zeros(2, np.int64))
        return topology._replace(order=items[topology.order])

    def ask_for(self, subtree: int) -> None:
        """Build a subtree for a ray that waits; what goes wrong is raised by `check`, as nothing can be raised here."""
        for _ in range(2):  # whoever interrupts the program may do so in the middle of this
            try:
                self._build(subtree)
                return
            except BaseException as error:
                self._raised = error
        self._broken = True
        publish_word(self.table, 1 + subtree, self._nothing)

    def check(self) -> None:
        """Raise what went wrong while rays waited: each picture asks before it is shown.  A tree that lacks a subtree
        raises that again and again."""
        raised = self._raised
        if raised is not None:
            self._raised = raised if self._broken else None
            raise raised

    def build_all(self, control: NDArray[np.int64] | None = None, threads: int = 1) -> None:
        """Build what is not built yet; raises Cancelled once control[CANCELLED] is set, and counts what is done in
        control[DONE]."""
        control = np.zeros(2, np.int64) if control is None else control
        waiting = [p for p in np.argsort(-self.sizes, kind="stable").tolist() if self.table[1 + p] < 0]

        def one(chunk: int, worker: int) -> None:
            self._build(waiting[chunk], control)
            control[DONE] += self.sizes[waiting[chunk]]

        for_each_chunk(one, len(waiting), threads, lambda: bool(control[CANCELLED]))

    def _build(self, subtree: int, control: NDArray[np.int64] | None = None) -> None:
        with self._locks[subtree]:
            if self.table[1 + subtree] >= 0:
                return
            if control is not None and control[CANCELLED]:
                raise Cancelled
            items, triangles = self._items[subtree], len(self._rows)
            quadrics = items[items >= triangles] - triangles
            topology = self._topology(subtree)
            # Take room, and write it there.
            used, filled = len(topology.children), count_blocks(topology, triangles)
            with self._room:
                node, block = self._nodes, self._blocks
                if node + used > len(self.tree.nodes) or block + filled > len(self.tree.blocks):
                    raise MemoryError("no room for a subtree")
                self._nodes, self._blocks = node + used, block + filled
            tree, links, end = self.tree, self._links, block + filled
            clear(Tree(tree.nodes[node : node + used], tree.blocks[block:end]))
            write_topology(tree, links, topology, triangles, Offsets(node, block, 0, 0, subtree))
            fill_blocks(tree.blocks, self._rows, block, end)
            pad_blocks(tree, links, self.padding, block, end)
            self._padded[quadrics] = self._boxes[quadrics]  # an interrupted build may have padded them
            for quadric in quadrics.tolist():
                pad_quadrics(tree, links, self._padded, self.padding, quadric, quadric + 1)
            unite_nodes(tree, links, node, node + used)
            publish_word(self.table, 1 + subtree, node)
            self._items[subtree] = items[:0]

    def opened(self, code: int) -> int:
        """The number of the node that a child's code, that is no leaf's, stands for; a subtree is built."""
        if code < SUBTREE:
            return code
        self._build(code - SUBTREE)
        return int(self.table[1 + code - SUBTREE])

    @property
    def used(self) -> Tree:
        """The nodes and blocks that are there so far."""
        return Tree(self.tree.nodes[: self._nodes], self.tree.blocks[: self._blocks])

    @property
    def built(self) -> int:
        """How many primitives lie in subtrees that are built."""
        return int(self.sizes[self.table[1:] >= 0].sum())

    @property
    def memory_bytes(self) -> int:
        """Of nodes and blocks, and of what is kept of subtrees that wait."""
        waiting = sum(items.nbytes for items in self._items)
        return self.used.nodes.nbytes + self.used.blocks.nbytes + waiting + 4 * (self._nodes + self._blocks)


def _reserved_rows(rows: int, columns: int) -> Float32:
    """(rows, columns) float32 zeros, aligned, whose memory is taken from the system where it is first written."""
    size = max(4 * rows * columns, 1)
    try:
        memory = _reserved(size)
    except OSError as error:
        raise MemoryError(f"no room for a tree of {size / 1e9:.1f} GB") from error
    return np.frombuffer(memory, np.float32, rows * columns).reshape(rows, columns)


def _reserved(size: int) -> mmap.mmap:
    if sys.platform == "win32":
        return mmap.mmap(-1, size)
    flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | getattr(mmap, "MAP_NORESERVE", 0)
    memory = mmap.mmap(-1, size, flags=flags)
    if hasattr(mmap, "MADV_HUGEPAGE"):
        with suppress(OSError):  # of a kernel without large pages
            memory.madvise(mmap.MADV_HUGEPAGE)
    return memory
