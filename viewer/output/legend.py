"""What the legend of a view says: its colours, what each stands for, and how much of the frame has it.

The window draws it into the picture, or beside it, and a saved picture may carry it; `legend_parts` says what it
consists of, and `legend_layout` where that lies.  Nothing here needs GL.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tracer.frame import Frame
from tracer.method import Method
from tracer.scene.lights import number_of
from tracer.statistics import CutErrors
from viewer.output.legend_counts import (
    LegendRow,
    certificate_legend,
    lights_legend,
    occlusion_legend,
    penumbra_legend,
    shadow_legend,
    work_legend,
)
from viewer.output.legend_of_fates import of_fates, of_moving_shadows
from viewer.output.legend_of_space import of_cell_lights, of_cuts, of_tree, of_voxels
from viewer.output.legend_parts import ARRIVAL_NAMES, AS_USUAL, Chosen, Entry, Legend, Note, Scale, Tone
from viewer.state import terms, verified
from viewer.state.readings import can_draw, has_modes_of_cells, span_of
from viewer.state.tone import clipped
from viewer.state.views import (
    ARRIVAL_COLORS,
    ARRIVAL_MEANING,
    BLACK,
    GREY,
    TOO_BRIGHT,
    WRONG,
    Arrival,
    View,
)
from viewer.util.numbers import count, percent


def legend_of(frame: Frame, view: View, chosen: Chosen = AS_USUAL) -> Legend | None:
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
        View.CUTS: of_cuts,
        View.VOXELS: of_voxels,
        View.CELL_LIGHTS: of_cell_lights,
        View.TREE: of_tree,
        View.FATE: of_fates,
        View.MOVING_SHADOW: of_moving_shadows,
    }
    return makers[view](frame, view, chosen) if view in makers and can_draw(frame, view, chosen.light) else None


def _classes(rows: list[LegendRow], units: str) -> tuple[Entry, ...]:
    return tuple(
        Entry(
            row.name.replace("_", " ").lower(),
            row.color,
            (f"{100.0 * row.pixel_share:.1f} %", count(row.units)),
            f"{row.name}: {row.meaning}. {count(row.pixels)} pixels; {100.0 * row.unit_share:.2f} % of all {units}.",
            stripes=row.stripes,
        )
        for row in rows
    )


def _at_rest(frame: Frame) -> tuple[Entry, ...]:
    """The primitives of dynamic objects that are not counted as dynamic, so that none is missed."""
    resting = frame.statistics.resting
    if not resting:
        return ()
    meaning = f"{count(resting)} primitives of dynamic objects that rest: with {frame.settings.method} they count as "
    return (Entry("dynamic, at rest", None, ("", count(resting)), f"{meaning}static, and are in the rows above"),)


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
    name, parts = "shadow rays, all bounces", columns.values()
    return (
        Entry(f"{name}{'' if culls else ', if by modes'}{_of_part(frame)}", None, tuple(columns), _BY_MODES, True),
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


def _of_part(frame: Frame) -> str:
    """That figures are not those of all pixels, where that is so."""
    part = frame.statistics.part
    return f", {percent(part, 1.0)} shaded" if part < 1.0 else ""


def _occlusion(frame: Frame, view: View, chosen: Chosen) -> Legend:
    units = _units(frame)
    entries = (*_classes(occlusion_legend(frame), units), *_at_rest(frame))
    return Legend(view.label, ("pixels", units), entries, facts=_by_modes(frame))


def _of_light(frame: Frame, view: View, chosen: Chosen) -> Legend:
    title = f"{view.label}, {chosen.light_in_words}"
    if view is View.SHADOW:
        rows, units, facts = (
            shadow_legend(frame, chosen.light),
            _units(frame),
            _by_modes(frame, chosen.light, number_of(chosen.lights, chosen.light)),
        )
    else:
        rows, units, facts = certificate_legend(frame, chosen.light), "cells", ()
    if not rows:
        return Legend(
            title,
            notes=(Note("This light is not culled, as there are too many: all its rays are traced.", Tone.WARNING),),
        )
    return Legend(title, ("pixels", units), (*_classes(rows, units), *_at_rest(frame)), facts=facts)


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
    partly = frame.statistics.part < 1.0
    name = f"in the {percent(frame.statistics.part, 1.0)} that is shaded" if partly else "in all"
    facts = [Entry(name, values=(f"{count(found.total)} ({part})",), meaning=_IN_ALL_SAVED if saved else _IN_ALL)]
    facts.append(Entry("per pixel", values=(f"{found.per_pixel:.2f}, at most {count(found.most)}",)))
    notes = (Note(_NEAREST),) if partly else ()
    if not chosen.shares:
        low, high = chosen.span or (0.0, found.top)
        scale = Scale(f"{low:.4g}", f"{high:.4g} and more", f"{(low + high) / 2.0:.3g}")
        return Legend(view.label, (), (), scale, tuple(facts), notes=notes)
    title = (
        "Share of the shadow rays due that is untraced" if saved else "Share of the rays without culling that is traced"
    )
    entries = (Entry("no shadow ray is due", GREY),) if saved else ()
    return Legend(title, (), entries, Scale("0 %", "100 %", "50 %"), tuple(facts), notes=notes)


def _penumbra(frame: Frame, view: View, chosen: Chosen) -> Legend:
    title = f"{view.label}, {chosen.light_in_words}"
    found = penumbra_legend(frame, chosen.light)
    entries = tuple(
        Entry(ARRIVAL_NAMES[one], ARRIVAL_COLORS[one], (percent(pixels, found.seen),), f"{ARRIVAL_MEANING[one]}. "
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
    entries = (Entry(ARRIVAL_NAMES[Arrival.UNKNOWN], GREY),) if frame.shaded is not None else ()
    middle = count(found.most // 2) if found.most % 2 == 0 else ""
    scale = Scale("0", count(found.most), middle)
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    return Legend("Lights that each pixel has to look at", (), entries, scale, facts)


def _difference(frame: Frame, view: View, chosen: Chosen) -> Legend:
    """What is wrong in the frame, or of what it is said that nothing is."""
    statistics, found = frame.statistics, verified.known(frame.statistics.wrong)
    colored = view is View.DIFFERENCE or chosen.marked
    name = "around wrong pixels" if colored and view is not View.DIFFERENCE else terms.WRONG_PIXELS
    name = verified.named(name, found)
    pixels = f"{count(found.pixels)} ({percent(found.pixels, found.shaded)})"
    entries = (Entry(name, WRONG if colored else None, (pixels,), terms.MEANINGS[terms.WRONG_PIXELS]),)
    largest, seen = verified.largest_difference(frame)
    of_pixels = (
        Entry("of them look otherwise", None, (count(seen),), _LOOK_OTHERWISE),
        Entry("largest difference", None, (verified.difference_in_words(largest),), _LARGEST),
    )
    cuts = statistics.cuts
    if cuts is not None and cuts.errors is not None:
        return Legend(view.label, (), entries, facts=(*of_pixels, *_cut_errors(cuts.errors)))
    if found.answers:
        answers = f"{count(found.answers)} ({percent(found.answers, found.due)} of those due)"
        tip = f"{terms.MEANINGS[terms.WRONG]}: {verified.share(found)}"
        facts = (*of_pixels, Entry(verified.named(terms.WRONG, found), None, (answers,), tip))
        notes = (Note(verified.of_what(statistics)),) if statistics.part < 1.0 else ()
        return Legend(view.label, (), entries, facts=facts, notes=notes)
    said = f"{verified.in_words(statistics)}."
    return Legend(view.label, (), entries, notes=(Note(said, Tone.PLAIN if found.untraced else Tone.WARNING),))


_TOO_BRIGHT = "red, green or blue is brighter than the screen's"
_NEAREST = "Other pixels show what the nearest of these has."
_BLACK = "no channel is brighter than nothing"


def _cut_errors(errors: CutErrors) -> tuple[Entry, ...]:
    """What is wrong in pictures by clusters of lights, of which no answer is wrong."""
    parts = (("half of the pixels", errors.median), ("95 % of them", errors.most_of), ("all of them", errors.most))
    return tuple(Entry(f"{name} differ by", None, (f"{100.0 * e:.2g} % at most",), _ERRORS) for name, e in parts)


_ERRORS = (
    "by what part of its light a pixel differs from the picture by all lights; darker ones than 1/64 as if that bright"
)
_SHARE = "of the samples that pixels in the penumbra face, those that reach them"
_BY_MODES = "of this frame, at all bounces, by the modes after the frame before: what the paper's method saves"
_IN_ALL_SAVED = "of the first sample of each pixel; the share is of the shadow rays due"
_IN_ALL = (
    "of the first sample of each pixel, through the whole scene: shadow rays that asked dynamic objects or a few "
    "candidates alone are not among them; the share is of the rays traced without culling"
)
_LOOK_OTHERWISE = "than with every answer right; one deep in reflections may change nothing that a screen shows"
_LARGEST = "between a channel of a wrong pixel's colour and the right one, also where both are too bright for a screen"
