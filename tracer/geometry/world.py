"""The world at a moment: whichever structure is below, placed for the frame, and two queries on batches of rays.

Building happens once; `place` then only moves what moved since (§3 of the paper).  Rays ask two
questions in batches: `closest_hits` and `any_hits`.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.bvh8 import place as bvh8
from tracer.geometry.kdtree import place as kdtree
from tracer.geometry.poses import Poses, poses_at
from tracer.geometry.primitives import Outlines, Primitives, WorldTriangles
from tracer.geometry.queries import batch_of
from tracer.geometry.rays import Hits, Rays
from tracer.kernels import Entry
from tracer.parallel import for_each_chunk, thread_count
from tracer.scene.chains import Chains
from tracer.scene.model import Progress, Scene

CHUNK = 8192  # rays a thread takes at a time

STRUCTURES: dict[str, Any] = {"kdtree": kdtree.KdTrees, "bvh8": bvh8.Trees8}
ACCELERATORS = tuple(STRUCTURES)


class Follower(Protocol):
    """Who says, from one place to the next, which objects rest (`tracer.culling.rest`)."""

    def follow(self, poses: Poses, primitives: Primitives) -> NDArray[np.bool_]:
        """(objects,) whether each rests, as posed and, where it deforms, shaped now; only what is present may."""


class World:
    """A scene's geometry for rays: `place` it for a time, then ask.

    Raises Cancelled if `progress` does while trees are being built, ValueError for an accelerator
    that does not exist.  `placed` is what kernels are given; `facets` (primitives, 16) float32 what shading
    reads (`tracer.geometry.facets`), of which `normals` (t, 9) are the corners' normals in the space of each
    triangle's object; `object_of` (primitives,) int32 tells whose each primitive is.  Placing overwrites what
    was placed before.
    """

    def __init__(
        self, scene: Scene, time: float = 0.0, accelerator: str = "bvh8", progress: Progress | None = None
    ) -> None:
        if accelerator not in ACCELERATORS:
            raise ValueError(f"there is no accelerator {accelerator!r}; there is {', '.join(ACCELERATORS)}")
        self.accelerator = accelerator
        self._primitives = Primitives(scene)
        self.facets, self.normals = self._primitives.facets, self._primitives.normals
        self.object_of = self._primitives.object_of
        self.primitives = self._primitives
        self.scene = scene
        self.structure = STRUCTURES[accelerator](self._primitives, len(scene.objects), progress)
        self.place(time)

    @property
    def scene(self) -> Scene:
        """What is placed: may be exchanged for a scene of the same objects that moves them otherwise."""
        return self._scene

    @scene.setter
    def scene(self, scene: Scene) -> None:
        self._scene = scene
        self._chains = Chains(scene.animation, [o.chain for o in scene.objects])

    def place(self, time: float, rest: Follower | None = None) -> None:
        """Move and deform dynamic objects to where and what they are at `time` seconds.

        Those that rest, by what `rest` says, are static geometry to `any_hits`; without it none does."""
        self._primitives.deform(time)
        self._poses = poses_at(self._chains, self._primitives.empty, time)
        resting = np.zeros(len(self._poses.present), np.bool_)
        if rest is not None:
            resting[:] = rest.follow(self._poses, self._primitives)
        self.placed = self.structure.place(self._poses, resting)

    def triangles_of(self, index: int) -> WorldTriangles:
        """The triangles of an object that is there, as rays meet them."""
        return self.structure.triangles_of(index, self._poses.to_world[index])

    def outlines(self) -> Outlines:
        """Where each primitive is."""
        return self._primitives.outlines(self._poses)

    def object_boxes(self) -> NDArray[np.float32]:
        """Boxes (objects, 6) around dynamic objects; inverted for those that are not there, and object 0."""
        boxes = np.tile(np.array([1, 1, 1, -1, -1, -1], np.float32), (len(self._poses.present), 1))
        there = 1 + np.flatnonzero(self._poses.present[1:])
        boxes[there] = self._primitives.object_boxes(there, self._poses)
        return boxes

    def closest_hits(self, rays: Rays, threads: int = 0) -> Hits:
        """Nearest hits of a batch (see `tracer.geometry.rays`)."""
        n = len(rays.t_min)
        hits = Hits(np.empty(n, np.float32), np.empty(n, np.int32), np.empty(n, np.float32), np.empty(n, np.float32))
        self._ask(self.structure.closest, batch_of(rays, hits), n, threads)
        return hits

    def any_hits(self, rays: Rays, threads: int = 0) -> NDArray[np.bool_]:
        """(n,) whether anything, static or dynamic, lies in each ray's interval."""
        n = len(rays.t_min)
        blocked = np.zeros(n, np.uint8)
        self._ask(self.structure.any_hit, batch_of(rays, blocked=blocked), n, threads)
        return blocked != 0

    def occluders(self, rays: Rays, threads: int = 0) -> NDArray[np.int32]:
        """(n,) a primitive, not always the nearest, that lies in each ray's interval; MISS where none does.

        The same on every run, and for any number of threads: rays are asked CHUNK by CHUNK."""
        n = len(rays.t_min)
        blocked, found = np.empty(n, np.uint8), np.empty(n, np.int32)
        self._ask(self.structure.any_hit, batch_of(rays, blocked=blocked, occluders=found), n, threads)
        return found

    def _ask(self, query: Entry, batch: NDArray[np.int64], n: int, threads: int) -> None:
        counts = np.zeros((thread_count(threads), 2), np.int64)
        data, described, counted = self.placed.data, batch.ctypes.data, [c.ctypes.data for c in counts]

        def work(chunk: int, worker: int) -> None:
            query.call(data, described, chunk * CHUNK, min(n, (chunk + 1) * CHUNK), counted[worker])

        for_each_chunk(work, -(-n // CHUNK), len(counts))

    def bounds(self) -> NDArray[np.float32]:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        return self.structure.bounds()
