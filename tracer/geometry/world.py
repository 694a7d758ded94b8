"""The world at a moment: a scene's geometry in an acceleration structure, placed for a frame.

Trees are built once.  For every frame objects are posed, and what has moved since is moved in the structure (§3 of the
paper).  After that batches of rays ask two questions: `closest_hits` and `any_hits`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.accelerators import ACCELERATORS, BVH8, KD_TREE, LAZY, MAX_PACKET_SIZE
from tracer.geometry.boxes import NO_BOX
from tracer.geometry.bvh8 import subtrees
from tracer.geometry.bvh8.structure import Bvh8
from tracer.geometry.kdtree.structure import KdTree
from tracer.geometry.lazy_tree.structure import LazyKdTree
from tracer.geometry.poses import Poses, poses_at
from tracer.geometry.primitives import Outlines, Primitives, WorldTriangles
from tracer.geometry.queries import EVERYTHING, batch_of
from tracer.geometry.rays import Hits, Rays
from tracer.geometry.structure import BuiltPart, Structure
from tracer.runtime.kernels import NativeCallback
from tracer.runtime.parallel import for_each_chunk, thread_count
from tracer.scene.animation import Chains
from tracer.scene.model import Cancelled, Progress, Scene

CHUNK = 8192  # rays a thread takes at a time
EACH = 1024  # rays, traced alone, after which somebody may cancel

STRUCTURES: dict[str, Any] = {KD_TREE: KdTree, LAZY: LazyKdTree, BVH8: Bvh8}

LARGE = subtrees.LARGE
"""Primitives that never move: of more, the 8-wide tree may be built where rays arrive."""


class World:
    """The geometry of a scene at a time, which answers rays.

    Trees are built once. `place` then moves what moves; it overwrites what was placed before.

    Parameters
    ----------
    scene : Scene
        What there is.
    time : float
        The moment to begin with, in seconds.
    accelerator : str
        "bvh8", the fast structure; "kdtree", the paper's; or "kdtree-lazy", a kd-tree that is built where rays arrive.
    progress : callable, optional
        Called while trees are built; it may raise Cancelled.
    lazy : bool, optional
        Whether "bvh8" leaves most of a large scene until rays arrive; the answers and counters are the same.

    Attributes
    ----------
    placed
        What kernels are given.
    attributes : (primitives, 16) float32
        What shading reads of each primitive (`tracer.geometry.primitives`).
    normals : (triangles, 9) float32
        Normals at the corners, in the space of each triangle's object.
    object_of : (primitives,) int32
        The object that each primitive belongs to.

    Raises
    ------
    ValueError
        If there is no such accelerator.
    Cancelled
        If `progress` raises it.
    """

    def __init__(
        self,
        scene: Scene,
        time: float = 0.0,
        accelerator: str = BVH8,
        progress: Progress | None = None,
        lazy: bool = False,
    ) -> None:
        if accelerator not in ACCELERATORS:
            raise ValueError(f"there is no accelerator {accelerator!r}; there is {', '.join(ACCELERATORS)}")
        self.accelerator = accelerator
        report = progress or (lambda what, fraction: None)
        self.primitives = Primitives(scene, lambda done: report("laying out primitives", done))
        self.attributes, self.normals = self.primitives.attributes, self.primitives.normals
        self.object_of = self.primitives.object_of
        self.scene = scene
        self.structure: Structure = STRUCTURES[accelerator](self.primitives, len(scene.objects), progress, lazy)
        self.place(time)

    @property
    def scene(self) -> Scene:
        """What is placed: may be exchanged for a scene of the same objects that moves them otherwise."""
        return self._scene

    @scene.setter
    def scene(self, scene: Scene) -> None:
        self._scene = scene
        self._chains = Chains(scene.animation, [o.chain for o in scene.objects])

    def pose(self, time: float) -> Poses:
        """Deform objects to their shapes at `time` seconds and return all objects' poses then.

        The structure stays as it is until `place` is called with these poses."""
        self.primitives.deform(time)
        return poses_at(self._chains, self.primitives.boxes, time)

    def place(
        self, when: float | Poses, resting: NDArray[np.bool_] | None = None, max_packet_size: int = MAX_PACKET_SIZE
    ) -> None:
        """Move the dynamic objects to where they are.

        Parameters
        ----------
        when : float or Poses
            A time in seconds, or what `pose` has returned.
        resting : (objects,) bool, optional
            Objects that count as static geometry for `any_hits`; none by default.
        max_packet_size : int
            Rays that may go through a tree side by side, 128, 16 or 1. The answers are the same; a structure that
            traces rays one by one takes no note of it.
        """
        self.structure.max_packet_size = max_packet_size
        self._poses = poses = when if isinstance(when, Poses) else self.pose(when)
        rest = np.zeros_like(poses.present) if resting is None else poses.present & resting
        rest[0] = False  # what never moves is in a tree of its own
        self.placed = self.structure.place(poses, rest)

    @property
    def hit_padding(self) -> float:
        """By what part of the largest coordinate boxes that hits must lie in are larger than triangles."""
        return self.structure.hit_padding

    @property
    def extent(self) -> float:
        """The largest coordinate by which the boxes of dynamic objects are padded now; 0 where they are not."""
        return self.structure.extent

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        """Which objects (n,) rays meet where they are known to be, so that something can be proved of them."""
        return self.structure.certain(poses)

    def known_places(self) -> NDArray[np.bool_]:
        """Which dynamic objects (n,) are there, and met where they are known to be (`certain`)."""
        known = self._poses.present & self.certain(self._poses)
        known[0] = False  # what never moves is no object
        return known

    def triangles_of(self, index: int) -> WorldTriangles:
        """The triangles of an object that is present, just as rays meet them."""
        return self.structure.triangles_of(index, self._poses.to_world[index])

    def outlines(self) -> Outlines:
        """Where each primitive is."""
        return self.primitives.outlines(self._poses)

    def object_boxes(self) -> NDArray[np.float32]:
        """Boxes (objects, 6) around dynamic objects; inverted for those that are not present, and for object 0."""
        boxes = np.tile(NO_BOX, (len(self._poses.present), 1))
        present = 1 + np.flatnonzero(self._poses.present[1:])
        boxes[present] = self.primitives.object_boxes(present, self._poses)
        return boxes

    def closest_hits(self, rays: Rays, threads: int = 0) -> Hits:
        """Find the nearest hit of each ray.

        Parameters
        ----------
        rays : Rays
            n rays, made by `RayBatch`.
        threads : int
            Threads that work at once; 0 for one on each core.

        Returns
        -------
        Hits
            t, primitive, u and v, (n,) each; t is inf and primitive -1 for a miss.
        """
        hits = _empty_hits(rays)
        self._ask(self.structure.closest, batch_of(rays, hits), len(rays.t_min), threads)
        return hits

    def any_hits(self, rays: Rays, threads: int = 0) -> NDArray[np.bool_]:
        """Say for each ray whether anything, static or dynamic, lies in its interval.

        Parameters
        ----------
        rays : Rays
            n rays, made by `RayBatch`.
        threads : int
            Threads that work at once; 0 for one on each core.

        Returns
        -------
        (n,) bool
            True for a ray that is blocked.
        """
        n = len(rays.t_min)
        blocked = np.zeros(n, np.uint8)
        self._ask(self.structure.any_hit, batch_of(rays, blocked=blocked), n, threads)
        return blocked != 0

    def occluders(self, rays: Rays, threads: int = 0) -> NDArray[np.int32]:
        """Find for each ray a primitive that lies in its interval, which need not be the nearest.

        The answer is the same on every run and for any number of threads.

        Parameters
        ----------
        rays : Rays
            n rays, made by `RayBatch`.
        threads : int
            Threads that work at once; 0 for one on each core.

        Returns
        -------
        (n,) int32
            Numbers of primitives, -1 for a ray that nothing blocks.
        """
        n = len(rays.t_min)
        blocked, found = np.empty(n, np.uint8), np.empty(n, np.int32)
        self._ask(self.structure.any_hit, batch_of(rays, blocked=blocked, occluders=found), n, threads)
        return found

    def closest_hits_each(self, rays: Rays) -> tuple[Hits, NDArray[np.int64]]:
        """Find the nearest hits with what each ray costs by itself.

        Parameters
        ----------
        rays : Rays
            n rays, made by `RayBatch`.

        Returns
        -------
        tuple of Hits and (n, 2) int64
            The hits, and the traversal steps and intersection tests of each ray, traced alone.
        """
        hits = _empty_hits(rays)
        return hits, self._ask_each(self.structure.closest, batch_of(rays, hits), len(rays.t_min), None)

    def occluders_each(
        self, rays: Rays, which: int = EVERYTHING, cancelled: Callable[[], bool] | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
        """Find for each ray a primitive that blocks it, with what that costs.

        Parameters
        ----------
        rays : Rays
            n rays, made by `RayBatch`.
        which : int
            What is asked: static geometry (1), dynamic objects (2) or both (3).
        cancelled : callable, optional
            Asked now and then.

        Returns
        -------
        tuple of (n,) int32 and (n, 2) int64
            The primitives, -1 for a ray that nothing blocks, and the traversal steps and intersection tests of each
            ray, traced alone.

        Raises
        ------
        Cancelled
            Once `cancelled()` is true.
        """
        n = len(rays.t_min)
        blocked, found = np.empty(n, np.uint8), np.empty(n, np.int32)
        batch = batch_of(rays, blocked=blocked, which=which, occluders=found)
        return found, self._ask_each(self.structure.any_hit, batch, n, cancelled)

    def _ask_each(
        self, query: NativeCallback, batch: NDArray[np.int64], n: int, cancelled: Callable[[], bool] | None
    ) -> NDArray[np.int64]:
        counts = np.zeros((n, 2), np.int64)
        data, described, counted = self.placed.data, batch.ctypes.data, counts.ctypes.data
        for i in range(n):
            if i % EACH == 0 and cancelled is not None and cancelled():
                raise Cancelled("cancelled")
            query.call(data, described, i, i + 1, counted + 16 * i)
        return counts

    def _ask(self, query: NativeCallback, batch: NDArray[np.int64], n: int, threads: int) -> None:
        counts = np.zeros((thread_count(threads), 2), np.int64)
        data, described, counted = self.placed.data, batch.ctypes.data, [c.ctypes.data for c in counts]

        def work(chunk: int, worker: int) -> None:
            query.call(data, described, chunk * CHUNK, min(n, (chunk + 1) * CHUNK), counted[worker])

        for_each_chunk(work, -(-n // CHUNK), len(counts))
        self.built()  # raises what went wrong where rays had something built

    def build(self) -> None:
        """Build now what `lazy` left, so that no frame has to: for measurements."""
        self.structure.build()

    def built(self) -> BuiltPart | None:
        """How much of the trees rays have had built so far; None where all are built before rays come."""
        return self.structure.built()

    def bounds(self) -> NDArray[np.float32]:
        """Box (6,) around everything that is there now; inverted for an empty world."""
        return self.structure.bounds()


def _empty_hits(rays: Rays) -> Hits:
    n = len(rays.t_min)
    return Hits(np.empty(n, np.float32), np.empty(n, np.int32), np.empty(n, np.float32), np.empty(n, np.float32))
