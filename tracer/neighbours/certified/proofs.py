"""What is certified of cells, as proofs that others can check: which rays, and the primitives that it rests on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import shadow_mode
from tracer.neighbours.certified.cells import FULL, LIT, named_by
from tracer.neighbours.certified.certify import make_scratch
from tracer.neighbours.certified.store import CertificateStore
from tracer.neighbours.certified.tasks import put_cell_of
from tracer.runtime.kernels import kernel
from tracer.visibility.error_bounds import BOX


class Proof(NamedTuple):
    """That a light is hidden from a cell by the primitives `by` together, or that nothing static hides it: `verdict` is
    "full" or "lit"."""

    cell: int
    light: int
    verdict: str
    by: tuple[int, ...]


@kernel
def _put(cells, occluders, cell, scale, scratch):
    return put_cell_of(cells, occluders, cell, scale, scratch)


def prism_of(store: CertificateStore, cell: int) -> NDArray[np.float64]:
    """(6, 3): the corners of the prism in which a cell's shadow rays end, of its floor and then of its ceiling."""
    scratch = make_scratch()
    _put(store.cells, store.occluders, cell, store.scale, scratch)
    return scratch.shaft.corners.T.copy()


def proofs_of(store: CertificateStore, seen: Iterable[int]) -> list[Proof]:
    """What is certified of cells, and of the cells that they are parts of where it was proved of these."""
    found: dict[Proof, None] = {}
    cells = store.cells
    for leaf in map(int, seen):
        for light in np.flatnonzero(store.certified).tolist():
            state = int(shadow_mode(cells.words[leaf], light))
            if state == LIT:
                found[Proof(leaf, light, "lit", ())] = None
            elif state == FULL and (cell := store.naming(leaf, light)):
                names = named_by(cells, cell, light)
                if names is not None and len(names):
                    found[Proof(cell, light, "full", tuple(names.tolist()))] = None
    return list(found)


def as_json(store: CertificateStore, seen: Iterable[int], triangles: int) -> dict[str, Any]:
    """Proofs with all that they rest on, each number exactly as kernels have it.  The first `triangles` of the
    primitives are triangles: of the others only the boxes count, which are empty for what moves."""
    place: dict[int, int] = {}  # of each cell among those that are written
    proofs = [proof._asdict() | {"cell": place.setdefault(proof.cell, len(place))} for proof in proofs_of(store, seen)]
    rows = store.occluders.rows.astype(np.float64)
    return {
        "lights": store.lights.astype(np.float64).tolist(),
        "triangles": rows[:triangles, :9].tolist(),
        "boxes": rows[triangles:, BOX : BOX + 6].tolist(),
        "cells": [prism_of(store, cell).tolist() for cell in place],
        "proofs": proofs,
    }
