"""How things move: Kochanek-Bartels tracks, and the chains of transforms of all objects, evaluated all together.

A frame needs every track of a scene at one time, and a scene may have hundreds, so tracks are laid side by side: one
array holds segment i of every track, and a handful of array operations yields all translations, scales and rotations of
the moment.  The result is kept for the time asked last.  (A loop over tracks took longer than placing the objects.)

Of n keys only 1 to n - 2 are passed through; the first and the last shape the tangents, and time is clamped between.
Files hold duplicate and even backward key times, so a segment is found by linear scan: the first whose end is later.

The chains of objects that move together begin with the same transforms.  So they are a tree (`Chains`): every node is
the product of its parent's matrix and one more transform, and all products at one depth are one array operation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.scene import rotations
from tracer.scene.arrays import Float64, vector
from tracer.scene.camera import Camera
from tracer.scene.limits import LARGEST

Chain = tuple[Float64 | str, ...]


@dataclass(frozen=True)
class Keys:
    """One Kochanek-Bartels track of n >= 4 keys.

    times (n,) seconds; values (n, 3) for translation and scale, or (n, 4) for rotation: axis of
    any length, then degrees; shape (n, 3) tension, continuity and bias.  All float64.
    """

    times: Float64
    values: Float64
    shape: Float64


@dataclass(frozen=True)
class TrackSet:
    """What one `k` statement says of a name: any of translation, rotation, scale and visibility.

    visibility is (n, 2) float64: time and 0 or 1.
    """

    translation: Keys | None = None
    rotation: Keys | None = None
    scale: Keys | None = None
    visibility: Float64 | None = None

    def visible(self, time: float) -> bool:
        """Visible until the first key; then as the newest key says."""
        if self.visibility is None:
            return True
        (past,) = np.nonzero(self.visibility[:, 0] <= time)
        return len(past) == 0 or bool(self.visibility[past[-1], 1])


@dataclass(frozen=True)
class _Segments:
    """The segments of m tracks side by side: all arrays (m, s, ...), padded with the last segment.

    A time t lies in the first segment with end > t, else in the last.  first and last (m,) clamp it.
    """

    first: Float64
    last: Float64
    start: Float64
    end: Float64
    knots: Float64  # (m, s, 4, d): what the interpolation between start and end is made of

    @staticmethod
    def of(tracks: Sequence[Keys], knots: Sequence[Float64]) -> _Segments:
        """`knots` holds one (segments, 4, d) array per track."""
        count = max(len(k) for k in knots)

        def stack(rows: list[Float64]) -> Float64:
            return np.stack([np.concatenate([r, np.repeat(r[-1:], count - len(r), axis=0)]) for r in rows])

        return _Segments(
            np.array([t.times[1] for t in tracks]),
            np.array([t.times[-2] for t in tracks]),
            stack([t.times[1:-2] for t in tracks]),
            stack([t.times[2:-1] for t in tracks]),
            stack(list(knots)),
        )

    def find(self, time: float) -> tuple[Float64, Float64]:
        """u (m, 1) in 0..1 and the knots (m, 4, d) of the segment that holds the time, per track."""
        clamped = np.minimum(np.maximum(time, self.first), self.last)
        later = self.end > clamped[:, None]
        index = np.where(later.any(axis=1), later.argmax(axis=1), later.shape[1] - 1)
        rows = np.arange(len(index))
        start, end = self.start[rows, index], self.end[rows, index]
        length = end - start
        u = np.where(length > 0, (clamped - start) / np.where(length > 0, length, 1.0), 1.0)
        return np.clip(u, 0.0, 1.0)[:, None], self.knots[rows, index]


def _tangents(times: Float64, shape: Float64, steps: Float64) -> tuple[Float64, Float64]:
    """Tangents that leave the start and enter the end of each segment 1 .. n - 3.

    steps (n - 1, d) are the differences of neighbouring keys; both results are (n - 3, d).
    """
    before, here, after = steps[:-2], steps[1:-1], steps[2:]

    def speed(numerator: Float64, denominator: Float64) -> Float64:
        # Keys that share a time have no speed to match: take uniform steps.
        return np.where(denominator != 0, numerator / np.where(denominator != 0, denominator, 1.0), 0.5)[:, None]

    length = times[2:-1] - times[1:-2]
    t, c, b = (shape[1:-2, i, None] for i in range(3))
    leave = speed(length, times[2:-1] - times[:-3]) * (1 - t)
    leave = leave * ((1 + c) * (1 + b) * before + (1 - c) * (1 - b) * here)
    t, c, b = (shape[2:-1, i, None] for i in range(3))
    enter = speed(length, times[3:] - times[1:-2]) * (1 - t)
    enter = enter * ((1 + c) * (1 - b) * after + (1 - c) * (1 + b) * here)
    return leave, enter


def _curve_knots(keys: Keys) -> Float64:
    """(segments, 4, 3): end points and tangents of the cubic Hermite polynomials."""
    leave, enter = _tangents(keys.times, keys.shape, np.diff(keys.values, axis=0))
    return np.stack([keys.values[1:-2], keys.values[2:-1], leave, enter], axis=1)


def _hermite(u: Float64, knots: Float64) -> Float64:
    """(m, 3) points at u (m, 1) of the polynomials with knots (m, 4, 3); what waits does so bit for bit."""
    start, end, leave, enter = (knots[:, i] for i in range(4))
    v = 1 - u
    points = (1 + 2 * u) * v * v * start + u * u * (3 - 2 * u) * end + u * v * (v * leave - u * enter)
    waits = (start == end) & (leave == 0) & (enter == 0)
    return np.where(waits.all(axis=1, keepdims=True), start, points)


def _rotation_knots(keys: Keys) -> Float64:
    """(segments, 4, 4): end points and the two inner quaternions of each squad."""
    q = rotations.from_axes(keys.values[:, :3], keys.values[:, 3])
    # Opposite quaternions are one rotation: choose signs, key after key, for the shorter way.
    same = np.sum(q[1:] * q[:-1], axis=1) >= 0
    q[1:] *= np.cumprod(np.where(same, 1.0, -1.0))[:, None]
    steps = rotations.log(rotations.multiply(rotations.conjugate(q[:-1]), q[1:]))
    leave, enter = _tangents(keys.times, keys.shape, steps)
    inner_start = rotations.multiply(q[1:-2], rotations.exp((leave - steps[1:-1]) / 2))
    inner_end = rotations.multiply(q[2:-1], rotations.exp((steps[1:-1] - enter) / 2))
    return np.stack([q[1:-2], q[2:-1], inner_start, inner_end], axis=1)


def _squad(u: Float64, knots: Float64) -> Float64:
    """(m, 3, 3) rotations at u (m, 1) of the squads with knots (m, 4, 4)."""
    start, end, leave, enter = (knots[:, i] for i in range(4))
    return rotations.matrices(rotations.squad(start, end, leave, enter, u))


@dataclass(frozen=True)
class Animation:
    """All tracks of a scene by name.  Names that no track bears mean the identity."""

    tracks: Mapping[str, TrackSet] = field(default_factory=dict)
    _latest: dict[str, tuple[float, Float64]] = field(default_factory=dict, init=False, repr=False, compare=False)

    @staticmethod
    def empty() -> Animation:
        return Animation({})

    @cached_property
    def _translations(self) -> tuple[list[int], _Segments | None]:
        return self._pack([t.translation for t in self.tracks.values()], _curve_knots)

    @cached_property
    def _rotations(self) -> tuple[list[int], _Segments | None]:
        return self._pack([t.rotation for t in self.tracks.values()], _rotation_knots)

    @cached_property
    def _scales(self) -> tuple[list[int], _Segments | None]:
        return self._pack([t.scale for t in self.tracks.values()], _curve_knots)

    @staticmethod
    def _pack(tracks: list[Keys | None], knots: Callable[[Keys], Float64]) -> tuple[list[int], _Segments | None]:
        which = [i for i, keys in enumerate(tracks) if keys is not None]
        present = [keys for keys in tracks if keys is not None]
        return which, _Segments.of(present, [knots(keys) for keys in present]) if present else None

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.tracks)}

    def matrices(self, time: float) -> Float64:
        """T R S of every track, (tracks, 4, 4) float64 in the order of `tracks`; kept, so not to be written to."""
        known = self._latest.get("matrices")
        if known is not None and known[0] == time:
            return known[1]
        placed = np.tile(np.eye(4), (len(self.tracks), 1, 1))
        with np.errstate(all="ignore"):  # keys far apart within no time make speeds beyond all numbers
            which, segments = self._rotations
            if segments is not None:
                placed[which, :3, :3] = _squad(*segments.find(time))
            which, segments = self._scales
            if segments is not None:
                placed[which, :3, :3] *= _hermite(*segments.find(time))[:, None, :]
            which, segments = self._translations
            if segments is not None:
                placed[which, :3, 3] = _hermite(*segments.find(time))
        placed.flags.writeable = False
        self._latest["matrices"] = (time, placed)  # one assignment: safe from any thread
        return placed

    def matrix(self, chain: Chain, time: float) -> Float64:
        """(4, 4) float64 from the space of the chain's last element to the world."""
        product: Float64 | None = None
        for element in chain:
            if not isinstance(element, str):
                step = element
            elif element in self._numbers:
                step = self.matrices(time)[self._numbers[element]]
            else:
                continue
            with np.errstate(all="ignore"):
                product = step if product is None else product @ step
        return np.eye(4) if product is None else product.copy()

    def visible(self, chain: Chain, time: float) -> bool:
        """True where every named track of the chain is visible."""
        names = (e for e in chain if isinstance(e, str) and e in self.tracks)
        return all(self.tracks[name].visible(time) for name in names)

    def translation(self, name: str, time: float) -> Float64:
        """(3,) float64, of at most LARGEST; zero where no track of that name translates."""
        number = self._numbers.get(name)
        moved = np.zeros(3) if number is None else np.nan_to_num(self.matrices(time)[number, :3, 3])
        return np.clip(moved, -LARGEST, LARGEST)

    def camera(self, base: Camera, time: float) -> Camera:
        """`base` moved by the tracks named `camera`: they replace what they tell, and leave the rest."""
        tracks = self.tracks.get("camera")
        if tracks is None:
            return base
        position, direction, up = base.position, base.direction, base.up
        if tracks.translation is not None:
            position = vector(self.translation("camera", time))
        with np.errstate(all="ignore"):
            which, segments = self._rotations
            if tracks.rotation is not None and segments is not None:  # without its scale, which its matrix has
                rotation = _squad(*segments.find(time))[which.index(self._numbers["camera"])]
                rotation = rotation if np.isfinite(rotation).all() else np.eye(3)
                direction, up = vector(-rotation[:, 2]), vector(rotation[:, 1])
        return Camera(position, direction, up, base.angle)


