"""One pixel: why its shadow rays are culled or traced, the modes of its primitive, its rays, and what it shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons
from numpy.typing import NDArray

from tracer.culling import modes
from tracer.culling.fate import Fate
from tracer.culling.modes import OcclusionMode
from tracer.frame import Frame
from tracer.inspect.mode_origins import Origin
from tracer.inspect.reasons import Reason, Rule, Why
from tracer.inspect.why_in_words import Link, Words, plain
from tracer.scene.model import Material, Scene
from viewer.services.inspector import Pixel, with_origins
from viewer.state.palette import FATES, OCCLUSION, SHADOW, Class
from viewer.state.picking import Pick, shadow_mode_of, unit_of, wrong_at
from viewer.state.views import has_modes_of_cells
from viewer.util.numbers import count, several
from viewer.window.panels import lights, rays
from viewer.window.panels.links import Pointed, sentence
from viewer.window.panels.status import traced_before_an_answer
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, fitted, heading, paragraph, properties, swatch, tooltip, value

_MOST_LIGHTS = 40  # that are listed at once


def show(ui: Ui) -> None:
    """The panel: what was clicked, else what the pointer is on."""
    selection = ui.controller.selection
    picked, at = selection.picked, selection.pixel
    if picked is not None:
        close = icons.ICON_FA_XMARK
        button = imgui.calc_text_size(close).x + 2.0 * imgui.get_style().frame_padding.x
        named = f"{picked.object_name} ({picked.kind})"
        clipped(
            f"pixel {at[0]}, {at[1]}: {named}" if at is not None else named, QUIET,
            imgui.get_content_region_avail().x - button - imgui.get_style().item_spacing.x,
        )  # fmt: skip
        imgui.same_line()
        if imgui.small_button(f"{close}##release"):
            selection.clear()
            return
        tooltip(f"clear the selection, and inspect what the pointer is on{ui.key('Stop, or clear the selection')}")
        _details(ui, picked, at)
        return
    found = selection.at(selection.hovered)
    if found is None:
        paragraph("Point at a pixel, or click one: why are its shadow rays culled, or traced?", QUIET)
    elif found.primitive < 0:
        paragraph(f"Pixel {found.x}, {found.y}: background.", QUIET)
    else:
        clipped(f"pixel {found.x}, {found.y} under the pointer: {found.object_name} ({found.kind})", QUIET)
        _details(ui, found, (found.x, found.y))


def _details(ui: Ui, pick: Pick, at: Pixel | None) -> None:
    """All that is known; of what is not visible from here, what it is."""
    frame, scene = ui.controller.frame, ui.controller.session.scene
    if frame is None or scene is None:
        return
    unit = unit_of(frame, pick.primitive, at)
    if at is None:
        paragraph("Not visible from here. Its shadow rays are explained when it is in view again.", QUIET)
    else:
        wrong = wrong_at(frame, *at)
        if wrong:
            of = f"in its {frame.settings.samples} samples, " if frame.settings.samples > 1 else ""
            paragraph(f"{several(wrong, 'wrong shadow answer')} at this pixel, {of}at all bounces.", ERROR)
            if ui.controller.shrinking.offers and imgui.small_button("Shrink"):
                ui.controller.shrinking.start()
        _why(ui, pick, unit, frame, scene, wrong or 0)  # first, as it is what a click asks
        if frame.settings.keeps_modes:
            heading("Modes of its cell" if has_modes_of_cells(frame) else "Modes")
            _modes(ui, unit, frame, scene)
        rays.section(ui)
    heading("Surface")
    with properties("primitive", 5.8) as shown:
        if shown:
            _surface(pick, unit, at, frame, scene)


def _surface(pick: Pick, unit: int, at: Pixel | None, frame: Frame, scene: Scene) -> None:
    value("Object", pick.object_name + ("  (moves)" if pick.dynamic else ""), wraps=True)
    value("Primitive", f"{pick.primitive}  ({pick.kind})")
    if has_modes_of_cells(frame) and unit >= 0:
        value("Cell", f"{unit}", "the part of the primitive that has modes and pixel counts of its own")
    if pick.primitive < scene.primitive_count:  # an edit may be on its way
        material = scene.material_of(pick.primitive)
        value("Material", material.name, _describe(material), wraps=True)
    if pick.point is not None:
        value("Point", "{:.4g}, {:.4g}, {:.4g}".format(*pick.point))
    if at is None:
        return
    x, y = at
    if not frame.settings.keeps_modes and 0 <= unit < len(frame.pixel_count):  # else it is said above
        value("Pixels", f"{count(frame.pixel_count[unit])} now")
    value("Depth", f"{frame.depth[y, x]:.5g}")
    value("Normal", ", ".join(f"{along:z.2f}" for along in frame.normal[y, x]))


def _describe(m: Material) -> str:
    text = "diffuse ({:.3g}, {:.3g}, {:.3g}), specular ({:.3g}, {:.3g}, {:.3g})".format(*m.diffuse, *m.specular)
    text += f", exponent {m.exponent:.4g}"
    return text + (f", transmission {m.transmission:.3g}, index {m.ior:.3g}" if m.transmission else "")


# --- why: sentences for one light, a line for each other one -------------------------------------------


@dataclass
class FirstLight:
    """The light of the views `before` the pixel `of` was clicked; -1 once a light is chosen in the panel."""

    of: Pick | None = None
    before: int = 0


def _why(ui: Ui, pick: Pick, unit: int, frame: Frame, scene: Scene, wrong: int) -> None:
    """The sentences, the chosen light's first; nothing but what the answer waits for while they are not known."""
    found = ui.controller.inspector.why
    if found is None:
        paragraph(unanswered(ui), QUIET)
        return
    origins = ui.controller.history.origins_of(frame, unit)
    if origins is not None:
        found = ui.cached("why", found, origins, partial(with_origins, found, origins, "picture {}".format))
    words = Words(scene, found)
    if not found.reasons:
        paragraph("The scene has no lights.", QUIET)
    if beyond := wrong_beyond(found):
        paragraph(f"{several(beyond, 'wrong answer')} at what is reflected here or seen through it.", ERROR)
        if imgui.small_button("List its rays"):
            rays.show_rays(ui)
    elif wrong and frame.settings.samples > 1 and not any(one.wrong for one in found.reasons):
        paragraph(
            "Other samples of this pixel are wrong; below is the first, which is right. Fly nearer to see them.", ERROR
        )
    told = False  # what hides the primitive
    chosen = _first_light(ui, found)
    if chosen is not None:
        _name(ui, chosen, chosen=True)
        sentence(ui, words.reason(chosen), "reason")
        if said := words.answer(chosen):
            sentence(ui, said, "answer", ERROR if chosen.wrong else QUIET)
        told = (chosen.instead or chosen).rule in (Rule.PARTLY_OCCLUDED, Rule.NOT_SEEN_WHOLE, Rule.EXAMINED_ANEW)
    if found.coverage is not None:
        sentence(ui, words.coverage(found.coverage, told), "coverage")
    _other_lights(ui, words, found, chosen, scene.light_positions(frame.time), pick.point)


