"""A tree of rays in words: as rows, as the window lists it and the command line prints it.

A row has rows below it: a ray that was sent on, the shadow rays of a point, by light, and where there are many, those
that have the same fate together.  Rows below are made when somebody asks for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.verdicts import Verdict
from tracer.inspect.path_records import AWAY, TRACED, VERDICTS, RayTree, ShadowRays
from tracer.inspect.reasons import MEANING, WHY_TRACED
from tracer.inspect.why_in_words import primitive_in_words
from tracer.scene.lights import named_light
from tracer.scene.model import Scene
from viewer.state.palette import BLOCKED, LIT, PARTLY_LIT, PATH, UNKNOWN, WRONG, Color
from viewer.util.numbers import count, several

SAID: dict[Verdict, str] = {
    Verdict.AWAY: "surface faces away",
    Verdict.PASSED_OVER: "light hidden from the region",
    Verdict.FULL_SHADOW: "culled by FULL_SHADOW",
    Verdict.NON_SHADOW: "dynamic only by NON_SHADOW",
    Verdict.CERTIFIED_FULL: "culled by certificate full",
    Verdict.CERTIFIED_LIT: "dynamic only by certificate lit",
    Verdict.CANDIDATES: "candidates only",
    Verdict.BEAM: "culled by a beam",
    Verdict.CACHED: "cached occluder",
    Verdict.BUFFER_LIT: "light buffer: nothing in front",
    Verdict.BUFFER_FULL: "light buffer: behind what covers the cell",
    Verdict.BUFFER_TESTED: "light buffer: candidates only",
    Verdict.VOXEL_LIT: "lit voxel",
    Verdict.VOXEL_FULL: "full voxel",
    Verdict.VOXEL_WALK: "walk through voxels",
    Verdict.CELL_LIT: "lit cell",
    Verdict.CELL_FULL: "light hidden from the cell",
    Verdict.CELL_TESTED: "blockers of the cell only",
    Verdict.ANSWERED: "culled",
    Verdict.TRACED: "traced",
}


class RaySubset(StrEnum):
    """Which shadow rays are to be seen."""

    ALL = "all"
    TRACED = "traced"
    UNTRACED = "untraced"
    BLOCKED = "blocked"
    WRONG = "wrong"


SUBSET_HELP: dict[RaySubset, str] = {
    RaySubset.ALL: "all lights, also those that the surface faces away from",
    RaySubset.TRACED: "shadow rays that were traced through the scene",
    RaySubset.UNTRACED: "shadow rays that were due and not traced: culled, dynamic only, candidates and cache",
    RaySubset.BLOCKED: "shadow rays that do not reach their light",
    RaySubset.WRONG: "shadow rays with a wrong answer",
}


class RayFilter(NamedTuple):
    """Which shadow rays are to be seen, and of which light, None for all."""

    shown: RaySubset = RaySubset.ALL
    light: int | None = None

    def places(self, rays: ShadowRays) -> NDArray[np.int64]:
        """The places of the rays that are to be seen."""
        kept = {
            RaySubset.ALL: np.ones(len(rays.light), np.bool_),
            RaySubset.TRACED: rays.verdict == TRACED,
            RaySubset.UNTRACED: (rays.verdict != TRACED) & (rays.verdict != AWAY),
            RaySubset.BLOCKED: (rays.verdict != AWAY) & ~rays.lit,
            RaySubset.WRONG: rays.wrong,
        }[self.shown]
        return np.flatnonzero(kept if self.light is None else kept & (rays.light == self.light))


def color_of(rays: ShadowRays, places: Places) -> Color:
    """Return the colour of shadow rays by where they end; grey where none is due, magenta where any is wrong."""
    due = places[rays.verdict[places] != AWAY]
    if not len(due):
        return UNKNOWN
    if rays.wrong[due].any():
        return WRONG
    return LIT if rays.lit[due].all() else PARTLY_LIT if rays.lit[due].any() else BLOCKED


MOST_LIGHTS = 12
"""Lights of a point that have a row each; of more, those with the same fate have one together."""
MOST_NAMED = 3  # primitives that are named in a row

RayKey = tuple[int | str, ...]
Places = NDArray[np.int64]
Outcome = tuple[int, int, str, int, str]  # verdict, lit, what blocks it, wrong, what was known


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class RayRow:
    """`ray` is the path ray it is about, and `places` are the shadow rays of that which it stands for, none for the
    path ray itself; `tip` says more about it."""

    key: RayKey
    text: str
    tip: str
    color: Color
    ray: int
    places: Places = field(default_factory=lambda: np.empty(0, np.int64))
    below: Callable[[], list[RayRow]] | None = None

    @cached_property
    def rows(self) -> list[RayRow]:
        """What is below it."""
        return [] if self.below is None else self.below()


class RayRows:
    """The rows of a tree of rays of a scene, as a filter lets them be seen."""

    def __init__(self, tree: RayTree, scene: Scene, shown: RayFilter) -> None:
        self.tree, self._scene, self._filter = tree, scene, shown

    @cached_property
    def top(self) -> list[RayRow]:
        """The primary ray's row."""
        return [self._path(number) for number in self.tree.children.get(-1, ())]

    def _path(self, number: int) -> RayRow:
        """A ray on its way, and below it its shadow rays and the rays that it sends on."""
        ray = self.tree.rays[number]
        met = "leaves the scene" if ray.primitive < 0 else f"{self._name(ray.primitive)} at {ray.t:.4g}"
        tip = [
            f"ray {ray.number}, bounce {ray.bounce}; weight {ray.weight.max():.3g}; "
            f"{several(ray.steps, 'step')} and {several(ray.tests, 'test')}, traced alone",
            "adds ({:.3g}, {:.3g}, {:.3g}) to the pixel".format(*ray.light),
        ]
        if ray.shadows is not None:
            tip.append("shadow rays: " + self._summary(ray.shadows, np.arange(len(ray.shadows.light))))
        text, key = f"{ray.kind.value} ray: {met}", ("ray", number)

        def below() -> list[RayRow]:
            s = ray.shadows
            shadows = [] if s is None else self._shadows(number, s, self._filter.places(s), key, of_point=True)
            return shadows + [self._path(one) for one in self.tree.children.get(number, ())]

        return RayRow(key, text, "\n".join(tip), PATH, number, below=below)

    def _shadows(self, ray: int, s: ShadowRays, places: Places, above: RayKey, of_point: bool = False) -> list[RayRow]:
        """Rows of shadow rays: those of a point by light, or of many lights by what became of them; below that those of
        a light by what became of them, and those with the same fate one by one."""
        outcomes, lights = self._by_outcome(s, places), len(np.unique(s.light[places]))
        if lights <= MOST_LIGHTS if of_point else lights > 1 and len(outcomes) == 1:
            own = np.split(places, np.flatnonzero(np.diff(s.light[places])) + 1) if len(places) else []
            return [
                self._group(ray, s, of, (*above, "light", int(s.light[of[0]])), self._light(s, of[0])) for of in own
            ]
        name, rows = self._light if lights > 1 else self._sample, []
        if len(outcomes) > 1 or of_point:
            for one, same in sorted(outcomes.items()):
                named = name(s, same[0]) if len(same) == 1 else ""
                rows.append(self._group(ray, s, np.array(same), (*above, "fate", *one), named))
            return rows
        return [self._group(ray, s, np.array([one]), (*above, one), self._sample(s, one)) for one in places.tolist()]

    def _group(self, ray: int, s: ShadowRays, places: Places, key: RayKey, name: str) -> RayRow:
        """A row for shadow rays: of those alike what they share, else how many have which fate."""
        first, outcomes = int(places[0]), list(self._by_outcome(s, places))
        one_light = bool((s.light[places] == s.light[first]).all())
        if len(places) == 1:
            text, tip = self._fate(s, places), self._tip(s, first)
        elif len(outcomes) > 1:
            text, tip = self._summary(s, places), ""
        else:
            what, by = "samples" if one_light else "rays", outcomes[0][2]
            text, tip = f"{count(len(places))} {what} {self._fate(s, places, by)}", MEANING[VERDICTS[s.verdict[first]]]
        folds = len(places) > 1 and not (one_light and (s.verdict[places] == AWAY).all())
        below = partial(self._shadows, ray, s, places, key) if folds else None
        return RayRow(key, f"{name}: {text}" if name else text, tip, color_of(s, places), ray, places, below)

    def _by_outcome(self, s: ShadowRays, places: Places) -> dict[Outcome, list[int]]:
        """The places with each fate; what blocks them counts where they are of one light."""
        outcomes: dict[Outcome, list[int]] = {}
        one = len(np.unique(s.light[places])) == 1
        for place in places.tolist():
            blocked = one and s.verdict[place] != AWAY and not s.lit[place] and s.blocker[place] >= 0
            by = self._scene.name_of(int(s.blocker[place])) if blocked else ""
            outcome = int(s.verdict[place]), int(s.lit[place]), by, int(s.wrong[place]), s.reason(place).known
            outcomes.setdefault(outcome, []).append(place)
        return outcomes

    # --- words -----------------------------------------------------------------------------------------

    def _fate(self, s: ShadowRays, places: Places, by: str = "") -> str:
        """What became of a shadow ray in words, or of several with the same fate, `by` the object that blocks them."""
        place, alike = int(places[0]), len(places) > 1
        verdict, text = VERDICTS[s.verdict[place]], SAID[VERDICTS[s.verdict[place]]]
        if not verdict.due:
            return text
        shared = f"blocked by {by}" if by else "in shadow"
        text += f" ({known})" if (known := s.reason(place).known) else ""
        text += ", lit" if s.lit[place] else f", {shared if alike else self._blocked(s, place)}"
        text += " (wrong)" if s.wrong[place] else ""
        if verdict is Verdict.TRACED:
            text += f"; {several(s.steps[places].sum(), 'step')}, {several(s.tests[places].sum(), 'test')}"
        return text

    def _blocked(self, s: ShadowRays, place: int) -> str:
        return f"blocked by {self._name(int(s.blocker[place]))}" if s.blocker[place] >= 0 else "in shadow by its mode"

    def _tip(self, s: ShadowRays, place: int) -> str:
        verdict, reason = VERDICTS[s.verdict[place]], s.reason(place)
        parts = [WHY_TRACED.get(reason.known, MEANING[verdict])]
        if reason.told:
            parts.append(reason.told)
        if reason.named:
            names = [self._name(number) for number in reason.named[:MOST_NAMED]]
            more = len(reason.named) - len(names)
            parts.append("Named: " + ", ".join(names) + (f" and {more} more." if more else "."))
        if s.asked_moving[place]:
            parts.append(
                f"Asking dynamic objects: {several(s.steps[place], 'step')}, {several(s.tests[place], 'test')}."
            )
        if verdict is Verdict.TRACED and s.met[place] not in (-1, s.blocker[place]):
            parts.append(f"Tracing hit {self._name(int(s.met[place]))} first.")
        if s.wrong[place]:
            truth = f"it is {self._blocked(s, place)}" if s.blocker[place] >= 0 else "nothing blocks the ray"
            parts.append(f"This answer is wrong: {truth}.")
        return "\n".join(parts)

    def _summary(self, s: ShadowRays, places: Places) -> str:
        """How many of some shadow rays have each verdict, and how many of these are lit."""
        parts = []
        for number in np.unique(s.verdict[places]):
            same = places[s.verdict[places] == number]
            lit = int(s.lit[same].sum())
            parts.append(f"{count(len(same))} {SAID[VERDICTS[number]]}" + (f" ({count(lit)} lit)" if lit else ""))
        return ", ".join(parts)

    def _name(self, primitive: int) -> str:
        """A primitive as people find it again."""
        return primitive_in_words(self._scene, primitive)

    def _light(self, s: ShadowRays, place: int) -> str:
        return named_light(self._scene.lights, int(s.light[place]))

    def _sample(self, s: ShadowRays, place: int) -> str:
        return f"sample {place - s.of_light(int(s.light[place])).start}"


def unfolded(rows: list[RayRow], is_open: Callable[[RayRow], bool], level: int = 0) -> Iterator[tuple[int, RayRow]]:
    """The rows that are seen where some are open, each with its level."""
    for row in rows:
        yield level, row
        if row.below is not None and is_open(row):
            yield from unfolded(row.rows, is_open, level + 1)


def totals(tree: RayTree) -> str:
    """All shadow rays of the tree in a line."""
    paths = f"{count(len(tree.rays))} {'ray' if len(tree.rays) == 1 else 'rays'}"
    said = ", ".join(f"{count(number)} {SAID[verdict]}" for verdict, number in tree.counts.items() if verdict.due)
    return f"{paths} and {count(tree.due)} shadow rays that are due" + (f": {said}" if said else "")
