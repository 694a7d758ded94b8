"""A large tree in pieces: all are built at once, or each when the first ray reaches it.

A piece's content follows from its triangles alone, and the code of its root in the crown never changes
(`layout.PIECE`).  So rays meet the same in the same order whenever, and by whomever, a piece is built: who watches
answers and counters cannot tell.  A ray that reaches a piece that is not there calls back, and waits until the piece is
built, by its own thread or by another that came first.
"""

from __future__ import annotations

import ctypes
import mmap
import sys
import threading
import weakref
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import PADDING
from tracer.geometry.building import CANCELLED, DONE
from tracer.geometry.bvh8.build import count_blocks
from tracer.geometry.bvh8.crown import crown_over, write_crown
from tracer.geometry.bvh8.layout import BLOCK_SIZE, NODE_SIZE, PIECE, Tree
from tracer.geometry.bvh8.refit import Links, fill_blocks, make_links, pad_blocks, pad_quadrics, unite_nodes
from tracer.geometry.bvh8.write import Offsets, clear, write_topology
from tracer.geometry.wide_tree.build import build_topology
from tracer.geometry.wide_tree.topology import Topology
from tracer.runtime.parallel import for_each_chunk
from tracer.scene import memory_check
from tracer.scene.arrays import Float32
from tracer.scene.model import Cancelled

LARGE = 500_000  # triangles and quadrics: a tree over more is made of pieces
PIECE_SIZE = 1 << 13  # triangles of a piece at most
_CALLED = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * 5)


