"""What a scene was when its picture was taken, as a short code for each part, to say later which part is another."""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracer.scene.model import Scene

PARTS = {
    "geometry": ("objects",),
    "materials": ("materials", "background", "ambient"),
    "textures": ("textures",),
    "lights": ("lights",),
    "camera": ("camera",),
    "animation": ("animation", "time_range", "frames"),
}
_last: tuple[weakref.ref[Scene], dict[str, str]] | None = None


def of_scene(scene: Scene) -> dict[str, str]:
    """A code for each of PARTS; that of the last scene is remembered."""
    global _last
    if _last is None or _last[0]() is not scene:
        codes = {part: _code([getattr(scene, name) for name in names]) for part, names in PARTS.items()}
        _last = weakref.ref(scene), codes
    return dict(_last[1])


def code_of(scene: Scene) -> str:
    """One code of all that a scene holds."""
    return "-".join(of_scene(scene).values())


def of_pixels(pixels: NDArray[np.uint8] | NDArray[np.float32]) -> str:
    """A code of a picture's size and pixels, to the bit."""
    return _code([pixels])


def _code(values: list[Any]) -> str:
    digest = hashlib.blake2b(digest_size=8)
    _feed(digest, values)
    return digest.hexdigest()


def _feed(digest: Any, value: Any) -> None:
    """Numbers by their bits, containers by what they hold, and each with its kind, so that none passes for another."""
    if isinstance(value, np.ndarray):
        digest.update(f"array {value.dtype.str} {value.shape}".encode())
        digest.update(np.ascontiguousarray(value).data)
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for item in fields(value):
            if item.compare:  # the others are what was computed from these
                _feed(digest, getattr(value, item.name))
    elif isinstance(value, Mapping):
        digest.update(f"map {len(value)}".encode())
        for key in value:
            _feed(digest, key)
            _feed(digest, value[key])
    elif isinstance(value, list | tuple):
        digest.update(f"list {len(value)}".encode())
        for item in value:
            _feed(digest, item)
    else:
        digest.update(f"{type(value).__name__} {value.name if isinstance(value, Path) else value!r};".encode())
