"""What views share in turning the buffers of a frame into pixels.

Three kernels go over a picture once each, on one core and without the GIL: flat colours by class, a number on the
colour map, or any colours.  All end the same way: with some of the picture's light and shade, the background where
nothing is hit, and lines between cells and between primitives.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.kernels import inlined, kernel
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import BACKGROUND, GREY, color_map

Pixels = NDArray[np.uint8]

OUTLINE = 0.35
"""Brightness of the borders between primitives, against what is there."""
CELL_LINE = 0.55
"""Brightness of the lines between cells, against that of the cells."""
FAINT_LINE = 0.72
"""The same where cells have many colours, and may be small."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)

_BACKGROUND, _GREY = np.asarray(BACKGROUND, np.float32), np.asarray(GREY, np.float32)
_MAP = color_map().astype(np.float64)
_ONE = np.float32(1.0)


# --- for views -----------------------------------------------------------------------------------


def by_class(
    frame: Frame,
    draw: DrawOptions,
    index: NDArray[np.int32],
    classes: NDArray[np.uint8],
    palette: NDArray[np.float32],
    striped: NDArray[np.float32] | None = None,
    stripe: int = 1,
    cells: NDArray[np.int32] | None = None,
) -> Pixels:
    """Draw the colour `palette[classes[index]]` of each pixel, shaded.

    In every second stripe, so many pixels across, `striped` takes the place of the palette.  Between `cells` there are
    lines."""
    pixels, classes = _empty(frame), classes if len(classes) else np.zeros(1, np.uint8)
    _paint_classes(
        index, classes, palette, palette if striped is None else striped, stripe, frame.color, np.float32(draw.shading),
        frame.primitive, _BACKGROUND, frame.primitive if cells is None else cells,
        _ONE if cells is None else np.float32(CELL_LINE), np.float32(_outline(draw)), pixels,
    )  # fmt: skip
    return pixels


def by_code(frame: Frame, draw: DrawOptions, codes: NDArray, palette: NDArray[np.float32]) -> Pixels:
    """Draw the colour of the code (h, w) at each pixel, shaded."""
    return by_class(frame, draw, codes.astype(np.int32), np.arange(len(palette), dtype=np.uint8), palette)


def by_number(
    frame: Frame,
    draw: DrawOptions,
    place: NDArray,
    known: NDArray[np.bool_] | None = None,
    cells: NDArray[np.int32] | None = None,
    shading: float = 0.0,
) -> Pixels:
    """Draw numbers (h, w), 0 to 1, on the colour map, and grey where they are not `known`."""
    pixels = _empty(frame)
    place = on_map(place).astype(np.float64)
    if known is not None:
        place[~known] = np.nan
    _paint_numbers(
        place, _MAP, _GREY, frame.color, np.float32(shading), frame.primitive, _BACKGROUND,
        frame.primitive if cells is None else cells, 1.0 if cells is None else FAINT_LINE, _outline(draw), pixels,
    )  # fmt: skip
    return pixels


def by_color(
    frame: Frame, draw: DrawOptions, colors: NDArray[np.float32], shading: float = 0.0, everywhere: bool = False
) -> Pixels:
    """Draw colours (h, w, 3), `everywhere` or only where something is hit."""
    pixels = _empty(frame)
    colors = np.ascontiguousarray(colors, np.float32)
    _paint_colors(
        colors, everywhere, frame.color, np.float32(shading), frame.primitive, _BACKGROUND,
        np.float32(_outline(draw)), pixels,
    )  # fmt: skip
    return pixels


def in_bytes(color: tuple[float, float, float] | NDArray) -> Pixels:
    """Return colours as pixels have them."""
    return np.round(np.clip(np.asarray(color, np.float32), 0.0, 1.0) * 255.0).astype(np.uint8)


def in_range(numbers: NDArray, span: tuple[float, float]) -> NDArray:
    """Return numbers as places on the colour map, 0 to 1 inside the range."""
    return (numbers - span[0]) / (span[1] - span[0])


def on_map(t: NDArray) -> NDArray:
    """Return places between the 256 entries of the colour map, as a linear filter reads it."""
    return np.clip(np.clip(t, 0.0, 1.0) * 256 - 0.5, 0.0, 255.0)


def mapped(t: NDArray) -> NDArray[np.float64]:
    """Return the colours (..., 3) of numbers from 0 to 1 on the colour map."""
    place = on_map(t)
    return np.stack([np.interp(place, np.arange(len(_MAP)), _MAP[:, c]) for c in range(3)], axis=-1)


def shaded(frame: Frame, flat: NDArray, shading: float, where: NDArray[np.bool_]) -> NDArray:
    """Return flat colours (n, 3) of some pixels with some of the traced picture's light and shade."""
    light = 0.25 + 0.95 * np.sqrt(np.clip(frame.color[where], 0.0, 1.0) @ LUMINANCE)
    return np.clip(flat * (1.0 + shading * (light[:, None] - 1.0)), 0.0, 1.0)


def on_line(cells: NDArray) -> NDArray[np.bool_]:
    """Find the pixels whose neighbour to the right, or below, is another."""
    line = np.zeros(cells.shape, np.bool_)
    line[:, :-1] |= cells[:, 1:] != cells[:, :-1]
    line[:-1] |= cells[1:] != cells[:-1]
    return line