class Chains:
    """The transform chains of n objects under an animation."""

    def __init__(self, animation: Animation, chains: Sequence[Chain]) -> None:
        self._animation = animation
        constants: dict[bytes, int] = {np.eye(4).tobytes(): 0}
        matrices = [np.eye(4)]
        numbers = {name: i for i, name in enumerate(animation.tracks)}
        # Node 0 is the identity; of the others parent, depth and step: a constant, or ~ the number of a track.
        nodes: dict[tuple[int, int], int] = {(0, 0): 0}
        depth = [0]
        self._leaf = np.zeros(len(chains), np.intp)
        for i, chain in enumerate(chains):
            node = 0
            for element in chain:
                if isinstance(element, str):
                    if element not in numbers:
                        continue  # names that no track bears mean the identity
                    step = ~numbers[element]
                else:
                    matrix = np.asarray(element, np.float64)
                    step = constants.setdefault(matrix.tobytes(), len(matrices))
                    matrices += [matrix] * (step == len(matrices))
                if (node, step) not in nodes:
                    nodes[node, step] = len(depth)
                    depth.append(depth[node] + 1)
                node = nodes[node, step]
            self._leaf[i] = node
        self._constants = np.stack(matrices)
        parents, steps = np.array(list(nodes)).T
        steps = np.where(steps < 0, len(matrices) + ~steps, steps)
        depths = np.array(depth)
        by_depth = np.split(np.argsort(depths, kind="stable"), np.cumsum(np.bincount(depths))[:-1])[1:]
        self._levels = [(level, parents[level], steps[level]) for level in by_depth]
        self._count = len(depth)
        hidden: dict[str, list[int]] = {}
        for i, chain in enumerate(chains):
            for name in {element for element in chain if isinstance(element, str)} & numbers.keys():
                hidden.setdefault(name, []).append(i)
        self._hidden_by: list[tuple[TrackSet, NDArray[np.int64]]] = [
            (animation.tracks[name], np.array(which, np.int64))
            for name, which in hidden.items()
            if animation.tracks[name].visibility is not None
        ]

    def matrices(self, time: float) -> Float64:
        """(n, 4, 4) from the space of each chain's last element to the world: what `Animation.matrix` gives of each."""
        steps = np.concatenate([self._constants, self._animation.matrices(time)])
        placed = np.empty((self._count, 4, 4))
        placed[0] = np.eye(4)
        for nodes, parents, which in self._levels:
            with np.errstate(all="ignore"):  # what grows beyond all numbers is not placed
                placed[nodes] = placed[parents] @ steps[which]
        return placed[self._leaf]

    def visible(self, time: float) -> NDArray[np.bool_]:
        """(n,) true where every named track of a chain is visible."""
        visible = np.ones(len(self._leaf), np.bool_)
        for tracks, objects in self._hidden_by:
            if not tracks.visible(time):
                visible[objects] = False
        return visible
