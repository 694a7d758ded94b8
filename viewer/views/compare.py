"""Two pictures as one: the signed difference of two frames in numbers, colours and words, and both in one picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from viewer.state.comparison import ENDLESS, RING, CompareMode, Spot, worst_spots
from viewer.state.draw_options import AXES
from viewer.state.palette import LESS, MORE, SAME, WIPE_LINE
from viewer.util.numbers import count, percent
from viewer.views.base import Pixels, Values, Words
from viewer.views.color import CHANNELS
from viewer.views.legend import Entry, Legend, Note, NoteKind, Scale, fact
from viewer.views.wipe import wipe_column

HIDDEN_SHARE = 0.5
"""Per cent of the pixels that differ, at most, which lie beyond the range of a difference that is fitted."""
GAP = 4
"""Pixels between pictures that are saved side by side."""


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


@dataclass(frozen=True)
class Difference:
    """B - A at each pixel of B, (h, w) float32, of such values, its statistics, and where it is largest."""

    pixels: NDArray[np.float32]
    values: Values
    stats: DiffStats
    worst: tuple[Spot, ...]

    @property
    def differing(self) -> Values:
        """The differences as values, of the pixels that have one."""
        size = np.abs(self.pixels)
        return Values(self.pixels[..., None], ("B - A",), (size > 0.0) & (size < ENDLESS), self.values.classes)

    def words(self, x: int, y: int) -> Words:
        """Return what it says of one pixel."""
        apart = float(self.pixels[y, x])
        if self.values.classes:
            return ("other",) if apart else ("same",)
        if abs(apart) > ENDLESS:
            return ("miss", "in A" if apart < 0.0 else "in B")
        return (f"{apart:+.3g}" if apart else "0",)


def difference_of(a: Values, b: Values) -> Difference:
    """Return B - A at the pixels of B: in the channel where they differ most; 1 where classes are others."""
    height, width = b.numbers.shape[:2]
    apart = b.numbers - fitted(a.numbers, (width, height))
    if b.classes:
        pixels = (apart[..., 0] != 0.0).astype(np.float32)
    elif apart.shape[-1] == 1:
        pixels = apart[..., 0]
    else:
        pixels = np.take_along_axis(apart, np.abs(apart).argmax(axis=-1)[..., None], -1)[..., 0]
    return Difference(pixels, b, diff_stats(pixels), worst_spots(pixels, b.classes))


def diff_stats(difference: NDArray[np.float32]) -> DiffStats:
    """Sum a difference up.  Where one of the two pictures has no depth, it counts as differing, and no further."""
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


def signed_picture(difference: NDArray[np.float32], limit: float) -> Pixels:
    """Draw a signed difference (h, w) in false colour, as far as `limit` to both sides, (h, w, 3) uint8."""
    t = np.clip(difference / np.float32(limit), -1.0, 1.0)[..., None]
    less, same, more = (np.asarray(color, np.float32) for color in (LESS, SAME, MORE))
    colors = same + np.abs(t) * (np.where(t < 0.0, less, more) - same)
    return np.round(colors * 255.0).astype(np.uint8)


def composed(a: Pixels, b: Pixels, mode: CompareMode, wipe: float, shows_a: bool) -> Pixels:
    """Return what a comparison shows of two pictures, in the size of B, or twice as wide side by side."""
    height, width = b.shape[:2]
    a = fitted(a, (width, height))
    if mode is CompareMode.SIDE:
        return np.concatenate([a, np.zeros((height, GAP, 3), np.uint8), b], axis=1)
    if mode is CompareMode.WIPE and not shows_a:
        column = wipe_column(width, wipe)
        both = np.concatenate([a[:, :column], b[:, column:]], axis=1)
        both[:, column : column + 1] = np.round(np.multiply(255.0, WIPE_LINE))
        return both
    return a if shows_a else b


def difference_legend(found: Difference, limit: float, ringed: int = 0) -> Legend:
    """Say what a signed difference shows, with its range, and how far the pictures are apart; so many are `ringed`."""
    stats, values = found.stats, found.values
    together: dict[tuple[str, ...], str] = {CHANNELS: "colour", AXES: "normal"}
    what = together.get(values.names, values.names[0])
    pixels = fact("pixels that differ", f"{count(stats.pixels)} ({percent(stats.pixels, stats.of)})")
    if not stats.pixels:
        said = f"Nothing differs: {what} is the same in both, bit for bit."
        return Legend("B - A", notes=(Note(said, NoteKind.GOOD),))
    rings = (Entry("ringed: where they differ most", RING, (count(ringed),)),) if ringed else ()
    if values.classes:
        entries = (Entry("another one in B", MORE), Entry("the same in both", SAME))
        return Legend(f"B - A: {what}", (), entries, facts=(pixels,))
    what += ", in the channel that differs most" if len(values.names) > 1 else ""
    scale = Scale(f"-{limit:.3g}", f"+{limit:.3g}", "0", signed=True)
    facts = (
        pixels,
        fact("least and largest", f"{_signed(stats.least)}   {_signed(stats.largest)}"),
        fact("mean", _signed(stats.mean)),
    )
    return Legend(f"B - A: {what}", (), rings, scale, facts)


def _signed(number: float) -> str:
    return f"{number:+.4g}" if number else "0"
