"""One frame by several methods, side by side: the picture, enlarged crops, what differs from "none", and counts."""

from __future__ import annotations

import base64
import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tracer.frame import Frame
from tracer.scene.model import Scene
from viewer.output.capture import CHUNK
from viewer.state.palette import color_map
from viewer.state.session import Session
from viewer.state.view_state import ViewState
from viewer.state.views import View
from viewer.util.numbers import changed
from viewer.views import colorize

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ENDINGS = (".png", ".pdf")
_COLUMN, _LABELS, _BAR = 3.1, 1.7, 1.1  # inches of a method's column, of the names of rows, and of the colour bar
_COUNT = 0.21  # inches of a line of counts
_LINE, _LETTER = 0.19, 0.082  # inches of a line of words below the title, and of one of their letters
_MARK = "#FF00FF"
_LEAST = 1e-3  # the top of the colour range where nothing differs
_IN_PDF = re.compile(rb"/Keywords \(shadowcull:([A-Za-z0-9+/=]+)\)")


class Crop(NamedTuple):
    """A rectangle of pixels, from its upper left corner."""

    x: int
    y: int
    width: int
    height: int

    def of(self, pixels: NDArray[Any]) -> NDArray[Any]:
        return pixels[self.y : self.y + self.height, self.x : self.x + self.width]

    def __str__(self) -> str:
        return f"{self.x},{self.y},{self.width},{self.height}"


EDITION = 2
"""Of the words in which a title says what came before: figures keep theirs, so that they can be drawn again."""


@dataclass(frozen=True)
class Shown:
    """What a figure shows: the frames by their methods, that by "none" as the reference, the crops, the pixels (x, y)
    that are marked in these, and words below the title; `warmed` is how many frames were traced before each, and
    `edition` says in which words the title does."""

    scene: Scene
    recipe: ViewState
    frames: Mapping[str, Frame]
    reference: Frame
    crops: Sequence[Crop]
    marks: Sequence[tuple[int, int]] = ()
    words: str = ""
    warmed: int = 0
    edition: int = EDITION

    @property
    def span(self) -> tuple[float, float] | None:
        """What has the first and the last colour, for all methods: as was asked for, or of a map of work that of all;
        None in other views."""
        view = self.recipe.draw.view
        if self.recipe.draw.span is not None or not view.needs_work:
            return self.recipe.draw.span
        return 0.0, max(view.declared.span(frame)[1] for frame in self.frames.values())

    @property
    def pictures(self) -> dict[str, NDArray[np.uint8]]:
        """(h, w, 3) of each method, in one range of colours for all."""
        draw = replace(self.recipe.draw, magnified=1).with_span(self.span)
        return {method: colorize(frame, draw) for method, frame in self.frames.items()}

    def difference(self, method: str) -> NDArray[np.float32]:
        """(h, w) how far a method's colours are from those of "none": the largest of the three channels."""
        here, right = (np.clip(frame.color, 0.0, 1.0) for frame in (self.frames[method], self.reference))
        return np.abs(here - right).max(axis=-1)

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


def figure(shown: Shown) -> Figure:
    """The figure; the same data give the same file."""
    from viewer.output import figures  # loads matplotlib

    return figures.styled(_figure)(shown)


