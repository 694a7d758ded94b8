"""What edits of the scene have changed from one frame to another: pixels, modes, certificates, counters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.scene.edits import Edited
from tracer.statistics import FrameStatistics
from viewer.state.palette import WRONG, Certificate
from viewer.state.readings import has_modes_of_cells

DIMMED, LEAST = 0.3, 0.25
"""Brightness of the picture beneath changed pixels, and how strong the colour is of those that have changed least."""


class Counter(NamedTuple):
    """A counter before and after."""

    name: str
    before: int
    after: int


@dataclass(frozen=True)
class Transitions:
    """How many primitives, or pixels, went from each state to each: counts (n, n), row before, column after.

    `light` is its number in the scene as it was read, None where no light is concerned; only what is known before and
    after is counted."""

    light: int | None
    names: tuple[str, ...]
    counts: NDArray[np.int64]

    @property
    def changed(self) -> int:
        return int(self.counts.sum() - np.trace(self.counts))

    def pairs(self) -> list[tuple[str, str, int]]:
        """(before, after, how many) of all that changed, the most first."""
        found = [
            (self.names[i], self.names[k], int(self.counts[i, k]))
            for i, k in zip(*np.nonzero(self.counts), strict=True)
            if i != k
        ]
        return sorted(found, key=lambda one: -one[2])


@dataclass(frozen=True)
class Effects:
    """`changes` (h, w) uint8 are the largest differences of each pixel's channels on the screen, None where the
    pictures do not have the same samples; `exact` is how many pixels have another linear colour.  What has no modes, or
    no certificates, has none of these lists."""

    changes: NDArray[np.uint8] | None
    exact: int
    counters: tuple[Counter, ...]
    occlusion: Transitions | None = None
    shadows: tuple[Transitions, ...] = ()
    certificates: tuple[Transitions, ...] = ()

    @property
    def pixels(self) -> int:
        """How many have another colour on the screen."""
        return int(np.count_nonzero(self.changes)) if self.changes is not None else 0

    @property
    def most(self) -> int:
        """The largest difference of a channel on the screen, 0 to 255."""
        return int(self.changes.max(initial=0)) if self.changes is not None else 0


def same_place(one: Frame, other: Frame) -> bool:
    """Whether two frames are of the same moment from the same place, in the same size."""
    return (one.time, one.camera, one.width, one.height) == (other.time, other.camera, other.width, other.height)


def effects(before: Frame, of: Edited, after: Frame, now: Edited) -> Effects:
    """From a frame of a scene to one of the same scene edited otherwise, both of the same place."""
    changes, exact = None, 0
    if before.settings.samples == after.settings.samples:
        exact = int((before.color != after.color).any(axis=-1).sum())
        changes = np.abs(before.pixels.astype(np.int16) - after.pixels).max(axis=-1).astype(np.uint8)
    occlusion, shadows = _of_modes(before, of, after, now)
    certificates = _of_certificates(before, of, after, now)
    return Effects(changes, exact, _counters(before.statistics, after.statistics), occlusion, shadows, certificates)


def _of_modes(
    before: Frame, of: Edited, after: Frame, now: Edited
) -> tuple[Transitions | None, tuple[Transitions, ...]]:
    """Of all primitives that are in both scenes."""
    frames = before, after
    if not all(frame.settings.keeps_modes for frame in frames) or any(has_modes_of_cells(frame) for frame in frames):
        return None, ()
    old = of.numbers[now.primitives]
    here = old >= 0
    words = before.modes[old[here]], after.modes[here]
    names = tuple(_said(mode.name) for mode in OcclusionMode)
    first, second = (modes.occlusion_mode(word) for word in words)
    occlusion = Transitions(None, names, _pairs(first, second, len(names)))
    names, found = tuple(_said(mode.name) for mode in ShadowMode), []
    for number, old_light, light in _lights_of_both(of, now):
        if modes.has_shadow_mode(before.modes, old_light) and modes.has_shadow_mode(after.modes, light):
            pair = modes.shadow_mode(words[0], old_light), modes.shadow_mode(words[1], light)
            found.append(Transitions(number, names, _pairs(pair[0], pair[1], len(names))))
    return occlusion, tuple(found)


def _of_certificates(before: Frame, of: Edited, after: Frame, now: Edited) -> tuple[Transitions, ...]:
    """Of the pixels that show the same primitive in both pictures."""
    if before.certificates is None or after.certificates is None:
        return ()
    old, new = before.primitive, after.primitive
    known = (old >= 0) & (new >= 0)
    known[known] = of.primitives[old[known]] == now.primitives[new[known]]
    words = before.certificates[known], after.certificates[known]
    names, found = tuple(_said(one.name) for one in Certificate), []
    for number, first, second in _lights_of_both(of, now):
        if modes.has_shadow_mode(before.certificates, first) and modes.has_shadow_mode(after.certificates, second):
            pair = modes.shadow_mode(words[0], first), modes.shadow_mode(words[1], second)
            found.append(Transitions(number, names, _pairs(pair[0], pair[1], len(names))))
    return tuple(found)


def _lights_of_both(of: Edited, now: Edited) -> list[tuple[int, int, int]]:
    """(number in the scene as it was read, number before, number after) of the lights that are on in both."""
    pairs = ((n, of.light_here(n), k) for k, n in enumerate(now.lights[: modes.MAX_CULLED_LIGHTS].tolist()))
    return [(n, first, k) for n, first, k in pairs if first >= 0]


def _pairs(before: NDArray[np.uint8], after: NDArray[np.uint8], kinds: int) -> NDArray[np.int64]:
    places = before.astype(np.int64) * kinds + after
    return np.bincount(places.reshape(-1), minlength=kinds * kinds).reshape(kinds, kinds)


def _said(name: str) -> str:
    return name.replace("_", " ").lower()


def _counters(before: FrameStatistics, after: FrameStatistics) -> tuple[Counter, ...]:
    def of(s: FrameStatistics) -> dict[str, int]:
        return {
            "due": s.shadow.due,
            "culled": s.shadow.culled,
            "dynamic only": s.shadow.dynamic_only,
            "candidates": s.shadow.candidates_only,
            "traced": s.shadow.traced,
            "steps": s.traversal_steps,
            "tests": s.intersection_tests,
            "certified": s.certificates,
        }

    first, second = of(before), of(after)
    return tuple(Counter(name, first[name], second[name]) for name in first)


def picture_of(frame: Frame, changes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(h, w, 3) uint8: the picture dimmed, and changed pixels the brighter in magenta the more they have changed."""
    drawn = (frame.pixels * DIMMED).astype(np.float32)
    changed = changes > 0
    strength = LEAST + (1.0 - LEAST) * np.sqrt(changes[changed] / max(1, int(changes.max(initial=0))))
    drawn[changed] = strength[:, None] * 255.0 * np.array(WRONG) + (1.0 - strength[:, None]) * drawn[changed]
    return drawn.astype(np.uint8)