class PiecewiseTree:
    """The tree over triangles (t, 9), corner and edges, and boxes (q, 6) of quadrics: a crown, and pieces that wait.

    `tree` has room for all that may come, which takes memory only where something is, but 640 addresses a triangle.
    Where these are few, as `ulimit -v` makes them, pieces are built once before, to see what they need.  `table` is
    what rays read (`placed.root_of_piece`), and is of use while this object lives; `boxes` (p, 6) lie around pieces of
    so many triangles and quadrics, `sizes` (p,).  control (2,) int64: the build ends with Cancelled once
    control[CANCELLED] is set.  Raises MemoryError."""

    def __init__(self, rows: Float32, boxes: Float32, control: NDArray[np.int64], threads: int) -> None:
        self._rows, self._boxes, self._padded = rows, boxes, boxes.copy()
        crown = crown_over(rows, boxes, PIECE_SIZE, control, threads)
        self._items, pieces = crown.items, len(crown.items)
        self.sizes = np.array([len(items) for items in crown.items])
        self.boxes = crown.boxes
        self.padding = np.float32(PADDING * np.abs(crown.boxes).max(initial=0))
        first = len(crown.children) + 1, 1
        try:
            self.tree, self._links = self._with_room(*first, int(np.maximum(self.sizes, 1).sum()), len(rows), True)
        except MemoryError:  # of addresses: what is never used takes no memory
            self.tree, self._links = self._with_room(*first, *self._needed(control, threads))
        write_crown(self.tree, crown, self.padding)
        nothing = len(crown.children)  # a node for pieces that cannot be built
        clear(Tree(self.tree.nodes[nothing : nothing + 1], self.tree.blocks[:1]))
        self._nothing, self._nodes, self._blocks = nothing, nothing + 1, 1
        self._locks, self._room = [threading.Lock() for _ in range(pieces)], threading.Lock()
        self._raised: BaseException | None = None
        self._broken = False
        self.table = table = np.full(1 + pieces, -1, np.int64)
        this = weakref.ref(self)

        def called(piece: int, _a: int, _b: int, _c: int, _d: int) -> None:
            try:
                tree = this()
                if tree is not None:
                    tree.ask_for(piece)
            finally:  # the ray goes on with whatever stands there
                if table[1 + piece] < 0:
                    table[1 + piece] = nothing

        self._called = _CALLED(called)
        self.table[0] = ctypes.cast(self._called, ctypes.c_void_p).value or 0

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
        """How many nodes and blocks the pieces will have, (2,), and some for builds that are interrupted: found out by
        building them, without room for them."""
        found = np.zeros((len(self._items), 2), np.int64)

        def one(piece: int, worker: int) -> None:
            topology = self._topology(piece)
            found[piece] = len(topology.children), count_blocks(topology, len(self._rows))

        for_each_chunk(one, len(found), threads, lambda: bool(control[CANCELLED]))
        return found.sum(0) + 2 * found.max(0, initial=0)

    def _topology(self, piece: int) -> Topology:
        """The topology of a piece, with the numbers of the whole tree's triangles and quadrics."""
        items, triangles = self._items[piece], len(self._rows)
        flat = int(np.searchsorted(items, triangles)) if len(self._boxes) else len(items)
        boxes = self._boxes[items[flat:] - triangles]
        topology = build_topology(self._rows[items[:flat]], boxes, np.zeros(2, np.int64))
        return topology._replace(order=items[topology.order])

    def ask_for(self, piece: int) -> None:
        """Build a piece for a ray that waits; what goes wrong is raised by `check`, as nothing can be raised here."""
        for _ in range(2):  # whoever interrupts the program may do so in the middle of this
            try:
                self._build(piece)
                return
            except BaseException as error:
                self._raised = error
        self._broken, self.table[1 + piece] = True, self._nothing

    def check(self) -> None:
        """Raise what went wrong while rays waited: each picture asks before it is shown.  A tree that lacks a piece
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

    def _build(self, piece: int, control: NDArray[np.int64] | None = None) -> None:
        with self._locks[piece]:
            if self.table[1 + piece] >= 0:
                return
            if control is not None and control[CANCELLED]:
                raise Cancelled
            items, triangles = self._items[piece], len(self._rows)
            quadrics = items[items >= triangles] - triangles
            topology = self._topology(piece)
            # Take room, and write it there.
            used, filled = len(topology.children), count_blocks(topology, triangles)
            with self._room:
                node, block = self._nodes, self._blocks
                if node + used > len(self.tree.nodes) or block + filled > len(self.tree.blocks):
                    raise MemoryError("no room for a piece of the tree")
                self._nodes, self._blocks = node + used, block + filled
            tree, links, end = self.tree, self._links, block + filled
            clear(Tree(tree.nodes[node : node + used], tree.blocks[block:end]))
            write_topology(tree, links, topology, triangles, Offsets(node, block, 0, 0, piece))
            fill_blocks(tree.blocks, self._rows, block, end)
            pad_blocks(tree, links, self.padding, block, end)
            self._padded[quadrics] = self._boxes[quadrics]  # an interrupted build may have padded them
            for quadric in quadrics.tolist():
                pad_quadrics(tree, links, self._padded, self.padding, quadric, quadric + 1)
            unite_nodes(tree, links, node, node + used)
            # A reader takes no lock.  Letting go of one here and taking it again orders what was written before the
            # number, on processors that reorder writes as well.
            with self._room:
                pass
            with self._room:
                self.table[1 + piece] = node
            self._items[piece] = items[:0]

    def opened(self, code: int) -> int:
        """The number of the node that a child's code, that is no leaf's, stands for; a piece is built."""
        if code < PIECE:
            return code
        self._build(code - PIECE)
        return int(self.table[1 + code - PIECE])

    @property
    def used(self) -> Tree:
        """The nodes and blocks that are there so far."""
        return Tree(self.tree.nodes[: self._nodes], self.tree.blocks[: self._blocks])

    @property
    def built(self) -> int:
        """How many primitives lie in pieces that are built."""
        return int(self.sizes[self.table[1:] >= 0].sum())

    @property
    def memory_bytes(self) -> int:
        """Of nodes and blocks, and of what is kept of pieces that wait."""
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
