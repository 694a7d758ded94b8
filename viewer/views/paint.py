"""What views share in turning the buffers of a frame, and slices through space, into pixels.

Two kernels go over a picture once each, on one core and without the GIL: one draws the colours of a table, by class or
by a number on the colour map, and the other any colours.  Both end the same way: with some of the picture's light and
shade, the background where nothing is hit, and lines between cells and between primitives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.frame import EVERYWHERE, Frame, Region
from tracer.geometry.camera import pinhole
from viewer.state.draw_options import DrawOptions
from viewer.state.palette import BACKGROUND, GREY, color_map
from viewer.views import kernels

Pixels = NDArray[np.uint8]

OUTLINE = 0.35
"""Brightness of the borders between primitives, against what is there."""
CELL_LINE = 0.55
"""Brightness of the lines between cells, against that of the cells."""
FAINT_LINE = 0.72
"""The same where cells have many colours, and may be small."""
FEWEST = 6.0
"""Pixels that parts of space must be wide for their borders to be drawn."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)

_BACKGROUND = np.asarray(BACKGROUND, np.float32)
_MAP = color_map(1024)  # so fine that no step of a channel is left out
_MAP_AND_GREY = np.concatenate([_MAP, np.asarray([GREY], np.float32)])
_ONE = np.float32(1.0)


def by_class(
    frame: Frame, draw: DrawOptions, classes: NDArray, palette: NDArray[np.float32], stripe: int = 0,
    cells: NDArray[np.int32] | None = None, line: float = CELL_LINE, shading: float | None = None,
) -> Pixels:  # fmt: skip
    """Draw the colour of the class (h, w) of each pixel, shaded; between `cells` there is a `line`.

    Stripes of so many pixels take their colours from the first and the second half of the palette in turn."""
    pixels = _empty(frame)
    kernels.paint_table(
        classes.astype(np.int32), palette, stripe, frame.color,
        np.float32(draw.shading if shading is None else shading), frame.primitive, _BACKGROUND,
        frame.primitive if cells is None else cells, _ONE if cells is None else np.float32(line),
        np.float32(outline(draw)), pixels,
    )  # fmt: skip
    return pixels


def by_number(
    frame: Frame, draw: DrawOptions, place: NDArray, known: NDArray[np.bool_] | None = None,
    cells: NDArray[np.int32] | None = None, shading: float = 0.0,
) -> Pixels:  # fmt: skip
    """Draw numbers (h, w), 0 to 1, on the colour map, and grey where they are not `known`."""
    index = on_map(place)
    if known is not None:
        index[~known] = len(_MAP)
    return by_class(frame, draw, index, _MAP_AND_GREY, 0, cells, FAINT_LINE, shading)


def by_color(
    frame: Frame, draw: DrawOptions, colors: NDArray[np.float32], shading: float = 0.0, everywhere: bool = False
) -> Pixels:
    """Draw colours (h, w, 3), `everywhere` or only where something is hit."""
    pixels = _empty(frame)
    colors = np.ascontiguousarray(colors, np.float32)
    kernels.paint_colors(
        colors, everywhere, frame.color, np.float32(shading), frame.primitive, _BACKGROUND,
        np.float32(outline(draw)), pixels,
    )  # fmt: skip
    return pixels


def in_bytes(color: tuple[float, float, float] | NDArray) -> Pixels:
    """Return colours as pixels have them."""
    return np.round(np.clip(np.asarray(color, np.float32), 0.0, 1.0) * 255.0).astype(np.uint8)


def in_range(numbers: NDArray, span: tuple[float, float]) -> NDArray:
    """Return numbers as places on the colour map, 0 to 1 inside the range."""
    return (numbers - span[0]) / (span[1] - span[0])


def on_map(t: NDArray) -> NDArray[np.int32]:
    """Return which colours of the map stand for numbers, of which it has those from 0 to 1."""
    return np.rint(np.clip(t, 0.0, 1.0) * (len(_MAP) - 1)).astype(np.int32)


def mapped(t: NDArray) -> NDArray[np.float32]:
    """Return the colours (..., 3) of numbers from 0 to 1 on the colour map."""
    return _MAP[on_map(t)]


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


class Met(NamedTuple):
    """Where the ray of each pixel meets a plane: `points` (h, w, 3), not a number where it does not, and how far away
    that is; `behind` says that something lies before it, and `per_pixel` is how wide a pixel is there."""

    points: NDArray[np.float32]
    behind: NDArray[np.bool_]
    per_pixel: NDArray[np.float32]


def met(frame: Frame, axis: int, place: float, where: Region = EVERYWHERE) -> Met:
    """Find where the rays of a frame, or of some of its pixels, meet a plane across an axis."""
    rays, depth = pinhole(frame.camera, frame.width, frame.height), frame.depth[where]
    x, y = np.arange(frame.width, dtype=np.float32)[where[1]], np.arange(frame.height, dtype=np.float32)[where[0]]
    points, plane = np.empty((*depth.shape, 3), np.float32), np.float32(place)
    with np.errstate(all="ignore"):
        ways = [rays.corner[k] + x * rays.column[k] + y[:, None] * rays.row[k] for k in range(3)]
        t = np.where(ways[axis] != 0.0, (plane - np.float32(rays.origin[axis])) / ways[axis], np.nan)
        t = np.where(t > 0.0, t, np.nan).astype(np.float32)
        for k in range(3):
            points[..., k] = plane + 0.0 * t if k == axis else rays.origin[k] + t * ways[k]
        distance = t * np.sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2])
        return Met(points, distance >= depth, distance * rays.spread)


def wide_enough(width: NDArray[np.float32] | float, per_pixel: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Find where parts of space of this width are large enough for their borders to be drawn."""
    with np.errstate(invalid="ignore"):
        found: NDArray[np.bool_] = width >= FEWEST * per_pixel
    return found


def make_ready() -> None:
    """Compile the kernels, or load what has been compiled."""
    one, color, pixels = np.zeros((1, 1), np.int32), np.zeros((1, 1, 3), np.float32), np.empty((1, 1, 3), np.uint8)
    end = color, _ONE, one, _BACKGROUND
    kernels.paint_table(one, color[0], 0, *end, one, _ONE, _ONE, pixels)
    kernels.paint_colors(color, True, *end, _ONE, pixels)


def _empty(frame: Frame) -> Pixels:
    return np.empty((*frame.primitive.shape, 3), np.uint8)


def outline(draw: DrawOptions) -> float:
    """Return how bright the borders of primitives are."""
    return OUTLINE if draw.outlines else 1.0
