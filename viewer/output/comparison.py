"""One frame by several methods: what is held side by side, the numbers of each, and what a figure file carries."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.experiments.counterexample import difference_of
from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.model import Scene
from viewer.output.capture import CHUNK
from viewer.state import codec
from viewer.state.view_state import ViewState
from viewer.state.views import Record
from viewer.util.numbers import changed
from viewer.views import colorize

ENDINGS = (".png", ".pdf")
MOST_METHODS, MOST_CROPS = 6, 6
_IN_PDF = re.compile(rb"/Keywords \(shadowcull:([A-Za-z0-9+/=]+)\)")


class Crop(NamedTuple):
    """A rectangle of pixels, from its upper left corner."""

    x: int
    y: int
    width: int
    height: int

    @staticmethod
    def around(pixel: tuple[int, int], size: tuple[int, int]) -> Crop:
        """Return the surroundings of a pixel, inside a picture of this size."""
        width, height = (min(max(least, side // 8), side) for least, side in zip((24, 18), size, strict=True))
        x = min(max(pixel[0] - width // 2, 0), size[0] - width)
        y = min(max(pixel[1] - height // 2, 0), size[1] - height)
        return Crop(x, y, width, height)

    def of(self, pixels: NDArray[Any]) -> NDArray[Any]:
        return pixels[self.y : self.y + self.height, self.x : self.x + self.width]

    def __str__(self) -> str:
        return f"{self.x},{self.y},{self.width},{self.height}"


@dataclass(frozen=True)
class Comparison:
    """What a figure shows of a state: a column for each of the methods, rectangles that are enlarged, pixels (x, y)
    that are marked in these, and words below the title."""

    methods: tuple[str, ...]
    crops: tuple[Crop, ...] = ()
    marks: tuple[tuple[int, int], ...] = ()
    words: str = ""

    def checked(self, size: tuple[int, int]) -> Comparison:
        """Return it; raises ValueError, in one line, for what cannot be drawn of a picture of this size."""
        width, height = size
        if not 1 <= len(self.methods) <= MOST_METHODS or len(set(self.methods)) < len(self.methods):
            raise ValueError(f"--methods: give 1 to {MOST_METHODS}, each once")
        if len(self.crops) > MOST_CROPS:
            raise ValueError(f"--crops: {MOST_CROPS} at most, not {len(self.crops)}")
        for crop in self.crops:
            inside = crop.x + crop.width <= width and crop.y + crop.height <= height
            if not inside or crop.width < 1 or crop.height < 1:
                raise ValueError(f"--crops {crop}: not inside the picture of {width} x {height} pixels")
        for method in self.methods:
            Method.parse(method)
        return self


def comparison_of(data: Any, size: tuple[int, int]) -> Comparison:
    """Return what a figure carries beside its state; raises ValueError in one line."""
    return codec.from_json(data, Comparison, "its figure").checked(size)


@dataclass(frozen=True)
class Shown:
    """A comparison that was traced: the frames by their methods, that by "none" as the reference, and how many were
    traced before each."""

    scene: Scene
    state: ViewState
    comparison: Comparison
    frames: Mapping[str, Frame]
    reference: Frame
    warmed: int = 0

    @property
    def span(self) -> tuple[float, float] | None:
        """What has the first and the last colour, for all methods: as was asked for, or of a map of work that of all;
        None in other views."""
        view = self.state.draw.view
        if self.state.draw.span is not None or view.records is not Record.WORK:
            return self.state.draw.span
        return 0.0, max(view.declared.span(frame)[1] for frame in self.frames.values())

    @property
    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """(h, w, 3) of each method, in one range of colours for all."""
        draw = replace(self.state.draw, magnified=1).with_span(self.span)
        return {method: colorize(frame, draw) for method, frame in self.frames.items()}

    def difference(self, method: str) -> NDArray[np.float32]:
        """(h, w) how far a method's colours are from those of "none": the largest of the three channels."""
        return difference_of(self.frames[method].color, self.reference.color)

    def differing(self, method: str) -> int:
        """How many pixels are not those of "none", bit for bit."""
        return int((self.frames[method].color != self.reference.color).any(axis=-1).sum())

    def counts(self, method: str) -> list[tuple[str, str]]:
        """Names and values of a method's counters, as people read them; what certificates take counts as work."""
        cost, right = self.frames[method].statistics, self.reference.statistics.shadow
        rays = cost.shadow
        due = max(rays.due, 1)
        steps, tests = rays.traversal_steps + cost.certificate_steps, rays.intersection_tests + cost.certificate_tests

        def work(now: int, then: int) -> str:
            against = "" if method == "none" or not then else f" ({changed(now / then - 1.0)})"
            return f"{now:,}{against}"

        return [
            ("shadow rays due", f"{rays.due:,}"),
            ("culled", f"{rays.culled / due:.1%}"),
            ("dynamic only", f"{rays.dynamic_only / due:.1%}"),
            ("traversal steps", work(steps, right.traversal_steps)),
            ("intersection tests", work(tests, right.intersection_tests)),
            ("pixels that differ", f"{self.differing(method):,}"),
        ]


def texts_of_file(ending: str, text: str) -> dict[str, str]:
    """Return the notes of a figure file that carry a text, by their names there."""
    if ending == ".pdf":
        return {"Keywords": f"{CHUNK}:{base64.b64encode(text.encode()).decode()}"}
    return {CHUNK: text, "Software": "Shadowcull"}


def text_of_pdf(data: bytes) -> str | None:
    """What a PDF of ours carries; None for another."""
    found = _IN_PDF.search(data)
    try:
        return base64.b64decode(found[1]).decode() if found else None
    except ValueError:
        return None
