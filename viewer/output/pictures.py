"""The views as pictures without a GPU: what the shaders do, in numpy.

For `shadowcull render`, which must run where there is no GL.  Each function here is the twin of the
shader of the same name under `shaders/` and takes its colours from the same table
(`viewer.state.views`), so that a picture made by a command and one captured from the window agree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from viewer.output.legend_counts import certificates_of
from viewer.state.marks import Mark, wipe_column, wrong_marks
from viewer.state.readings import (
    arrivals,
    cell_lights,
    cut_nodes,
    lights_due,
    moving_shadows,
    samples_of,
    span_of,
    tree_of,
    untrusted,
    voxels_of,
    whole_of,
    work_of,
)
from viewer.state.slices import LINE as VOXEL_LINE
from viewer.state.slices import MIDDLE, NOTHING, STATE, Slice, slice_codes
from viewer.state.tone import NEUTRAL, Tone, clipped, toned
from viewer.state.tree_slice import BORDER, HIDDEN, LEVEL, LINE, STRIPE, WAITS, tree_codes
from viewer.state.tree_slice import NOTHING as NO_PART
from viewer.state.views import (
    ARRIVAL_COLORS,
    BACKGROUND,
    BENEATH,
    BLACK,
    CELL_LINE,
    CERTIFICATE_COLORS,
    CLIP_STRIPE,
    FAINT_LINE,
    FATE_COLORS,
    GREY,
    MOVING_SHADOW_COLORS,
    OCCLUSION_COLORS,
    PALE,
    RING_DIMMING,
    SHADOW_COLORS,
    TOO_BRIGHT,
    TREE_WAITS,
    UNTRUSTED_STRIPE,
    VOXEL_COLORS,
    WIPE_LINE,
    WRONG,
    Arrival,
    MovingShadow,
    View,
    color_map,
)

SHADING = 0.35
"""How much of the picture's light and shade shows under flat colours, as in the window."""

OUTLINE = 0.35
"""Brightness of the borders between primitives, against what is there."""

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)


def picture(
    frame: Frame,
    view: View = View.COLOR,
    light: int = 0,
    shading: float = SHADING,
    marked: bool = True,
    wipe: float = 0.5,
    shares: bool = False,
    beneath: float = BENEATH,
    outlines: bool = False,
    magnified: int = 1,
    tone: Tone = NEUTRAL,
    clipping: bool = False,
    span: tuple[float, float] | None = None,
    cut: Slice = MIDDLE,
) -> NDArray[np.uint8]:
    """(height, width, 3) uint8, row 0 at the top: a frame in one of its views.

    `light` is the light that views of one light speak of, `marked` draws rings around wrong pixels, and `wipe` is the
    place of the wipe's line, 0 to 1 from the left.  Maps of work show counts of rays, or `shares`; `beneath` is the
    brightness of the picture beneath the difference, and behind the slice `cut` through space.  `outlines` draws the
    borders between primitives, and rings are for a picture that is shown `magnified` times.  Pictures have a `tone`,
    and stripes where the screen cuts them off if `clipping`; maps of numbers go over `span`, by default over what the
    frame has.

    Raises ValueError where there is no such light, or where the view is one of verified frames, or of what was
    recorded, and the frame is not.
    """
    if view.of_light and not 0 <= light < frame.lights:
        raise ValueError(f"no light {light}: {lights_in_words(frame.lights)}")
    if view is View.COLOR:
        colors = _displayed(frame.color, tone, clipping)
    elif view is View.DIFFERENCE:
        colors = _difference(frame, marked, beneath, outlines, magnified, tone)
    elif view is View.WIPE:
        colors = _wipe(frame, marked, wipe, outlines, magnified, tone, clipping)
    elif view.needs_work:
        colors = _on_background(frame, _work(frame, view, shares, span))
    elif view is View.CERTIFICATE:
        colors = _on_background(frame, _certificate(frame, light, shading))
    elif view is View.PENUMBRA:
        colors = _on_background(frame, _shaded(frame, _penumbra(frame, light), shading))
    elif view is View.FATE:
        fates = np.asarray(list(FATE_COLORS.values()), np.float32)[frame.fate(light)]
        colors = _on_background(frame, _shaded(frame, fates, shading))
    elif view is View.MOVING_SHADOW:
        colors = _on_background(frame, _moving_shadow(frame, light, shading))
    elif view is View.LIGHTS:
        colors = _on_background(frame, _counted(lights_due(frame), span or span_of(frame, view)))
    elif view is View.CUTS:
        colors = _on_background(frame, _counted(cut_nodes(frame), span or span_of(frame, view)))
    elif view is View.CELL_LIGHTS:
        colors = _on_background(frame, _cell_lights(frame, span or span_of(frame, view)))
    elif view is View.VOXELS:
        colors = _voxels(frame, light, beneath, outlines, tone, cut)
    elif view is View.TREE:
        colors = _tree(frame, span or span_of(frame, view), shading, beneath, outlines, tone, cut)
    elif view is View.DEPTH:
        colors = _on_background(frame, _depth(frame, span))
    elif view is View.NORMAL:
        colors = _on_background(frame, frame.normal * 0.5 + 0.5)
    else:
        table = {View.OCCLUSION: _occlusion, View.PRIMITIVE: _primitive, View.PIXEL_COUNT: _pixel_count}
        entries = _shadow(frame, light) if view is View.SHADOW else table[view](frame)
        numbers = frame.primitive if view is View.PRIMITIVE else frame.unit
        flat = _per_pixel(numbers, entries)
        if view is View.SHADOW:
            flat[_untrusted_stripes(frame, light)] = SHADOW_COLORS[ShadowMode.INIT]
        colors = _on_background(frame, _shaded(frame, flat, shading))
    if outlines and not (view.needs_verify or view.has_slice):  # those draw over the borders
        colors = _outlined(frame, colors)
    return np.round(np.clip(colors, 0.0, 1.0) * 255.0).astype(np.uint8)


