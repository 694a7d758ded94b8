"""What edits of the scene have changed: the newest picture beside the one before the edits, which is kept for that."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.scene.edits import NO_EDITS, Edited
from viewer.services.editing import Editing
from viewer.state.palette import Certificate
from viewer.state.picking import same_place
from viewer.state.readings import has_modes_of_cells
from viewer.state.session import Session

COUNTERS = {
    "due": "shadow.due", "culled": "shadow.culled", "dynamic only": "shadow.dynamic_only",
    "candidates": "shadow.candidates_only", "traced": "shadow.traced", "steps": "traversal_steps",
    "tests": "intersection_tests", "certified": "certificates",
}  # fmt: skip
"""Counters that are compared, each with its place in the statistics of a frame."""


class Lack(Enum):
    """Why nothing can be compared now."""

    NONE = ""
    NO_EDITS = "Nothing is edited."
    NO_FRAME = "The picture is being traced."
    ELSEWHERE = "There is no picture without the edits from here, at this time and in this size."


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
        changed = [(i, k) for i, k in zip(*np.nonzero(self.counts), strict=True) if i != k]
        found = [(self.names[i], self.names[k], int(self.counts[i, k])) for i, k in changed]
        return sorted(found, key=lambda one: -one[2])


@dataclass(frozen=True)
class Effects:
    """`changes` (h, w) uint8 are the largest differences of each pixel's channels on the screen, None where the
    pictures do not have the same samples; `exact` is how many pixels have another linear colour.  What has no modes, or
    no certificates, has none of these lists."""

    changes: NDArray[np.uint8] | None
    exact: int
    counters: tuple[Counter, ...]
    occlusion: Transitions | None
    shadows: tuple[Transitions, ...]
    certificates: tuple[Transitions, ...]

    @property
    def pixels(self) -> int:
        """How many have another colour on the screen."""
        return int(np.count_nonzero(self.changes)) if self.changes is not None else 0

    @property
    def most(self) -> int:
        """The largest difference of a channel on the screen, 0 to 255."""
        return int(self.changes.max(initial=0)) if self.changes is not None else 0


def effects(before: Frame, of: Edited, after: Frame, now: Edited) -> Effects:
    """From a frame of a scene to one of the same scene edited otherwise, both of the same place."""
    changes, exact = None, 0
    if before.settings.samples == after.settings.samples:
        exact = int((before.color != after.color).any(axis=-1).sum())
        changes = np.abs(before.pixels.astype(np.int16) - after.pixels).max(axis=-1).astype(np.uint8)
    places = {name: attrgetter(path) for name, path in COUNTERS.items()}
    counters = tuple(Counter(name, at(before.statistics), at(after.statistics)) for name, at in places.items())
    return Effects(
        changes, exact, counters, *_of_modes(before, of, after, now), _of_certificates(before, of, after, now)
    )


def _of_modes(
    before: Frame, of: Edited, after: Frame, now: Edited
) -> tuple[Transitions | None, tuple[Transitions, ...]]:
    """Of all primitives that are in both scenes."""
    frames = before, after
    if not all(frame.settings.keeps_modes for frame in frames) or any(has_modes_of_cells(frame) for frame in frames):
        return None, ()
    old = of.numbers[now.primitives]
    then, here = before.modes[old[old >= 0]], after.modes[old >= 0]
    occlusion = _transitions(None, OcclusionMode, modes.occlusion_mode(then), modes.occlusion_mode(here))
    return occlusion, _by_light(of, now, ShadowMode, then, here)


def _of_certificates(before: Frame, of: Edited, after: Frame, now: Edited) -> tuple[Transitions, ...]:
    """Of the pixels that show the same primitive in both pictures."""
    if before.certificates is None or after.certificates is None:
        return ()
    old, new = before.primitive, after.primitive
    same = (old >= 0) & (new >= 0)
    same[same] = of.primitives[old[same]] == now.primitives[new[same]]
    return _by_light(of, now, Certificate, before.certificates[same], after.certificates[same])


def _by_light(
    of: Edited, now: Edited, states: type[IntEnum], before: NDArray, after: NDArray
) -> tuple[Transitions, ...]:
    """Of each light that is on in both scenes, where both have words for it."""
    found = []
    for here, number in enumerate(now.lights[: modes.MAX_CULLED_LIGHTS].tolist()):
        then = of.light_here(number)
        if then >= 0 and modes.has_shadow_mode(before, then) and modes.has_shadow_mode(after, here):
            pair = modes.shadow_mode(before, then), modes.shadow_mode(after, here)
            found.append(_transitions(number, states, *pair))
    return tuple(found)


def _transitions(light: int | None, states: type[IntEnum], before: NDArray, after: NDArray) -> Transitions:
    n, names = len(states), tuple(state.name.replace("_", " ").lower() for state in states)
    counts = np.bincount((before.astype(np.int64) * n + after).reshape(-1), minlength=n * n)
    return Transitions(light, names, counts.reshape(n, n))


class BeforeEdits:
    """Keeps whole frames of the scene as it was read; `effects` compares the newest frame with them."""

    def __init__(self, session: Session, editing: Editing) -> None:
        self._session, self._editing = session, editing
        self.forget()

    def forget(self) -> None:
        """Another scene is open."""
        self._kept: dict[int, Frame] = {}  # by samples of a pixel: all of one moment, place and size
        self._of: Edited | None = None
        self._now: Frame | None = None
        self._edits = NO_EDITS  # those that are put aside
        self._found: tuple[Frame, Frame, Effects] | None = None

    def take(self, whole: Frame | None, settled: bool) -> None:
        """Take up the newest whole frame, None where that is not of the scene as it is edited now; `settled` says that
        no better one is to come."""
        session, editing, edited = self._session, self._editing, self._session.edited
        if session.edits != self._edits:
            editing.put_aside = False  # somebody wants others
        self._now = whole if not editing.under_way else None
        if whole is None or edited is None or edited.edits:
            return
        if any(not same_place(kept, whole) for kept in self._kept.values()):
            self._kept = {}
        self._kept[whole.settings.samples], self._of = whole, edited
        if settled:
            editing.put_aside = False

    def take_anew(self) -> None:
        """Put the edits aside until a picture without them has come from here, or other edits are wanted."""
        if self._session.edits:
            self._edits = self._session.edits
            self._editing.show_without()

    @property
    def taking(self) -> bool:
        """Whether the edits are put aside for a moment."""
        return self._editing.put_aside

    @property
    def lack(self) -> Lack:
        """Why there is nothing to compare."""
        if not self._session.edits:
            return Lack.NO_EDITS
        if self._now is None:
            return Lack.NO_FRAME
        return Lack.NONE if self._reference is not None else Lack.ELSEWHERE

    @property
    def _reference(self) -> Frame | None:
        """The kept frame that is most like the newest: of as many samples, if there is one."""
        now = self._now
        if now is None or not self._kept:
            return None
        found = self._kept.get(now.settings.samples) or next(iter(self._kept.values()))
        return found if same_place(found, now) else None

    @property
    def frame(self) -> Frame | None:
        """The newest frame, where it can be compared."""
        return self._now if self.lack is Lack.NONE else None

    @property
    def effects(self) -> Effects | None:
        """What has changed; None where there is nothing to compare (`lack`)."""
        before, now, edited = self._reference, self.frame, self._session.edited
        if before is None or now is None or edited is None or self._of is None:
            return None
        if self._found is None or self._found[0] is not before or self._found[1] is not now:
            self._found = before, now, effects(before, self._of, now, edited)
        return self._found[2]
