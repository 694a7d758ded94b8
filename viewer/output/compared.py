"""Two pictures as one, without a GPU: what the window shows of a comparison, for files.

`signed_picture` is the twin of `shaders/signed.frag`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from viewer.output.legend_parts import Entry, Legend, Note, Scale, Tone
from viewer.state.comparison import Apart, Way, fitted
from viewer.state.marks import wipe_column
from viewer.state.values import AXES, CHANNELS, Values
from viewer.state.views import LESS, MORE, SAME, WIPE_LINE
from viewer.state.worst import RING
from viewer.util.numbers import count, percent

GAP = 4
"""Pixels between pictures that are saved side by side."""


def signed_picture(difference: NDArray[np.float32], limit: float) -> NDArray[np.uint8]:
    """(h, w, 3) uint8: a signed difference (h, w) in false colour, as far as `limit` to both sides."""
    t = np.clip(difference / np.float32(limit), -1.0, 1.0)[..., None]
    less, same, more = (np.asarray(color, np.float32) for color in (LESS, SAME, MORE))
    colors = same + np.abs(t) * (np.where(t < 0.0, less, more) - same)
    return np.round(colors * 255.0).astype(np.uint8)


def composed(a: NDArray[np.uint8], b: NDArray[np.uint8], way: Way, wipe: float, shows_a: bool) -> NDArray[np.uint8]:
    """What a comparison shows of two pictures (h, w, 3) uint8, in the size of B, or twice as wide side by side."""
    height, width = b.shape[:2]
    a = fitted(a, (width, height))
    if way is Way.SIDE:
        gap = np.zeros((height, GAP, 3), np.uint8)
        return np.concatenate([a, gap, b], axis=1)
    if way is Way.WIPE and not shows_a:
        column = wipe_column(width, wipe)
        both = np.concatenate([a[:, :column], b[:, column:]], axis=1)
        both[:, column : column + 1] = np.round(np.multiply(255.0, WIPE_LINE))
        return both
    return a if shows_a else b


def _signed(number: float) -> str:
    return f"{number:+.4g}" if number else "0"


def what_of(values: Values) -> str:
    """What the numbers are, in words."""
    together: dict[tuple[str, ...], str] = {CHANNELS: "colour", AXES: "normal"}
    return together.get(values.names, values.names[0])


def difference_legend(found: Apart, values: Values, limit: float, ringed: int = 0) -> Legend:
    """What a signed difference shows, with its range, and how far the pictures are apart; so many are `ringed`."""
    pixels = Entry("pixels that differ", None, (f"{count(found.pixels)} ({percent(found.pixels, found.of)})",))
    if not found.pixels:
        said = f"Nothing differs: {what_of(values)} is the same in both, bit for bit."
        return Legend("B - A", notes=(Note(said, Tone.GOOD),))
    rings = (Entry("ringed: where they differ most", RING, (count(ringed),)),) if ringed else ()
    if values.classes:
        entries = (Entry("another one in B", MORE), Entry("the same in both", SAME))
        return Legend(f"B - A: {values.names[0]}", (), entries, facts=(pixels,))
    what = f"{what_of(values)}, in the channel that differs most" if len(values.names) > 1 else what_of(values)
    scale = Scale(f"-{limit:.3g}", f"+{limit:.3g}", "0", signed=True)
    facts = (
        pixels,
        Entry("least and largest", None, (f"{_signed(found.least)}   {_signed(found.largest)}",)),
        Entry("mean", None, (_signed(found.mean),)),
    )
    return Legend(f"B - A: {what}", (), rings, scale, facts)
