"""A slice through the voxels of the method `voxels`."""

from __future__ import annotations

import numpy as np

from tracer.culling.modes import ShadowMode
from tracer.culling.voxels.tell import STATE_NAMES, VoxelStates
from tracer.frame import Frame
from tracer.scene.lights import named_light
from viewer.state.draw_options import AXES, DrawOptions, Slice
from viewer.state.palette import GREY, SHADOW_COLORS, Color
from viewer.state.readings import VOXELS
from viewer.util.numbers import count, percent
from viewer.views.base import FrameView, Layer, Lights, Pixels, Values, Words, once, single
from viewer.views.color import dimmed
from viewer.views.legend import Entry, Legend, Note, NoteKind, fact
from viewer.views.paint import CELL_LINE, by_color, in_bytes
from viewer.views.slices import NO_VOXEL, STATE, VOXEL_LINE, middle_of, slice_codes, slice_seen, voxel_words

FULL, LIT = int(ShadowMode.FULL_SHADOW), int(ShadowMode.NON_SHADOW)
STATES: dict[int, tuple[Color, str]] = {
    0: (GREY, "neither is known: rays that end in it walk on towards the light, from voxel to voxel"),
    FULL: (
        SHADOW_COLORS[ShadowMode.FULL_SHADOW],
        "one triangle hides the light from all of it: rays that end in it, or come to it, are blocked",
    ),
    LIT: (
        SHADOW_COLORS[ShadowMode.NON_SHADOW],
        "nothing static is between it and the light: rays that end in it, or come to it, are tested against dynamic "
        "objects only",
    ),
}
"""By the state of a voxel, which has the place of a shadow mode."""
_PALETTE = np.asarray([color for color, _ in STATES.values()], np.float32)


class Voxels(FrameView):
    label = "Voxels"
    key = "Shift+V"
    help = (
        "A slice through the voxels of the method voxels: which are in shadow of the chosen light as a whole, which "
        "see all of it, and of which neither is known. Behind it the picture is dimmed."
    )
    of_light = has_slice = shows_picture = everywhere = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return VOXELS in frame.structures

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        states, light, cut = voxels_of(frame), draw.light, draw.slice
        codes = once(frame, ("voxels", light, cut), lambda: slice_codes(frame, states, light, cut))
        pixels, there = by_color(frame, draw, dimmed(frame, draw.tone, draw.beneath)), codes != NO_VOXEL
        colors = _PALETTE[codes[there] & STATE]
        colors[codes[there] & VOXEL_LINE != 0] *= np.float32(CELL_LINE)
        pixels[there] = in_bytes(colors)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        states, cut, light = voxels_of(frame), draw.slice, draw.light
        title, axis, grid = f"{self.label}, {named_light(lights, light)}", AXES[cut.axis], states.grid
        if not states.known[light]:
            why = "Nothing is known of this light: it is a lamp, or past those that there is room for; its rays are "
            return Legend(title, notes=(Note(f"{why}traced.", NoteKind.WARNING),))
        layer = np.take(np.arange(grid.voxels).reshape(states.shape), cut.layer(states.shape), axis=cut.axis)
        in_slice = np.bincount(states.states(light, layer).reshape(-1), minlength=3).tolist()
        in_all = states.counts(light)
        entries = tuple(
            Entry(
                STATE_NAMES[state],
                STATES[state][0],
                (percent(in_slice[state], layer.size), percent(in_all[state], grid.voxels)),
                f"{STATES[state][1]}. {count(in_all[state])} voxels in all",
            )
            for state in (FULL, LIT, 0)
        )
        facts = (
            fact(f"slice at {axis}", f"{middle_of(grid, cut):.4g}", "the middles of a layer of voxels"),
            fact("layer", f"{count(cut.layer(states.shape))} of {count(states.shape[cut.axis])}", "counted from 0"),
            fact("grid", " x ".join(str(n) for n in states.shape), f"of voxels that are {grid.side:.3g} wide"),
        )
        return Legend(title, ("slice", "all"), entries, facts=facts)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        voxels = voxels_of(frame)
        numbers = slice_seen(frame, voxels.grid, draw.slice).numbers
        states = voxels.states(draw.light, np.maximum(numbers, 0).astype(np.int64))
        return single(states, "state of the voxel", numbers >= 0, classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        return voxel_words(frame, voxels_of(frame), draw.light, draw.slice, x, y)

    def layer(self, frame: Frame, cut: Slice) -> Layer | None:
        if not self.can_draw(frame):
            return None
        states = voxels_of(frame)
        return Layer(cut.layer(states.shape), states.shape[cut.axis], middle_of(states.grid, cut))


def voxels_of(frame: Frame) -> VoxelStates:
    """Return the voxels as the frame found them.  Raises ValueError for a frame by a method that has none."""
    if VOXELS not in frame.structures:
        raise ValueError("the method of the frame has no voxels")
    found: VoxelStates = frame.structures[VOXELS]
    return found


VIEW = Voxels()
