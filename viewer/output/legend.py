"""What the legend of a view says: its colours, what each stands for, and how much of the frame has it.

The window draws it into the picture, or beside it, and a saved picture may carry it; `legend_layout` says where its
parts lie.  Nothing here needs GL.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from tracer.culling.voxels.tell import STATE_NAMES
from tracer.fit import too_few
from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.lights import Light, number_of
from tracer.statistics import CutErrors
from viewer.output.legend_counts import (
    LegendRow,
    cell_lights_legend,
    certificate_legend,
    cuts_legend,
    difference_legend,
    lights_legend,
    occlusion_legend,
    penumbra_legend,
    shadow_legend,
    voxels_legend,
    work_legend,
)
from viewer.state import terms
from viewer.state.readings import can_draw, has_modes_of_cells, span_of, tree_of, voxels_of
from viewer.state.slices import AXES, MIDDLE, Slice, middle_of
from viewer.state.tone import NEUTRAL, clipped
from viewer.state.tone import Tone as DisplayTone
from viewer.state.tree_slice import SAMPLES, place_of, share_built
from viewer.state.views import (
    ARRIVAL_COLORS,
    ARRIVAL_MEANING,
    BLACK,
    GREY,
    TOO_BRIGHT,
    TREE_WAITS,
    VOXEL_COLORS,
    VOXEL_MEANING,
    WRONG,
    Arrival,
    Color,
    View,
)
from viewer.util.numbers import count, percent

NEARLY_ALL = 0.9  # of the lights: cuts of more clusters show nothing


class Tone(Enum):
    """How a note is meant."""

    PLAIN = "a fact"
    GOOD = "all is well"
    WARNING = "take care"


@dataclass(frozen=True)
class Entry:
    """A line: a colour, or none, what it stands for, a value for each of the legend's columns, and more in words.

    Where it is `quiet`, its values name what is below them."""

    name: str
    color: Color | None = None
    values: tuple[str, ...] = ()
    meaning: str = ""
    quiet: bool = False


@dataclass(frozen=True)
class Scale:
    """The colour map as a bar, and what its ends and its middle stand for; `reverse` begins with its last colour, and
    `signed` is that of a signed difference."""

    low: str
    high: str
    middle: str = ""
    reverse: bool = False
    signed: bool = False


@dataclass(frozen=True)
class Note:
    """A sentence below the rest."""

    text: str
    tone: Tone = Tone.PLAIN


@dataclass(frozen=True)
class Legend:
    """A title, names of the columns of values, and the rest as far as there is any; `facts` come after the colours."""

    title: str
    columns: tuple[str, ...] = ()
    entries: tuple[Entry, ...] = ()
    scale: Scale | None = None
    facts: tuple[Entry, ...] = ()
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class Chosen:
    """What else is chosen of a view: its light, with its name and number, whether wrong pixels are marked,
    shares of rays, the range of its numbers, the tone of its picture, whether what this clips is marked, and the slice
    through space."""

    light: int = 0
    light_name: str = ""
    marked: bool = True
    shares: bool = False
    span: tuple[float, float] | None = None
    tone: DisplayTone = NEUTRAL
    clipping: bool = False
    light_number: int | None = None
    cut: Slice = MIDDLE

    @property
    def number(self) -> int:
        return self.light if self.light_number is None else self.light_number


def legend_of(frame: Frame, view: View, chosen: Chosen = Chosen()) -> Legend | None:
    """The legend of a frame in a view that can be drawn of it; None for colours that speak for themselves."""
    if view is View.COLOR and chosen.clipping:
        return _clipped(frame, chosen)
    makers: dict[View, Callable[[Frame, View, Chosen], Legend]] = {
        View.OCCLUSION: _occlusion,
        View.SHADOW: _of_light,
        View.CERTIFICATE: _of_light,
        View.PRIMITIVE: _primitives,
        View.DEPTH: _depth,
        View.NORMAL: _normals,
        View.PIXEL_COUNT: _pixel_counts,
        View.DIFFERENCE: _difference,
        View.WIPE: _difference,
        View.SAVED: _work,
        View.COST: _work,
        View.PENUMBRA: _penumbra,
        View.LIGHTS: _lights,
        View.CUTS: _cuts,
        View.VOXELS: _voxels,
        View.CELL_LIGHTS: _cell_lights,
        View.TREE: _tree,
    }
    return makers[view](frame, view, chosen) if view in makers and can_draw(frame, view, chosen.light) else None


def light_in_words(number: int, name: str) -> str:
    """A light by its number, and its name where that says more: light 2 (lamp)."""
    said = f"light {number}"
    return said if name in ("", said) else f"{said} ({name})"


def named_light(lights: Sequence[Light], light: int) -> str:
    """The same of one of a scene's lights; its number is that in the scene as it was read, whichever are off now."""
    return light_in_words(number_of(lights, light), lights[light].name if light < len(lights) else "")


