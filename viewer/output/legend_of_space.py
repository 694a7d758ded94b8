"""Legends of what is kept of space and of lights in it: clusters, voxels, cells, and trees that are built in part."""

from __future__ import annotations

from tracer.culling.voxels.tell import STATE_NAMES
from tracer.fit import lights_in_words, too_few
from tracer.frame import Frame
from tracer.method import Method
from viewer.output.legend_counts import cell_lights_legend, cuts_legend, voxels_legend
from viewer.output.legend_parts import ARRIVAL_NAMES, Chosen, Entry, Legend, Note, Scale, Tone
from viewer.state.readings import span_of, tree_of, voxels_of
from viewer.state.slices import AXES, middle_of
from viewer.state.tree_slice import SAMPLES, place_of, share_built
from viewer.state.views import GREY, TREE_WAITS, VOXEL_COLORS, VOXEL_MEANING, Arrival, View
from viewer.util.numbers import count, percent

NEARLY_ALL = 0.9  # of the lights: cuts of more clusters show nothing
_EACH = "the chosen error: clusters are parted until each alone is wrong by no more than this part of a pixel's light"
_BOUND = (
    "the sum over the clusters of a pixel, each within its own error: by what part of its light the pixel would be "
    "wrong if every cluster were as wrong as it can be, all in the same direction; the middle of all pixels. What is "
    "wrong in fact, as Verify tells, is a small part of that."
)
_PER_CELL = (
    "those that are not known to be hidden from all of the cell: they light all of it, or something may block them"
)
_OF_SLICE = f"its area, by {SAMPLES} x {SAMPLES} points; what lies outside of all boxes counts for neither"


def of_cuts(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found = cuts_legend(frame)
    facts = (
        Entry("per pixel", values=(f"{found.per_pixel:.4g} for {lights_in_words(frame.lights, found.lights)}",)),
        Entry("each may be wrong by", None, (f"{percent(frame.settings.lightcuts_error, 1.0)} of the light",), _EACH),
        Entry("all of them together", None, (f"{percent(found.bound, 1.0)} at most",), _BOUND),
    )
    entries = (Entry(ARRIVAL_NAMES[Arrival.UNKNOWN], GREY),) if found.unknown else ()
    scale = Scale("0", count(found.most), count(found.most // 2) if found.most % 2 == 0 else "")
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    cuts = frame.statistics.cuts
    notes: tuple[Note, ...] = ()
    if cuts is not None and cuts.blocks and cuts.mean > NEARLY_ALL * cuts.lights:
        few = too_few(Method.parse(frame.settings.method), frame.lights, cuts.lights)
        one = "light" if cuts.lights == frame.lights else "sample of a light"
        notes = (Note(f"Nearly every {one} is a cluster of its own{f': {few}' if few else ''}.", Tone.WARNING),)
    return Legend("Clusters of lights that each pixel is shaded by", (), entries, scale, facts, notes)


def of_voxels(frame: Frame, view: View, chosen: Chosen) -> Legend:
    states, found = voxels_of(frame), voxels_legend(frame, chosen.light, chosen.cut)
    axis, grid = AXES[chosen.cut.axis], states.grid
    title = f"{view.label}, {chosen.light_in_words}"
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


def of_cell_lights(frame: Frame, view: View, chosen: Chosen) -> Legend:
    found = cell_lights_legend(frame)
    facts = (
        Entry("per pixel", values=(f"{found.per_pixel:.4g} of {count(frame.lights)} lights",), meaning=_PER_CELL),
        Entry("cells in view", values=(count(found.cells),)),
    )
    entries = (Entry(ARRIVAL_NAMES[Arrival.UNKNOWN], GREY),) if found.unknown else ()
    scale = Scale("0", count(found.most), count(found.most // 2) if found.most % 2 == 0 else "")
    if chosen.span is not None:
        scale = Scale(f"{chosen.span[0]:.4g}", f"{chosen.span[1]:.4g}")
    return Legend("Lights that the cell must look at", (), entries, scale, facts)


def of_tree(frame: Frame, view: View, chosen: Chosen) -> Legend:
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
