"""What became of a shadow ray, in words and colours, and which of them are to be seen."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.culling.verdicts import Verdict
from tracer.ray_reasons import unused
from tracer.told_rays import AWAY, TRACED, ShadowRays
from viewer.state.views import Color

SAID: dict[Verdict, str] = {
    Verdict.AWAY: "not asked: faces away",
    Verdict.PASSED_OVER: "passed over",
    Verdict.FULL_SHADOW: "culled by FULL_SHADOW",
    Verdict.NON_SHADOW: "culled by NON_SHADOW",
    Verdict.CERTIFIED_FULL: "culled by certificate full",
    Verdict.CERTIFIED_LIT: "culled by certificate lit",
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

MEANING: dict[Verdict, str] = {
    Verdict.AWAY: "The light is behind the surface, so that no shadow ray is due.",
    Verdict.PASSED_OVER: "The light is proven to be hidden from all that is near the point.",
    Verdict.FULL_SHADOW: "The primitive is fully rendered, and every shadow ray from it to this light was blocked.",
    Verdict.NON_SHADOW: "The primitive is fully rendered, and nothing static blocked any shadow ray from it to this "
    "light: only objects that move are tested.",
    Verdict.CERTIFIED_FULL: "The whole cell is proven to be in the shadow of static geometry.",
    Verdict.CERTIFIED_LIT: "Nothing static is between the whole cell and the light: only objects that move are tested.",
    Verdict.CANDIDATES: "Only a few primitives can block the light here: these are tested, and objects that move.",
    Verdict.BEAM: "What is between the lamp and neighbouring points was asked about all of its samples at once.",
    Verdict.CACHED: "The primitive that blocked a ray there before was tested first, and blocks this one too.",
    Verdict.BUFFER_LIT: "Nothing that the light sees in this direction is nearer to it than the point.",
    Verdict.BUFFER_FULL: "The point is behind a triangle that hides all of a cell of the light's cube.",
    Verdict.BUFFER_TESTED: "Only a few primitives are in the point's cell of the light's cube: these are tested.",
    Verdict.VOXEL_LIT: "Nothing static is between the light and any point of the voxel: only objects that move "
    "are tested.",
    Verdict.VOXEL_FULL: "One triangle hides the light from all of the voxel.",
    Verdict.VOXEL_WALK: "Of the point's voxel nothing is known: the ray walked on towards the light, from voxel to "
    "voxel.",
    Verdict.CELL_LIT: "The point's cell knows of nothing that blocks the light: only objects that move are tested.",
    Verdict.CELL_FULL: "The point's cell knows the light to be hidden from all of it.",
    Verdict.CELL_TESTED: "The point's cell knows what may block the light: these primitives are tested, and objects "
    "that move.",
    Verdict.ANSWERED: "The method knew the answer.",
    Verdict.TRACED: "Nothing was known: the ray was traced through the scene.",
}

_PROVEN = {
    "full": "the light is hidden from the whole cell",
    "lit": "nothing static is in the way",
    "candidates": "only a few primitives can block the light here",
}
WHY_TRACED: dict[str, str] = {
    "INIT": "Traced: nothing is known of the primitive yet, or not towards this light.",
    "PARTIALLY_OCCLUDED": "Traced: something hides a part of the primitive, so that its shadow modes are not trusted.",
    "DYNAMIC": "Traced: the primitive moves, so that it has no shadow modes.",
    "PARTIAL_SHADOW": "Traced: some shadow rays from the primitive to this light were blocked, and others were not.",
    "candidates": "Traced: only a few primitives can block the light here, but to trace the ray with its neighbours is "
    "quicker than to test these.",
    **{
        unused(state): f"Traced: a certificate says that {known}. But the method auto looks no certificates up "
        "here, as it has measured that tracing every ray is quicker."
        for state, known in _PROVEN.items()
    },
}
"""What tracing says where something was known all the same (`ShadowRays.known`)."""


class Shown(StrEnum):
    """Which shadow rays are to be seen."""

    ALL = "all"
    TRACED = "traced"
    CULLED = "culled"
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
            Shown.CULLED: (rays.verdict != TRACED) & (rays.verdict != AWAY),
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
