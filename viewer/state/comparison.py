"""Two pictures beside each other: A, which was kept or is traced by a second method, and B, the live one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from viewer.state.views import View

RATES = (0.25, 3.0)
"""Times a second, least and most, that pictures blink: no more, as faster flashes are dangerous to some people."""
ENDLESS = 1e29
"""From here on a difference is one without end: one of the two pictures hits nothing there."""
MOST_SPOTS = 5
"""Spots that are marked, at most."""
LEAST_MARKED = 0.25
"""Of the largest difference: what is smaller is not marked."""
RING = (1.0, 1.0, 1.0)
"""The colour of rings."""

Spot = tuple[int, int]


class CompareMode(StrEnum):
    """How two pictures are compared."""

    label: str
    meaning: str

    def __new__(cls, value: str, label: str, meaning: str) -> CompareMode:
        made = str.__new__(cls, value)
        made._value_, made.label, made.meaning = value, label, meaning
        return made

    FLIP = "flip", "Flip", "Shows B, and A while Z is held."
    WIPE = "wipe", "Wipe", "Shows A left of a line and B right of it. Drag the line."
    SIDE = "side", "Side by side", "Shows A on the left and B on the right."
    DIFFERENCE = "difference", "Signed difference", "Shows B - A: orange where B has more, blue where it has less."
    BLINK = "blink", "Blink", "Shows A and B in turn."


class Source(StrEnum):
    """Where A comes from."""

    KEPT = "kept"
    METHOD = "method"


@dataclass(frozen=True)
class Side:
    """One of the two pictures: a frame in a view, of the scene of this name, at the frame number of its animation;
    `light_number` is what people call its light."""

    frame: Frame
    view: View
    light: int
    scene: str
    number: int
    light_number: int | None = None

    @property
    def of_light(self) -> str:
        """Which light a view of one light is of, in words after a comma."""
        number = self.light if self.light_number is None else self.light_number
        return f", light {number}" if self.view.of_light else ""

    @property
    def method(self) -> str:
        return self.frame.settings.method


def named(side: Side, other: Side | None) -> str:
    """The method that traced a picture, and what else sets it apart from the other."""
    parts = [side.method]
    if other is None:
        return parts[0]
    if (side.view, side.light if side.view.of_light else 0) != (other.view, other.light if other.view.of_light else 0):
        parts.append(side.view.label.lower() + side.of_light)
    if side.scene != other.scene:
        parts.append(side.scene)
    if side.frame.time != other.frame.time or side.scene != other.scene:
        parts.append(f"frame {side.number}")
    mine, its = side.frame.settings, other.frame.settings
    for name, text in (("depth", "depth {}"), ("samples", "{} samples"), ("lamp_samples", "{} lamp samples")):
        if getattr(mine, name) != getattr(its, name) and getattr(mine, name) is not None:
            parts.append(text.format(getattr(mine, name)))
    if len(parts) == 1 and mine.method == its.method and side.frame.camera != other.frame.camera:
        parts.append("another camera")
    return ", ".join(parts)


def sizes_in_words(a: Frame, b: Frame) -> str:
    """What becomes of sizes, or samples, that differ; empty where they do not."""
    if a.primitive.shape == b.primitive.shape:
        samples = a.settings.samples, b.settings.samples
        if samples[0] == samples[1]:
            return ""
        had = f"{samples[0]} sample{'s' * (samples[0] != 1)}"
        return f"A has {had} a pixel, B {samples[1]}: edges differ by that. Keep A again at as many."
    stretched = ""
    if abs(a.width * b.height - b.width * a.height) > max(a.width, b.width, a.height, b.height):
        stretched = ", stretched"
    return f"A has {a.width} x {a.height} pixels, B {b.width} x {b.height}: A is shown in B's size{stretched}."


@dataclass(frozen=True)
class Compare:
    """Whether and how two pictures are compared: with `same_view` A is shown in the view of B; `limit` is the range of
    the difference, None for one that fits; `second` is the method that traces A, where it is not kept."""

    on: bool = False
    mode: CompareMode = CompareMode.WIPE
    source: Source = Source.KEPT
    same_view: bool = False
    rate: float = 1.5
    limit: float | None = None
    second: str = ""

    def changes(self, after: Compare) -> dict[str, str]:
        """What has changed since, in a few words for each."""
        changed: dict[str, str] = {}
        if (self.on, self.mode) != (after.on, after.mode):
            changed["mode"] = f"comparison: {after.mode.label.lower()}" if after.on else "comparison off"
        if self.source is not after.source:
            changed["source"] = "A by another method" if after.source is Source.METHOD else "A as it was kept"
        if self.second and self.second != after.second:
            changed["second"] = f"second method {after.second}"
        if self.same_view != after.same_view:
            changed["same_view"] = "A in the view of B" if after.same_view else "A in its own view"
        if self.rate != after.rate:
            changed["rate"] = f"blinking at {after.rate:.2f} Hz"
        if self.limit != after.limit:
            changed["limit"] = "range of the difference"
        return changed

    def shows_a(self, seconds: float) -> bool:
        """Whether pictures blink, and it is A's turn at this time in seconds."""
        return self.mode is CompareMode.BLINK and int(2.0 * self.rate * seconds) % 2 == 1


