"""One pixel: why its shadow rays are culled or traced, the modes of its primitive, its rays, and what it shows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.frame import Frame
from tracer.mode_origins import NEVER
from tracer.why_in_words import Link, Words
from viewer.state.palette import OCCLUSION_COLORS, OCCLUSION_MEANING, SHADOW_COLORS, SHADOW_MEANING
from viewer.state.picking import Pick, pixel_of
from viewer.state.readings import can_draw
from viewer.state.views import View
from viewer.views import cell_lights
from viewer.window.panels import rays, why
from viewer.window.panels.links import sentence
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    clipped,
    count,
    fact,
    heading,
    paragraph,
    properties,
    swatch,
    tooltip,
)


def show(ui: Ui) -> None:
    """The panel: what was clicked, else what the pointer is on."""
    c = ui.controller
    if c.selection.picked is not None:
        at, named = c.selection.pixel, f"{c.selection.picked.object_name} ({c.selection.picked.kind})"
        where = f"pixel {at[0]}, {at[1]}: {named}" if at is not None else f"{named}, not visible from here"
        clipped(where, QUIET)
        imgui.same_line()
        if imgui.small_button(f"{icons.ICON_FA_XMARK}##release"):
            c.selection.picked = None
            return
        tooltip(f"let it go, and follow the pointer again{ui.key('Stop, or clear the selection')}")
        _details(ui, c.selection.picked)
        return
    found = c.selection.at(c.selection.hovered)
    if found is None:
        paragraph(
            "Point at the picture to inspect a pixel; click to keep it here. Why are its shadow rays culled, or not?",
            QUIET,
        )
    elif found.primitive < 0:
        paragraph(f"Pixel {found.x}, {found.y}: nothing but background.", QUIET)
    else:
        clipped(f"pixel {found.x}, {found.y} under the pointer: {found.object_name} ({found.kind})", QUIET)
        _details(ui, found)


def _details(ui: Ui, pick: Pick) -> None:
    frame = ui.controller.frame
    by_modes = frame is None or frame.settings.keeps_modes
    if pick.wrong and frame is not None:
        paragraph(_wrong(pick.wrong, frame.settings.samples), ERROR)
    why.show(ui)  # first, as it is what a click asks
    if by_modes:
        heading("Modes of its cell" if pick.in_cells else "Modes")
        _modes(ui, pick)
        _references(ui)
    rays.section(ui)
    heading("Surface")
    with properties("primitive", 5.8) as shown:
        if shown:
            fact("Object", pick.object_name + ("  (moves)" if pick.dynamic else ""))
            fact("Primitive", f"{pick.primitive}  ({pick.kind})")
            if pick.in_cells:
                fact("Cell", f"{pick.unit}", "the part of it that carries modes and counts")
            if pick.material is not None:
                fact("Material", pick.material.name, _describe(pick))
            asks = _cell_asks(frame, pick)
            if asks:
                fact("Its cell", asks, "of the octree of this method: all but those that it knows to be hidden")
            if not by_modes:  # else it is said above
                fact("Pixels", f"{count(pick.pixels)} now")
            if math.isfinite(pick.depth):  # else nothing of it is seen
                fact("Depth", f"{pick.depth:.5g}")
            if pick.point is not None:
                fact("Point", "{:.4g}, {:.4g}, {:.4g}".format(*pick.point))
            if pick.normal is not None:
                fact("Normal", ", ".join(f"{along:z.2f}" for along in pick.normal))


def _wrong(answers: int, samples: int) -> str:
    """How many answers are wrong at a pixel, and of which of its rays; the sentences are of its first ray alone."""
    of = f"in its {samples} samples, at all bounces" if samples > 1 else "at all bounces"
    return f"{count(answers)} wrong shadow {'answer' if answers == 1 else 'answers'} at this pixel, {of}."


def _references(ui: Ui) -> None:
    """What became of the occlusion tests of the pixel against its two neighbours."""
    found, scene = ui.controller.inspector.why, ui.controller.session.scene
    if found is None or scene is None:
        return
    words = Words(scene, found)
    for number, one in enumerate(found.references):
        sentence(ui, words.reference(one), f"reference {number}", QUIET)


def _cell_asks(frame: Frame | None, pick: Pick) -> str:
    """How many lights the cell must look at that the pixel is in, in words; nothing where that is not known."""
    at = pixel_of(pick, frame) if frame is not None and can_draw(frame, View.CELL_LIGHTS) else None
    if frame is None or at is None:
        return ""
    asked = int(cell_lights.VIEW.found(frame)[at[1], at[0]])
    return f"asks {count(asked)} of {count(frame.lights)} lights" if asked >= 0 else ""


def _modes(ui: Ui, pick: Pick) -> None:
    """The occlusion mode, and the shadow mode per light."""
    with _rows() as shown:
        if not shown:
            return
        if pick.occlusion is not None:
            mode = pick.occlusion
            _mode("occlusion", mode.name, OCCLUSION_COLORS[mode], OCCLUSION_MEANING[mode])
            _whole_since(ui, pick)
        moves = pick.occlusion is OcclusionMode.DYNAMIC
        for light, shadow in enumerate(() if moves else pick.shadows):
            if shadow is not None:
                _mode(ui.light_name(light), shadow.name, SHADOW_COLORS[shadow], SHADOW_MEANING[shadow])
                _origin(ui, pick, light, shadow)
    uncovered = sum(mode is None for mode in pick.shadows)
    if uncovered:
        paragraph(f"{uncovered} more {'light is' if uncovered == 1 else 'lights are'} not culled", QUIET)


def _whole_since(ui: Ui, pick: Pick) -> None:
    """The picture since which the primitive is fully rendered.  Pictures are numbered as in the plots."""
    origins = ui.controller.history.origins_of(pick)
    if origins is not None and origins.whole != NEVER and pick.occlusion is OcclusionMode.FULLY_RENDERED:
        sentence(ui, ("since ", Link(f"picture {origins.whole}", frame=origins.whole)), "whole", QUIET)


def _origin(ui: Ui, pick: Pick, light: int, mode: ShadowMode) -> None:
    """The pictures in which the point was first seen lit by a light, and first blocked from it, with the pixels."""
    origins = ui.controller.history.origins_of(pick)
    if origins is None or mode is ShadowMode.INIT or light >= len(origins.lights):
        return
    met = origins.lights[light].met()
    for lit, number in met:
        found, word = ui.controller.origins.of(number, light, lit), "lit" if lit else "blocked"
        pixel, by = None if found is None else found.pixel, ""
        if found is not None:
            more = f" and {found.count - 1} more" if found.count > 1 else ""
            by = f", pixel {pixel[0]}, {pixel[1]}{more}" if pixel is not None else ", by reflected or refracted rays"
        sentence(
            ui, (f"{word} in ", Link(f"picture {number}", frame=number, pixel=pixel), by), f"{light} {word}", QUIET
        )
    if met and mode is not ShadowMode.PARTIAL_SHADOW:
        paragraph("never seen lit" if mode is ShadowMode.FULL_SHADOW else "never seen blocked", QUIET)


@contextmanager
def _rows() -> Iterator[bool]:
    """A table of two columns that wrap, a light on the left and its mode; yields whether it is visible."""
    shown = imgui.begin_table("modes", 2, int(imgui.TableFlags_.sizing_stretch_prop))
    if shown:
        imgui.table_setup_column("light", int(imgui.TableColumnFlags_.width_stretch), 1.0)
        imgui.table_setup_column("mode", int(imgui.TableColumnFlags_.width_stretch), 1.5)
    try:
        yield shown
    finally:
        if shown:
            imgui.end_table()


def _mode(name: str, mode: str, color: tuple[float, float, float], meaning: str) -> None:
    imgui.table_next_column()
    swatch(color)
    paragraph(name, QUIET)
    imgui.table_next_column()
    paragraph(mode.replace("_", " ").lower())
    tooltip(meaning)


def _describe(pick: Pick) -> str:
    m = pick.material
    assert m is not None
    text = "diffuse ({:.3g}, {:.3g}, {:.3g}), specular ({:.3g}, {:.3g}, {:.3g})".format(*m.diffuse, *m.specular)
    text += f", exponent {m.exponent:.4g}"
    return text + (f", transmission {m.transmission:.3g}, index {m.ior:.3g}" if m.transmission else "")