def _figure(shown: Shown) -> Figure:
    from matplotlib.figure import Figure
    from matplotlib.gridspec import GridSpec

    from viewer.output import figures

    width, height = shown.recipe.size
    crops = list(shown.crops) or [Crop(0, 0, width, height)]
    tall = [_COLUMN * min(max(crop.height / crop.width, 0.3), 1.5) for crop in crops]
    rows = [("picture", _COLUMN * height / width)] if shown.crops else []
    for inches in tall:
        rows += [("crop", inches), ("difference", inches)]
    lines = len(shown.counts(next(iter(shown.frames))))
    rows.append(("counts", _COUNT * lines + 0.1))
    count = len(shown.frames)
    across = _LABELS + count * _COLUMN + _BAR
    words = textwrap.wrap(shown.words, int((across - 0.4) / _LETTER)) if shown.words else []
    head = 0.95 + _LINE * len(words)
    size = across, sum(inches for _, inches in rows) + 0.14 * len(rows) + 0.2 + head
    page = Figure(figsize=size)
    grid = GridSpec(
        len(rows), count, page, left=_LABELS / size[0], right=1.0 - _BAR / size[0], top=1.0 - head / size[1],
        bottom=0.2 / size[1], wspace=0.05, hspace=0.14 * len(rows) / sum(inches for _, inches in rows),
        height_ratios=[inches for _, inches in rows],
    )  # fmt: skip
    pictures, differences = shown.pictures, {method: shown.difference(method) for method in shown.frames}
    top = max(_LEAST, *(float(crop.of(d).max()) for crop in crops for d in differences.values()))
    for column, method in enumerate(shown.frames):
        crop_number = -1
        for number, (kind, _) in enumerate(rows):
            panel = page.add_subplot(grid[number, column])
            figures.bare(panel)
            if number == 0:
                panel.set_title(method, fontsize=15.0, fontweight="bold")
            if kind == "picture":
                _show_picture(panel, pictures[method], crops)
            elif kind == "crop":
                crop_number += 1
                panel.imshow(crops[crop_number].of(pictures[method]), interpolation="nearest")
                _mark(panel, crops[crop_number], shown.marks)
                _frame(panel, crop_number if shown.crops else None)
            elif kind == "difference":
                _show_difference(panel, crops[crop_number].of(differences[method]), top, method)
                _mark(panel, crops[crop_number], shown.marks if method != "none" else ())
                _frame(panel, crop_number if shown.crops else None)
            else:
                _show_counts(panel, shown.counts(method), first=column == 0)
            if column == 0 and kind != "counts":
                panel.set_ylabel(_row_name(kind, crop_number if shown.crops else None), fontsize=12.0)
    _color_bars(page, shown, top, size)
    page.suptitle(_title(shown), x=0.02, y=1.0 - 0.12 / size[1], ha="left", va="top", fontsize=14.0)
    for number, line in enumerate(words):
        page.text(0.02, 1.0 - (0.42 + _LINE * number) / size[1], line, ha="left", va="top", fontsize=10.5)
    return page


def _title(shown: Shown) -> str:
    recipe, (width, height) = shown.recipe, shown.recipe.size
    number = Session(shown.scene).frame_at(recipe.time)
    warm = _warm(shown.warmed, shown.edition) if shown.warmed else ""
    samples = f", {recipe.settings.samples} samples" if recipe.settings.samples > 1 else ""
    return (
        f"{shown.scene.path.name}, frame {number}{warm}, {width} × {height}{samples}; {recipe.draw.view.label.lower()}"
    )


def _warm(frames: int, edition: int) -> str:
    """How many frames were traced before."""
    if edition < 2:
        return f", after {'the frame' if frames == 1 else f'the {frames} frames'} before it"
    return f", with what {frames} earlier frame{'s' * (frames != 1)} taught"


def _row_name(kind: str, crop: int | None) -> str:
    if kind == "picture":
        return "picture"
    name = "picture" if crop is None and kind == "crop" else f"crop {'ABCDEF'[crop or 0]}"
    return name if kind == "crop" else "difference\nto none"


def _frame(panel: Axes, crop: int | None) -> None:
    """A border in the colour of the crop."""
    from viewer.output.figures import COLORS

    for side in panel.spines.values():
        side.set_visible(True)
        side.set_color("#888888" if crop is None else COLORS[crop % len(COLORS)])
        side.set_linewidth(0.8 if crop is None else 2.0)


def _mark(panel: Axes, crop: Crop, marks: Sequence[tuple[int, int]]) -> None:
    """A square around each marked pixel that the crop shows."""
    from matplotlib.patches import Rectangle

    for x, y in marks:
        if 0 <= x - crop.x < crop.width and 0 <= y - crop.y < crop.height:
            corner = x - crop.x - 0.5, y - crop.y - 0.5
            panel.add_patch(Rectangle(corner, 1.0, 1.0, fill=False, edgecolor=_MARK, linewidth=1.6))


