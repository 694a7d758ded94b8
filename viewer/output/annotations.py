"""Arrows, boxes and words, drawn into a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from viewer.output.legend_picture import font
from viewer.state.annotations import Annotation, Kind

INK, EDGE = (255, 214, 10), (16, 18, 22)
"""Bright on dark, so that they are seen on any picture."""
LINE, LETTERS, HEAD = 1 / 220, 1 / 24, 7.0
"""Widths of lines and heights of letters, in parts of the shorter side; an arrow's head, in widths of its line."""


def line_width(width: int, height: int) -> int:
    """Pixels of a line on a picture of this size."""
    return max(2, round(LINE * min(width, height)))


def letter_height(width: int, height: int) -> int:
    """Pixels of letters on a picture of this size."""
    return max(11, round(LETTERS * min(width, height)))


def head_of(start: tuple[float, float], end: tuple[float, float], width: float) -> list[tuple[float, float]]:
    """The three corners of an arrow's head, its tip first, for a line of this width."""
    length = math.hypot(end[0] - start[0], end[1] - start[1]) or 1.0
    x, y = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    long = min(HEAD * width, 0.8 * length)
    back = end[0] - long * x, end[1] - long * y
    half = 0.45 * long
    return [end, (back[0] - half * y, back[1] + half * x), (back[0] + half * y, back[1] - half * x)]


def annotated(pixels: NDArray[np.uint8], annotations: Sequence[Annotation]) -> NDArray[np.uint8]:
    """A copy of a picture (h, w, 3) with its annotations, each on a dark edge; the picture itself without any."""
    if not annotations:
        return pixels
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    height, width = pixels.shape[:2]
    line = line_width(width, height)
    for each in annotations:
        start, end = (each.x0 * width, each.y0 * height), (each.x1 * width, each.y1 * height)
        if each.kind is Kind.TEXT:
            letters = font(letter_height(width, height))
            draw.text(start, each.text, INK, letters, stroke_width=max(1, line // 2), stroke_fill=EDGE)
        elif each.kind is Kind.BOX:
            (left, right), (top, bottom) = sorted((start[0], end[0])), sorted((start[1], end[1]))
            draw.rectangle((left - line / 2, top - line / 2, right + line / 2, bottom + line / 2), None, EDGE, 2 * line)
            draw.rectangle((left, top, right, bottom), None, INK, line)
        else:
            _arrow(draw, start, end, line + 2 * max(1, line // 2), EDGE, line)
            _arrow(draw, start, end, line, INK, line)
    return np.asarray(image)


def _arrow(
    draw: ImageDraw.ImageDraw,
    start: tuple[float, float],
    end: tuple[float, float],
    width: int,
    ink: tuple[int, int, int],
    line: int,
) -> None:
    tip, left, right = head_of(start, end, line)
    middle = (left[0] + right[0]) / 2, (left[1] + right[1]) / 2
    draw.line((start, middle), ink, width)
    draw.polygon([tip, left, right], ink, ink, max(1, width - line + 1))
