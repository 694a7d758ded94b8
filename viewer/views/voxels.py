"""A slice through the voxels of the method `voxels`: one layer of them, drawn as the plane through their middles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling.modes import ShadowMode
from tracer.frame import Frame
from tracer.neighbours.voxels.grid import BLOCK
from tracer.neighbours.voxels.tell import STATE_NAMES, VoxelStates
from tracer.visibility.grid import index_of
from viewer.state.draw_options import AXES, DrawOptions, Slice
from viewer.state.palette import GREY, SHADOW, Color
from viewer.state.views import VOXELS
from viewer.util.numbers import count, percent
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, once, single
from viewer.views.color import dimmed
from viewer.views.legend import Entry, Legend, Note, NoteKind, fact
from viewer.views.paint import CELL_LINE, by_color, in_bytes, met, on_line, wide_enough

FULL, LIT = int(ShadowMode.FULL_SHADOW), int(ShadowMode.NON_SHADOW)
STATES: dict[int, tuple[Color, str]] = {
    0: (GREY, "neither is known: rays that end in it walk on towards the light, from voxel to voxel"),
    FULL: (
        SHADOW[ShadowMode.FULL_SHADOW].color,
        "one triangle hides the light from all of it: rays that end in it, or come to it, are blocked",
    ),
    LIT: (
        SHADOW[ShadowMode.NON_SHADOW].color,
        "nothing static is between it and the light: rays that end in it, or come to it, are tested against dynamic "
        "objects only",
    ),
}
"""By the state of a voxel, which has the place of a shadow mode."""
_PALETTE = np.asarray([color for color, _ in STATES.values()], np.float32)


class Voxels(DrawnView):
    label = "Voxels"
    key = "Shift+V"
    help = (
        "A slice through the voxels of the method Voxels: which are in shadow of the chosen light as a whole, which "
        "see all of it, and of which neither is known. Behind it the picture is dimmed."
    )
    shows = VOXELS
    of_light = has_slice = shows_picture = everywhere = True

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        numbers, lines = voxels_seen(frame, draw.slice)
        pixels, there = by_color(frame, draw, dimmed(frame, draw.tone, draw.beneath)), numbers >= 0
        colors = _PALETTE[voxels_of(frame).states(draw.light, numbers[there].astype(np.int64))]
        colors[lines[there]] *= np.float32(CELL_LINE)
        pixels[there] = in_bytes(colors)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        states, cut, light = voxels_of(frame), draw.slice, draw.light
        grid, number, title = states.grid, cut.layer(states.shape[cut.axis]), self.title(draw, lights)
        if not states.known[light]:
            why = "Voxels know nothing of this light: it is a lamp, or there are too many. All its rays are traced."
            return Legend(title, notes=(Note(why, NoteKind.WARNING),))
        layer = np.take(np.arange(grid.cubes).reshape(states.shape), number, axis=cut.axis)
        in_slice = np.bincount(states.states(light, layer).reshape(-1), minlength=3).tolist()
        in_all = states.counts(light)
        entries = tuple(
            Entry(
                STATE_NAMES[state],
                STATES[state][0],
                (percent(in_slice[state], layer.size), percent(in_all[state], grid.cubes)),
                f"{STATES[state][1]}. {count(in_all[state])} voxels in all",
            )
            for state in (FULL, LIT, 0)
        )
        facts = (
            fact(f"slice at {AXES[cut.axis]}", f"{plane_of(states, cut):.4g}", "the middles of a layer of voxels"),
            fact("layer", f"{count(number)} of {count(states.shape[cut.axis])}", "counted from 0"),
            fact("grid", " x ".join(str(n) for n in states.shape), f"of voxels that are {grid.side:.3g} wide"),
        )
        return Legend(title, ("slice", "all"), entries, facts=facts)

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        numbers = voxels_seen(frame, draw.slice)[0]
        states = voxels_of(frame).states(draw.light, np.maximum(numbers, 0).astype(np.int64))
        return single(states, "state of the voxel", numbers >= 0, classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        """Return the voxel's place and its state; a dash where none is seen."""
        number = int(voxels_seen(frame, draw.slice)[0][y, x])
        if number < 0:
            return ("-",)
        states = voxels_of(frame)
        state = int(states.states(draw.light, np.array(number)))
        return "{}, {}, {}".format(*index_of(states.grid, number)), STATE_NAMES[state]

    def layers(self, frame: Frame, axis: int) -> int:
        return voxels_of(frame).shape[axis] if self.can_draw(frame) else 0


def voxels_of(frame: Frame) -> VoxelStates:
    """Return the voxels as the frame found them."""
    found: VoxelStates = frame.structures[VOXELS]
    return found


def plane_of(states: VoxelStates, cut: Slice) -> float:
    """Return where the plane of a slice lies along its axis, in units of the scene: in the middle of its layer."""
    grid, number = states.grid, cut.layer(states.shape[cut.axis])
    return float((grid.x, grid.y, grid.z)[cut.axis] + (number + 0.5) * grid.side)


def voxels_seen(frame: Frame, cut: Slice) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Return the number of the voxel (h, w) that each pixel sees in a slice, -1 where it sees none, and whether its
    border is drawn there; that of a block of voxels where voxels are too small.

    Where something lies before the slice, that is seen instead."""
    return once(frame, ("voxels", cut), lambda: _voxels_seen(frame, voxels_of(frame), cut))


def _voxels_seen(frame: Frame, states: VoxelStates, cut: Slice) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    grid, sides = states.grid, states.shape
    seen = met(frame, cut.axis, plane_of(states, cut))
    along = (seen.points - np.array((grid.x, grid.y, grid.z), np.float32)) * np.float32(grid.per_unit)
    with np.errstate(invalid="ignore"):
        there = ~seen.behind & ((along >= 0.0) & (along < sides)).all(axis=-1)
    place = np.where(there[..., None], along, 0.0).astype(np.int64)
    place[..., cut.axis] = cut.layer(sides[cut.axis])
    numbers = np.where(there, np.ravel_multi_index(tuple(np.moveaxis(place, -1, 0)), sides), -1).astype(np.int32)
    blocks = np.where(there, (place // BLOCK) @ (1 << 40, 1 << 20, 1), -1)
    lines = np.where(wide_enough(grid.side, seen.per_pixel), on_line(numbers), on_line(blocks))
    return numbers, there & lines & wide_enough(BLOCK * grid.side, seen.per_pixel)


VIEW = Voxels()