def _show_picture(panel: Axes, pixels: NDArray[np.uint8], crops: Sequence[Crop]) -> None:
    from matplotlib.patches import Rectangle

    from viewer.output.figures import COLORS

    panel.imshow(pixels, interpolation="nearest")
    for number, crop in enumerate(crops):
        color = COLORS[number % len(COLORS)]
        corner, words = (crop.x - 0.5, crop.y - 0.5), "ABCDEF"[number]
        panel.add_patch(Rectangle(corner, crop.width, crop.height, fill=False, edgecolor=color, linewidth=2.0))
        box = {"facecolor": color, "edgecolor": "none", "pad": 1.5}
        inside = crop.y < 0.08 * pixels.shape[0]
        panel.text(*corner, words, color="white", fontsize=10.0, fontweight="bold", bbox=box,
                   va="top" if inside else "bottom", ha="left")  # fmt: skip


def _show_difference(panel: Axes, values: NDArray[np.float32], top: float, method: str) -> None:
    panel.imshow(values, cmap="inferno", vmin=0.0, vmax=top, interpolation="nearest")
    if not values.any():
        words = "the reference" if method == "none" else "no difference"
        panel.text(0.5, 0.5, words, color="#BBBBBB", fontsize=12.0, ha="center", va="center", transform=panel.transAxes)


def _show_counts(panel: Axes, counts: Sequence[tuple[str, str]], first: bool) -> None:
    """A line for each counter, its name beside the first column."""
    for number, (name, value) in enumerate(counts):
        y = 1.0 - (number + 0.5) / len(counts)
        if first:
            panel.text(-0.02, y, name, fontsize=10.5, ha="right", va="center", transform=panel.transAxes)
        panel.text(0.98, y, value, fontsize=10.5, ha="right", va="center", transform=panel.transAxes)


def _color_bars(page: Figure, shown: Shown, top: float, size: tuple[float, float]) -> None:
    """What the colours of all differences mean, where there are any, and those of maps of numbers."""
    from matplotlib.colors import ListedColormap

    bars: list[tuple[tuple[float, float], Any, str]] = []
    view = shown.recipe.draw.view
    if shown.span is not None and not shown.recipe.draw.shares:
        near_is_bright = view is View.DEPTH
        colors = ListedColormap(color_map()[::-1] if near_is_bright else color_map())  # type: ignore[arg-type]
        bars.append((shown.span, colors, view.label.lower() if near_is_bright else f"{view.label.lower()}, per pixel"))
    if top > _LEAST:
        bars.append(((0.0, top), "inferno", "difference to none, of 1"))
    for number, (span, colors, words) in enumerate(bars):
        height = 0.8 / len(bars) - 0.08
        bottom = 0.5 - height / 2 if len(bars) == 1 else 0.1 + (1 - number) * 0.4
        place = (1.0 - 0.92 * _BAR / size[0], bottom, 0.12 / size[0], min(height, 0.4))
        _color_bar(page, place, span, colors, words)


def _color_bar(
    page: Figure, place: tuple[float, float, float, float], span: tuple[float, float], colors: Any, words: str
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    bar = page.colorbar(ScalarMappable(Normalize(*span), colors), cax=page.add_axes(place))
    bar.set_label(words, fontsize=10.5)
    bar.ax.tick_params(labelsize=9.5)
    bar.outline.set_visible(False)  # type: ignore[operator]


def save(shown: Shown, path: Path, text: str) -> None:
    """Write the figure as one of ENDINGS with what it carries; raises OSError in one line."""
    from viewer.output import figures  # loads matplotlib

    kept = {"png": {CHUNK: text, "Software": "Shadowcull"}, "pdf": {"Keywords": f"{CHUNK}:{_packed(text)}"}}
    figures.save(figure(shown), path, kept[path.suffix.lower()[1:]])


def _packed(text: str) -> str:
    return base64.b64encode(text.encode()).decode()


def text_of_pdf(data: bytes) -> str | None:
    """What a PDF of ours carries; None for another."""
    found = _IN_PDF.search(data)
    try:
        return base64.b64decode(found[1]).decode() if found else None
    except ValueError:
        return None
