"""Which way is up in a mesh, by the customs of file formats, and by how the model would stand.

glTF says that y is up. STL comes from workshops, where z is, and so do PLY files that Blender writes; most others are
made for y. A model that stands badly that way and much better the other way is taken to be made for the other one.
Standing well means what it does for things: it takes much to tip them over, they touch the ground all over their
footprint, and they are about as wide as deep (after Fu, Cohen-Or, Dror and Sheffer 2008, who learn such measures).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tracer.scene.arrays import Float32, Float64

NEAR_GROUND = 0.004
"""Part of the model's diagonal within which a point touches the ground."""
NEARLY = 0.03
"""The same for the usual way: a model that lies there on a small bump would only settle a little..."""
DOUBTFUL = 0.1
"""... so it counts for this part of how well it would stand then."""
STEADY = 30.0
"""Degrees: what must be tipped as far before it falls stands as well as anything."""
UNSTEADY = 8.0
"""Degrees: what falls before that does not stand at all."""
MUCH_BETTER = 3.0
_DIRECTIONS = 64
MOST_ASKED = 250_000
"""Triangles that are looked at: of a model of more, as many from all over the file."""


def customary(path: Path, head: bytes) -> str:
    """The axis that usually points up in files of this kind; `head` is how the file begins."""
    kind = path.suffix.lower()
    return "z" if kind == ".stl" or (kind == ".ply" and b"blender" in head.lower()) else "y"


def guess(path: Path, head: bytes, corners: Float32) -> str:
    """The axis that probably points up in a file of triangles (n, 3, 3)."""
    custom = customary(path, head)
    if path.suffix.lower() in (".gltf", ".glb") or not len(corners):
        return custom
    other = "y" if custom == "z" else "z"
    wide = np.asarray(corners[:: -(-len(corners) // MOST_ASKED)], np.float64)
    mass = _mass(wide)
    usual = max(_footing(wide, mass, custom, NEAR_GROUND)[1], DOUBTFUL * _footing(wide, mass, custom, NEARLY)[1])
    tipping, better = _footing(wide, mass, other, NEAR_GROUND)
    return other if tipping >= UNSTEADY and better > MUCH_BETTER * usual else custom


def footing(corners: Float32, axis: str) -> tuple[float, float]:
    """How well triangles (n, 3, 3) stand with y or z up: how many degrees they can be tipped before they fall, negative
    where they fall at once; and a score, 0 for what does not stand."""
    wide = np.asarray(corners, np.float64)
    return _footing(wide, _mass(wide), axis, NEAR_GROUND)


def _footing(wide: Float64, mass: tuple[Float64, Float64], axis: str, touching: float) -> tuple[float, float]:
    """As `footing`; `mass` is theirs, and `touching` the part of their diagonal within which a point touches ground."""
    up = "xyz".index(axis)
    flat = [i for i in range(3) if i != up]
    points = wide.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    near = points[points[:, up] <= low[up] + touching * float(np.linalg.norm(high - low))][:, flat]
    middle, spread = mass
    turns = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    ways = np.stack([np.cos(turns), np.sin(turns)])
    reach = np.array([np.argmax(near @ way) for way in ways.T])  # the corners of what it stands on
    hull = near[reach]
    margin = float(np.min(np.einsum("ij,ji->i", hull - middle[flat], ways)))
    height = float(middle[up] - low[up])
    tipping = float(np.degrees(np.arctan2(margin, max(height, 1e-300))))
    x, y = (hull - middle[flat]).T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    footprint = float(np.prod((high - low)[flat])) or 1.0
    least, greatest = np.linalg.eigvalsh(spread[np.ix_(flat, flat)])
    square = float(max(least, 0.0) / greatest) if greatest > 0 else 0.0
    return tipping, area / footprint * min(max(tipping, 0.0), STEADY) * square


def _mass(corners: Float64) -> tuple[Float64, Float64]:
    """Middle (3,) and spread (3, 3) of a thin shell of these triangles."""
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    weights = areas / areas.sum() if areas.sum() > 0 else np.full(len(areas), 1.0 / len(areas))
    means = (corners[:, 0] + corners[:, 1] + corners[:, 2]) / 3.0
    middle = weights @ means
    means -= middle
    # The exact second moments of triangles, of equal weight per area.
    spread = 9.0 * (weights[:, None] * means).T @ means
    for corner in range(3):
        away = corners[:, corner] - middle
        spread += (weights[:, None] * away).T @ away
    return middle, spread / 12
