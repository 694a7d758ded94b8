"""The way of one ray through the 8-wide trees, node by node.

Rays travel in packets there, and a packet enters what any of its rays may enter.  These are the nodes that the ray
itself enters, in the order in which it would go alone (`single_ray`), with the hits that it has in any company.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tracer.geometry.boxes import inverse
from tracer.geometry.bvh8.layout import BOX, CHILDREN, COUNT, PRIMITIVES, QUADRIC, Tree
from tracer.geometry.bvh8.packet import FAR
from tracer.geometry.interpreted import interpreted
from tracer.geometry.intersect import hit_quadric
from tracer.geometry.rays import MISS, Ray
from tracer.geometry.triangle_test import Triangle, crossing, terms_of
from tracer.geometry.visits import Visit, corners_of
from tracer.geometry.wide_tree.topology import WIDTH
from tracer.scene.arrays import Float32

_inverse, _crossing, _terms_of = interpreted(inverse), interpreted(crossing), interpreted(terms_of)
_hit_quadric = interpreted(hit_quadric)


class TreeAt(NamedTuple):
    """A tree to go through: its name, nodes and blocks, and its root."""

    name: str
    tree: Tree
    root: int


class _Pending(NamedTuple):
    code: int
    enter: float
    leave: float
    box: Float32
    level: int


class Walk:
    """One ray's way: for its `nearest` hit, or for any.  quadrics (q, 16) are as seen from the world; the first of them
    is primitive `triangles`; `opened` tells the nodes that the codes of pieces stand for."""

    def __init__(
        self, quadrics: Float32, triangles: int, nearest: bool, opened: Callable[[int], int] | None = None
    ) -> None:
        self._opened = opened or (lambda code: code)
        self._quadrics, self._first, self._nearest = quadrics.reshape(-1), triangles, nearest
        self.visits: list[Visit] = []
        self.primitive = MISS

    def go(self, ray: Ray, trees: list[TreeAt]) -> list[Visit]:
        """All nodes that the ray enters, in their order."""
        self._ray, self.t = ray, ray.t_max
        self._origin, self._way = np.array(ray[:3], np.float32), np.array(ray[3:6], np.float32)
        with np.errstate(all="ignore"):
            self._inverse = np.array([_inverse(x) for x in self._way], np.float32)
            for placed in trees:
                if self._nearest or self.primitive == MISS:
                    self._go_through(placed)
        return self.visits

    def _inside(self, boxes: Float32) -> tuple[Float32, Float32]:
        """t where the ray enters and leaves boxes (6, n)."""
        low, high = ((side - self._origin[:, None]) * self._inverse[:, None] for side in (boxes[:3], boxes[3:]))
        enter = np.maximum(np.minimum(low, high).max(0), self._ray.t_min)
        return enter, np.minimum(np.maximum(low, high).min(0), self.t)

    def _go_through(self, placed: TreeAt) -> None:
        nodes, codes = placed.tree.nodes, placed.tree.nodes.view(np.int32)
        root = nodes[placed.root, : 6 * WIDTH].reshape(6, WIDTH)
        used = codes[placed.root, CHILDREN : CHILDREN + WIDTH] != ~0
        if not used.any():
            return
        box = np.concatenate([root[:3, used].min(1), root[3:, used].max(1)])
        enter, leave = self._inside(box[:, None])
        if enter[0] > leave[0]:
            return
        pending = [_Pending(placed.root, float(enter[0]), float(leave[0]), box, 0)]
        while pending:
            at = pending.pop()
            if self._nearest and at.enter > self.t:
                continue
            if at.code >= 0:
                at = at._replace(code=self._opened(at.code))
            visit = Visit(placed.name, at.code, False, at.level, corners_of(at.box), at.enter, at.leave)
            if at.code < 0:
                self._test(visit, placed.tree.blocks[~at.code] if ~at.code < QUADRIC else None, ~at.code)
                if self.primitive != MISS and not self._nearest:
                    return
                continue
            self.visits.append(visit)
            boxes = nodes[at.code, : 6 * WIDTH].reshape(6, WIDTH)
            enter, leave = self._inside(boxes)
            entered = [
                _Pending(int(codes[at.code, CHILDREN + c]), float(enter[c]), float(leave[c]), boxes[:, c], at.level + 1)
                for c in np.flatnonzero(enter <= leave)
            ]
            if self._nearest:
                entered.sort(key=lambda child: -child.enter)
            quadrics = [child for child in entered if child.code < 0 and ~child.code >= QUADRIC]
            pending += [child for child in entered if child not in quadrics] + quadrics  # quadrics are tested at once

    def _test(self, visit: Visit, block: Float32 | None, leaf: int) -> None:
        """Test the ray against what a leaf holds."""
        ray = self._ray
        if block is None:
            number = self._first + leaf - QUADRIC
            t = float(_hit_quadric(ray._replace(t_max=FAR), self._quadrics, leaf - QUADRIC))
            hits = [(number, t)] if visit.enter <= t <= visit.leave and t < ray.t_max else []
            tested: tuple[int, ...] = (number,)
        else:
            count = int(block.view(np.int32)[COUNT])
            numbers = block.view(np.int32)[PRIMITIVES : PRIMITIVES + count]
            tested = tuple(int(n) for n in numbers)
            terms = _terms_of(*self._origin, Triangle(*block[: 9 * WIDTH].reshape(9, WIDTH)[:, :count]))
            crosses, sign, _, _, area = _crossing(*self._way, terms)
            t_all = (terms.height.view(np.int32) ^ sign).view(np.float32) * (np.float32(1) / area)
            first, last = self._inside_whole(block[BOX : BOX + 6])
            crosses = crosses & (t_all > ray.t_min) & (t_all < ray.t_max) & (t_all >= first) & (t_all <= last)
            hits = [(tested[k], float(t_all[k])) for k in np.flatnonzero(crosses)]
        for number, t in hits:
            if self._nearest and (t < self.t or (t == self.t and number < self.primitive)):
                self.t, self.primitive = np.float32(t), number
            elif not self._nearest and self.primitive == MISS:
                self.primitive = number
        self.visits.append(visit._replace(node=leaf % QUADRIC, leaf=True, tested=tested, hits=tuple(hits)))

    def _inside_whole(self, box: Float32) -> tuple[np.float32, np.float32]:
        """t where the line of the ray enters and leaves a box (6,)."""
        low, high = ((side - self._origin) * self._inverse for side in (box[:3], box[3:]))
        return np.minimum(low, high).max(), np.maximum(low, high).min()
