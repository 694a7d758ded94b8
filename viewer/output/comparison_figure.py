"""The figure of one frame by several methods, side by side: the picture, enlarged crops, what differs from "none",
and counts.

Importing this loads matplotlib, as `figures` does."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from tracer.experiments import figures
from tracer.experiments.figures import COLORS, bare, styled
from viewer.output.comparison import Crop, Shown, texts_of_file
from viewer.state.palette import color_map
from viewer.state.session import Session
from viewer.state.views import View
from viewer.util.files import write_bytes
from viewer.util.numbers import several

_COLUMN, _LABELS, _BAR = 3.1, 1.7, 1.1  # inches of a method's column, of the names of rows, and of the colour bar
_COUNT = 0.21  # inches of a line of counts
_LINE, _LETTER = 0.19, 0.082  # inches of a line of words below the title, and of one of their letters
_MARK = "#FF00FF"
_LEAST = 1e-3  # the top of the colour range where nothing differs


def save(shown: Shown, path: Path, text: str) -> None:
    """Write the figure as one of ENDINGS with what it carries; raises OSError in one line."""
    kept = texts_of_file(path.suffix.lower(), text)
    write_bytes(path, figures.file_of(figure(shown), path.suffix, kept))


@styled()
def figure(shown: Shown) -> Figure:
    """Draw it; the same data give the same file."""
    width, height = shown.state.size
    whole = not shown.comparison.crops
    crops = [Crop(0, 0, width, height)] if whole else list(shown.comparison.crops)
    rows = [] if whole else [("picture", 0, _COLUMN * height / width)]
    for number, crop in enumerate(crops):
        inches = _COLUMN * min(max(crop.height / crop.width, 0.3), 1.5)
        rows += [("crop", number, inches), ("difference", number, inches)]
    rows.append(("counts", 0, _COUNT * len(shown.counts(next(iter(shown.frames)))) + 0.1))
    heights = [inches for _, _, inches in rows]
    across = _LABELS + len(shown.frames) * _COLUMN + _BAR
    words = textwrap.wrap(shown.comparison.words, int((across - 0.4) / _LETTER)) if shown.comparison.words else []
    head = 0.95 + _LINE * len(words)
    size = across, sum(heights) + 0.14 * len(rows) + 0.2 + head
    page = Figure(figsize=size)
    grid = GridSpec(
        len(rows), len(shown.frames), page, left=_LABELS / size[0], right=1.0 - _BAR / size[0],
        top=1.0 - head / size[1], bottom=0.2 / size[1], wspace=0.05, hspace=0.14 * len(rows) / sum(heights),
        height_ratios=heights,
    )  # fmt: skip
    pictures, differences = shown.pictures, {method: shown.difference(method) for method in shown.frames}
    top = max(_LEAST, *(float(crop.of(d).max()) for crop in crops for d in differences.values()))
    for column, method in enumerate(shown.frames):
        for line, (kind, number, _) in enumerate(rows):
            panel = page.add_subplot(grid[line, column])
            bare(panel)
            if line == 0:
                panel.set_title(method, fontsize=15.0, fontweight="bold")
            if kind == "picture":
                _show_picture(panel, pictures[method], crops)
            elif kind == "counts":
                _show_counts(panel, shown.counts(method), first=column == 0)
            else:
                crop = crops[number]
                if kind == "crop":
                    panel.imshow(crop.of(pictures[method]), interpolation="nearest")
                else:
                    _show_difference(panel, crop.of(differences[method]), top, method)
                _mark(panel, crop, shown.comparison.marks if kind == "crop" or method != "none" else ())
                _frame(panel, None if whole else number)
            if column == 0 and kind != "counts":
                panel.set_ylabel(_row_name(kind, None if whole else number), fontsize=12.0)
    _color_bars(page, shown, top, size)
    page.suptitle(_title(shown), x=0.02, y=1.0 - 0.12 / size[1], ha="left", va="top", fontsize=14.0)
    for number, text in enumerate(words):
        page.text(0.02, 1.0 - (0.42 + _LINE * number) / size[1], text, ha="left", va="top", fontsize=10.5)
    return page


def _title(shown: Shown) -> str:
    state, (width, height) = shown.state, shown.state.size
    number, view = Session(shown.scene).frame_at(state.time), state.draw.view.label.lower()
    before = f", with what {several(shown.warmed, 'earlier frame')} taught" if shown.warmed else ""
    samples = f", {state.settings.samples} samples" if state.settings.samples > 1 else ""
    return f"{shown.scene.path.name}, frame {number}{before}, {width} × {height}{samples}; {view}"


def _row_name(kind: str, crop: int | None) -> str:
    if kind == "picture":
        return "picture"
    name = "picture" if crop is None and kind == "crop" else f"crop {'ABCDEF'[crop or 0]}"
    return name if kind == "crop" else "difference\nto none"


def _frame(panel: Axes, crop: int | None) -> None:
    """A border in the colour of the crop."""
    for side in panel.spines.values():
        side.set_visible(True)
        side.set_color("#888888" if crop is None else COLORS[crop % len(COLORS)])
        side.set_linewidth(0.8 if crop is None else 2.0)


def _mark(panel: Axes, crop: Crop, marks: Sequence[tuple[int, int]]) -> None:
    """A square around each marked pixel that the crop shows."""
    for x, y in marks:
        if 0 <= x - crop.x < crop.width and 0 <= y - crop.y < crop.height:
            corner = x - crop.x - 0.5, y - crop.y - 0.5
            panel.add_patch(Rectangle(corner, 1.0, 1.0, fill=False, edgecolor=_MARK, linewidth=1.6))


def _show_picture(panel: Axes, pixels: NDArray[np.uint8], crops: Sequence[Crop]) -> None:
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
    bars: list[tuple[tuple[float, float], Any, str]] = []
    view = shown.state.draw.view
    if shown.span is not None and not shown.state.draw.shares:
        near_is_bright = view is View.DEPTH
        colors = ListedColormap(color_map()[::-1] if near_is_bright else color_map())  # type: ignore[arg-type]
        bars.append((shown.span, colors, view.label.lower() if near_is_bright else f"{view.label.lower()}, per pixel"))
    if top > _LEAST:
        bars.append(((0.0, top), "inferno", "difference to none, of 1"))
    for number, (span, colors, words) in enumerate(bars):
        height = 0.4 if len(bars) == 1 else 0.32
        bottom = 0.3 if len(bars) == 1 else 0.1 + (1 - number) * 0.4
        axes = page.add_axes((1.0 - 0.92 * _BAR / size[0], bottom, 0.12 / size[0], height))
        bar = page.colorbar(ScalarMappable(Normalize(*span), colors), cax=axes)
        bar.set_label(words, fontsize=10.5)
        bar.ax.tick_params(labelsize=9.5)
        bar.outline.set_visible(False)  # type: ignore[operator]