def _classes(rows: list[LegendRow], units: str) -> tuple[Entry, ...]:
    return tuple(
        Entry(
            row.name.replace("_", " ").lower(),
            row.color,
            (f"{100.0 * row.pixel_share:.1f} %", count(row.units)),
            f"{row.name}: {row.meaning}. {count(row.pixels)} pixels; {100.0 * row.unit_share:.2f} % of all {units}.",
        )
        for row in rows
    )


def _units(frame: Frame) -> str:
    return "cells" if has_modes_of_cells(frame) else "primitives"


def _by_modes(frame: Frame, light: int | None = None, number: int | None = None) -> tuple[Entry, ...]:
    """What the paper's method would cull of this frame's shadow rays: of one light, and of all."""
    said, columns = frame.statistics.by_modes, {"all lights": frame.statistics.by_modes_in_all}
    if not said:
        return ()
    if light is not None and light < len(said) > 1:
        columns = {f"light {number}": said[light]} | columns
    culls = Method.parse(frame.settings.method).uses_modes
    parts = columns.values()
    return (
        Entry(f"shadow rays{'' if culls else ', if by modes'}", None, tuple(columns), _BY_MODES, quiet=True),
        Entry(
            terms.CULLED,
            None,
            tuple(percent(one.full_shadow, one.due) for one in parts),
            "of the rays due: those of fully rendered primitives in full shadow",
        ),
        Entry(
            terms.DYNAMIC_ONLY,
            None,
            tuple(percent(one.non_shadow, one.due) for one in parts),
            "of the rays due: those of fully rendered primitives in non-shadow, tested against dynamic objects only",
        ),
    )


def _occlusion(frame: Frame, view: View, chosen: Chosen) -> Legend:
    units = _units(frame)
    entries = _classes(occlusion_legend(frame), units)
    return Legend(view.label, ("pixels", units), entries, facts=_by_modes(frame))


def _of_light(frame: Frame, view: View, chosen: Chosen) -> Legend:
    title = f"{view.label}, {light_in_words(chosen.number, chosen.light_name)}"
    if view is View.SHADOW:
        rows, units, facts = (
            shadow_legend(frame, chosen.light),
            _units(frame),
            _by_modes(frame, chosen.light, chosen.number),
        )
    else:
        rows, units, facts = certificate_legend(frame, chosen.light), "cells", ()
    if not rows:
        return Legend(
            title,
            notes=(Note("This light is not culled, as there are too many: all its rays are traced.", Tone.WARNING),),
        )
    return Legend(title, ("pixels", units), _classes(rows, units), facts=facts)


def _primitives(frame: Frame, view: View, chosen: Chosen) -> Legend:
    seen = int(np.count_nonzero(np.bincount(frame.primitive[frame.primitive >= 0])))
    return Legend(view.label, facts=(Entry("in view, each in a colour of its own", values=(count(seen),)),))


def _clipped(frame: Frame, chosen: Chosen) -> Legend:
    """How much of the picture the screen cuts off."""
    found, pixels = clipped(frame.color, chosen.tone), frame.primitive.size
    rows = (("too bright", TOO_BRIGHT, found.bright, _TOO_BRIGHT), ("black", BLACK, found.black, _BLACK))
    entries = tuple(
        Entry(name, color, (percent(int(where.sum()), pixels),), f"{meaning}: {count(int(where.sum()))} pixels")
        for name, color, where, meaning in rows
    )
    words = chosen.tone.in_words()
    return Legend(f"Clipped pixels{f', {words}' if words else ''}", ("pixels",), entries)


