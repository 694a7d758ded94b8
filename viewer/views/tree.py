"""A slice through an acceleration structure that is built where rays arrive."""

from __future__ import annotations

import numpy as np

from tracer.frame import Frame
from tracer.geometry.tree_parts import NOWHERE, TreeParts
from viewer.state.draw_options import AXES, DrawOptions, Slice
from viewer.state.palette import BACKGROUND, hex_color
from viewer.state.readings import TREE, TREE_IS_GONE
from viewer.util.numbers import count, percent
from viewer.views.base import FrameView, Layer, Lights, Pixels, Values, Words, hits, once, single
from viewer.views.color import dimmed
from viewer.views.legend import Entry, Legend, Scale, fact
from viewer.views.paint import FAINT_LINE, checkered, in_range, mapped, on_line, outline, shaded
from viewer.views.slices import (
    BORDER,
    HIDDEN,
    LAYERS,
    LEVEL,
    LINE,
    NO_PART,
    SAMPLES,
    STRIPE,
    WAITS,
    layer_of,
    part_seen,
    part_words,
    place_of,
    share_built,
    tree_codes,
    tree_seen,
)  # fmt: skip

WAITS_COLORS = hex_color("4A4E57"), hex_color("6B707B")
"""Stripes of what of a tree is not built."""
_OF_SLICE = f"its area, by {SAMPLES} x {SAMPLES} points; what lies outside of all boxes counts for neither"


class Tree(FrameView):
    label = "Tree built"
    key = "Shift+T"
    help = (
        "A slice through a tree that is built where rays arrive: built parts by their level, and grey stripes where no "
        "ray has been yet. Lines are the borders of parts, and white ones those of objects or pieces. The slice goes "
        "through everything; what lies before it shows as light and shade."
    )
    has_range = has_slice = is_flat = shows_picture = everywhere = True

    def can_draw(self, frame: Frame, light: int = 0) -> bool:
        return TREE in frame.structures and frame.structures[TREE].alive

    def span(self, frame: Frame) -> tuple[float, float]:
        return 0.0, float(tree_of(frame).levels)

    def colorize(self, frame: Frame, draw: DrawOptions) -> Pixels:
        parts, cut = tree_of(frame), draw.slice
        found = once(frame, ("tree", cut), lambda: tree_codes(frame, parts, cut))
        pixels, there = _behind(frame, draw), found != NO_PART
        codes, stripes = found[there], checkered(found.shape, STRIPE)[there]
        colors = mapped(in_range((codes & LEVEL).astype(float), draw.span or self.span(frame)))
        waits = codes & WAITS != 0
        colors[waits] = np.asarray(WAITS_COLORS, np.float32)[stripes[waits]]
        colors[codes & LINE != 0] *= np.float32(FAINT_LINE)
        hidden = codes & HIDDEN != 0
        behind = np.zeros(found.shape, np.bool_)
        behind[there] = hidden
        colors[hidden] = shaded(frame, colors[hidden], draw.shading, behind)
        colors[codes & BORDER != 0] = 1.0
        pixels[there] = np.round(np.clip(colors, 0.0, 1.0) * 255.0).astype(np.uint8)
        return pixels

    def legend(self, frame: Frame, draw: DrawOptions, lights: Lights) -> Legend | None:
        parts, built, cut = tree_of(frame), frame.statistics.built, draw.slice
        share = share_built(parts, cut)
        low, high = draw.span or self.span(frame)
        facts = [fact(f"slice at {AXES[cut.axis]}", f"{place_of(parts, cut):.4g}")]
        if share is not None:
            facts.append(fact("built of the slice", percent(share, 1.0), _OF_SLICE))
        if built is not None:
            in_nodes = f"{percent(built.primitives, built.of)} of {count(built.of)}"
            facts.append(fact("nodes built", count(built.nodes)))
            facts.append(fact("primitives in them", in_nodes, "of all; the others wait for a ray to come near"))
        entries = (
            Entry("not built: no ray has come", WAITS_COLORS[1]),
            Entry(f"border of {'an object' if parts.owner == 'object' else 'a piece'}", (1.0, 1.0, 1.0)),
        )
        scale = Scale(f"level {low:.4g}", f"{high:.4g}")
        return Legend(f"{self.label}: levels of its parts, {parts.name}", (), entries, scale, tuple(facts))

    def values(self, frame: Frame, draw: DrawOptions) -> Values:
        parts = tree_seen(frame, tree_of(frame), draw.slice).parts
        levels = np.where(parts.built, parts.levels, -1)
        return single(levels, "level", parts.numbers != NOWHERE, classes=True)

    def words(self, frame: Frame, draw: DrawOptions, x: int, y: int) -> Words:
        tree = tree_of(frame)
        return part_words(part_seen(frame, tree, draw.slice, x, y), tree.owner)

    def layer(self, frame: Frame, cut: Slice) -> Layer | None:
        return Layer(layer_of(cut), LAYERS, place_of(tree_of(frame), cut)) if self.can_draw(frame) else None


def _behind(frame: Frame, draw: DrawOptions) -> Pixels:
    """Draw the dimmed picture.  It is rounded as float64, as the slice is: dimmed white lies between two bytes."""
    colors = np.where(
        hits(frame)[..., None], dimmed(frame, draw.tone, draw.beneath), np.asarray(BACKGROUND, np.float32)
    )
    colors[on_line(frame.primitive)] *= np.float32(outline(draw))
    return np.round(colors.astype(np.float64) * 255.0).astype(np.uint8)


def tree_of(frame: Frame) -> TreeParts:
    """Return the tree that the frame's rays were building.  Raises ValueError for a frame whose tree was there before,
    or is no more."""
    if TREE not in frame.structures:
        raise ValueError("all of the frame's tree was built before its rays came")
    found: TreeParts = frame.structures[TREE]
    if not found.alive:
        raise ValueError(TREE_IS_GONE)
    return found


VIEW = Tree()
