"""What is drawn above, into and under pictures that are saved: what culling saves, legends, and a caption, at sizes
that go with the picture's."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from tracer.frame import Frame
from tracer.util.text import wrapped
from viewer.state.palette import DARK, FATES, LIGHT, Color, hex_color, label_color
from viewer.state.savings import WOULD_OPACITY, bar_of, counters, in_words, placed
from viewer.views.legend import BACKDROP_OPACITY, Legend, fitting

# The least size of letters in pixels, and how many lines of them the picture's shorter side holds.
OF_LEGEND, OF_STRIP = (11, 42), (12, 36)
PAPER, INK = (1.0, 1.0, 1.0), hex_color("14161A")


@cache
def font(size: int) -> ImageFont.FreeTypeFont:
    """Return letters for pictures, so many pixels high."""
    import matplotlib  # brings a font that knows the letters of many scripts

    return ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", size)


def in_bytes(color: Color) -> tuple[int, int, int]:
    """Return a colour as pictures have it, 0 to 255."""
    red, green, blue = (round(255.0 * channel) for channel in color)
    return red, green, blue


def _letter_size(pixels: NDArray[np.uint8], least: int, lines: int) -> int:
    return max(least, round(min(pixels.shape[:2]) / lines))


def with_caption(pixels: NDArray[np.uint8], caption: str) -> NDArray[np.uint8]:
    """Return a picture (h, w, 3) with a white strip below it, as high as the words need; without any, the picture."""
    return np.concatenate([pixels, np.asarray(_strip(pixels, caption, PAPER, INK))]) if caption else pixels


def with_savings(pixels: NDArray[np.uint8], frame: Frame, comparison: str | None) -> NDArray[np.uint8]:
    """Return a picture (h, w, 3) of a frame below a strip with the sentence of what culling saves, and the bar; the
    picture itself where `comparison` is None.

    What is said there of steps and time is the `comparison`; all else is read off the frame's counters."""
    if comparison is None:
        return pixels
    bar, size = bar_of(frame), _letter_size(pixels, *OF_STRIP)
    height, margin, pad = round(1.35 * size) if bar else 0, round(0.6 * size), round(0.35 * size)
    words = ", ".join(filter(None, (in_words(counters(frame)), comparison)))
    strip = _strip(pixels, words, DARK, LIGHT, height)
    draw, letters, bottom = ImageDraw.Draw(strip), font(size), strip.height - margin
    for part, left, right, label_at, beside in placed(bar, margin, strip.width - 2 * margin, letters.getlength, pad):
        color, there = FATES[part.fate].color, WOULD_OPACITY if part.would else 1.0
        red, green, blue = np.multiply(there, color) + np.multiply(1.0 - there, DARK)
        inset = (height - (right - left)) // 2 if beside else 0
        if right > left:
            corners = left, bottom - height + inset, right - 1, bottom - inset - 1
            draw.rectangle(corners, in_bytes((red, green, blue)))
        if label_at is not None:
            said = in_bytes(LIGHT if part.would or beside else label_color(color))
            draw.text((label_at, bottom - height + round(0.1 * size)), part.label, said, letters)
    return np.concatenate([np.asarray(strip), pixels])


def _strip(pixels: NDArray[np.uint8], text: str, paper: Color, ink: Color, below: int = 0) -> Image.Image:
    """Return a strip as wide as a picture, with a text, and room for what comes `below` it, so many pixels high."""
    width, size = pixels.shape[1], _letter_size(pixels, *OF_STRIP)
    letters, margin, step = font(size), round(0.6 * size), round(1.35 * size)
    lines = wrapped(text, letters.getlength, width - 2 * margin)
    strip = Image.new("RGB", (width, 2 * margin + step * len(lines) + below), in_bytes(paper))
    draw = ImageDraw.Draw(strip)
    for number, line in enumerate(lines):
        draw.text((margin, margin + number * step), line, in_bytes(ink), letters)
    return strip


def with_legend(pixels: NDArray[np.uint8], legend: Legend, place: tuple[float, float]) -> NDArray[np.uint8] | None:
    """Return a copy of a picture (h, w, 3) with its legend; None where the picture is too small for it.

    `place` says where in the room that is left: 0, 0 is the upper left corner, 1, 1 the lower right."""
    height, width = pixels.shape[:2]
    size = _letter_size(pixels, *OF_LEGEND)
    letters, margin = font(size), round(0.5 * size)
    room = width - 2 * margin, height - 2 * margin
    layout = fitting(legend, letters.getlength, 1.2 * size, *room)
    if layout is None:
        return None
    left = round(margin + place[0] * (room[0] - layout.width))
    top = round(margin + place[1] * (room[1] - layout.height))
    area = Image.fromarray(pixels)
    box = (left, top, left + round(layout.width), top + round(layout.height))
    backdrop = Image.new("RGB", (box[2] - left, box[3] - top), in_bytes(DARK))
    area.paste(Image.blend(area.crop(box), backdrop, BACKDROP_OPACITY), box)
    draw = ImageDraw.Draw(area)
    for one in layout.boxes:
        x, y = left + one.x, top + one.y
        corners = round(x), round(y), round(x + one.width) - 1, round(y + one.height) - 1
        if corners[2] >= corners[0]:
            draw.rectangle(corners, in_bytes(one.color))
    for words in layout.words:
        draw.text((left + words.x, top + words.y), words.text, in_bytes(words.color), letters)
    return np.asarray(area)
