"""The exact value of each pixel in a view: as numbers, to be compared and counted, and in words, for a single pixel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode, ShadowMode, has_shadow_mode
from tracer.frame import Frame, Region
from tracer.geometry.tree_parts import NOWHERE
from viewer.state.readings import (
    CUT_BOUND,
    can_draw,
    cell_lights,
    cut_nodes,
    lights_due,
    moving_shadows,
    samples_of,
    tree_of,
    untrusted,
    voxels_of,
    whole_of,
    work_of,
)
from viewer.state.slices import MIDDLE, Slice, slice_seen, voxel_words
from viewer.state.tree_slice import part_seen, part_words, tree_seen
from viewer.state.views import FATE_NAMES, MOVING_SHADOW_NAMES, Certificate, MovingShadow, View

CHANNELS = ("red", "green", "blue")
AXES = ("x", "y", "z")
FAR = np.float32(1e30)
"""Stands for the depth of what hits nothing, so that numbers can be subtracted."""


@dataclass(frozen=True)
class Values:
    """What a view shows of each pixel: `numbers` (h, w, k) float32 with a name for each of the k; where they are
    `classes`, modes or numbers of primitives, only whether they are the same means anything.  `known` (h, w) says where
    there is a value."""

    numbers: NDArray[np.float32]
    names: tuple[str, ...]
    known: NDArray[np.bool_]
    classes: bool = False


def values_of(frame: Frame, view: View, light: int = 0, *, cut: Slice) -> Values:
    """The values of a frame that the view can be drawn of, in the slice `cut` where it shows one; raises ValueError for
    another."""
    if not can_draw(frame, view, light):
        raise ValueError(f"the frame has nothing for the view {view.label}")
    everywhere, hit = np.ones(frame.primitive.shape, np.bool_), frame.primitive >= 0
    known = everywhere if frame.shaded is None else frame.shaded
    if view in (View.COLOR, View.WIPE):
        return Values(frame.color, CHANNELS, everywhere)
    if view is View.NORMAL:
        return Values(frame.normal, AXES, hit)
    if view is View.DEPTH:
        return _single(np.where(hit, frame.depth, FAR), "depth", hit)
    if view is View.PRIMITIVE:
        return _single(frame.primitive, "primitive", hit, classes=True)
    if view is View.OCCLUSION:
        return _single(frame.occlusion_mode, "occlusion mode", hit, classes=True)
    if view is View.SHADOW:
        return _single(_per_pixel(frame, _shadow_modes(frame, light)), "shadow mode", hit, classes=True)
    if view is View.CERTIFICATE:
        return _single(_certificates(frame, light), "certificate", hit, classes=True)
    if view is View.PIXEL_COUNT:
        return _single(_per_pixel(frame, frame.pixel_count), "pixels of the primitive", hit)
    if view is View.DIFFERENCE:
        return _single(_there(frame.wrong), "wrong answers", known)
    if view is View.LIGHTS:
        due = lights_due(frame)
        return _single(due, "lights due", hit & (due >= 0))
    if view is View.CUTS:
        nodes = cut_nodes(frame)
        return _single(nodes, "clusters of lights", hit & (nodes >= 0))
    if view is View.CELL_LIGHTS:
        asks = cell_lights(frame)
        return _single(asks, "lights that the cell asks", hit & (asks >= 0))
    if view is View.VOXELS:
        voxels = voxels_of(frame)
        numbers = slice_seen(frame, voxels.grid, cut).numbers
        states = voxels.states(light, np.maximum(numbers, 0).astype(np.int64))
        return _single(states, "state of the voxel", numbers >= 0, classes=True)
    if view is View.TREE:
        parts = tree_seen(frame, tree_of(frame), cut).parts
        return _single(np.where(parts.built, parts.levels, -1), "level", parts.numbers != NOWHERE, classes=True)
    if view is View.PENUMBRA:
        asked, reached = samples_of(frame, light)
        return _single(reached / np.maximum(asked, 1), "share of the light", hit & known & (asked > 0))
    if view is View.FATE:
        return _single(frame.fate(light), "fate of the shadow ray", hit, classes=True)
    if view is View.MOVING_SHADOW:
        return _single(moving_shadows(frame, light), "shadow of a moving object", hit, classes=True)
    name = "shadow rays untraced" if view is View.SAVED else "rays traced"
    return _single(_there(work_of(frame, view)), name, known)


def words_at(
    frame: Frame, view: View, light: int, x: int, y: int, shares: bool = False, cut: Slice = MIDDLE
) -> tuple[str, ...]:
    """What a view shows of one pixel, in a few short lines; nothing where it cannot be drawn of this frame."""
    if not can_draw(frame, view, light):
        return ()
    if view in (View.COLOR, View.WIPE):
        return tuple(f"{channel:.3f}" for channel in frame.color[y, x])
    if (view.needs_work or view is View.DIFFERENCE) and frame.shaded is not None and not frame.shaded[y, x]:
        return ("?",)
    if view is View.DIFFERENCE:
        return (f"{int(_there(frame.wrong)[y, x])} wrong",)
    if view in (View.SAVED, View.COST):
        work = int(_there(work_of(frame, view))[y, x])
        whole = int(whole_of(frame, view)[y, x]) if shares else 0
        return (f"{100.0 * work / whole:.0f} %",) if whole else (f"{work}",)
    if view is View.VOXELS:
        return voxel_words(frame, voxels_of(frame), light, cut, x, y)
    if view is View.TREE:
        tree = tree_of(frame)
        return part_words(part_seen(frame, tree, cut, x, y), tree.owner)
    if frame.primitive[y, x] < 0:
        return ("miss",)
    return _WORDS[view](frame, light, x, y)


def _normal(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return tuple(f"{axis:+z.3f}" for axis in frame.normal[y, x])


def _depth(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return (f"{frame.depth[y, x]:.5g}",)


def _primitive(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return (str(int(frame.primitive[y, x])),)


def _occlusion(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return _spoken(OcclusionMode(int(modes.occlusion_mode(frame.modes[frame.unit[y, x]]))).name)


def _shadow(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    word = frame.modes[frame.unit[y, x]]
    if int(modes.occlusion_mode(word)) == OcclusionMode.DYNAMIC:
        return _spoken(OcclusionMode.DYNAMIC.name)
    if not has_shadow_mode(frame.modes, light):
        return ("not", "culled")
    said = _spoken(ShadowMode(int(modes.shadow_mode(word, light))).name)
    return (*said, "untrusted") if untrusted(frame, light)[frame.unit[y, x]] else said


def _certificate(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    words = frame.certificates
    if words is None or not has_shadow_mode(words, light):
        return _spoken(Certificate.NONE.name)
    return _spoken(Certificate(int(modes.shadow_mode(words[y, x], light))).name)


def _pixel_count(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    unit = frame.unit[y, x]
    highest = int(frame.highest_count[unit])
    return f"{int(frame.pixel_count[unit])} now", f"{highest} most" if highest else "no most"


def _penumbra(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    asked, reached = samples_of(frame, light)
    if frame.shaded is not None and not frame.shaded[y, x]:
        return ("?",)
    return (f"{int(reached[y, x])} of {int(asked[y, x])}",)


def _fate(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return tuple(FATE_NAMES[Fate(int(frame.fate(light, _at(x, y))[0, 0]))].split(": "))


def _moving_shadow(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    return tuple(MOVING_SHADOW_NAMES[MovingShadow(int(moving_shadows(frame, light, _at(x, y))[0, 0]))].split(", "))


def _at(x: int, y: int) -> Region:
    return slice(y, y + 1), slice(x, x + 1)


def _lights(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    due = np.count_nonzero(frame.asked[y, x]) if frame.asked is not None else 0
    return ("?",) if frame.shaded is not None and not frame.shaded[y, x] else (str(due),)


def _cuts(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    nodes, bound = int(cut_nodes(frame)[y, x]), float(frame.layers[CUT_BOUND][y, x])
    return ("?",) if nodes < 0 else (f"{nodes}", f"± {100.0 * bound:.3g} %")


def _cell_lights(frame: Frame, light: int, x: int, y: int) -> tuple[str, ...]:
    asked = int(cell_lights(frame)[y, x])
    return ("?",) if asked < 0 else (f"{asked} of {frame.lights}",)


_WORDS: dict[View, Callable[[Frame, int, int, int], tuple[str, ...]]] = {
    View.NORMAL: _normal,
    View.DEPTH: _depth,
    View.PRIMITIVE: _primitive,
    View.OCCLUSION: _occlusion,
    View.SHADOW: _shadow,
    View.CERTIFICATE: _certificate,
    View.PIXEL_COUNT: _pixel_count,
    View.PENUMBRA: _penumbra,
    View.FATE: _fate,
    View.MOVING_SHADOW: _moving_shadow,
    View.LIGHTS: _lights,
    View.CUTS: _cuts,
    View.CELL_LIGHTS: _cell_lights,
}


def _spoken(name: str) -> tuple[str, ...]:
    return tuple(name.lower().split("_"))


def _single(numbers: NDArray, name: str, known: NDArray[np.bool_], classes: bool = False) -> Values:
    return Values(np.asarray(numbers, np.float32)[..., None], (name,), known, classes)


def _there(buffer: NDArray | None) -> NDArray:
    assert buffer is not None, "the view can be drawn of it"
    return buffer


def _per_pixel(frame: Frame, entries: NDArray) -> NDArray:
    """What units have, at each pixel; -1 for a miss."""
    units = frame.unit
    if len(entries) == 0:
        return np.full(units.shape, -1)
    return np.where(units >= 0, entries[np.maximum(units, 0)].astype(np.int64), -1)


def _shadow_modes(frame: Frame, light: int) -> NDArray[np.uint8]:
    if not has_shadow_mode(frame.modes, light):
        return np.zeros(len(frame.modes), np.uint8)
    return modes.shadow_mode(frame.modes, light)


def _certificates(frame: Frame, light: int) -> NDArray[np.uint8]:
    words = frame.certificates
    if words is None or not has_shadow_mode(words, light):
        return np.zeros(frame.primitive.shape, np.uint8)
    return modes.shadow_mode(words, light)
