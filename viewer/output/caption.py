"""A caption under a picture: a strip with what it shows, in words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from viewer.output.legend_picture import font

LONGEST = 500
SMALLEST, LINES = 12, 36
"""The least size of letters in pixels, and how many lines of them the picture's shorter side would hold."""
PAPER, INK = (255, 255, 255), (20, 22, 26)


def with_caption(pixels: NDArray[np.uint8], caption: str) -> NDArray[np.uint8]:
    """A picture (h, w, 3) with a white strip below it, as high as the words need; the picture itself without any."""
    if not caption:
        return pixels
    height, width = pixels.shape[:2]
    size = max(SMALLEST, round(min(width, height) / LINES))
    letters, margin, step = font(size), round(0.6 * size), round(1.35 * size)
    lines = _broken(caption, lambda text: letters.getlength(text) <= width - 2 * margin)
    strip = Image.new("RGB", (width, 2 * margin + step * len(lines)), PAPER)
    draw = ImageDraw.Draw(strip)
    for number, line in enumerate(lines):
        draw.text((margin, margin + number * step), line, INK, letters)
    return np.concatenate([pixels, np.asarray(strip)])


def _broken(text: str, fits: Callable[[str], bool]) -> list[str]:
    """The words in lines that fit; a word that is too long by itself is broken where it must be."""
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if fits(longer):
            line = longer
            continue
        if line:
            lines.append(line)
        while not fits(word) and len(word) > 1:
            part = next((n for n in range(len(word) - 1, 1, -1) if fits(word[:n])), 1)
            lines.append(word[:part])
            word = word[part:]
        line = word
    return [*lines, line] if line else lines
