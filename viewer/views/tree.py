"""A slice through an acceleration structure that is built where rays arrive.

It is drawn through everything: wherever a ray of the picture passes the tree is built, so what waits is what lies
behind something, and would never be seen if that hid the slice."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tracer.frame import EVERYWHERE, Frame, Region
from tracer.geometry.tree_parts import NOWHERE, PartsAt, TreeParts, nothing_at
from viewer.state.draw_options import AXES, DrawOptions, Slice
from viewer.state.palette import hex_color
from viewer.state.views import TREE
from viewer.util.numbers import count, percent, several
from viewer.views.base import DrawnView, Lights, Lines, Pixels, Values, single
from viewer.views.color import dimmed
from viewer.views.legend import Entry, Legend, Scale, fact
from viewer.views.paint import (
    FAINT_LINE,
    Met,
    by_color,
    checkered,
    in_bytes,
    in_range,
    mapped,
    met,
    on_line,
    shaded,
    wide_enough,
)  # fmt: skip

LAYERS = 100
"""Steps from one side of what most primitives are in to the other."""
STRIPE = 4
"""Pixels across which a stripe of what waits goes."""
WAITS_COLORS = hex_color("4A4E57"), hex_color("6B707B")
"""Stripes of what of a tree is not built."""


class Tree(DrawnView):
    label = "Tree built"
    key = "Shift+T"
    help = (
        "A slice through a tree that is built where rays arrive: built parts by their level, and grey stripes where no "
        "ray has been yet. Lines are the borders of parts, and white ones those of objects or subtrees. The slice goes "
        "through everything; what lies before it shows as light and shade."
    )
    has_range = has_slice = is_flat = shows_picture = everywhere = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return TREE in frame.structures and frame.structures[TREE].alive

    def span(self, frame: Frame) -> tuple[float, float]:
        return 0.0, float(tree_of(frame).levels)

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        found, plane = tree_seen(frame, draw.slice)
        pixels, there = by_color(frame, draw, dimmed(frame, draw.tone, draw.beneath)), found.numbers != NOWHERE
        colors = mapped(in_range(found.levels[there].astype(float), draw.span or self.span(frame)))
        waits, stripes = found.built[there] == 0, checkered(there.shape, STRIPE)[there]
        colors[waits] = np.asarray(WAITS_COLORS, np.float32)[stripes[waits]]
        lines = on_line(found.numbers) & _all_near(wide_enough(found.widths, plane.per_pixel))
        colors[lines[there]] *= np.float32(FAINT_LINE)
        hidden = there & plane.behind
        colors[hidden[there]] = shaded(frame, colors[hidden[there]], draw.shading, hidden)
        colors[_in_company(on_line(found.owners))[there]] = 1.0
        pixels[there] = in_bytes(colors)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        parts, built, cut = tree_of(frame), frame.statistics.built, draw.slice
        low, high = draw.span or self.span(frame)
        facts = [fact(f"slice at {AXES[cut.axis]}", f"{plane_of(parts, cut):.4g}")]
        if built is not None:
            in_nodes = f"{percent(built.primitives, built.of)} of {count(built.of)}"
            facts.append(fact("nodes built", count(built.nodes)))
            facts.append(fact("primitives in them", in_nodes, "of all; the others wait for a ray to come near"))
        entries = (
            Entry("not built: no ray has come", WAITS_COLORS[1]),
            Entry(f"border of {'an object' if parts.owner == 'object' else 'a subtree'}", (1.0, 1.0, 1.0)),
        )
        scale = Scale(f"level {low:.4g}", f"{high:.4g}")
        return Legend(f"{self.label}: levels of its parts, {parts.name}", (), entries, scale, tuple(facts))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        found, _ = tree_seen(frame, draw.slice)
        return single(np.where(found.built, found.levels, -1), "level", found.numbers != NOWHERE, classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Lines:
        """Return what part is seen, with the word for what owners are; a dash for none."""
        found, _ = tree_seen(frame, draw.slice, (slice(y, y + 1), slice(x, x + 1)))
        number, level, built, held, owner = (
            int(column[0, 0]) for column in (found.numbers, found.levels, found.built, found.held, found.owners)
        )
        if number == NOWHERE:
            return ("-",)
        leaf = f"leaf of {several(held, 'primitive')}" if held else "empty leaf"
        what = "not built yet" if not built else "inner node" if held < 0 else leaf
        return (what, f"level {level}", *((f"{tree_of(frame).owner} {owner}",) if owner >= 0 else ()))

    def layers(self, frame: Frame, axis: int) -> int:
        return LAYERS if self.can_draw(frame) else 0


def tree_of(frame: Frame) -> TreeParts:
    """Return the tree that the frame's rays were building."""
    found: TreeParts = frame.structures[TREE]
    return found


def plane_of(parts: TreeParts, cut: Slice) -> float:
    """Return where the plane of a slice lies along its axis, in units of the scene: in the middle of its layer."""
    low, high = float(parts.extent[cut.axis]), float(parts.extent[cut.axis + 3])
    return low + (cut.layer(LAYERS) + 0.5) / LAYERS * (high - low)


def tree_seen(frame: Frame, cut: Slice, where: Region = EVERYWHERE) -> tuple[PartsAt, Met]:
    """Return the part of the tree (h, w) that each pixel sees in a slice, and where that is; none once the tree is no
    more."""
    parts = tree_of(frame)
    plane = met(frame, cut.axis, plane_of(parts, cut), where)
    shape = plane.behind.shape
    found = parts.at(plane.points.reshape(-1, 3), cut.axis) or nothing_at(plane.behind.size)
    return PartsAt._make(column.reshape(shape) for column in found), plane


def _in_company(line: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find pixels of lines with two neighbours of lines at least: others are dots, as of flat boxes far away."""
    padded = np.pad(line, 1)
    height, width = line.shape
    near = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3) if (y, x) != (1, 1)]
    return line & (np.sum(near, axis=0, dtype=np.uint8) >= 2)


def _all_near(there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find where a pixel and its neighbours to the right and below are: lines belong to both sides."""
    near = there.copy()
    near[:, :-1] &= there[:, 1:]
    near[:-1] &= there[1:]
    return near


VIEW = Tree()