def elided(name: str, other: str, fits: Callable[[str], bool]) -> str:
    """The name, or as much of it as fits; what it has in common with the beginning of the other goes first, from its
    end, then what both end with, then the end of what is left."""
    if fits(name):
        return name
    alike = next((n for n, pair in enumerate(zip(name, other, strict=False)) if pair[0] != pair[1]), None)
    same = name[: min(len(name), len(other)) if alike is None else alike]
    same = same[: max(same.rfind(mark) + 1 for mark in " ,+") if len(same) < len(name) else 0]  # whole words
    rest = name[len(same) :]
    for kept in range(len(same) - 1, -1, -1) if same else ():
        if fits(same[:kept].rstrip() + "..." + rest):
            return same[:kept].rstrip() + "..." + rest
    front = "..." if same else ""
    for end in range(len(rest) - 1, 0, -1):
        if fits(front + rest[:end].rstrip() + "..."):
            return front + rest[:end].rstrip() + "..."
    return front + rest[:1]


# --- where they are furthest apart ------------------------------------------------------------------


def worst_spots(difference: NDArray[np.float32], classes: bool = False) -> tuple[Spot, ...]:
    """Column and row of the pixels that differ most, the worst first, and none near another, of a difference (h, w).

    Differences without end, of what only one picture hits, are none of them.  Of `classes`, which differ or do not, all
    spots are found, or none where there are more than can be marked: these are seen without marks."""
    height, width = difference.shape
    size = np.abs(difference)
    size[~(size < ENDLESS)] = 0.0
    near = max(4, max(width, height) // 24)
    spots: list[Spot] = []
    worst = 0.0
    while size.size:
        y, x = divmod(int(size.argmax()), width)
        found = float(size[y, x])
        if found <= LEAST_MARKED * worst or len(spots) == MOST_SPOTS:
            return () if classes and found > 0.0 else tuple(spots)
        worst = worst or found
        spots.append((x, y))
        size[max(0, y - near) : y + near + 1, max(0, x - near) : x + near + 1] = 0.0
    return ()


def with_rings(picture: NDArray[np.uint8], spots: tuple[Spot, ...]) -> NDArray[np.uint8]:
    """A picture (h, w, 3) with a ring around each spot, dark and light, so that it is seen on any ground."""
    if not spots:
        return picture
    height, width = picture.shape[:2]
    side, found = max(width, height), picture.copy()
    radius, thickness = max(3.0, side / 120.0), max(1.0, side / 700.0)
    rows, columns = np.arange(height)[:, None], np.arange(width)[None]
    for x, y in spots:
        off = np.abs(np.hypot(columns - x, rows - y) - radius)
        found[off <= 1.5 * thickness] = 0
        found[off <= 0.5 * thickness] = np.round(np.multiply(255.0, RING))
    return found
