"""Where the objects of a scene are at a moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.geometry.boxes import transform_boxes
from tracer.scene.animation import Chains
from tracer.scene.arrays import Float64
from tracer.scene.limits import LARGEST, SMALLEST


class Poses(NamedTuple):
    """Where n objects are at `time` seconds: maps (n, 3, 4) float64 to the world and back, and present (n,) bool.

    An object is absent if it is empty, hidden, scaled to nothing, so that no ray can be transformed to its space, or
    moved farther away than `LARGEST`.  Its maps are 0 then.
    """

    time: float
    to_world: Float64
    to_object: Float64
    present: NDArray[np.bool_]


def poses_at(chains: Chains, boxes: Float64, time: float) -> Poses:
    """The poses of n objects at `time` seconds; boxes (n, 6) are around them in their own spaces, inverted for those
    without primitives."""
    matrices = chains.matrices(time)[:, :3]
    present = chains.visible(time) & (boxes[:, 0] <= boxes[:, 3])
    with np.errstate(all="ignore"):  # what a track brings beyond all numbers compares as false
        present &= np.abs(transform_boxes(boxes, matrices)).max(1) <= LARGEST
    to_world = np.where(present[:, None, None], matrices, 0.0)
    to_object = np.zeros_like(to_world)
    try:
        to_object[present] = inverses(to_world[present])
    except np.linalg.LinAlgError:  # one of them at least: find out which
        for i in np.flatnonzero(present):
            try:
                to_object[i] = inverses(to_world[i : i + 1])[0]
            except np.linalg.LinAlgError:
                present[i] = False
                to_world[i] = 0.0
    lost = ~(np.abs(to_object[:, :, :3]).max((1, 2)) <= 1 / SMALLEST)
    present[lost], to_world[lost], to_object[lost] = False, 0.0, 0.0
    return Poses(time, to_world, to_object, present)


def inverses(affine: Float64) -> Float64:
    """Inverses (n, 3, 4) of affine maps (n, 3, 4); raises LinAlgError where one squashes space."""
    linear = np.linalg.inv(affine[:, :, :3])
    return np.concatenate([linear, -(linear @ affine[:, :, 3:])], axis=2)


def products(a: Float64, b: Float64) -> Float64:
    """First b, then a: affine maps (n, 3, 4)."""
    linear = a[:, :, :3] @ b
    linear[:, :, 3] += a[:, :, 3]
    return linear
