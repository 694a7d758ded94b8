"""What became of a shadow ray, in words and colours, and which of them are to be seen."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.verdicts import Verdict
from tracer.told_rays import AWAY, TRACED, ShadowRays
from viewer.state.palette import Color

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
        if self.light is not None:
            kept = kept & (rays.light == self.light)
        return np.flatnonzero(kept)


GREY: Color = (0.52, 0.55, 0.60)
LIT: Color = (0.94, 0.89, 0.26)
DARK: Color = (0.34, 0.71, 0.91)
PARTLY: Color = (0.90, 0.55, 0.20)
WRONG: Color = (1.0, 0.0, 0.66)


def color_of(rays: ShadowRays, place: int) -> Color:
    """Yellow for what is lit, blue for what is dark, grey for what was not asked, magenta for what is wrong."""
    if rays.wrong[place]:
        return WRONG
    if rays.verdict[place] == AWAY:
        return GREY
    return LIT if rays.lit[place] else DARK


def color_of_all(rays: ShadowRays, places: NDArray[np.int64]) -> Color:
    """The colour of those that share one; orange where some are lit and others are not."""
    colors = {color_of(rays, place) for place in places.tolist()} - {GREY}
    if WRONG in colors:
        return WRONG
    return PARTLY if len(colors) > 1 else next(iter(colors), GREY)