def lights_in_words(count: int) -> str:
    """What numbers the lights of a scene have."""
    if count == 0:
        return "the scene has no lights"
    return "the scene has one light, number 0" if count == 1 else f"the scene's lights are 0 to {count - 1}"


def ringed(frame: Frame) -> NDArray[np.uint8]:
    """(height, width, 3) uint8: the traced picture of a verified frame with rings around wrong pixels.

    Raises ValueError where the frame was not verified."""
    colors = np.clip(frame.color, 0.0, 1.0)
    colors[wrong_marks(frame) == Mark.RING] = WRONG
    return np.round(colors * 255.0).astype(np.uint8)


def _on_background(frame: Frame, colors: NDArray) -> NDArray:
    return np.where((frame.primitive >= 0)[..., None], colors, np.asarray(BACKGROUND, np.float32))


def _shaded(frame: Frame, flat: NDArray, shading: float) -> NDArray:
    """Flat colours with some of the traced picture's light and shade, so that shapes stay readable."""
    light = 0.25 + 0.95 * np.sqrt(np.clip(frame.color, 0.0, 1.0) @ _LUMINANCE)
    return np.clip(flat * (1.0 + shading * (light[..., None] - 1.0)), 0.0, 1.0)


def _per_pixel(numbers: NDArray[np.int32], table: NDArray) -> NDArray:
    """Look a colour up by the number at each pixel; misses get some colour, to be overwritten."""
    if len(table) == 0:
        return np.zeros((*numbers.shape, 3), np.float32)
    return table[np.maximum(numbers, 0)]


def _occlusion(frame: Frame) -> NDArray:
    palette = np.asarray([OCCLUSION_COLORS[mode] for mode in OcclusionMode], np.float32)
    return palette[modes.occlusion_mode(frame.modes)]


def _shadow(frame: Frame, light: int) -> NDArray:
    """By shadow mode; what moves has none and is shown as moving, a light that culling does not cover as unknown."""
    palette = np.asarray([*SHADOW_COLORS.values(), OCCLUSION_COLORS[OcclusionMode.DYNAMIC]], np.float32)
    if modes.has_shadow_mode(frame.modes, light):
        mode = modes.shadow_mode(frame.modes, light)
    else:
        mode = np.zeros(len(frame.modes), np.uint8)
    mode[modes.occlusion_mode(frame.modes) == OcclusionMode.DYNAMIC] = len(palette) - 1
    return palette[mode]


def _untrusted_stripes(frame: Frame, light: int) -> NDArray[np.bool_]:
    """(h, w): every second stripe of what has a shadow mode that is not trusted."""
    y, x = np.indices(frame.unit.shape)
    stripes = (x + y) // UNTRUSTED_STRIPE % 2 == 1
    return untrusted(frame, light)[np.maximum(frame.unit, 0)] & stripes if len(frame.modes) else np.zeros_like(stripes)


def _certificate(frame: Frame, light: int, shading: float) -> NDArray:
    """By the certificate of each pixel's cell, what moves as moving, and darker lines between cells."""
    palette = np.asarray([*CERTIFICATE_COLORS.values(), OCCLUSION_COLORS[OcclusionMode.DYNAMIC]], np.float32)
    colors = _shaded(frame, palette[certificates_of(frame, light)], shading)
    colors[_on_line(frame.cell)] *= CELL_LINE
    return colors


