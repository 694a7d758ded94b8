"""What an acceleration structure is to the rest of the program: built once, placed for a frame, asked by address.

`tracer.geometry.bvh8`, `kdtree` and `lazy_tree` are such structures.  `World` picks one by its name; nobody
else knows which, or looks inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.poses import Poses
from tracer.geometry.primitives import Primitives, WorldTriangles
from tracer.geometry.queries import Placed
from tracer.runtime.kernels import NativeCallback
from tracer.scene.arrays import Float32, Float64


@dataclass(frozen=True)
class BuiltPart:
    """How much rays have had built so far of a tree that is built where they arrive: "kdtree-lazy", or "bvh8" of a
    large scene.

    Attributes
    ----------
    nodes : int
        Nodes that are built.
    primitives : int
        Primitives in them.
    of : int
        Primitives in all.
    memory_bytes : int
        Memory of the tree, with what it keeps of primitives that no ray has come near.
    """

    nodes: int
    primitives: int
    of: int
    memory_bytes: int

    @property
    def share(self) -> float:
        """The part of the primitives that is built, 0 to 1."""
        return self.primitives / max(self.of, 1)


def placed_by(
    structure: Structure,
    primitives: Primitives,
    to_object: Float32,
    data: NDArray[np.int64],
    moves: bool,
    moving_box: Float32,
) -> Placed:
    """What kernels get of a structure that has placed its primitives; whoever keeps it keeps `data` as well."""
    closest, any_hit, of = structure.closest.address, structure.any_hit.address, primitives
    return Placed(
        of.triangles, of.quadrics, to_object, of.object_of, closest, any_hit, data.ctypes.data, moves, moving_box
    )


class Structure(Protocol):
    """Made from the primitives of a scene, the number of its objects, who is told of the build's progress, and whether
    what it can do without may wait until rays arrive (which is no matter where nothing, or everything, may).

    `closest` and `any_hit` are its queries (`tracer.geometry.queries`).  Two numbers say where hits are reported at
    all, which certificates need to know: a hit on a triangle counts only where t lies inside a box around it, which
    is larger than the triangle by the part `hit_padding` of the largest coordinate in the triangle's tree; `extent`
    is that coordinate for the trees of dynamic objects as they are placed now, 0 where their boxes are not padded.
    `together` is how many rays may go through a tree side by side: 128, 16, or 1; set before a world is placed.
    """

    closest: NativeCallback
    any_hit: NativeCallback
    hit_padding: float
    extent: float
    max_packet_size: int

    def place(self, poses: Poses, resting: NDArray[np.bool_]) -> Placed:
        """Move all present objects to their poses; `resting` (objects,) tells which count as static geometry."""

    def certain(self, poses: Poses) -> NDArray[np.bool_]:
        """Which objects (n,) rays meet where `triangles_of` has them, as closely as proofs about shadows need."""

    def triangles_of(self, index: int, to_world: Float64) -> WorldTriangles:
        """The triangles of the object of this number where to_world (3, 4) takes it, just as rays meet them."""

    def build(self) -> None:
        """Build now what waits for rays, where it need not; for who measures frames."""

    def built(self) -> BuiltPart | None:
        """How much of it rays have had built so far; None for a structure that is built before they come."""

    def bounds(self) -> NDArray[np.float32]:
        """Box (6,) around everything that is placed; inverted for an empty world."""
