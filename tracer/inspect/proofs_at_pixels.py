"""What certificates of cells are worth at each pixel of a picture that is there already.

*Slack* is how far a light may move before the certificate of a pixel's cell fails.  *Regret* is which shadow rays of
primary hits were traced although the smallest cell at their point could have been proved, so that a better method would
have saved them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import FATE, Fate
from tracer.methods.certified import CertifiedCells
from tracer.neighbours.certified.cells import CORNER, NORMAL
from tracer.neighbours.certified.slack import proved_cells

if TYPE_CHECKING:
    from tracer.frame import Frame
    from tracer.renderer import Renderer

UNKNOWN = -1
Cancel = Callable[[], bool] | None


def _cells_of(renderer: Renderer, frame: Frame) -> CertifiedCells:
    """The method that has made a frame's certificates.

    Raises LookupError where the renderer has begun another frame, or has no certificates of cells."""
    renderer.work_on(frame)
    method = renderer.state.method("certified")
    if not isinstance(method, CertifiedCells) or method.store is None or frame.cells is None:
        raise LookupError("the frame has no certificates of cells")
    return method


def slack_at_pixels(renderer: Renderer, frame: Frame, light: int, cancelled: Cancel = None) -> NDArray[np.float32]:
    """How far a light may surely move before the certificate of each pixel fails.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame, which has made no other since.
    frame : Frame
        The picture, whole, by a method with certificates of cells.
    light : int
        Number of the light.
    cancelled : callable, optional
        Asked now and then.

    Returns
    -------
    (h, w) float32
        In units of the scene; -1 where no certificate says all of the light.

    Raises
    ------
    LookupError
        If the renderer has begun another frame, or has no certificates of cells.
    Cancelled
        Once `cancelled()` is true.
    """
    finder = _cells_of(renderer, frame).slack
    store = finder.store
    slack = np.full(frame.primitive.shape, UNKNOWN, np.float32)
    if light >= store.count or not store.certified[light] or frame.cells is None:
        return slack
    cells = store.cells
    there = (frame.cells > 0) & (frame.cells < cells.used[0])
    there[there] = cells.owner[frame.cells[there]] >> 1 == frame.primitive[there]  # cells may have other numbers now
    which, inverse = np.unique(proved_cells(cells, frame.cells[there], light), return_inverse=True)
    found = np.full(len(which), UNKNOWN, np.float32)
    found[which > 0] = finder.of_cells(which[which > 0], light, cancelled)
    slack[there] = found[inverse]
    return slack


def regret_at_pixels(renderer: Renderer, frame: Frame, cancelled: Cancel = None) -> NDArray[np.int32]:
    """How many shadow rays of each primary hit were traced although the answer could have been proved.

    Parameters
    ----------
    renderer : Renderer
        The renderer that made the frame, which has made no other since.
    frame : Frame
        The picture, whole, by a method with certificates of cells, with `record_fates`.
    cancelled : callable, optional
        Asked now and then.

    Returns
    -------
    (h, w) int32
        Lights, of those that are certified; -1 where nothing is hit.

    Raises
    ------
    LookupError
        If the renderer has begun another frame, or has no certificates of cells.
    ValueError
        If the frame has no record of fates.
    Cancelled
        Once `cancelled()` is true.
    """
    finder, buffers = _cells_of(renderer, frame).slack, renderer.work_on(frame).buffers
    if frame.fates is None:
        raise ValueError("the frame did not record what became of its shadow rays")
    certified, receivers = finder.store.certified, finder.store.cells.receivers
    traced = frame.fates[..., : len(certified)] & FATE == Fate.TRACED
    y, x, light = np.nonzero(traced & certified & (frame.primitive >= 0)[..., None])
    row = receivers[frame.primitive[y, x]]
    seen_from = np.asarray(renderer.work_on(frame).rays.origin, np.float32) - row[:, CORNER : CORNER + 3]
    back = np.einsum("ij,ij->i", seen_from, row[:, NORMAL : NORMAL + 3]) < 0.0
    with_cells = row[:, NORMAL : NORMAL + 3].any(axis=1)
    owner = (2 * frame.primitive[y, x] + back).astype(np.int32)
    place = buffers.u[y, x], buffers.v[y, x]
    those = np.flatnonzero(with_cells)
    proved = finder.are_provable(
        owner[those], place[0][those], place[1][those], light[those].astype(np.int32), cancelled
    )
    regret = np.where(frame.primitive >= 0, 0, UNKNOWN).astype(np.int32)
    np.add.at(regret, (y[those[proved]], x[those[proved]]), 1)
    return regret
