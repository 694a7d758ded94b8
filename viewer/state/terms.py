"""The names of counters and phases wherever people read them, in the window and on the command line alike.

JSON and CSV have names of their own, which do not change."""

from __future__ import annotations

from tracer.frame import Frame
from tracer.frame_in_progress import OF_MODES
from tracer.method import Method
from tracer.settings import Settings
from tracer.statistics import ShadowCounts
from viewer.util.numbers import count

DUE = "due"
CULLED = "culled"
DYNAMIC_ONLY = "dynamic only"
SAVED = "saved"
CANDIDATES_ONLY = "candidates"
CACHE_HITS = "cache hits"
TRACED = "traced"
WRONG = "wrong answers"
WRONG_PIXELS = "wrong pixels"
BEYOND = "pixels beyond the error"
PASSED_OVER = "passed over"
BUILT = "built"

BY_BEAMS = (
    "The tests of shadow rays include those of beams: triangles that are tested against all rays to a lamp at once, "
    "instead of tracing each ray."
)
"""What is said of the tests where certificates cull rays of lamps."""

MEANINGS = {
    DUE: "one towards each light on the visible side of a surface, at all bounces",
    CULLED: "not traced, as its answer is known",
    SAVED: "culled or dynamic only: not tested against static geometry",
    DYNAMIC_ONLY: "nothing static is in the way: tested against dynamic objects alone, where any can be",
    CANDIDATES_ONLY: "tested against a few primitives and dynamic objects instead of the whole scene",
    CACHE_HITS: "blocked by the primitive that blocked a ray there before",
    TRACED: "nothing was known: traced through the whole scene",
    PASSED_OVER: "samples of lights, at all points, that are proved not to reach them: not even looked at, and not due",
    BUILT: "of the tree, which is built where rays arrive: primitives in nodes that are built",
    WRONG: "shadow rays for which culling and tracing disagree, in all samples so far",
    WRONG_PIXELS: "with a wrong answer to any light, at any bounce, in any sample so far",
    BEYOND: "pixels that differ from the picture by all lights by more than clusters of lights may be wrong by",
}

MADE = {
    "certificates made": "proofs for parts of surfaces, made in this frame",
    "voxels classified": "voxels, and blocks of them, of which it was found out in this frame what reaches them",
    "cells settled": "cells of space of which it was found out in this frame what blocks a light from them",
    "light buffers made": "cubes around lights that were filled in this frame with what the light sees",
}
"""What methods make before shading (`tracer.method.Kind.makes`), and what it is."""

PHASES = {
    "place": ("dynamic objects", "moving them to where they are at this time, and rebuilding their trees"),
    "primary": ("primary rays", "from the camera to the first surface"),
    "occlusion testing": ("occlusion tests", "whether primitives hide each other at neighbouring pixels"),
    "certification": ("preparing", "finding out what blocks a light, or that nothing does, before shading"),
    "surfaces": ("surfaces", "what each pixel shows, and its light if nothing blocked it"),
    "shading": ("shading", "shadow rays, light, textures, reflections and refractions"),
    "filling": ("filling in", "pixels that are not shaded yet, from their neighbours"),
    "mode setting": ("modes", "setting the modes of primitives by what this frame has found"),
}
"""The phases of a frame, in their order: the name of each, and what happens in it."""


FOR_DISPLAY = "for display"
WHY_FOR_DISPLAY = "beside the method, which culls by no modes, so that they can be shown: no part of the frame's time"
"""Of phases whose modes are only looked at."""


def phase(name: str, settings: Settings) -> tuple[str, str]:
    """The name of a phase of a frame, and what happens in it; of modes that are only looked at, which is no part of the
    frame's time."""
    label, tip = PHASES.get(name, (name, ""))
    if name in OF_MODES and settings.modes_beside:
        return f"{label} ({FOR_DISPLAY})", f"{tip}: {WHY_FOR_DISPLAY}"
    return label, tip


def traced_shadow_rays(shadow: ShadowCounts) -> str:
    """Which shadow rays count as traced, and how many others asked something, in a sentence or two."""
    others = shadow.rays - shadow.traced
    text = "traced through the whole scene"
    if others > 0:
        text += f"; {count(others)} others were tested against dynamic objects or a few candidates only: they do not "
        text += "count as traced, but their steps and tests are counted here"
    return text


def made(method: str) -> tuple[str, str]:
    """What a method makes before shading, as "certificates made", and its meaning; nothing where it makes nothing."""
    found = Method.parse(method).makes
    return " and ".join(found), "; ".join(MADE[one] for one in found)


def things(made: str) -> str:
    """What it is that was made: certificates, of "certificates made"."""
    return " and ".join(one.rsplit(" ", 1)[0] for one in made.split(" and "))


def asks_by_beams(frame: Frame, lamps: bool) -> bool:
    """Whether beams have asked some of what is counted as tests of shadow rays; `lamps`: not all lights are points."""
    return lamps and frame.certificates is not None and frame.statistics.shadow.saved > 0
