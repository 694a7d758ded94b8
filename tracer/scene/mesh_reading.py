"""How trimesh is made to read files of strangers: in silence, and without formats of images that may run programs."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock, get_ident
from typing import Any

import numpy as np
from PIL import Image

from tracer.scene.textures import FORMATS

_lock = Lock()
_inside = 0  # threads that are within `only_known_images`
_open = Image.open


@contextmanager
def quiet() -> Iterator[None]:
    """Without what trimesh, numpy and Pillow say of a file to the terminal: it is judged by us."""
    log, here = logging.getLogger("trimesh.util"), get_ident()

    def elsewhere(record: logging.LogRecord) -> bool:
        return record.thread != here

    log.addFilter(elsewhere)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    finally:
        log.removeFilter(elsewhere)


@contextmanager
def only_known_images() -> Iterator[None]:
    """Images within a file, which trimesh opens by itself, are of FORMATS: it would let Pillow try all that it knows.

    Several threads may read at once."""
    global _inside
    with _lock:
        _inside += 1
        Image.open = _known  # type: ignore[assignment]
    try:
        yield
    finally:
        with _lock:
            _inside -= 1
            if not _inside:
                Image.open = _open


def _known(source: Any, mode: Any = "r", formats: Any = FORMATS) -> Image.Image:
    return _open(source, mode, formats)
