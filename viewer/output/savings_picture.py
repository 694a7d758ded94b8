"""What culling saves in pictures that are saved: a strip above the picture, with the sentence and the bar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from tracer.frame import Frame
from viewer.output.overlays import CAPTION_LINES, CAPTION_SMALLEST, font, in_bytes
from viewer.state.palette import FATE_COLORS, Color, label_color
from viewer.state.savings import PALE, Bar, bar_of, counters_in_words
from viewer.views.legend import BACKDROP, TEXT, wrapped


def with_savings(pixels: NDArray[np.uint8], frame: Frame, comparison: str | None) -> NDArray[np.uint8]:
    """A picture (h, w, 3) of a frame below a strip; the picture itself where `comparison` is None.

    What is said there of steps and time is the `comparison`; all else is read off the frame's counters."""
    if comparison is None:
        return pixels
    height, width = pixels.shape[:2]
    size = max(CAPTION_SMALLEST, round(min(width, height) / CAPTION_LINES))
    letters, margin, step = font(size), round(0.6 * size), round(1.35 * size)
    words = ", ".join(filter(None, (counters_in_words(frame), comparison)))
    lines = wrapped(words, letters.getlength, width - 2 * margin)
    bar = bar_of(frame)
    strip = Image.new("RGB", (width, 2 * margin + step * (len(lines) + bool(bar.parts))), in_bytes(BACKDROP))
    draw = ImageDraw.Draw(strip)
    for number, line in enumerate(lines):
        draw.text((margin, margin + number * step), line, in_bytes(TEXT), letters)
    if bar.parts:
        box = margin, margin + len(lines) * step, width - margin, margin + (len(lines) + 1) * step
        _draw(strip, draw, bar, box, size)
    return np.concatenate([np.asarray(strip), pixels])


def _draw(strip: Image.Image, draw: ImageDraw.ImageDraw, bar: Bar, box: tuple[int, int, int, int], size: int) -> None:
    """The parts beside each other, each as wide as its share."""
    left, top, right, bottom = box
    letters, done, pad = font(size), 0, round(0.35 * size)
    for part in bar.parts:
        start, end = (left + round((right - left) * rays / part.due) for rays in (done, done + part.rays))
        done += part.rays
        if end <= start:
            continue
        color = FATE_COLORS[part.fate]
        strip.paste(Image.fromarray(_filled(color, end - start, bottom - top, size, bar.would)), (start, top))
        text = part.label(letters.getlength, end - start - 2 * pad)
        if bar.would and text:
            back = start + pad + round(letters.getlength(text)) + pad // 2
            draw.rectangle((start + pad // 2, top, back, bottom), in_bytes(BACKDROP))
        said = TEXT if bar.would else label_color(color)
        draw.text((start + pad, top + round(0.1 * size)), text, in_bytes(said), letters)


def _filled(color: Color, width: int, height: int, size: int, hatched: bool) -> NDArray[np.uint8]:
    """(height, width, 3) of a colour, in stripes where it is hatched."""
    full = np.array(in_bytes(color), np.float32)
    if not hatched:
        return np.full((height, width, 3), full, np.uint8)
    y, x = np.indices((height, width))
    stripe = ((x + y) % (size // 2 + 2) < size // 4 + 1)[..., None]
    pale = PALE * full + (1.0 - PALE) * np.array(in_bytes(BACKDROP), np.float32)
    return np.where(stripe, full, pale).astype(np.uint8)
