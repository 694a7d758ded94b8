"""Why a shadow ray of a pixel was culled, and what was known of one that was traced all the same."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.cells import units_of
from tracer.culling.verdicts import Answered, Because, Verdict
from tracer.inspect.explanation import NO_CERTIFICATE
from tracer.method import Method
from tracer.methods.watching import ANSWERED, LIT, Seen
from tracer.scene.arrays import Float32
from tracer.shading import points, wave

if TYPE_CHECKING:
    from tracer.frame_in_progress import FrameInProgress
    from tracer.methods.interface import ShadowMethod, Stage

MOST_NAMED = 64  # lights of a point that are passed over and whose blockers are looked for


def unused(state: str) -> str:
    """What is said of a certificate that nobody has looked up."""
    return f"proven {state}, unused"


def primitive_of(seen: Seen, row: int) -> int:
    """What a ray hits."""
    return int(seen.wave.view(np.int32)[row, wave.HIT_PRIMITIVE])


def end_of(seen: Seen, row: int) -> Float32:
    """Where the shadow rays of a ray's point end."""
    return seen.point[row, points.LIFTED_ROW : points.LIFTED_ROW + 3]


def known_of(
    work: FrameInProgress, stages: list[tuple[ShadowMethod, Stage]], seen: Seen, row: int, light: int, is_point: bool
) -> str:
    """What was known of a point and a light although its ray was traced, in a word or two, or nothing.

    A certificate that a method has, but does not look up as long as that takes longer than it saves (`auto`), is
    `unused`."""
    if Method.parse(work.settings.method).uses_modes and modes.has_shadow_mode(work.words, light):
        word = work.words[_unit(work, seen, row)]
        occlusion = modes.OcclusionMode(int(word) & 3)
        whole = occlusion is modes.OcclusionMode.FULLY_RENDERED
        return modes.ShadowMode(int(modes.shadow_mode(word, light))).name if whole else occlusion.name
    if is_point:
        asked = {method for method, _ in stages}
        for method in work.methods:
            state = (method.explain(primitive_of(seen, row), end_of(seen, row), light) or (NO_CERTIFICATE,))[0]
            if method not in asked and state != NO_CERTIFICATE:
                return unused(state)
            if state == "candidates":
                return state
    return ""


def _unit(work: FrameInProgress, seen: Seen, row: int) -> int:
    """What carries the modes of a ray's point."""
    if not len(work.first):
        return primitive_of(seen, row)
    found = np.empty(1, np.int32)
    units_of(
        work.first,
        np.array([primitive_of(seen, row)], np.int32),
        *(seen.wave[row, at : at + 1] for at in (wave.HIT_U, wave.HIT_V)),
        found,
    )
    return int(found[0])


def reasons_of(
    stages: list[tuple[ShadowMethod, Stage]],
    primitive: int,
    end: Float32,
    lights: NDArray[np.int32],
    noted: NDArray[np.int32],
    kept: NDArray[np.int32],
) -> dict[int, Because]:
    """Why each of a point's shadow rays that was culled was so, by its place."""
    point = float(end[0]), float(end[1]), float(end[2])
    selecting = next((method for method, stage in stages if stage.select is not None), None)
    places = np.flatnonzero(noted >> ANSWERED)
    passed_over, known, whys = int((noted >> ANSWERED == 1).sum()), {}, {}
    for place in places.tolist():
        number, lit = int(noted[place] >> ANSWERED) - 1, bool(noted[place] & LIT)
        key = int(lights[place]), number, lit, int(kept[place])
        if key not in known:
            method = selecting if number == 0 else stages[number - 1][0]
            if number == 0 and (method is None or passed_over > MOST_NAMED):
                known[key] = Because(Verdict.PASSED_OVER)
            else:
                assert method is not None
                known[key] = method.because(Answered(primitive, point, int(lights[place]), lit, int(kept[place])))
        whys[place] = known[key]
    return whys
