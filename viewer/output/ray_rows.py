"""A tree of rays in words: as rows, as the window lists it and the command line prints it.

A row has rows below it: a ray that was sent on, the shadow rays of a point, by light, and where there are many, those
that have the same fate together.  Rows below are made when somebody asks for them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.verdicts import Verdict
from tracer.reasons import MEANING, WHY_TRACED
from tracer.scene.lights import named_light
from tracer.scene.model import Scene
from tracer.told_rays import AWAY, TRACED, VERDICTS, PathRay, RayTree, ShadowRays
from tracer.why_in_words import primitive_in_words
from viewer.state.palette import Color
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


class Shown(StrEnum):
    """Which shadow rays are to be seen."""

    ALL = "all"
    TRACED = "traced"
    UNTRACED = "untraced"
    BLOCKED = "blocked"
    WRONG = "wrong"

    @property
    def meaning(self) -> str:
        return {
            Shown.ALL: "all lights, also those that the surface faces away from",
            Shown.TRACED: "shadow rays that were traced through the scene",
            Shown.UNTRACED: "shadow rays that were due and not traced: culled, dynamic only, candidates and cache",
            Shown.BLOCKED: "shadow rays that do not reach their light",
            Shown.WRONG: "shadow rays with a wrong answer",
        }[self]


class Filter(NamedTuple):
    """Which shadow rays are to be seen, and of which light, None for all."""

    shown: Shown = Shown.ALL
    light: int | None = None

    def places(self, rays: ShadowRays) -> NDArray[np.int64]:
        """The places of the rays that are to be seen."""
        kept = {
            Shown.ALL: np.ones(len(rays.light), np.bool_),
            Shown.TRACED: rays.verdict == TRACED,
            Shown.UNTRACED: (rays.verdict != TRACED) & (rays.verdict != AWAY),
            Shown.BLOCKED: (rays.verdict != AWAY) & ~rays.lit,
            Shown.WRONG: rays.wrong,
        }[self.shown]
        return np.flatnonzero(kept if self.light is None else kept & (rays.light == self.light))


GREY: Color = (0.52, 0.55, 0.60)
LIT: Color = (0.94, 0.89, 0.26)
DARK: Color = (0.34, 0.71, 0.91)
PARTLY: Color = (0.90, 0.55, 0.20)
WRONG: Color = (1.0, 0.0, 0.66)


def color_of(rays: ShadowRays, places: Places) -> Color:
    """Yellow for what is lit, blue for what is dark, orange where both are, grey for what was not asked, magenta for
    what is wrong."""
    due = places[rays.verdict[places] != AWAY]
    if not len(due):
        return GREY
    if rays.wrong[due].any():
        return WRONG
    return LIT if rays.lit[due].all() else PARTLY if rays.lit[due].any() else DARK


MOST_LIGHTS = 12
"""Lights of a point that have a row each; of more, those with the same fate have one together."""
MOST_NAMED = 3  # primitives that are named in a row
PATH_COLOR: Color = (0.86, 0.88, 0.92)

Key = tuple[int | str, ...]
Places = NDArray[np.int64]
Fate = tuple[int, int, str, int, str]  # verdict, lit, what blocks it, wrong, what was known


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class Row:
    """`ray` is the path ray it is about, and `places` are the shadow rays of that which it stands for, none for the
    path ray itself; `tip` says more about it."""

    key: Key
    text: str
    tip: str
    color: Color
    ray: int
    places: Places = field(default_factory=lambda: np.empty(0, np.int64))
    below: Callable[[], list[Row]] | None = None

    @cached_property
    def rows(self) -> list[Row]:
        """What is below it."""
        return [] if self.below is None else self.below()


class RayRows:
    """The rows of a tree of rays of a scene, as a filter lets them be seen."""

    def __init__(self, tree: RayTree, scene: Scene, shown: Filter) -> None:
        self.tree, self._scene, self._filter = tree, scene, shown

    @cached_property
    def top(self) -> list[Row]:
        """The primary ray's row."""
        return [self._path(number) for number in self.tree.children.get(-1, ())]

    def _path(self, number: int) -> Row:
        """A ray on its way, and below it its shadow rays and the rays that it sends on."""
        ray = self.tree.rays[number]
        met = "leaves the scene" if ray.primitive < 0 else f"{self.name(ray.primitive)} at {ray.t:.4g}"
        tip = [
            f"ray {ray.number}, bounce {ray.bounce}; weight {ray.weight.max():.3g}; "
            f"{count(ray.steps)} steps and {count(ray.tests)} tests, traced alone",
            "adds ({:.3g}, {:.3g}, {:.3g}) to the pixel".format(*ray.light),
        ]
        if ray.shadows is not None:
            tip.append("shadow rays: " + self.summary(ray.shadows, np.arange(len(ray.shadows.light))))
        text, key = f"{ray.kind.value} ray: {met}", ("ray", number)
        return Row(key, text, "\n".join(tip), PATH_COLOR, number, below=lambda: self._below(ray, key))

    def _below(self, ray: PathRay, key: Key) -> list[Row]:
        found, s = [], ray.shadows
        if s is not None:
            places = self._filter.places(s)
            many = len(np.unique(s.light[places])) > MOST_LIGHTS
            found = (self._fates if many else self._lights)(ray, s, places, key)
        return found + [self._path(number) for number in self.tree.children.get(ray.number, ())]

    # --- shadow rays: by light, by what became of them, and one by one ---------------------------------

    def _lights(self, ray: PathRay, s: ShadowRays, places: Places, above: Key) -> list[Row]:
        """A row for each light."""
        own = np.split(places, np.flatnonzero(np.diff(s.light[places])) + 1) if len(places) else []
        return [self._group(ray, s, of, (*above, "light", int(s.light[of[0]])), self._light(s, of[0])) for of in own]

    def _fates(self, ray: PathRay, s: ShadowRays, places: Places, above: Key) -> list[Row]:
        """A row for those with each fate."""
        one, rows = len(np.unique(s.light[places])) == 1, []
        for fate, same in sorted(self._by_fate(s, places).items()):
            name = "" if len(same) > 1 else self._sample(s, same[0]) if one else self._light(s, same[0])
            rows.append(self._group(ray, s, np.array(same), (*above, "fate", *fate), name))
        return rows

    def _samples(self, ray: PathRay, s: ShadowRays, places: Places, above: Key) -> list[Row]:
        """A row for each sample of a light."""
        return [self._single(ray, s, place, (*above, place), self._sample(s, place)) for place in places.tolist()]

    def _group(self, ray: PathRay, s: ShadowRays, places: Places, key: Key, name: str) -> Row:
        """A row for several: of those alike what they share, else how many have which fate; of one its own."""
        first, named = int(places[0]), f"{name}: " if name else ""
        one = len(np.unique(s.light[places])) == 1
        if len(places) == 1:
            return self._single(ray, s, first, key, name)
        fates = list(self._by_fate(s, places))
        if len(fates) > 1:
            text, tip, below = f"{named}{self.summary(s, places)}", "", partial(self._fates, ray, s, places, key)
        else:
            what = "samples" if one else "rays"
            text = f"{named}{count(len(places))} {what} {self.fate(s, places, fates[0][2])}"
            tip = MEANING[VERDICTS[s.verdict[first]]]
            below = partial(self._samples if one else self._lights, ray, s, places, key)
        away = one and (s.verdict[places] == AWAY).all()
        return Row(key, text, tip, color_of(s, places), ray.number, places, None if away else below)

    def _single(self, ray: PathRay, s: ShadowRays, place: int, key: Key, name: str) -> Row:
        places = np.array([place])
        text = f"{name}: {self.fate(s, places)}"
        return Row(key, text, self._tip(s, place), color_of(s, places), ray.number, places)

    def _by_fate(self, s: ShadowRays, places: Places) -> dict[Fate, list[int]]:
        """The places with each fate; what blocks them counts where they are of one light."""
        fates: dict[Fate, list[int]] = {}
        one = len(np.unique(s.light[places])) == 1
        for place in places.tolist():
            blocked = one and s.verdict[place] != AWAY and not s.lit[place] and s.blocker[place] >= 0
            by = self._scene.name_of(int(s.blocker[place])) if blocked else ""
            fate = int(s.verdict[place]), int(s.lit[place]), by, int(s.wrong[place]), s.known.get(place, "")
            fates.setdefault(fate, []).append(place)
        return fates

    # --- words -----------------------------------------------------------------------------------------

    def fate(self, s: ShadowRays, places: Places, by: str = "") -> str:
        """What became of a shadow ray in words, or of several with the same fate, `by` the object that blocks them."""
        place, alike = int(places[0]), len(places) > 1
        verdict, text = VERDICTS[s.verdict[place]], SAID[VERDICTS[s.verdict[place]]]
        if not verdict.due:
            return text
        shared = f"blocked by {by}" if by else "in shadow"
        text += f" ({s.known[place]})" if place in s.known else ""
        text += ", lit" if s.lit[place] else f", {shared if alike else self._blocked(s, place)}"
        text += " (wrong)" if s.wrong[place] else ""
        if verdict is Verdict.TRACED:
            text += f"; {several(s.steps[places].sum(), 'step')}, {several(s.tests[places].sum(), 'test')}"
        return text

    def _blocked(self, s: ShadowRays, place: int) -> str:
        return f"blocked by {self.name(int(s.blocker[place]))}" if s.blocker[place] >= 0 else "in shadow by its mode"

    def _tip(self, s: ShadowRays, place: int) -> str:
        verdict = VERDICTS[s.verdict[place]]
        parts = [WHY_TRACED.get(s.known.get(place, ""), MEANING[verdict])]
        if place in s.told:
            parts.append(s.told[place])
        if place in s.named:
            names = [self.name(number) for number in s.named[place][:MOST_NAMED]]
            more = len(s.named[place]) - len(names)
            parts.append("Named: " + ", ".join(names) + (f" and {more} more." if more else "."))
        if s.asked_moving[place]:
            parts.append(f"Testing dynamic objects took {s.steps[place]} steps and {s.tests[place]} tests.")
        if verdict is Verdict.TRACED and s.met[place] not in (-1, s.blocker[place]):
            parts.append(f"Tracing hit {self.name(int(s.met[place]))} first.")
        if s.wrong[place]:
            truth = f"it is {self._blocked(s, place)}" if s.blocker[place] >= 0 else "nothing blocks the ray"
            parts.append(f"This answer is wrong: {truth}.")
        return "\n".join(parts)

    def summary(self, s: ShadowRays, places: Places) -> str:
        """How many of some shadow rays have each verdict, and how many of these are lit."""
        parts = []
        for number in np.unique(s.verdict[places]):
            same = places[s.verdict[places] == number]
            lit = int(s.lit[same].sum())
            parts.append(f"{count(len(same))} {SAID[VERDICTS[number]]}" + (f" ({count(lit)} lit)" if lit else ""))
        return ", ".join(parts)

    def name(self, primitive: int) -> str:
        """A primitive as people find it again."""
        return primitive_in_words(self._scene, primitive)

    def _light(self, s: ShadowRays, place: int) -> str:
        return named_light(self._scene.lights, int(s.light[place]))

    def _sample(self, s: ShadowRays, place: int) -> str:
        return f"sample {place - s.of_light(int(s.light[place])).start}"


def unfolded(rows: list[Row], is_open: Callable[[Row], bool], level: int = 0) -> Iterator[tuple[int, Row]]:
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
