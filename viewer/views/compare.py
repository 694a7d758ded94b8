"""Two pictures as one: the signed difference of two frames in numbers, colours and words, and both in one picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viewer.state.comparison import CompareMode
from viewer.state.draw_options import AXES
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE
from viewer.util.numbers import count, percent
from viewer.views.base import Lines, Pixels, Values
from viewer.views.color import CHANNELS
from viewer.views.difference import Mark, marks
from viewer.views.legend import Entry, Legend, Note, NoteKind, Scale, fact
from viewer.views.paint import in_bytes
from viewer.views.wipe import wipe_column

ENDLESS = 1e29
"""From here on a difference is one without end: one of the two pictures has no value there."""
HIDDEN_SHARE = 0.5
"""Per cent of the pixels that differ, at most, which lie beyond the range of a difference that is fitted."""
MOST_RINGED = 0.05
"""The part of the pixels that differ up to which they have rings: of more, the rings would be the picture."""
GAP = 4
"""Pixels between pictures that are saved side by side."""
_RING = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class DiffStats:
    """How far two pictures are apart: pixels that differ, of so many, the least, the largest and the mean difference;
    `limit` is the range, to both sides of 0, that shows nearly all."""

    pixels: int
    of: int
    least: float
    largest: float
    mean: float
    limit: float


@dataclass(frozen=True, eq=False)  # arrays cannot be compared as one
class Difference:
    """B - A at each pixel of B, (h, w) float32, of such values, and its statistics."""

    pixels: NDArray[np.float32]
    values: Values
    stats: DiffStats

    @property
    def differing(self) -> Values:
        """The differences as values, of the pixels that have one."""
        size = np.abs(self.pixels)
        return Values(self.pixels[..., None], ("B - A",), (size > 0.0) & (size < ENDLESS), self.values.classes)

    def words(self, x: int, y: int) -> Lines:
        """Return what it says of one pixel."""
        apart = float(self.pixels[y, x])
        if self.values.classes:
            return ("other",) if apart else ("same",)
        if abs(apart) > ENDLESS:
            return ("no value", "in A" if apart < 0.0 else "in B")
        return (f"{apart:+.3g}" if apart else "0",)


def difference_of(a: Values, b: Values) -> Difference:
    """Return B - A at the pixels of B: in the channel where they differ most; 1 where classes are others."""
    height, width = b.numbers.shape[:2]
    apart = _apart(fitted(a.numbers, (width, height)), b.numbers)
    if b.classes:
        pixels = (apart[..., 0] != 0.0).astype(np.float32)
    else:
        pixels = np.take_along_axis(apart, np.abs(apart).argmax(axis=-1)[..., None], -1)[..., 0]
    return Difference(pixels, b, diff_stats(pixels))


def _apart(a: NDArray[np.float32], b: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return b - a; without end where only one of them is a number, and 0 where neither is."""
    with np.errstate(invalid="ignore", over="ignore"):
        apart = b - a
    unknown = np.isnan(apart)
    if unknown.any():  # also infinity less infinity
        only_b = np.isnan(a) & ~np.isnan(b)
        same = (a == b) | (np.isnan(a) & np.isnan(b))
        apart[unknown] = np.where(same, 0.0, np.where(only_b, -np.inf, np.inf))[unknown]
    return apart


def diff_stats(difference: NDArray[np.float32]) -> DiffStats:
    """Sum a difference up.  Where one of the two pictures has no value, it counts as differing, and no further."""
    finite = np.where(np.abs(difference) < ENDLESS, difference, np.float32(0.0))
    changed = finite[finite != 0.0]
    return DiffStats(
        pixels=int(np.count_nonzero(difference)),
        of=difference.size,
        least=float(finite.min(initial=0.0)),
        largest=float(finite.max(initial=0.0)),
        mean=float(finite.mean(dtype=np.float64)) if finite.size else 0.0,
        limit=float(np.percentile(np.abs(changed), 100.0 - HIDDEN_SHARE)) if len(changed) else 1.0,
    )


def fitted(a: NDArray, size: tuple[int, int]) -> NDArray:
    """Return A (h, w, ...) at the pixels of a picture of this width and height: of each the nearest."""
    width, height = size
    rows = ((2 * np.arange(height) + 1) * a.shape[0]) // (2 * height)
    columns = ((2 * np.arange(width) + 1) * a.shape[1]) // (2 * width)
    return a if a.shape[:2] == (height, width) else a[rows[:, None], columns[None]]


def signed_picture(found: Difference, limit: float, ringed: bool) -> Pixels:
    """Draw a signed difference in false colour, as far as `limit` to both sides, (h, w, 3) uint8; `ringed`: with rings
    around pixels that differ, or around each crowd of them, where these are few."""
    t = np.clip(found.pixels / np.float32(limit), -1.0, 1.0)[..., None]
    less, same, more = (np.asarray(color, np.float32) for color in (LESS, SAME, MORE))
    pixels = in_bytes(same + np.abs(t) * (np.where(t < 0.0, less, more) - same))
    if ringed and found.stats.pixels <= MOST_RINGED * found.stats.of:
        pixels[marks(found.pixels != 0.0) == Mark.RING] = in_bytes(_RING)
    return pixels


def composed(a: Pixels, b: Pixels, mode: CompareMode, wipe: float, shows_a: bool) -> Pixels:
    """Return what a comparison shows of two pictures, in the size of B, or twice as wide side by side."""
    height, width = b.shape[:2]
    a = fitted(a, (width, height))
    if mode is CompareMode.SIDE:
        return np.concatenate([a, np.zeros((height, GAP, 3), np.uint8), b], axis=1)
    if mode is CompareMode.WIPE and not shows_a:
        column = wipe_column(width, wipe)
        both = np.concatenate([a[:, :column], b[:, column:]], axis=1)
        both[:, column : column + 1] = in_bytes(WIPE_LINE)
        return both
    return a if shows_a else b


def difference_legend(found: Difference, limit: float) -> Legend:
    """Say what a signed difference shows, with its range, and how far the pictures are apart."""
    stats, values = found.stats, found.values
    together: dict[tuple[str, ...], str] = {CHANNELS: "colour", AXES: "normal"}
    what = together.get(values.names, values.names[0])
    pixels = fact("pixels that differ", f"{count(stats.pixels)} ({percent(stats.pixels, stats.of)})")
    if not stats.pixels:
        said = f"Nothing differs: {what} is the same in both, bit for bit."
        return Legend("B - A", notes=(Note(said, NoteKind.GOOD),))
    if values.classes:
        entries = (Entry("another one in B", MORE), Entry("the same in both", SAME))
        return Legend(f"B - A: {what}", (), entries, facts=(pixels,))
    what += ", in the channel that differs most" if len(values.names) > 1 else ""
    least, largest, mean = (f"{number:+.4g}" if number else "0" for number in (stats.least, stats.largest, stats.mean))
    facts = pixels, fact("least and largest", f"{least}   {largest}"), fact("mean", mean)
    return Legend(f"B - A: {what}", (), (), Scale(f"-{limit:.3g}", f"+{limit:.3g}", "0", signed=True), facts)
