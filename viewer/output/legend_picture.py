"""Legends in pictures that are saved: drawn without a window, at a size that goes with the picture's."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from viewer.state.palette import Color, color_map, signed_map
from viewer.views.legend import BACKDROP, BACKDROP_OPACITY, Layout, Legend, Swatch, fitting
from viewer.views.shadow import STRIPE

SMALLEST, LINES = 11, 42
"""The least size of letters in pixels, and how many lines of them a picture holds at least from edge to edge."""


@cache
def font(size: int) -> ImageFont.FreeTypeFont:
    """Letters for pictures, so many pixels high."""
    import matplotlib  # brings a font that knows the letters of many scripts

    return ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", size)


def with_legend(pixels: NDArray[np.uint8], legend: Legend, place: tuple[float, float]) -> NDArray[np.uint8] | None:
    """A copy of a picture (h, w, 3) with its legend; None where the picture is too small for it.

    `place` says where in the room that is left: 0, 0 is the upper left corner, 1, 1 the lower right."""
    height, width = pixels.shape[:2]
    size = max(SMALLEST, round(min(width, height) / LINES))
    letters, margin = font(size), round(0.5 * size)
    room = width - 2 * margin, height - 2 * margin
    layout = fitting(legend, letters.getlength, 1.2 * size, *room)
    if layout is None:
        return None
    left, top = (round(margin + part * (free - taken)) for part, free, taken in zip(place, room, _size_of(layout)))
    area = Image.fromarray(pixels)
    box = (left, top, left + round(layout.width), top + round(layout.height))
    backdrop = Image.new("RGB", (box[2] - left, box[3] - top), in_bytes(BACKDROP))
    area.paste(Image.blend(area.crop(box), backdrop, BACKDROP_OPACITY), box)
    draw = ImageDraw.Draw(area)
    for swatch in layout.swatches:
        _fill(area, draw, swatch, left, top)
    for words in layout.words:
        draw.text((left + words.x, top + words.y), words.text, in_bytes(words.color), letters)
    return np.asarray(area)


def _size_of(layout: Layout) -> tuple[float, float]:
    return layout.width, layout.height


def _fill(image: Image.Image, draw: ImageDraw.ImageDraw, swatch: Swatch, left: int, top: int) -> None:
    x, y = left + round(swatch.x), top + round(swatch.y)
    width, height = max(1, round(swatch.width)), max(1, round(swatch.height))
    if swatch.color is not None:
        draw.rectangle((x, y, x + width - 1, y + height - 1), in_bytes(swatch.color))
        if swatch.stripes is not None:
            rows, columns = np.nonzero(np.add.outer(np.arange(height), np.arange(width)) // STRIPE % 2)
            draw.point(np.stack([x + columns, y + rows], axis=1).reshape(-1).tolist(), in_bytes(swatch.stripes))
        return
    colors = np.round((signed_map if swatch.signed else color_map)(width) * 255.0).astype(np.uint8)
    bar = np.broadcast_to(colors[::-1] if swatch.reverse else colors, (height, width, 3))
    image.paste(Image.fromarray(np.ascontiguousarray(bar)), (x, y))


def in_bytes(color: Color) -> tuple[int, int, int]:
    """A colour as pictures have it, 0 to 255."""
    red, green, blue = (round(255.0 * channel) for channel in color)
    return red, green, blue
