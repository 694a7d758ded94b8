"""What is drawn above, into and under pictures that are saved: what culling saves, legends, and a caption, at sizes
that go with the picture's."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from tracer.frame import Frame
from viewer.state.palette import FATE_COLORS, Color, label_color
from viewer.state.savings import WOULD_OPACITY, bar_of, counters, in_words, places
from viewer.views.legend import BACKDROP, BACKDROP_OPACITY, TEXT, Legend, Swatch, fitting, wrapped
from viewer.views.shadow import STRIPE

# The least size of letters in pixels, and how many lines of them the picture's shorter side holds.
LEGEND_SMALLEST, LEGEND_LINES = 11, 42
CAPTION_SMALLEST, CAPTION_LINES = 12, 36
PAPER, INK = (255, 255, 255), (20, 22, 26)


@cache
def font(size: int) -> ImageFont.FreeTypeFont:
    """Return letters for pictures, so many pixels high."""
    import matplotlib  # brings a font that knows the letters of many scripts

    return ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf", size)


def in_bytes(color: Color) -> tuple[int, int, int]:
    """Return a colour as pictures have it, 0 to 255."""
    red, green, blue = (round(255.0 * channel) for channel in color)
    return red, green, blue


def with_caption(pixels: NDArray[np.uint8], caption: str) -> NDArray[np.uint8]:
    """Return a picture (h, w, 3) with a white strip below it, as high as the words need; without any, the picture."""
    if not caption:
        return pixels
    height, width = pixels.shape[:2]
    size = max(CAPTION_SMALLEST, round(min(width, height) / CAPTION_LINES))
    letters, margin, step = font(size), round(0.6 * size), round(1.35 * size)
    lines = _broken(caption, lambda text: letters.getlength(text) <= width - 2 * margin)
    strip = Image.new("RGB", (width, 2 * margin + step * len(lines)), PAPER)
    draw = ImageDraw.Draw(strip)
    for number, line in enumerate(lines):
        draw.text((margin, margin + number * step), line, INK, letters)
    return np.concatenate([pixels, np.asarray(strip)])


def with_savings(pixels: NDArray[np.uint8], frame: Frame, comparison: str | None) -> NDArray[np.uint8]:
    """Return a picture (h, w, 3) of a frame below a strip with the sentence of what culling saves, and the bar; the
    picture itself where `comparison` is None.

    What is said there of steps and time is the `comparison`; all else is read off the frame's counters."""
    if comparison is None:
        return pixels
    height, width = pixels.shape[:2]
    size = max(CAPTION_SMALLEST, round(min(width, height) / CAPTION_LINES))
    letters, margin, step = font(size), round(0.6 * size), round(1.35 * size)
    words = ", ".join(filter(None, (in_words(counters(frame)), comparison)))
    lines, bar = wrapped(words, letters.getlength, width - 2 * margin), bar_of(frame)
    strip = Image.new("RGB", (width, 2 * margin + step * (len(lines) + bool(bar))), in_bytes(BACKDROP))
    draw = ImageDraw.Draw(strip)
    for number, line in enumerate(lines):
        draw.text((margin, margin + number * step), line, in_bytes(TEXT), letters)
    top, pad = margin + len(lines) * step, round(0.35 * size)
    for part, left, right in places(bar, margin, width - margin):
        if right > left:
            color, there = FATE_COLORS[part.fate], WOULD_OPACITY if part.would else 1.0
            drawn = np.multiply(there, color) + np.multiply(1.0 - there, BACKDROP)
            draw.rectangle((left, top, right - 1, top + step - 1), in_bytes((drawn[0], drawn[1], drawn[2])))
            text = part.label(letters.getlength, right - left - 2 * pad)
            said = TEXT if part.would else label_color(color)
            draw.text((left + pad, top + round(0.1 * size)), text, in_bytes(said), letters)
    return np.concatenate([np.asarray(strip), pixels])


def _broken(text: str, fits: Callable[[str], bool]) -> list[str]:
    """The words in lines that fit; a word that is too long by itself is broken where it must be."""
    lines = [""]
    for word in text.split():
        if fits(longer := f"{lines[-1]} {word}".strip()):
            lines[-1] = longer
            continue
        lines.append("")
        for letter in word:
            if lines[-1] and not fits(lines[-1] + letter):
                lines.append("")
            lines[-1] += letter
    return list(filter(None, lines))


def with_legend(pixels: NDArray[np.uint8], legend: Legend, place: tuple[float, float]) -> NDArray[np.uint8] | None:
    """Return a copy of a picture (h, w, 3) with its legend; None where the picture is too small for it.

    `place` says where in the room that is left: 0, 0 is the upper left corner, 1, 1 the lower right."""
    height, width = pixels.shape[:2]
    size = max(LEGEND_SMALLEST, round(min(width, height) / LEGEND_LINES))
    letters, margin = font(size), round(0.5 * size)
    room = width - 2 * margin, height - 2 * margin
    layout = fitting(legend, letters.getlength, 1.2 * size, *room)
    if layout is None:
        return None
    left = round(margin + place[0] * (room[0] - layout.width))
    top = round(margin + place[1] * (room[1] - layout.height))
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


def _fill(image: Image.Image, draw: ImageDraw.ImageDraw, swatch: Swatch, left: int, top: int) -> None:
    x, y = left + round(swatch.x), top + round(swatch.y)
    width, height = max(1, round(swatch.width)), max(1, round(swatch.height))
    if swatch.color is None:
        colors = np.round(swatch.colors(width) * 255.0).astype(np.uint8)
        bar = np.broadcast_to(colors, (height, width, 3))
        image.paste(Image.fromarray(np.ascontiguousarray(bar)), (x, y))
        return
    draw.rectangle((x, y, x + width - 1, y + height - 1), in_bytes(swatch.color))
    if swatch.stripes is not None:
        rows, columns = np.nonzero(np.add.outer(np.arange(height), np.arange(width)) // STRIPE % 2)
        draw.point(np.stack([x + columns, y + rows], axis=1).reshape(-1).tolist(), in_bytes(swatch.stripes))
