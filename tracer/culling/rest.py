"""Which dynamic objects rest: they have an animated transform that does not move them now.

What rests counts as static until it moves: it blocks shadow rays as static geometry does, its primitives carry modes,
and what is known of shadows holds for it too.  So nothing may be known that an object which starts or stops makes
untrue.  Who keeps such knowledge compares what rested when it was last right with what rests now (`changes`), and drops
what depends on the boxes where objects lay that have started, or lie that have stopped (`tracer.culling.dependence`).

An object rests from the second of two frames on in which it is present, in the same pose and of the same shape, bit for
bit.  In a first frame, before which nothing has been seen to move, all that is present does.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import NO_BOX
from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives

FEW = 8  # boxes of objects that rest, at most: more become one
AWAY = 1e-4  # of a scene's largest coordinate, by which these boxes are larger


class Resting(NamedTuple):
    """Which of n objects rest: since (n,) int64 is the number of the frame from which on each does, 0 for those that do
    not; boxes (n, 6) float32 are around those that do, in the world.  Never written to once made."""

    since: NDArray[np.int64]
    boxes: NDArray[np.float32]


class Changed(NamedTuple):
    """Objects that have started or stopped: which, (k,) int64, and boxes (k, 6) float32 around where they rested or
    rest."""

    which: NDArray[np.int64]
    boxes: NDArray[np.float32]


def changes(before: Resting, now: Resting) -> tuple[Changed, Changed]:
    """What has started since, and what has stopped; what has done both, and rests again, is in either."""
    differing = before.since != now.since

    def those_of(resting: Resting) -> Changed:
        which = np.flatnonzero(differing & (resting.since > 0))
        return Changed(which, resting.boxes[which])

    return those_of(before), those_of(now)


def nothing_rests(objects: int) -> Resting:
    """As it is where nobody asks what rests."""
    return Resting(np.zeros(objects, np.int64), np.zeros((objects, 6), np.float32))


class Rest:
    """Follows n objects from frame to frame.

    `now` is what rests.
    """

    def __init__(self, objects: int) -> None:
        self.now = nothing_rests(objects)
        self._frame = 0
        self._poses: Poses | None = None
        self._shapes: dict[int, NDArray[np.float32]] = {}

    def update(self, poses: Poses, primitives: Primitives, certain: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """(n,) whether each object rests, as it is posed and shaped in a further frame; only those that are `certain`
        (n,) do (`World.certain`)."""
        rests = poses.present & certain
        rests[0] = False  # what never moves is no object that rests
        before, shapes = self._poses, {i: primitives.corners_of(i).copy() for i in primitives.deformations}
        if before is not None:
            same = before.to_world.view(np.int64) == poses.to_world.view(np.int64)
            rests &= before.present & same.all(axis=(1, 2))
            for index, corners in shapes.items():
                rests[index] &= np.array_equal(corners.view(np.int32), self._shapes[index].view(np.int32))
        self._poses, self._shapes = poses, shapes
        self._frame += 1
        since, boxes = np.where(rests, self.now.since, 0), self.now.boxes.copy()
        new = np.flatnonzero(rests & (since == 0))
        since[new], boxes[new] = self._frame, primitives.object_boxes(new, poses)
        self.now = Resting(since, boxes)
        return rests

    def forget(self) -> None:
        """A further frame in which nothing is to rest; the next to be followed is a first one again."""
        self._poses, self._shapes = None, {}
        self.now = nothing_rests(len(self.now.since))


def boxes_at_rest(resting: Resting, largest: float) -> NDArray[np.float32]:
    """Boxes (k, 6) around what rests, with room for all hits on it, in a scene with this largest coordinate."""
    boxes = resting.boxes[resting.since > 0]
    if len(boxes) > FEW:
        boxes = np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)])[None]
    if len(boxes):
        boxes = boxes - NO_BOX * np.float32(AWAY * max(float(np.abs(boxes).max()), largest))
    return np.ascontiguousarray(boxes, np.float32)
