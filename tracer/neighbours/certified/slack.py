"""How far a light may move before a certificate fails, its *slack*; and what could be proved of the smallest cells.

Where functions, boxes and planes are those of a ball around the light, a proof holds wherever in the ball the light is
(`tracer.visibility`).  So a certificate is proved anew for larger and smaller balls: no light that moves by less than
the largest makes it untrue.  Of a ray that was traced, the smallest cell around its point tells whether certificates
could have known the answer: a larger one has more to prove.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tracer.culling.modes import shadow_mode
from tracer.neighbours.certified.cells import FULL, LIT, NOBODY, OVERFLOW, SETTLED, TOO_MANY, Cells
from tracer.neighbours.certified.certify import certify, make_scratch
from tracer.neighbours.certified.tasks import DEEPEST, SMALLEST, put_cell_of
from tracer.runtime.kernels import kernel, subkernel
from tracer.runtime.parallel import for_each_chunk
from tracer.scene.arrays import Report
from tracer.visibility.budget import COUNTERS
from tracer.visibility.occluders import Occluders
from tracer.visibility.shaft import put_light

if TYPE_CHECKING:
    from tracer.neighbours.certified.store import CertificateStore

PART = 0.25  # of the diagonal of all that is static: slack is told up to that
TRIED, HALVING = 256, 16  # radii of balls, and after how many of these they are half as large
CHUNK = 64  # places that a thread takes at a time
Cancel = Callable[[], bool] | None


@subkernel
def _is_proved(cells, o, lights, cell, number, radius, alone, s, counts):
    """Whether the cell that s.shaft was put to is proved to be hidden from a ball of light, or lit by all of it;
    `alone` by the primitives that its certificate names."""
    light = np.float64(lights[number, 0]), np.float64(lights[number, 1]), np.float64(lights[number, 2])
    if not put_light(s.shaft, light, radius):
        return False
    start = np.int64(cells.lists[cell, number]) if alone else np.int64(OVERFLOW)
    asked = np.int64(cells.names[start]) & (SETTLED - 1) if start > NOBODY else np.int64(TOO_MANY)
    state, _amount = certify(s, o, number, light, cells.names[start + 1 : start + 1 + asked], asked, 0, counts)
    return state in (FULL, LIT)


@kernel
def find_slack(cells, o, lights, scale, cell, light, most, first, last, slack, s):
    """Find the slack (n,) float32 of cell (n,) int32 for light (n,) int32, from first to last - 1: at most `most`, and
    -1 where nothing is proved.  Where `most` is 0, there is no certificate yet.

    o are the `Occluders`, fitted to balls of this radius around lights (n, 3) float32; scale is the `SceneScale`, s a
    worker's `Scratch`."""
    counts, tried = np.zeros(COUNTERS, np.int64), TRIED if most > 0.0 else 0
    for i in range(first, last):
        slack[i] = -1.0
        if not put_cell_of(cells, o, np.int64(cell[i]), scale, s):
            continue

        # Halve the range of radii, of which the last is 0, down to the largest for which there is a proof.
        low, high, radius = 0, tried + 1, 0.0
        while low < high:
            middle = (low + high) // 2
            tries = most * 2.0 ** (-middle / HALVING) if middle < tried else 0.0
            if _is_proved(cells, o, lights, np.int64(cell[i]), np.int64(light[i]), tries, most > 0.0, s, counts):
                high, radius = middle, tries
            else:
                low = middle + 1
        if low <= tried:
            slack[i] = radius


