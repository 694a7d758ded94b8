"""All that is there in a frame, whether it moves or not, as a tree that knows where lamps are.

What is known of a lamp's rays serves one frame.  For that frame everything stands still: what moves is put where it is,
like an object that has come to rest.  So rays of which something is known have no moving objects left to ask."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.rest import Resting
from tracer.geometry.boxes import OUTWARDS
from tracer.visibility.occluders import FAR, Occluders
from tracer.visibility.static_geometry import StaticGeometry, max_height

if TYPE_CHECKING:
    from tracer.geometry.world import World


class LampGeometry:
    """The geometry of a world with so many lights, from frame to frame; `static` knows what never moves."""

    def __init__(self, world: World, lights: int, threads: int, static: StaticGeometry) -> None:
        self._world, self._lights, self._threads, self._static = world, lights, threads, static
        self._frame = 0
        self._start()

    def _start(self) -> None:
        self._geometry = StaticGeometry(self._world, self._lights, self._threads, asks=False, known=self._static)
        objects = len(self._world.primitives.triangle_starts) - 1
        self._since = np.zeros(objects, np.int64)  # how long each object has been where it is; 0 where it is not known
        self._fitted = np.zeros(self._lights, np.bool_)  # lights that boxes are fitted to

    def update(
        self, lamps: NDArray[np.bool_], lights: NDArray[np.float32], radii: NDArray[np.float32],
        moved: NDArray[np.bool_], resting: Resting,
    ) -> None:  # fmt: skip
        """Put everything where it is now, and fit boxes to `lamps` (n,), balls of radii (n,) around lights (n, 3), some
        of which have `moved` (n,) since the last frame."""
        if self._world.extent > self._geometry.allowed:  # boxes may have grown beyond those that are known
            self._start()
        self._frame += 1
        # What rests has been there since some frame, and all else since this one.
        since = np.where(resting.since > 0, 2 * resting.since, 2 * self._frame + 1)
        since[~self._world.known_places()] = 0
        before, self._since = self._since, since
        started, stopped = (np.flatnonzero((since != before) & (s > 0)) for s in (before, since))
        if len(started) or len(stopped):
            self._geometry.update(started, stopped, self._world.outlines())
            self._fitted[:] = False
        self._fitted &= lamps & ~moved
        self._geometry.update_lights(np.flatnonzero(lamps & ~self._fitted).tolist(), lights, radii, self._max_height)
        self._fitted |= lamps

    @property
    def _max_height(self) -> float:
        return max_height(self._geometry.largest)

    @property
    def occluders(self) -> Occluders:
        """Everything but what is `unknown`."""
        return self._geometry.occluders

    @property
    def within(self) -> NDArray[np.float32]:
        """A box (6,) outside of which nothing is known of where rays end."""
        return (self._geometry.bounds.reshape(-1) + self._max_height * OUTWARDS).astype(np.float32)

    @property
    def unknown(self) -> NDArray[np.float32]:
        """A box (6,) around the objects of which nothing can be proved; its lower corner is far above the upper one if
        there are none."""
        boxes = self._world.object_boxes()[self._since == 0]
        return np.concatenate([boxes[:, :3].min(0, initial=FAR), boxes[:, 3:].max(0, initial=-FAR)])
