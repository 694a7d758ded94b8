"""Lights: points, and lamps of some size that shine from many fixed points of their surface.

A lamp of 64 samples is 64 point lights that share its colour.  Its samples lie at the same places of the lamp in every
frame and for every method, so that the picture in which all shadow rays are traced is the truth, bit for bit.  They are
the first points of a Sobol sequence in two dimensions, shifted for each lamp (Cranley and Patterson 1976): 4, 16 or 64
of them are spread evenly over the lamp, and the first of 64 are those of 4.  Shading reads the lights of a frame as
`Lamps`: each has one sample or more.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.scene.arrays import Float64, Vector

KINDS = ("point", "sphere", "rectangle", "dome")
FALLOFFS = ("none", "inverse square")
MAX_SAMPLES = 1024
DEFAULT_SAMPLES = 16
"""Of a lamp, where nobody says how many."""
_BITS = 32


@dataclass(frozen=True)
class Light:
    """A light, which shines alike in all directions.

    Parameters
    ----------
    position : (x, y, z)
        Its centre.
    color : (r, g, b)
        What arrives from all of it: at any distance or, where it falls off, at distance 1.
    track : str or None
        The translation track that moves it (AFF `la`).
    kind : str
        "point"; "sphere" of some `radius`; "rectangle" with two `edges` from corner to corner; or "dome", the half of a
        sphere of `radius` whose top lies towards the first of its `edges`.
    samples : int
        Points from which it shines, 1 to 1024. A single one is the centre of a sphere or a rectangle, or the top of a
        dome.
    falloff : str
        "none", as in BART, or "inverse square".
    number : int or None
        Its number in the scene as it was read, where others of that scene are switched off.
    """

    name: str
    position: Vector
    color: Vector = (1.0, 1.0, 1.0)
    track: str | None = None
    kind: str = "point"
    radius: float = 0.0
    edges: tuple[Vector, ...] = ()
    samples: int = 1
    falloff: str = "none"
    number: int | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        edges = {"rectangle": 2, "dome": 1}.get(self.kind, 0)
        if self.kind not in KINDS:
            raise ValueError(f"a light's kind is one of {', '.join(KINDS)}, not {self.kind}")
        if self.falloff not in FALLOFFS:
            raise ValueError(f"a light's falloff is one of {', '.join(FALLOFFS)}, not {self.falloff}")
        if not 1 <= self.samples <= MAX_SAMPLES:
            raise ValueError(f"a light has 1 to {MAX_SAMPLES} samples, not {self.samples}")
        if len(self.edges) != edges:
            raise ValueError(f"a {self.kind} has {edges} edges, not {len(self.edges)}")
        if not (math.isfinite(self.radius) and self.radius >= 0):
            raise ValueError(f"a light's radius is 0 or more, not {self.radius}")
        if self.kind == "point" and self.samples > 1:
            raise ValueError("a point has one sample")

    def offsets(self) -> Float64:
        """(samples, 3) float64: where its samples are, as seen from its centre."""
        if self.kind == "point":
            return np.zeros((1, 3))
        if self.kind == "rectangle":
            u, v = self._places()
            return (np.stack([u, v], axis=1) - 0.5) @ np.array(self.edges, np.float64)
        if self.kind == "dome":
            return self.radius * self._on_dome()
        u, v = self._places()
        return np.zeros((1, 3)) if self.samples == 1 else self.radius * _on_sphere(1.0 - 2.0 * u, v)

    def _on_dome(self) -> Float64:
        up = np.array(self.edges[0], np.float64)
        up /= np.linalg.norm(up)
        if self.samples == 1:
            return up[None]
        side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
        side /= np.linalg.norm(side)
        u, v = self._places()
        local = _on_sphere(u, v)
        return local[:, :1] * side + local[:, 1:2] * np.cross(up, side) + local[:, 2:] * up

    def _places(self) -> tuple[Float64, Float64]:
        """Two coordinates from 0 to 1 for each sample; the centre for a single one."""
        if self.samples == 1:
            return np.array([0.5]), np.array([0.5])
        shift = np.random.default_rng(zlib.crc32(self.name.encode())).random(2)
        # Half a cell further, so that no sample lies on the border of its cell.
        u, v = (sobol(self.samples) + 0.5 / MAX_SAMPLES + shift).T % 1.0
        return u, v


def sobol(count: int) -> Float64:
    """(count, 2): the first points of Sobol's sequence in two dimensions, from 0 to 1 (Bratley and Fox 1988)."""
    numbers = np.arange(count, dtype=np.uint64)
    points = np.zeros((count, 2), np.uint64)
    direction = np.uint64(1 << (_BITS - 1))
    other = direction
    for bit in range(count.bit_length()):
        on = (numbers >> np.uint64(bit)) & np.uint64(1)
        points[:, 0] ^= on * (direction >> np.uint64(bit))
        points[:, 1] ^= on * other
        other ^= other >> np.uint64(1)
    return points / float(1 << _BITS)