def _penumbra(frame: Frame, light: int) -> NDArray:
    """By the samples of a light that reach each pixel, with a ramp where some do and some do not."""
    asked, reached = samples_of(frame, light)
    palette = np.asarray([ARRIVAL_COLORS[one] for one in Arrival], np.float32)
    found = arrivals(frame, light)
    share = (reached / np.maximum(asked, 1).astype(np.float32))[..., None]
    ramp = palette[Arrival.FEW] + share * (palette[Arrival.MOST] - palette[Arrival.FEW])
    between = (found == Arrival.FEW) | (found == Arrival.MOST)
    return np.where(between[..., None], ramp, palette[found])


def _moving_shadow(frame: Frame, light: int, shading: float) -> NDArray:
    """Moving shadows, what asks dynamic objects only, and these, over the paled picture in greys."""
    found = moving_shadows(frame, light)
    flat = np.asarray(list(MOVING_SHADOW_COLORS.values()), np.float32)[found]
    paled = (PALE + (1.0 - PALE) * (np.clip(frame.color, 0.0, 1.0) @ _LUMINANCE))[..., None]
    return np.where((found == MovingShadow.NONE)[..., None], paled, _shaded(frame, flat, shading))


def _displayed(color: NDArray[np.float32], tone: Tone, clipping: bool) -> NDArray:
    """Colours by their tone, with stripes where the screen cuts something off and that is to be marked."""
    shown = np.clip(toned(color, tone), 0.0, 1.0)
    if clipping:
        found, (y, x) = clipped(color, tone), np.indices(color.shape[:2])
        stripes = (x + y) // CLIP_STRIPE % 2 == 0
        shown[found.bright & stripes] = TOO_BRIGHT
        shown[found.black & stripes] = BLACK
    return shown


def _counted(numbers: NDArray[np.int32], span: tuple[float, float]) -> NDArray:
    """By numbers (h, w) of lights, or of clusters of them, by their range; grey where that is not known yet."""
    return np.where((numbers >= 0)[..., None], _mapped(_in_range(numbers, span)), np.asarray(GREY, np.float32))


def _cell_lights(frame: Frame, span: tuple[float, float]) -> NDArray:
    """By the lights that cells must look at, and darker lines between cells."""
    colors = _counted(cell_lights(frame), span)
    colors[_on_line(frame.cell)] *= FAINT_LINE
    return colors


def _voxels(frame: Frame, light: int, beneath: float, outlines: bool, tone: Tone, cut: Slice) -> NDArray:
    """A slice through voxels, by their states, over the dimmed picture."""
    codes, colors = (
        slice_codes(frame, voxels_of(frame), light, cut),
        beneath * np.clip(toned(frame.color, tone), 0.0, 1.0),
    )
    colors = _on_background(frame, colors)
    if outlines:
        colors = _outlined(frame, colors)
    palette = np.asarray(list(VOXEL_COLORS.values()), np.float32)
    there = codes != NOTHING
    sliced = palette[codes[there] & STATE]
    sliced[codes[there] & VOXEL_LINE != 0] *= np.float32(CELL_LINE)
    colors[there] = sliced
    return colors