def _first_light(ui: Ui, found: Why) -> Reason | None:
    """The light that is told in full; None where the scene has none."""
    state, draw, picked = ui.state(FirstLight), ui.controller.session.draw, ui.controller.selection.picked
    if picked is not state.of:
        state.of, state.before = picked, draw.light
    if draw.view.of_light or draw.light != state.before:
        return found.reasons[min(draw.light, len(found.reasons) - 1)] if found.reasons else None
    return min(found.reasons, key=telling, default=None)


def telling(one: Reason) -> tuple[bool, ...]:
    """Sort by this: wrong answers come first, then culled rays, then others that are blocked, then light."""
    due = one.fate is not Fate.FACES_AWAY
    blocked = due and one.lit < one.rays
    return not one.wrong, not (blocked and one.fate is Fate.CULLED), not blocked, not due


def _other_lights(
    ui: Ui, words: Words, found: Why, chosen: Reason | None, places: NDArray, point: Sequence[float] | None
) -> None:
    """A line for each, the most telling first; of many those that are looked for, wrong and near ones first."""
    many = len(found.reasons) > lights.FEW
    if many:
        paragraph(summary(found.reasons), QUIET)
    wanted = [found.reasons[light] for light in lights.found(ui, "inspector") if light < len(found.reasons)]
    if many and point is not None:
        wanted.sort(key=lambda one: (not one.wrong, math.dist(places[one.light], point)))
    elif not ui.controller.motion.is_animating:  # else lines would jump from frame to frame
        wanted.sort(key=telling)
    for one in wanted[:_MOST_LIGHTS]:
        if one is not chosen:
            _line(ui, words, one)
    if len(wanted) > _MOST_LIGHTS:
        paragraph(f"the nearest {_MOST_LIGHTS} are listed", QUIET)