def _on_sphere(z: Float64, turn: Float64) -> Float64:
    """Points of the unit sphere at height z, this part of a turn around it: equal areas are equally likely."""
    radius = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    return np.stack([radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn), z], axis=1)


def as_lamps(lights: tuple[Light, ...], radius: float | None, samples: int | None) -> tuple[Light, ...]:
    """These lights, each point light made a sphere of some radius, and every lamp given so many samples.

    None leaves the radius or the samples as they are, and gives 16 samples to a point that becomes a sphere; a radius
    of 0 makes spheres points."""
    return tuple(_as_lamp(light, radius, samples) for light in lights)


def _as_lamp(light: Light, radius: float | None, samples: int | None) -> Light:
    if radius is not None and light.kind in ("point", "sphere"):
        kind, count = ("sphere", DEFAULT_SAMPLES) if radius > 0 else ("point", 1)
        count = light.samples if kind == light.kind else count
        light = replace(light, kind=kind, radius=radius, samples=count)
    return light if samples is None or light.kind == "point" else replace(light, samples=samples)


def number_of(lights: Sequence[Light], light: int) -> int:
    """The number that people know a scene's light by: that in the scene as it was read, whichever others are off."""
    number = lights[light].number if light < len(lights) else None
    return light if number is None else number


def light_in_words(number: int, name: str) -> str:
    """Return a light by its number, and its name where that says more: light 2 (lamp)."""
    said = f"light {number}"
    return said if name in ("", said) else f"{said} ({name})"


def named_light(lights: Sequence[Light], light: int) -> str:
    """Return one of a scene's lights in the same words; its number is that in the scene as it was read."""
    return light_in_words(number_of(lights, light), lights[light].name if light < len(lights) else "")


COLOR, FALLS_OFF = 0, 3
LAMP_COLUMNS = 4
ROUNDED_UP = 1.000001  # times a number, in float32 no less than that


class Lamps(NamedTuple):
    """l lamps with n samples in all.

    places (l, 3) float32 are their centres, or the one sample that they have; samples (n, 3) float32 are positions,
    those of lamp i from first[i] to first[i + 1] - 1, first (l + 1,) int32; rows (l, 4) float32 are the colour of each
    sample, and 1 where it falls off with the square of the distance.  radii (l,) float32 are those of balls around
    places in which the lamp's samples lie: 0 for a single one."""

    places: NDArray[np.float32]
    samples: NDArray[np.float32]
    first: NDArray[np.int32]
    rows: NDArray[np.float32]
    radii: NDArray[np.float32]


class LampTable:
    """Lamps that keep their shape from frame to frame, wherever they are."""

    def __init__(self, lights: tuple[Light, ...]) -> None:
        self.lights = lights
        offsets = [light.offsets() for light in lights]
        counts = np.array([len(o) for o in offsets], np.int64)
        self._offsets = np.concatenate([np.empty((0, 3)), *offsets])
        self._owner = np.repeat(np.arange(len(lights)), counts)
        self._first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
        self._rows = np.zeros((len(lights), LAMP_COLUMNS), np.float32)
        for row, light, count in zip(self._rows, lights, counts, strict=True):
            row[:FALLS_OFF] = np.array(light.color) / count
            row[FALLS_OFF] = light.falloff != "none"
        #: (l,) bool: lamps with one sample.
        self.single = counts == 1

    def at(self, centers: NDArray[np.float64]) -> Lamps:
        """The lamps with their centres (l, 3) there."""
        samples = (centers[self._owner] + self._offsets).astype(np.float32)
        places = centers.astype(np.float32)
        places[self.single] = samples[self._first[:-1][self.single]]
        return Lamps(places, samples, self._first, self._rows, self._radii(places, samples))

    def _radii(self, places: NDArray[np.float32], samples: NDArray[np.float32]) -> NDArray[np.float32]:
        if not len(self.lights):
            return np.empty(0, np.float32)
        away = np.linalg.norm(samples.astype(np.float64) - places[self._owner], axis=1)
        return (ROUNDED_UP * np.maximum.reduceat(away, self._first[:-1])).astype(np.float32)