def _depth(frame: Frame, view: View, chosen: Chosen) -> Legend:
    near, far = chosen.span or span_of(frame, view)
    return Legend(f"{view.label}, in units of the scene", scale=Scale(f"{near:.4g}", f"{far:.4g}", "", reverse=True))


def _normals(frame: Frame, view: View, chosen: Chosen) -> Legend:
    ways = (("x", (1.0, 0.5, 0.5)), ("y", (0.5, 1.0, 0.5)), ("z", (0.5, 0.5, 1.0)))
    return Legend(view.label, entries=tuple(Entry(f"towards +{axis}", color) for axis, color in ways))


def _pixel_counts(frame: Frame, view: View, chosen: Chosen) -> Legend:
    zoom = frame.settings.zoom_factor
    scale = Scale(f"1/{zoom:.3g}", f"{zoom:.3g} x", "as many")
    entries = (Entry("never fully rendered", GREY),)
    return Legend("Pixels now, against the highest count", (), entries, scale, _by_modes(frame))


def _work(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found, saved = work_legend(frame, view), view is View.SAVED
    part = f"{percent(found.total, found.whole)}{' of those due' if saved else ''}"
    facts = [Entry("in all", values=(f"{count(found.total)} ({part})",), meaning=_IN_ALL_SAVED if saved else _IN_ALL)]
    facts.append(Entry("per pixel", values=(f"{found.per_pixel:.2f}, at most {count(found.most)}",)))
    if not chosen.shares:
        low, high = chosen.span or (0.0, found.top)
        scale = Scale(f"{low:.4g}", f"{high:.4g} and more", f"{(low + high) / 2.0:.3g}")
        return Legend(view.label, (), (), scale, tuple(facts))
    title = (
        "Share of the shadow rays due that is saved" if saved else "Share of the rays without culling that is traced"
    )
    entries = (Entry("no shadow ray is due", GREY),) if saved else ()
    return Legend(title, (), entries, Scale("0 %", "100 %", "50 %"), tuple(facts))


def _penumbra(frame: Frame, view: View, chosen: Chosen) -> Legend:
    title = f"{view.label}, {light_in_words(chosen.number, chosen.light_name)}"
    found = penumbra_legend(frame, chosen.light)
    entries = tuple(
        Entry(_ARRIVALS[one], ARRIVAL_COLORS[one], (percent(pixels, found.seen),), f"{ARRIVAL_MEANING[one]}. "
              f"{count(pixels)} pixels")
        for one, pixels in reversed(found.pixels.items())
        if pixels or one is not Arrival.UNKNOWN
    )  # fmt: skip
    facts = [Entry("samples", None, (count(found.samples),), "of the light, that a pixel faces at most")]
    if found.share is not None:
        facts.append(Entry("light in the penumbra", None, (percent(found.share, 1.0),), _SHARE))
    return Legend(title, ("pixels",), entries, facts=tuple(facts))


def _lights(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found = lights_legend(frame)
    facts = (Entry("per pixel", values=(f"{found.per_pixel:.4g} of {count(frame.lights)} lights",)),)
    entries = (Entry(_ARRIVALS[Arrival.UNKNOWN], GREY),) if frame.shaded is not None else ()
    middle = count(found.most // 2) if found.most % 2 == 0 else ""
    scale = Scale("0", count(found.most), middle)
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    return Legend("Lights that each pixel has to look at", (), entries, scale, facts)


def _cuts(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found = cuts_legend(frame)
    facts = (
        Entry("per pixel", values=(f"{found.per_pixel:.4g} for {count(found.lights)} lights",)),
        Entry("each may be wrong by", None, (f"{percent(frame.settings.lightcuts_error, 1.0)} of the light",), _EACH),
        Entry("all of them together", None, (f"{percent(found.bound, 1.0)} at most",), _BOUND),
    )
    entries = (Entry(_ARRIVALS[Arrival.UNKNOWN], GREY),) if found.unknown else ()
    scale = Scale("0", count(found.most), count(found.most // 2) if found.most % 2 == 0 else "")
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    cuts = frame.statistics.cuts
    notes: tuple[Note, ...] = ()
    if cuts is not None and cuts.blocks and cuts.mean > NEARLY_ALL * cuts.lights:
        few = too_few(Method.parse(frame.settings.method), cuts.lights)
        notes = (Note(f"Nearly every light is a cluster of its own{f': {few}' if few else ''}.", Tone.WARNING),)
    return Legend("Clusters of lights that each pixel is shaded by", (), entries, scale, facts, notes)


def _voxels(frame: Frame, view: View, chosen: Chosen) -> Legend:
    states, found = voxels_of(frame), voxels_legend(frame, chosen.light, chosen.cut)
    axis, grid = AXES[chosen.cut.axis], states.grid
    title = f"{view.label}, {light_in_words(chosen.number, chosen.light_name)}"
    if not states.known[chosen.light]:
        why = "Nothing is known of this light: it is a lamp, or past those that there is room for; its rays are traced."
        return Legend(title, notes=(Note(why, Tone.WARNING),))
    entries = tuple(
        Entry(
            STATE_NAMES[state],
            VOXEL_COLORS[state],
            (percent(found.in_slice[state], sum(found.in_slice)), percent(found.in_all[state], grid.voxels)),
            f"{VOXEL_MEANING[state]}. {count(found.in_all[state])} voxels in all",
        )
        for state in (1, 2, 0)
    )
    layer = chosen.cut.layer(states.shape)
    facts = (
        Entry(f"slice at {axis}", None, (f"{middle_of(grid, chosen.cut):.4g}",), "the middles of a layer of voxels"),
        Entry("layer", None, (f"{count(layer)} of {count(states.shape[chosen.cut.axis])}",), "counted from 0"),
        Entry("grid", None, (" x ".join(str(n) for n in states.shape),), f"of voxels that are {grid.side:.3g} wide"),
    )
    return Legend(title, ("slice", "all"), entries, facts=facts)


def _cell_lights(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found = cell_lights_legend(frame)
    facts = (
        Entry("per pixel", values=(f"{found.per_pixel:.4g} of {count(frame.lights)} lights",), meaning=_PER_CELL),
        Entry("cells in view", values=(count(found.cells),)),
    )
    entries = (Entry(_ARRIVALS[Arrival.UNKNOWN], GREY),) if found.unknown else ()
    scale = Scale("0", count(found.most), count(found.most // 2) if found.most % 2 == 0 else "")
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    return Legend("Lights that the cell must look at", (), entries, scale, facts)


def _tree(frame: Frame, view: View, chosen: Chosen) -> Legend:
    parts, built = tree_of(frame), frame.statistics.built
    share = share_built(parts, chosen.cut)
    low, high = chosen.span or span_of(frame, view)
    facts = [Entry(f"slice at {AXES[chosen.cut.axis]}", None, (f"{place_of(parts, chosen.cut):.4g}",))]
    if share is not None:
        facts.append(Entry("built of the slice", None, (percent(share, 1.0),), _OF_SLICE))
    if built is not None:
        in_nodes = f"{percent(built.primitives, built.of)} of {count(built.of)}"
        facts.append(Entry("nodes built", None, (count(built.nodes),)))
        facts.append(Entry("primitives in them", None, (in_nodes,), "of all; the others wait for a ray to come near"))
    entries = (
        Entry("not built: no ray has come", TREE_WAITS[1]),
        Entry(f"border of {'an object' if parts.owner == 'object' else 'a piece'}", (1.0, 1.0, 1.0)),
    )
    scale = Scale(f"level {low:.4g}", f"{high:.4g}")
    return Legend(f"{view.label}: levels of its parts, {parts.name}", (), entries, scale, tuple(facts))


def _difference(frame: Frame, view: View, chosen: Chosen) -> Legend:
    """What is wrong in the frame, or why nothing is."""
    found, shadow = difference_legend(frame), frame.statistics.shadow
    pixels = f"{count(found.pixels)} ({percent(found.pixel_share, 1.0)})"
    colored, samples = view is View.DIFFERENCE or chosen.marked, frame.settings.samples
    name = "around wrong pixels" if colored and view is not View.DIFFERENCE else "wrong pixels"
    name += f", all {samples} samples" if samples > 1 else ""
    entries = (Entry(name, WRONG if colored else None, (pixels,), _WRONG_PIXELS),)
    facts = (
        Entry(
            "wrong answers, first sample" if samples > 1 else "wrong answers",
            None,
            (f"{count(found.answers)} ({percent(found.answers, found.due)} of those due)",),
            _ANSWERS,
        ),
        Entry("largest difference", None, (f"{255.0 * found.largest:.0f} of 255",), _LARGEST),
    )
    cuts = frame.statistics.cuts
    if cuts is not None and cuts.errors is not None:
        return Legend(view.label, (), entries, facts=(*_cut_errors(cuts.errors), facts[1]))
    if not Method.parse(frame.settings.method).culls:
        note = Note("Culling is off: every shadow ray is traced, so nothing can be wrong.", Tone.WARNING)
    elif not any((shadow.culled, shadow.candidates_only, shadow.dynamic_only, shadow.cache_hits, shadow.passed_over)):
        note = Note("No shadow ray of this frame was culled, so none can be wrong.", Tone.WARNING)
    elif not found.pixels:
        note = Note("Nothing is wrong: every culled shadow ray has the answer that tracing gives.", Tone.GOOD)
    else:
        return Legend(view.label, (), entries, facts=facts)
    return Legend(view.label, (), entries, notes=(note,))


_ARRIVALS = {
    Arrival.AWAY: "faces away",
    Arrival.DARK: "fully dark",
    Arrival.FEW: "penumbra, at most half",
    Arrival.MOST: "penumbra, more than half",
    Arrival.LIT: "fully lit",
    Arrival.UNKNOWN: "not known yet",
}
_OF_SLICE = f"its area, by {SAMPLES} x {SAMPLES} points; what lies outside of all boxes counts for neither"
_TOO_BRIGHT = "red, green or blue is brighter than the screen's"
_BLACK = "no channel is brighter than nothing"


def _cut_errors(errors: CutErrors) -> tuple[Entry, ...]:
    """What is wrong in pictures by clusters of lights, of which no answer is wrong."""
    parts = (("half of the pixels", errors.median), ("95 % of them", errors.most_of), ("all of them", errors.most))
    return tuple(Entry(f"{name} differ by", None, (f"{100.0 * e:.2g} % at most",), _ERRORS) for name, e in parts)


_ERRORS = (
    "by what part of its light a pixel differs from the picture by all lights; darker ones than 1/64 as if that bright"
)
_EACH = "the chosen error: clusters are parted until each alone is wrong by no more than this part of a pixel's light"
_BOUND = (
    "the sum over the clusters of a pixel, each within its own error: by what part of its light the pixel would be "
    "wrong if every cluster were as wrong as it can be, all in the same direction; the middle of all pixels. What is "
    "wrong in fact, as Verify tells, is a small part of that."
)
_PER_CELL = (
    "those that are not known to be hidden from all of the cell: they light all of it, or something may block them"
)
_SHARE = "of the samples that pixels in the penumbra face, those that reach them"
_BY_MODES = "of this frame, at all bounces, by the modes after the frame before: what the paper's method saves"
_IN_ALL_SAVED = "of the first sample of each pixel; the share is of the shadow rays due"
_IN_ALL = "of the first sample of each pixel; the share is of the rays traced without culling"
_WRONG_PIXELS = "with a wrong answer for any light, at any bounce, in any sample"
_ANSWERS = "shadow rays for which culling and tracing disagree; of the first sample of each pixel"
_LARGEST = "between a wrong pixel's colour and the right one; a wrong answer deep in reflections may change nothing"
