"""What certificates of cells are worth at each pixel of a picture that is there already.

*Slack* is how far a light may surely move before the certificate of a pixel's cell fails.  *Regret* is how many shadow
rays of a primary hit were traced although the smallest cell at their point can be proved.

Both take a whole frame by a method with certificates of cells, and the renderer that made it; what this knows now
counts, which may be more.  They raise LookupError where it has no certificates of cells for the lights as they were in
the frame, and Cancelled once `cancelled()` is true.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import FATE, Fate
from tracer.inspect.projection import seen_at
from tracer.methods.certified import CertifiedCells
from tracer.neighbours.certified.cells import ALONG_U, ALONG_V, CORNER, NORMAL
from tracer.neighbours.certified.slack import Cancel, SlackFinder, proved_cells
from tracer.scene.arrays import Report

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer


def _finder_for(renderer: Renderer, frame: Frame) -> SlackFinder:
    """What finds slack in a frame."""
    method = renderer.state.method("certified")
    if not isinstance(method, CertifiedCells) or method.store is None or frame.cells is None:
        raise LookupError("the frame has no certificates of cells")
    there = renderer.scene.light_positions(frame.time)[: method.store.count].astype(np.float32)
    if not np.array_equal(method.store.lights, there):
        raise LookupError("another frame has begun, with lights elsewhere")
    return method.slack


def _places(
    finder: SlackFinder, frame: Frame, y: NDArray[np.int64], x: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
    """The owners of the cells, and u and v, of the points that pixels (n,) hit."""
    row = finder.store.cells.receivers[frame.primitive[y, x]].astype(np.float64)
    eye, at = (point - row[:, CORNER : CORNER + 3] for point in (frame.camera.position, seen_at(frame, x, y)))
    u, v = (np.einsum("ij,ij->i", at, row[:, way : way + 3]) for way in (ALONG_U, ALONG_V))
    below = np.einsum("ij,ij->i", eye, row[:, NORMAL : NORMAL + 3]) < 0.0
    return (2 * frame.primitive[y, x] + below).astype(np.int32), u, v


def _are_within(place: NDArray[np.float32], u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points (n,) are in cells at places (n, 3), give or take a hundredth of a cell."""
    across, down = ((at - place[:, k]) / place[:, 2] for k, at in enumerate((u, v)))  # upside down ones have size < 0
    return (across > -0.01) & (down > -0.01) & (across + down < 1.01)


def slack_at_pixels(renderer: Renderer, frame: Frame, light: int, cancelled: Cancel = None) -> NDArray[np.float32]:
    """(h, w) the slack of a light's certificates, in units of the scene; -1 where none says all."""
    finder, cell = _finder_for(renderer, frame), frame.cell
    cells, slack = finder.store.cells, np.full(frame.primitive.shape, -1.0, np.float32)
    if light < finder.store.count and finder.store.certified[light]:
        y, x = np.nonzero((cell > 0) & (cell < cells.used[0]) & (frame.primitive >= 0))
        owner, u, v = _places(finder, frame, y, x)
        number = cell[y, x]  # that another cell may have by now
        still = (cells.owner[number] == owner) & _are_within(cells.place[number], u, v)
        y, x = y[still], x[still]
        which, inverse = np.unique(proved_cells(cells, cell[y, x], light), return_inverse=True)
        found = np.full(len(which), -1.0, np.float32)
        found[which > 0] = finder.of_cells(which[which > 0], light, cancelled)
        slack[y, x] = found[inverse]
    return slack


def regret_at_pixels(
    renderer: Renderer, frame: Frame, cancelled: Cancel = None, report: Report = lambda part: None
) -> NDArray[np.int32]:
    """(h, w) the regret at each pixel, in lights, by `record_fates`, else ValueError; -1 where nothing is hit."""
    finder = _finder_for(renderer, frame)
    if frame.fates is None:
        raise ValueError("the frame did not record what became of its shadow rays")
    certified = finder.store.certified
    traced = (frame.fates[..., : len(certified)] & FATE == Fate.TRACED) & certified
    y, x, light = np.nonzero(traced & (frame.primitive >= 0)[..., None])
    with_cells = finder.store.cells.receivers[frame.primitive[y, x], NORMAL : NORMAL + 3].any(axis=1)
    y, x, light = y[with_cells], x[with_cells], light[with_cells]
    owner, u, v = _places(finder, frame, y, x)
    proved = finder.are_provable(owner, u, v, light.astype(np.int32), cancelled, report)
    regret = np.where(frame.primitive >= 0, 0, -1).astype(np.int32)
    np.add.at(regret, (y[proved], x[proved]), 1)
    return regret