def checkered(shape: tuple[int, int], stripe: int) -> NDArray[np.int64]:
    """Return 0 and 1 in slanted stripes, so many pixels across."""
    y, x = np.indices(shape)
    return (x + y) // stripe % 2


def make_ready() -> None:
    """Compile the kernels, or load what has been compiled."""
    one, color, pixels = np.zeros((1, 1), np.int32), np.zeros((1, 1, 3), np.float32), np.empty((1, 1, 3), np.uint8)
    end = one, _BACKGROUND
    _paint_classes(one, np.zeros(1, np.uint8), color[0], color[0], 1, color, _ONE, *end, one, _ONE, _ONE, pixels)
    _paint_numbers(np.zeros((1, 1)), _MAP, _GREY, color, _ONE, *end, one, 1.0, 1.0, pixels)
    _paint_colors(color, True, color, _ONE, *end, _ONE, pixels)


def _empty(frame: Frame) -> Pixels:
    return np.empty((*frame.primitive.shape, 3), np.uint8)


def _outline(draw: DrawOptions) -> float:
    return OUTLINE if draw.outlines else 1.0


# --- kernels -------------------------------------------------------------------------------------


@inlined
def _shade_row(color, y, shading, factor):
    """Find by what the light and shade of the picture multiplies flat colours, with the sums of fused products."""
    zero, one = np.float32(0), np.float32(1)
    red, green, blue = np.float32(0.2126), np.float64(np.float32(0.7152)), np.float64(np.float32(0.0722))
    for x in range(color.shape[1]):
        r, g, b = min(max(color[y, x, 0], zero), one), min(max(color[y, x, 1], zero), one), color[y, x, 2]
        luminance = np.float32(np.float64(g) * green + np.float64(r * red))
        luminance = np.float32(np.float64(min(max(b, zero), one)) * blue + np.float64(luminance))
        light = np.float32(0.25) + np.float32(0.95) * np.sqrt(luminance)
        factor[x] = one + shading * (light - one)


@inlined
def _line_row(cells, y, line, plain, factor):
    """Find by what lines multiply colours: `line` where the neighbour to the right, or below, is another."""
    h, w = cells.shape
    below = y + 1 if y + 1 < h else y
    for x in range(w):
        right = x + 1 if x + 1 < w else x
        cell = cells[y, x]
        factor[x] = line if (cells[y, right] != cell) | (cells[below, x] != cell) else plain


@kernel
def _paint_classes(
    index, classes, palette, striped, stripe, color, shading, primitive, background, cells, line, outline, pixels
):
    one, zero, most = np.float32(1), np.float32(0), np.float32(255)
    h, w = primitive.shape
    shade, border, edge = np.ones(w, np.float32), np.ones(w, np.float32), np.ones(w, np.float32)
    row = np.empty((w, 3), np.float32)
    for y in range(h):
        _shade_row(color, y, shading, shade)
        if line < one:
            _line_row(cells, y, line, one, border)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            if primitive[y, x] < 0:
                row[x, 0], row[x, 1], row[x, 2] = background[0], background[1], background[2]
                shade[x] = border[x] = one
            else:
                k = classes[index[y, x]]
                row[x, 0], row[x, 1], row[x, 2] = palette[k, 0], palette[k, 1], palette[k, 2]
        if stripe > 1:
            for x in range(w):
                if primitive[y, x] >= 0 and (x + y) // stripe % 2 == 1:
                    k = classes[index[y, x]]
                    row[x, 0], row[x, 1], row[x, 2] = striped[k, 0], striped[k, 1], striped[k, 2]
        for x in range(w):
            for c in range(3):
                shown = min(max(row[x, c] * shade[x], zero), one) * border[x] * edge[x]
                pixels[y, x, c] = np.uint8(np.rint(shown * most))


@kernel
def _paint_numbers(place, colors, unknown, color, shading, primitive, background, cells, line, outline, pixels):
    one, zero = np.float64(1), np.float64(0)
    h, w = primitive.shape
    shade, border, edge = np.ones(w, np.float32), np.ones(w), np.ones(w)
    for y in range(h):
        if shading > np.float32(0):
            _shade_row(color, y, shading, shade)
        if line < one:
            _line_row(cells, y, line, one, border)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            t = place[y, x]
            missed, known = primitive[y, x] < 0, t == t
            i = min(int(t), 255) if known else 0
            j = min(i + 1, 255)
            for c in range(3):
                if missed:
                    shown = np.float64(background[c])
                else:
                    flat = (colors[j, c] - colors[i, c]) * (t - i) + colors[i, c] if known else np.float64(unknown[c])
                    shown = min(max(flat * np.float64(shade[x]), zero), one) * border[x]
                pixels[y, x, c] = np.uint8(np.rint(shown * edge[x] * 255.0))


@kernel
def _paint_colors(colors, everywhere, color, shading, primitive, background, outline, pixels):
    one, zero, most = np.float32(1), np.float32(0), np.float32(255)
    h, w = primitive.shape
    shade, edge = np.ones(w, np.float32), np.ones(w, np.float32)
    for y in range(h):
        if shading > zero:
            _shade_row(color, y, shading, shade)
        if outline < one:
            _line_row(primitive, y, outline, one, edge)
        for x in range(w):
            missed = primitive[y, x] < 0 and not everywhere
            for c in range(3):
                shown = background[c] if missed else min(max(colors[y, x, c] * shade[x], zero), one)
                pixels[y, x, c] = np.uint8(np.rint(shown * edge[x] * most))