class SlackFinder:
    """Finds slack in a store, whose lights and objects are where they were when it was updated last."""

    def __init__(self, store: CertificateStore) -> None:
        self.store = store
        self._fitted: dict[int, tuple[Occluders, bytes, Occluders]] = {}  # by light: fitted to a ball, and what of

    @property
    def most(self) -> float:
        """No more slack is told, in units of the scene."""
        low, high = self.store.bounds
        return PART * float(np.linalg.norm(high - low))

    def of_cells(self, cell: NDArray[np.int32], light: int, cancelled: Cancel = None) -> NDArray[np.float32]:
        """(n,) how far a light may surely move for its certificates of cells (n,), FULL or LIT, to hold."""
        lights, o = np.full_like(cell, light), self._in_ball(light)
        return np.maximum(self._find(self.store.cells, o, cell, lights, self.most, cancelled), np.float32(0.0))

    def are_provable(
        self, owner: NDArray[np.int32], u: ArrayLike, v: ArrayLike, light: NDArray[np.int32], cancelled: Cancel = None,
        report: Report = lambda part: None,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """(n,) whether lights (n,) are proved to be hidden from the smallest cells at points (n,), or to light them."""
        store = self.store
        place = smallest_at(u, v, levels_of(store.occluders.rows[owner >> 1], store.scale.max_height))
        cells, cell = store.cells._replace(owner=owner, place=place), np.arange(len(owner), dtype=np.int32)
        return self._find(cells, store.occluders, cell, light, 0.0, cancelled, report) >= 0.0

    def _in_ball(self, light: int) -> Occluders:
        """The occluders fitted to a ball around a light, made when a light is asked about that has moved."""
        store, place = self.store, self.store.lights[light].tobytes()
        known = self._fitted.get(light)
        if known is None or known[0] is not store.occluders or known[1] != place:
            known = self._fitted[light] = store.occluders, place, store.occluders_in_ball(light, self.most)
        return known[2]

    def _find(
        self, cells: Cells, o: Occluders, cell: NDArray[np.int32], light: NDArray[np.int32], most: float,
        cancel: Cancel, report: Report = lambda part: None,
    ) -> NDArray[np.float32]:  # fmt: skip
        store, slack = self.store, np.empty(len(cell), np.float32)
        scratch = [make_scratch() for _ in range(store.threads)]

        def work(chunk: int, worker: int) -> None:
            rows = chunk * CHUNK, min(len(slack), (chunk + 1) * CHUNK)
            find_slack(cells, o, store.lights, store.scale, cell, light, most, *rows, slack, scratch[worker])
            report(rows[1] / len(slack))

        for_each_chunk(work, -(-len(slack) // CHUNK), store.threads, cancel)
        return slack


def proved_cells(cells: Cells, cell: NDArray[np.int32], light: int) -> NDArray[np.int32]:
    """(n,) the cells that the certificates, FULL or LIT, of cells (n,) were proved of: these, or wholes; 0 for none."""
    states = shadow_mode(cells.words[cell], light)
    cell = np.where((states == FULL) | (states == LIT), cell, np.int32(0))
    while True:
        parent = cells.parent[cell]
        whole = shadow_mode(cells.words[parent], light) == states
        rises = (cell > 0) & (parent > 0) & whole & ((states == LIT) | (cells.lists[cell, light] == NOBODY))
        if not rises.any():
            return cell
        cell = np.where(rises, parent, cell)


def levels_of(rows: NDArray[np.float32], highest: float) -> NDArray[np.float64]:
    """(n,) how often triangles, rows (n, ROW), can be divided, where rays end no higher above them than `highest`."""
    shortest = np.linalg.norm(rows[:, 3:9].astype(np.float64).reshape(-1, 2, 3), axis=2).min(1)
    most = np.log2(np.maximum(shortest / (SMALLEST * highest), 1.0))
    return np.clip(np.ceil(most) - 1.0, 0.0, -np.log2(DEEPEST))


def smallest_at(u: ArrayLike, v: ArrayLike, levels: ArrayLike) -> NDArray[np.float32]:
    """(n, 3) u, v and size of the cells at points (n,), in triangles that are divided so often (n,)."""
    parts, at = np.exp2(np.asarray(levels, np.float64)), np.clip(np.asarray([u, v], np.float64), 0.0, 1.0)
    x, y = (1.0 - 1e-12) * parts * at / np.maximum(at.sum(0), 1.0)  # inside, also where they are on the far edge
    column, row = np.floor(x), np.floor(y)
    down = x - column + y - row > 1.0  # the middle one of four, upside down
    place = np.stack([column + down, row + down, np.where(down, -1.0, 1.0)], 1) / parts[:, None]
    return place.astype(np.float32)