def _tree(
    frame: Frame,
    span: tuple[float, float],
    shading: float,
    beneath: float,
    outlines: bool,
    tone: Tone,
    cut: Slice,
) -> NDArray:
    """A slice through a tree, by the levels of its parts, through everything; around it the picture is dimmed."""
    codes = tree_codes(frame, tree_of(frame), cut)
    colors = _on_background(frame, beneath * np.clip(toned(frame.color, tone), 0.0, 1.0))
    if outlines:
        colors = _outlined(frame, colors)
    y, x = np.indices(codes.shape)
    waits = np.asarray(TREE_WAITS, np.float32)[(x + y) // STRIPE % 2]
    sliced = np.where((codes & WAITS != 0)[..., None], waits, _mapped(_in_range((codes & LEVEL).astype(float), span)))
    sliced = np.where((codes & LINE != 0)[..., None], np.float32(FAINT_LINE) * sliced, sliced)
    sliced = np.where((codes & HIDDEN != 0)[..., None], _shaded(frame, sliced, shading), sliced)
    sliced = np.where((codes & BORDER != 0)[..., None], np.float32(1.0), sliced)
    return np.where((codes != NO_PART)[..., None], sliced, colors)


def _outlined(frame: Frame, colors: NDArray) -> NDArray:
    """With darker borders between primitives."""
    return np.where(_on_line(frame.primitive)[..., None], OUTLINE * colors, colors)


def _on_line(cells: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels whose neighbour to the right, or below, lies in another cell."""
    line = np.zeros(cells.shape, np.bool_)
    line[:, :-1] |= cells[:, 1:] != cells[:, :-1]
    line[:-1] |= cells[1:] != cells[:-1]
    return line


def _in_range(numbers: NDArray, span: tuple[float, float]) -> NDArray:
    """Numbers as places on the colour map."""
    return (numbers - span[0]) / (span[1] - span[0])


def _work(frame: Frame, view: View, shares: bool, span: tuple[float, float] | None) -> NDArray:
    """Rays at each pixel, by their range, or which share they are; grey where they are a share of none."""
    work = work_of(frame, view)
    if not shares or work is None:
        span = span or span_of(frame, view)
        assert work is not None
        return _mapped(_in_range(work, span))
    whole = whole_of(frame, view)
    return np.where((whole > 0)[..., None], _mapped(work / np.maximum(whole, 1)), np.asarray(GREY, np.float32))


def _primitive(frame: Frame) -> NDArray:
    """A colour of its own for every primitive: its number, well mixed, picks hue, strength and brightness."""
    n = np.arange(1, int(frame.primitive.max(initial=-1)) + 2, dtype=np.uint32)
    n = (n ^ (n >> np.uint32(16))) * np.uint32(0x7FEB352D)  # lowbias32, as in the shader
    n = (n ^ (n >> np.uint32(15))) * np.uint32(0x846CA68B)
    n ^= n >> np.uint32(16)
    third = np.array([0.0, 2.0, 1.0], np.float32) / 3.0
    turn = ((n & 65535) / 65536.0)[:, None] + third
    hue = np.clip(np.abs((turn % 1.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0)
    strength = (0.35 + 0.5 * ((n >> 16) & 255) / 255.0)[:, None]
    brightness = (0.6 + 0.4 * ((n >> 24) & 255) / 255.0)[:, None]
    return ((1.0 + strength * (hue - 1.0)) * brightness).astype(np.float32)


def _pixel_count(frame: Frame) -> NDArray:
    """Pixels now against the highest count, logarithmic from 1 / zoom_factor to zoom_factor."""
    ratio = np.maximum(frame.pixel_count, 1) / np.maximum(frame.highest_count, 1)
    t = 0.5 + 0.5 * np.log(ratio) / np.log(max(frame.settings.zoom_factor, 1.01))
    return np.where((frame.highest_count > 0)[:, None], _mapped(t), np.asarray(GREY, np.float32))


def _depth(frame: Frame, span: tuple[float, float] | None) -> NDArray:
    """Near is bright; the range is that of the frame, or chosen."""
    near, far = span or span_of(frame, View.DEPTH)
    depth = np.where(np.isfinite(frame.depth), frame.depth, far)
    return _mapped(1.0 - np.clip(_in_range(depth, (near, far)), 0.0, 1.0))


def _difference(frame: Frame, marked: bool, beneath: float, outlines: bool, magnified: int, tone: Tone) -> NDArray:
    """Wrong pixels in their colour over the dimmed picture, and rings around them."""
    marks, colors = wrong_marks(frame, magnified), beneath * np.clip(toned(frame.color, tone), 0.0, 1.0)
    if outlines:
        colors = _outlined(frame, colors)
    if marked:
        colors[marks == Mark.RING] = np.float32(RING_DIMMING) * np.asarray(WRONG, np.float32)
    colors[marks == Mark.WRONG] = WRONG
    return colors


def _wipe(
    frame: Frame, marked: bool, wipe: float, outlines: bool, magnified: int, tone: Tone, clipping: bool
) -> NDArray:
    """Left of a line the traced picture, right of it the one in which every shadow answer is right."""
    marks, column = wrong_marks(frame, magnified), wipe_column(frame.width, wipe)
    assert frame.reference is not None
    traced = np.concatenate([frame.color[:, :column], frame.reference[:, column:]], axis=1)
    colors = _displayed(traced, tone, clipping)
    if outlines:
        colors = _outlined(frame, colors)
    if marked:
        colors[marks == Mark.RING] = WRONG
    colors[:, column : column + 1] = WIPE_LINE
    return colors


def _mapped(t: NDArray) -> NDArray:
    """Values from 0 to 1 on the colour map, between its entries as a GPU's linear filter."""
    entries = color_map()
    place = np.clip(np.clip(t, 0.0, 1.0) * len(entries) - 0.5, 0.0, len(entries) - 1.0)
    return np.stack([np.interp(place, np.arange(len(entries)), entries[:, c]) for c in range(3)], axis=-1)
