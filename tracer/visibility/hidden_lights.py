"""Which lights is a box of space left with?  All but those that one triangle hides from every point of it.

The tree of lights is descended.  The blockers that may hide a node are those that separate its middle from that of the
box; those around what hid the last nodes are tried first, since a wall hides many.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.memory import without_refcount
from tracer.runtime.kernels import inlined, kernel, subkernel
from tracer.runtime.parallel import for_each_chunk
from tracer.simd import address_of, bits_of, f32x16, load_f32x16, lowest_bit, maximum, minimum, ones
from tracer.visibility.blockers import between_middles, find_blockers, hull_of, that_hide
from tracer.visibility.budget import COUNTERS, STEPS, TESTS
from tracer.visibility.error_bounds import LONGEST
from tracer.visibility.light_tree import build_light_tree
from tracer.visibility.static_geometry import bounds_around

if TYPE_CHECKING:
    from tracer.geometry.world import World
    from tracer.scene.lights import Lamps

TRIED = 12  # blockers, for a node and a box, before it is left alone
RECENT = 4  # groups of blockers that are tried before any are looked for
FIRST_ROOM = 4096  # leaves, to begin with
STACK = 64  # nodes that wait on the way down: no tree of 2^31 lights is deeper
CHUNK = 32  # boxes that a thread takes at a time
MOVED = 8  # the part, one in so many, of lights that may have moved before all is proved anew


@inlined
def _between(around, sixteen, lights, region):
    """Bits of the groups whose box the line between both centres meets."""
    at, enter, leave = address_of(around[sixteen]), f32x16(np.float32(0)), f32x16(np.float32(1))
    inside = f32x16(np.float32(0)) == np.float32(0)
    for axis in range(3):
        a, d = lights.middle[axis], region.middle[axis] - lights.middle[axis]
        low, high = load_f32x16(at + 64 * axis) - a, load_f32x16(at + 192 + 64 * axis) - a
        if d == np.float32(0):
            inside = inside & (low <= np.float32(0)) & (high >= np.float32(0))
        else:
            inverse = np.float32(1) / d
            one, other = low * inverse, high * inverse
            enter, leave = maximum(enter, minimum(one, other)), minimum(leave, maximum(one, other))
    return bits_of(inside & (enter <= leave))


@inlined
def _try_group(blockers, group, lights, region, counts):
    """The blocker of a group that hides lights from a region, -1 for none; and how many were tried."""
    tried = np.int64(between_middles(blockers, group, lights, region))
    if tried == 0:
        return np.int64(-1), 0
    counts[TESTS] += ones(tried)
    hides = tried & np.int64(that_hide(blockers, group, lights, region))
    return (16 * group + lowest_bit(hides) if hides != 0 else np.int64(-1)), ones(tried)


@subkernel
def blocker_of(blockers, region, lights, recent, counts):
    """The blocker that hides a box of lights from a region, both `Hull`, -1 for none.

    recent (RECENT,) int64 are groups that are tried first."""
    if len(blockers.numbers) == 0:
        return np.int64(-1)
    for k in range(RECENT):
        found, _tried = _try_group(blockers, recent[k], lights, region, counts)
        if found >= 0:
            return found
    left = TRIED
    for sixteen in range(len(blockers.around)):
        groups = _between(blockers.around, sixteen, lights, region)
        while groups != 0:
            group = 16 * sixteen + lowest_bit(groups)
            groups &= groups - 1
            found, tried = _try_group(blockers, group, lights, region, counts)
            if found >= 0:
                for k in range(RECENT - 1, 0, -1):
                    recent[k] = recent[k - 1]
                recent[0] = group
                return found
            left -= tried
            if left <= 0:
                return np.int64(-1)
    return np.int64(-1)


@kernel
def leaves_left(tree, blockers, regions, starts, leaves, counts):
    """The leaves of a `LightTree` whose lights may shine on each of regions (n, 6) float64, lower and upper corners.

    Nodes are descended from those that are known to matter: starts (n, 2) int64 are the first and the last + 1 of each
    region's in leaves (m,) int32.  Returns (ends (n,) int64, found (k,) int32): the leaves of one region after those of
    another.  blockers are `Blockers`; counts (COUNTERS,) int64 are added to."""
    tree, blockers = without_refcount((tree, blockers))
    stack, recent = np.empty(STACK, np.int32), np.zeros(RECENT, np.int64)
    ends, found, end = np.empty(len(regions), np.int64), np.empty(FIRST_ROOM, np.int32), np.int64(0)
    for i in range(len(regions)):
        region = hull_of(regions, i)
        for k in range(starts[i, 0], starts[i, 1]):
            stack[0], pending = leaves[k], 1
            while pending > 0:
                pending -= 1
                node = np.int64(stack[pending])
                counts[STEPS] += 1
                if blocker_of(blockers, region, hull_of(tree.boxes, node), recent, counts) >= 0:
                    continue
                child = tree.children[node]
                if child != 0:
                    stack[pending], stack[pending + 1] = child, child + 1
                    pending += 2
                    continue
                if end == len(found):
                    longer = np.empty(2 * len(found), np.int32)
                    for j in range(end):
                        longer[j] = found[j]
                    found = longer
                found[end] = node
                end += 1
        ends[i] = end
    return ends, found[:end]


@kernel
def first_blocker(blockers, region, lights):
    """The blocker that hides a box of lights from a region, the first of boxes (1, 6) float64 each; -1 for none."""
    blockers, uncounted, recent = without_refcount(blockers), np.zeros(COUNTERS, np.int64), np.zeros(RECENT, np.int64)
    return blocker_of(blockers, hull_of(region, 0), hull_of(lights, 0), recent, uncounted)


class HiddenLights:
    """The lights of a scene as a tree, and the blockers that may hide them.

    What is proved rests on geometry that never moves and on where lights stand.  A light that has moved away from where
    the tree has it counts everywhere, until many have: then all is proved anew.

    Attributes:
        boxes: (l, 6) float32, the lower and the upper corner around the samples of each light, where it is now.
        moved: (l,) bool, lights of which nothing is known.
    """

    def __init__(self, world: World) -> None:
        triangles = world.triangles_of(0).rows
        self.bounds = bounds_around(triangles, np.empty((0, 6), np.float32))
        self.blockers = find_blockers(triangles, world.hit_padding / LONGEST * float(np.abs(self.bounds).max()))
        self.boxes = np.empty((0, 6), np.float32)
        self._proved, self._tree = self.boxes, build_light_tree(np.zeros((1, 6), np.float32))
        self.moved = np.empty(0, np.bool_)

    def update(self, boxes: NDArray[np.float32]) -> bool:
        """Lights are in these boxes (l, 6) now: whether all is to be proved anew."""
        before, self.boxes = self.boxes, boxes
        anew = boxes.shape != self._proved.shape
        if not anew:
            self.moved = (boxes != self._proved).any(1)
            anew = MOVED * self.moved.sum() > len(boxes) and bool((boxes == before).all())  # they stand again
        if anew:
            self._proved, self._tree, self.moved = boxes, build_light_tree(boxes), np.zeros(len(boxes), np.bool_)
        return anew

    def descend(
        self,
        regions: NDArray[np.float64],
        above: list[NDArray[np.int32]],
        threads: int,
        counts: NDArray[np.int64],
        cancel: Callable[[], bool] | None,
    ) -> list[NDArray[np.int32]]:
        """The leaves that each of regions (n, 6) is left with, of those below the nodes that are known to matter.

        counts (threads, COUNTERS) int64 are added to."""
        results: list[list[NDArray[np.int32]]] = [[] for _ in range(-(-len(regions) // CHUNK))]

        def work(chunk: int, worker: int) -> None:
            those = slice(chunk * CHUNK, (chunk + 1) * CHUNK)
            ends = np.cumsum([0, *(len(nodes) for nodes in above[those])])
            starts = np.stack([ends[:-1], ends[1:]], 1)
            nodes = np.concatenate(above[those])
            ends, found = leaves_left(self._tree, self.blockers, regions[those], starts, nodes, counts[worker])
            results[chunk] = np.split(found, ends[:-1])

        for_each_chunk(work, len(results), threads, cancel)
        return [leaves for chunk in results for leaves in chunk]

    def lights_below(self, leaves: NDArray[np.int32]) -> NDArray[np.int32]:
        """The numbers (k,) int32 of the lights in some leaves, in ascending order."""
        spans = [self._tree.order[first:last] for first, last in self._tree.lights[leaves].tolist()]
        return np.sort(np.concatenate([np.empty(0, np.int32), *spans]))

    def hidden_by(self, region: NDArray[np.float64], light: int) -> int:
        """The number of the triangle that hides a light from a region (6,), -1 for none."""
        blocker = first_blocker(self.blockers, region[None], self.boxes[light : light + 1].astype(np.float64))
        return int(self.blockers.numbers[blocker]) if blocker >= 0 else -1


class LightLists:
    """Lists of lights, numbered from 1 on in the order in which they are added."""

    def __init__(self) -> None:
        self._starts, self._lights = [np.zeros(1, np.int64)], [np.empty(0, np.int32)]
        self._count = 0

    def add(self, lists: list[NDArray[np.int32]]) -> NDArray[np.int64]:
        """Add lists (k,); their numbers."""
        if lists:
            self._starts.append(self._starts[-1][-1] + np.cumsum([len(lights) for lights in lists]))
            self._lights.append(np.concatenate(lists))
        self._count += len(lists)
        return self._count - len(lists) + 1 + np.arange(len(lists))

    @property
    def bytes(self) -> int:
        """Memory that lists take, in bytes."""
        return sum(a.nbytes for arrays in (self._starts, self._lights) for a in arrays)

    def arrays(self) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """(starts (n + 1,), lights (m,)): list k has the lights from starts[k - 1] to starts[k] - 1."""
        if len(self._starts) > 1:
            self._starts, self._lights = [np.concatenate(self._starts)], [np.concatenate(self._lights)]
        return self._starts[0], self._lights[0]


def boxes_of_samples(lamps: Lamps) -> NDArray[np.float32]:
    """Boxes (l, 6), lower and upper corner, around the samples of each of l > 0 lamps."""
    low, high = (around.reduceat(lamps.samples, lamps.first[:-1], axis=0) for around in (np.minimum, np.maximum))
    return np.concatenate([low, high], 1)
