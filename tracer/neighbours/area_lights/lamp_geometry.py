"""All that is there in a frame, whether it moves or not, as a tree that knows where lamps are.

What is known of a lamp's rays serves one frame.  So for this frame everything stands still: what moves is put where it
is, like an object that has come to rest, and nothing is left that lamps' rays would have to ask as well."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.rest import Resting
from tracer.geometry.boxes import OUTWARDS
from tracer.geometry.rays import RAY_OFFSET
from tracer.neighbours.certified.cells import HIGHEST
from tracer.visibility.occluders import Occluders
from tracer.visibility.static_geometry import StaticGeometry

if TYPE_CHECKING:
    from tracer.geometry.world import World


class LampGeometry:
    """Follows a world from frame to frame, for so many lights."""

    def __init__(self, world: World, lights: int, threads: int) -> None:
        self._world, self._lights, self._threads = world, lights, threads
        self._start()

    def _start(self) -> None:
        self._geometry = StaticGeometry(self._world, self._lights, self._threads, asks=False)
        self._since = np.zeros(len(self._world.primitives.triangle_starts) - 1, np.int64)
        self._frame = 0
        self._fitted = np.zeros(self._lights, np.bool_)

    def update(self, lamps: NDArray[np.bool_], lights: NDArray[np.float32], radii: NDArray[np.float32],
               moved: NDArray[np.bool_], resting: Resting) -> None:  # fmt: skip
        """Put everything where it is now, and fit boxes to `lamps` (n,), balls of radii (n,) around lights (n, 3), of
        which some have `moved` (n,) since the last frame."""
        if self._world.extent > self._geometry.allowed:
            self._start()
        self._frame += 1
        # What rests has stood since some frame, and all else since this one.
        since = np.where(resting.since > 0, 2 * resting.since, 2 * self._frame + 1)
        since[~self._world.certain_now()] = 0
        since[0] = 0
        changed = since != self._since
        gone, new = np.flatnonzero(changed & (self._since > 0)), np.flatnonzero(changed & (since > 0))
        self._since = since
        if len(gone) or len(new):
            self._geometry.update(gone, new, self._world.outlines())
            self._fitted[:] = False
        self._fitted &= ~moved & lamps
        fit = lamps & ~self._fitted
        self._geometry.update_lights(np.flatnonzero(fit).tolist(), lights, radii, self.highest)
        self._fitted |= fit

    @property
    def highest(self) -> float:
        """How high above surfaces rays may end, in units of the scene."""
        return float(np.float32(HIGHEST * RAY_OFFSET * self._geometry.largest))

    @property
    def occluders(self) -> Occluders:
        return self._geometry.occluders

    @property
    def within(self) -> NDArray[np.float32]:
        """A box (6,) outside of which nothing is known of where rays end."""
        return (self._geometry.bounds.reshape(-1) + self.highest * OUTWARDS).astype(np.float32)

    def moving(self, nothing) -> NDArray[np.float32]:
        """A box (6,) around what rays must ask as well; `nothing` where there is no such thing."""
        left = self._world.present_now() & (self._since == 0)
        left[0] = False
        if not left.any():
            return nothing
        boxes = self._world.object_boxes()[left]
        return np.concatenate([boxes[:, :3].min(0), boxes[:, 3:].max(0)])
