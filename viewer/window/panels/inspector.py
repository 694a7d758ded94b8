"""One pixel: why its shadow rays are culled or traced, the modes of its primitive, its rays, and what it shows."""

from __future__ import annotations

import math

from imgui_bundle import imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.culling.modes import OcclusionMode
from tracer.mode_origins import Origin
from tracer.scene.model import Material
from tracer.why_in_words import Link, Words
from viewer.state.palette import OCCLUSION_COLORS, OCCLUSION_MEANING, SHADOW_COLORS, SHADOW_MEANING
from viewer.state.picking import Pick
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
    heading,
    paragraph,
    properties,
    swatch,
    tooltip,
    value,
)


def show(ui: Ui) -> None:
    """The panel: what was clicked, else what the pointer is on."""
    selection = ui.controller.selection
    picked, at = selection.picked, selection.pixel
    if picked is not None:
        named = f"{picked.object_name} ({picked.kind})"
        clipped(f"pixel {at[0]}, {at[1]}: {named}" if at is not None else f"{named}, not visible from here", QUIET)
        imgui.same_line()
        if imgui.small_button(f"{icons.ICON_FA_XMARK}##release"):
            selection.clear()
            return
        tooltip(f"clear the selection, and inspect what the pointer is on{ui.key('Stop, or clear the selection')}")
        _details(ui, picked, at)
        return
    found = selection.at(selection.hovered)
    if found is None:
        paragraph(
            "Point at the picture to inspect a pixel, or click to select one: why are its shadow rays culled?", QUIET
        )
    elif found.primitive < 0:
        paragraph(f"Pixel {found.x}, {found.y}: background.", QUIET)
    else:
        clipped(f"pixel {found.x}, {found.y} under the pointer: {found.object_name} ({found.kind})", QUIET)
        _details(ui, found, (found.x, found.y))


def _details(ui: Ui, pick: Pick, at: tuple[int, int] | None) -> None:
    frame = ui.controller.frame
    by_modes = frame is None or frame.settings.keeps_modes
    if pick.wrong and frame is not None:
        paragraph(_wrong(pick.wrong, frame.settings.samples), ERROR)
    why.show(ui)  # first, as it is what a click asks
    if by_modes:
        heading("Modes of its cell" if pick.in_cells else "Modes")
        _modes(ui, pick)
    rays.section(ui)
    heading("Surface")
    with properties("primitive", 5.8) as shown:
        if not shown:
            return
        value("Object", pick.object_name + ("  (moves)" if pick.dynamic else ""), wraps=True)
        value("Primitive", f"{pick.primitive}  ({pick.kind})")
        if pick.in_cells:
            value("Cell", f"{pick.unit}", "the part of the primitive that has modes and pixel counts of its own")
        if pick.material is not None:
            value("Material", pick.material.name, _describe(pick.material), wraps=True)
        if frame is not None and at is not None and can_draw(frame, View.CELL_LIGHTS):
            asked = int(cell_lights.VIEW.found(frame)[at[1], at[0]])
            if asked >= 0:
                lights = f"looks at {count(asked)} of {count(frame.lights)} lights"
                value("Its cell", lights, "of the octree of this method: all but those known to be hidden from it")
        if not by_modes:  # else it is said above
            value("Pixels", f"{count(pick.pixels)} now")
        if math.isfinite(pick.depth):  # else nothing of it is seen
            value("Depth", f"{pick.depth:.5g}")
        if pick.point is not None:
            value("Point", "{:.4g}, {:.4g}, {:.4g}".format(*pick.point))
        if pick.normal is not None:
            value("Normal", ", ".join(f"{along:z.2f}" for along in pick.normal))


def _wrong(answers: int, samples: int) -> str:
    """How many answers are wrong at a pixel, and of which of its rays; the sentences are of its first ray alone."""
    of = f"in its {samples} samples, at all bounces" if samples > 1 else "at all bounces"
    return f"{count(answers)} wrong shadow {'answer' if answers == 1 else 'answers'} at this pixel, {of}."


def _modes(ui: Ui, pick: Pick) -> None:
    """The occlusion mode and the shadow mode per light, and how the pixel compares with its two reference pixels."""
    origins = ui.controller.history.origins_of(pick)
    if imgui.begin_table("modes", 2, int(imgui.TableFlags_.sizing_stretch_prop)):
        imgui.table_setup_column("light", int(imgui.TableColumnFlags_.width_stretch), 1.0)
        imgui.table_setup_column("mode", int(imgui.TableColumnFlags_.width_stretch), 1.5)
        if pick.occlusion is not None:
            mode = pick.occlusion
            _mode("occlusion", mode.name, OCCLUSION_COLORS[mode], OCCLUSION_MEANING[mode])
        for light, shadow in enumerate(() if pick.occlusion is OcclusionMode.DYNAMIC else pick.shadows):
            if shadow is not None:
                _mode(ui.light_name(light), shadow.name, SHADOW_COLORS[shadow], SHADOW_MEANING[shadow])
                if origins is not None and light < len(origins.lights):
                    _origin(ui, origins.lights[light], light)
        imgui.end_table()
    uncovered = sum(mode is None for mode in pick.shadows)
    if uncovered:
        paragraph(f"{uncovered} more {'light has' if uncovered == 1 else 'lights have'} no shadow mode", QUIET)
    found, scene = ui.controller.inspector.why, ui.controller.session.scene
    if found is not None and scene is not None:
        words = Words(scene, found)
        for number, one in enumerate(found.references):
            sentence(ui, words.reference(one), f"reference {number}", QUIET)


def _mode(name: str, mode: str, color: tuple[float, float, float], meaning: str) -> None:
    imgui.table_next_column()
    swatch(color)
    paragraph(name, QUIET)
    imgui.table_next_column()
    paragraph(mode.replace("_", " ").lower())
    tooltip(meaning)


def _origin(ui: Ui, origin: Origin, light: int) -> None:
    """The pictures, numbered as in the plots, in which the primitive was first seen lit by a light and blocked from it,
    with the pixels that were."""
    for lit, number in origin.met():
        found, word, by = ui.controller.origins.of(number, light, lit), "lit" if lit else "blocked", ""
        if found is not None and found.pixel is not None:
            by = f" at {found.pixel[0]}, {found.pixel[1]}" + (f" and {found.count - 1} more" if found.count > 1 else "")
        elif found is not None:
            by = " for reflected or refracted rays"
        link = Link(f"picture {number}", frame=number, pixel=None if found is None else found.pixel)
        sentence(ui, (f"{word} in ", link, by), f"{light} {word}", QUIET)


def _describe(m: Material) -> str:
    text = "diffuse ({:.3g}, {:.3g}, {:.3g}), specular ({:.3g}, {:.3g}, {:.3g})".format(*m.diffuse, *m.specular)
    text += f", exponent {m.exponent:.4g}"
    return text + (f", transmission {m.transmission:.3g}, index {m.ior:.3g}" if m.transmission else "")
