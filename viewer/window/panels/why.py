"""Why the shadow rays of a pixel are culled or traced: a sentence for the chosen light, a line for each other one."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import ImVec2, imgui

from tracer.explanation import Explanation
from tracer.reasons import Reason, Rule, Why
from tracer.why_in_words import Words, plain
from viewer.services.origin_pixels import with_origins
from viewer.services.pixel_inspector import MOST_LIGHTS, nearest_first
from viewer.state.palette import FATE_COLORS, FATE_NAMES
from viewer.window.panels import lights
from viewer.window.panels.links import Pointed, sentence
from viewer.window.panels.status import traced_before_an_answer
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, count, em, fitted, paragraph, swatch, tooltip_at


def show(ui: Ui) -> None:
    """The sentences, the chosen light's first; nothing but what the answer waits for while they are not known."""
    c = ui.controller
    answer, found, scene = c.inspector.answer, c.inspector.why, c.session.scene
    if found is None or scene is None:
        paragraph(unanswered(ui), QUIET)
        return
    found = _with_origins(ui, found)
    words = Words(scene, found)
    if not found.reasons:
        paragraph("The scene has no lights.", QUIET)
    chosen = min(c.session.draw.light, len(found.reasons) - 1)
    for one in found.reasons[chosen : chosen + 1]:
        _chosen(ui, words, one)
    many = len(found.reasons) > lights.FEW
    if not many:
        for one in found.reasons:
            if one.light != chosen:
                _line(ui, words, one)
    if found.coverage is not None:
        imgui.dummy(ImVec2(0.0, em(0.1)))
        told = found.reasons[chosen].occluded if found.reasons and _tells(found.reasons[chosen]) else None
        sentence(ui, words.coverage(found.coverage, told), "coverage")
    if answer is not None and answer.wrong_beyond:
        paragraph(_beyond(answer.wrong_beyond), ERROR)
    if many and answer is not None:
        _many(ui, words, found, answer.lights, chosen)


def unanswered(ui: Ui) -> str:
    """What the answer waits for."""
    c = ui.controller
    selection, run = c.selection, c.runs.current
    if run is not None:
        return f"answered when the {run.name} has ended"
    if selection.picked is not None and selection.pixel is None:
        return "The clicked point is not visible from here. Its shadow rays are explained when it is in view again."
    if c.inspector.problem:
        return f"No answer: {c.inspector.problem}."
    if c.motion.is_animating:
        return "answered when nothing moves"
    before = traced_before_an_answer(c)
    return f"answered after {before}" if before else "tracing its shadow rays ..."


def summary(known: Sequence[Explanation]) -> str:
    """How many lights get here, in full or in part."""
    due = [one for one in known if one.due]
    lit = sum(one.reached == one.samples for one in due)
    dark = sum(one.reached == 0 for one in due)
    parts = {"lit": lit, "in part": len(due) - lit - dark, "in shadow": dark, "facing away": len(known) - len(due)}
    return ", ".join(f"{count(number)} {name}" for name, number in parts.items() if number)


def _with_origins(ui: Ui, found: Why) -> Why:
    """The same with the pictures and pixels that set the modes of what was clicked."""
    c = ui.controller
    origins = None if c.selection.picked is None else c.history.origins_of(c.selection.picked)
    if origins is None:
        return found
    known: Why = ui.cached(
        "why", found, (origins, c.origins.answered),
        lambda: with_origins(found, origins, c.origins.of, lambda number: f"picture {number}"),
    )  # fmt: skip
    return known


def _chosen(ui: Ui, words: Words, one: Reason) -> None:
    """The light that is chosen, with all there is to say of it."""
    _name(ui, one, chosen=True)
    sentence(ui, words.reason(one), "reason")
    answer = words.answer(one)
    if answer:
        sentence(ui, answer, "answer", ERROR if one.wrong else QUIET)


def _tells(one: Reason) -> bool:
    """Whether a light's sentence says what hides the primitive."""
    return (one.instead or one).rule in (Rule.PARTLY_OCCLUDED, Rule.NOT_SEEN_WHOLE, Rule.EXAMINED_ANEW)


def _name(ui: Ui, one: Reason, chosen: bool) -> ImVec2:
    """A light's colour and name, and where that ends; resting on it picks it out over the picture, a click chooses
    it."""
    imgui.push_id(one.light)
    swatch(FATE_COLORS[one.fate])
    name, start = ui.light_name(one.light), imgui.get_cursor_screen_pos()
    clicked, _ = imgui.selectable(f"{name}##light", chosen, int(imgui.SelectableFlags_.allow_overlap))
    if clicked:
        ui.controller.settings.set_light(one.light)
    if imgui.is_item_hovered():
        ui.state(Pointed).light = one.light
    imgui.pop_id()
    return ImVec2(start.x + imgui.calc_text_size(name).x, start.y)


def _line(ui: Ui, words: Words, one: Reason) -> None:
    """Another light, in one line."""
    end = _name(ui, one, chosen=False)
    text = " ".join(filter(None, (plain(words.reason(one)), plain(words.answer(one)))))
    if imgui.is_item_hovered(int(imgui.HoveredFlags_.for_tooltip)):
        tooltip_at(f"{ui.light_name(one.light)}: {FATE_NAMES[one.fate]}\n\n{text}\n\nClick to choose this light.")
    below = imgui.get_cursor_screen_pos()
    imgui.set_cursor_screen_pos(ImVec2(end.x + em(0.5), end.y))
    shown = fitted(text, imgui.get_content_region_avail().x)
    imgui.text_colored(ERROR if one.wrong else QUIET, shown)
    imgui.set_cursor_screen_pos(below)


def _many(ui: Ui, words: Words, found: Why, known: Sequence[Explanation], chosen: int) -> None:
    """Those of many lights that are looked for, the nearest and those that are answered wrongly first."""
    paragraph(summary(known), QUIET)
    wanted = [known[light] for light in lights.found(ui, "inspector") if light < min(len(known), len(found.reasons))]
    nearest = nearest_first(wanted)
    nearest.sort(key=lambda one: not found.reasons[one.light].wrong)
    for one in nearest[:MOST_LIGHTS]:
        if one.light != chosen:
            _line(ui, words, found.reasons[one.light])
    if len(nearest) > MOST_LIGHTS:
        paragraph(f"the nearest {MOST_LIGHTS} are listed and drawn", QUIET)


def _beyond(wrong: int) -> str:
    answers = "1 shadow answer" if wrong == 1 else f"{count(wrong)} shadow answers"
    return f"Also wrong: {answers} at what is reflected here or seen through it; Rays lists them."
