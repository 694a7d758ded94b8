"""What every view is made of: what it declares, its pixels, its legend, and its exact values."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from threading import Lock
from typing import Any, ClassVar, NamedTuple, TypeVar
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from tracer.culling.fate import Fate
from tracer.frame import Frame
from tracer.scene.lights import Light, named_light
from viewer.state.draw_options import DrawOptions
from viewer.state.views import Declaration
from viewer.views.legend import Legend
from viewer.views.paint import Pixels

Lines = tuple[str, ...]
Lights = tuple[Light, ...]
T = TypeVar("T")


@dataclass(frozen=True)
class Values:
    """What a view shows of each pixel: `numbers` (h, w, k) float32 with a name for each of the k; where they are
    `classes`, modes or numbers of primitives, only whether they are the same means anything.  `known` (h, w) says where
    there is a value."""

    numbers: NDArray[np.float32]
    names: tuple[str, ...]
    known: NDArray[np.bool_]
    classes: bool = False


class DrawnView(Declaration):
    """A view: the file that declares one names an instance of a subclass `VIEW`.

    What a view returns is asked of frames that it can draw."""

    everywhere: ClassVar[bool] = False
    """Whether it shows something where nothing is hit, too."""

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        """Draw a frame, (h, w, 3) uint8."""
        raise NotImplementedError

    def highlighted(self, frame: Frame, draw: DrawOptions, fate: Fate | None) -> Pixels:
        """Draw the same; where a fate is given, and the view is of fates, this one stands out."""
        return self.colorize(frame, draw)

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        """Say what the colours mean, and how much of the frame has them; None where they speak for themselves."""
        return None

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        """Return the exact values that it shows."""
        raise NotImplementedError

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        """Return what it shows of one pixel, in a few short lines."""
        raise NotImplementedError

    def layers(self, frame: Frame, axis: int) -> int:
        """Count the layers across an axis of which a slice shows one; 0 where there is nothing to cut."""
        return 0

    def title(self, draw: DrawOptions, lights: Lights) -> str:
        """Return the title of the legend, with the light where the view is about one."""
        return f"{self.label}, {named_light(lights, draw.light)}" if self.of_light else self.label


_found: WeakKeyDictionary[Frame, dict[Hashable, Any]] = WeakKeyDictionary()
_lock = Lock()


def once(frame: Frame, what: Hashable, find: Callable[[], T]) -> T:
    """Return what `find` returns, which is found once for a frame: what is drawn again asks for it again."""
    with _lock:
        known = _found.setdefault(frame, {})
    if what not in known:
        known[what] = find()
    found: T = known[what]
    return found


def single(numbers: NDArray, name: str, known: NDArray[np.bool_], classes: bool = False) -> Values:
    """Return values of one number a pixel (h, w)."""
    return Values(np.asarray(numbers, np.float32)[..., None], (name,), known, classes)


def hits(frame: Frame) -> NDArray[np.bool_]:
    """Find the pixels that show something."""
    return frame.primitive >= 0


_SAMPLED = 20_000  # pixels, about, that percentiles are of


def percentiles(frame: Frame, numbers: NDArray, *of: float) -> list[float]:
    """Return percentiles of what is shown of a number (h, w), from pixels evenly spread; none where nothing is hit."""
    step = max(1, numbers.size // _SAMPLED)
    sample = numbers.reshape(-1)[::step][frame.primitive.reshape(-1)[::step] >= 0]
    found: list[float] = np.percentile(sample, of).tolist() if len(sample) else []
    return found


def is_shaded(frame: Frame, x: int, y: int) -> bool:
    """Return whether a pixel of a picture that is shaded in part is one that is."""
    return frame.shaded is None or bool(frame.shaded[y, x])


def shaded_pixels(frame: Frame) -> NDArray[np.bool_]:
    """Find the pixels that are shaded."""
    return np.ones(frame.primitive.shape, np.bool_) if frame.shaded is None else frame.shaded


BINS = 64


class Histogram(NamedTuple):
    """How often values lie where: `counts` (k, BINS) for each of k numbers, between `low` and `high`; and of each
    number the least, the largest and the mean.  `pixels` have a value, of so many."""

    counts: NDArray[np.int64]
    low: float
    high: float
    least: tuple[float, ...]
    largest: tuple[float, ...]
    mean: tuple[float, ...]
    pixels: int
    of: int


def histogram(values: Values, rows: slice, columns: slice) -> Histogram | None:
    """Count a region's values, whole numbers one by one if they are few; None where no pixel of it has one."""
    known = values.known[rows, columns]
    numbers = values.numbers[rows, columns][known].astype(np.float64)
    numbers = numbers[np.isfinite(numbers).all(axis=-1)]
    if len(numbers) == 0:
        return None
    low, high, whole = float(numbers.min()), float(numbers.max()), bool((numbers == np.rint(numbers)).all())
    if low == high or whole:
        low, high = low - 0.5, high + 0.5
    bins = round(high - low) if whole and high - low <= BINS else BINS
    counts = np.stack([np.histogram(column, bins, (low, high))[0] for column in numbers.T])
    least, largest, mean = (tuple(of(axis=0)) for of in (numbers.min, numbers.max, numbers.mean))
    return Histogram(counts, low, high, least, largest, mean, len(numbers), known.size)