def unanswered(ui: Ui) -> str:
    """What the answer waits for."""
    c = ui.controller
    if c.runs.current is not None:
        return f"Answered when the {c.runs.current.name} has ended."
    if c.inspector.problem:
        return f"No answer: {c.inspector.problem}."
    if c.motion.is_animating:
        return "Answered when nothing moves."
    before = traced_before_an_answer(c)
    return f"Answered after {before}." if before else "Tracing its shadow rays ..."


def summary(reasons: Sequence[Reason]) -> str:
    """How many lights get here, in full or in part."""
    due = [one for one in reasons if one.fate is not Fate.FACES_AWAY]
    lit = sum(one.lit == one.samples for one in due)
    dark = sum(one.lit == 0 for one in due)
    parts = {"lit": lit, "in part": len(due) - lit - dark, "in shadow": dark, "facing away": len(reasons) - len(due)}
    return ", ".join(f"{count(number)} {name}" for name, number in parts.items() if number)


def wrong_beyond(found: Why) -> int:
    """How many answers are wrong at what is mirrored at the pixel, or seen through it."""
    rays = () if found.tree is None else found.tree.rays[1:]
    return sum(int(ray.shadows.wrong.sum()) for ray in rays if ray.shadows is not None)


def _name(ui: Ui, one: Reason, chosen: bool) -> ImVec2:
    """A light's colour and name, and where that ends; the pointer picks it out over the picture, a click chooses it."""
    imgui.push_id(one.light)
    swatch(FATES[one.fate].color)
    name, start = ui.light_name(one.light), imgui.get_cursor_screen_pos()
    clicked, _ = imgui.selectable(f"{name}##light", chosen, int(imgui.SelectableFlags_.allow_overlap))
    if clicked:
        ui.controller.settings.set_light(one.light)
        ui.state(FirstLight).before = -1
    if imgui.is_item_hovered():
        ui.state(Pointed).light = one.light
    imgui.pop_id()
    return ImVec2(start.x + imgui.calc_text_size(name).x, start.y)


def _line(ui: Ui, words: Words, one: Reason) -> None:
    """Another light, in one line."""
    end = _name(ui, one, chosen=False)
    text = " ".join(filter(None, (plain(words.reason(one)), plain(words.answer(one)))))
    tooltip(f"{ui.light_name(one.light)}: {FATES[one.fate].name}\n\n{text}\n\nClick to choose this light.")
    below = imgui.get_cursor_screen_pos()
    imgui.set_cursor_screen_pos(ImVec2(end.x + imgui.get_style().item_spacing.x, end.y))
    imgui.text_colored(ERROR if one.wrong else QUIET, fitted(text, imgui.get_content_region_avail().x))
    imgui.set_cursor_screen_pos(below)


# --- modes ----------------------------------------------------------------------------------------------


def _modes(ui: Ui, unit: int, frame: Frame, scene: Scene) -> None:
    """The occlusion mode and the shadow mode per light, and how the pixel compares with its two reference pixels."""
    if not 0 <= unit < len(frame.modes):
        paragraph("Known when its cell is visible.", QUIET)
        return
    occlusion = OcclusionMode(int(modes.occlusion_mode(frame.modes[unit])))
    origins, covered = ui.controller.history.origins_of(frame, unit), 0
    if imgui.begin_table("modes", 2, int(imgui.TableFlags_.sizing_stretch_same)):
        _mode("occlusion", OCCLUSION[occlusion])
        for light in range(len(scene.lights)):
            shadow = shadow_mode_of(frame, unit, light)
            if shadow is None:
                break
            covered += 1
            if occlusion is not OcclusionMode.DYNAMIC:
                _mode(ui.light_name(light), SHADOW[shadow])
                if origins is not None and light < len(origins.lights):
                    _origin(ui, origins.lights[light], light)
        imgui.end_table()
    if uncovered := len(scene.lights) - covered:
        paragraph(f"{uncovered} more {'light has' if uncovered == 1 else 'lights have'} no shadow mode", QUIET)
    found = ui.controller.inspector.why
    if found is not None:
        for number, one in enumerate(found.references):
            sentence(ui, Words(scene, found).reference(one), f"reference {number}", QUIET)


def _mode(name: str, mode: Class) -> None:
    imgui.table_next_column()
    swatch(mode.color)
    paragraph(name, QUIET)
    imgui.table_next_column()
    paragraph(mode.name)
    tooltip(mode.meaning)


def _origin(ui: Ui, origin: Origin, light: int) -> None:
    """The pictures, numbered as in the plots, in which the primitive was first seen lit by a light and blocked from
    it."""
    for lit, number in origin.met():
        word = "lit" if lit else "blocked"
        sentence(ui, (f"{word} in ", Link(f"picture {number}", frame=number)), f"{light} {word}", QUIET)
