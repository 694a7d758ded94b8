"""Why it is in shadow: rows of the inspector and, for what was clicked, lines in the picture to lights and blockers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.explanation import Explanation
from tracer.frame import Frame
from tracer.ray_reasons import unused
from tracer.why import WHY_TRACED
from viewer.services.frame_answers import WrongAnswers, WrongLight
from viewer.services.shadow_inspector import MOST_LIGHTS, MOST_OCCLUDERS, Answer, Part, nearest_first, others_named
from viewer.state.picking import kind_of, primitive_in_words
from viewer.state.projection import place
from viewer.state.views import (
    ARRIVAL_COLORS,
    CERTIFICATE_COLORS,
    CERTIFICATE_MEANING,
    SHADOW_COLORS,
    Arrival,
    Certificate,
    ShadowMode,
)
from viewer.window.panels import lights, marks
from viewer.window.panels.coming import after
from viewer.window.panels.marks import SHADE, with_alpha
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, checkbox, count, em, heading, paragraph, swatch, tooltip

_LIT, _STOPPED = SHADOW_COLORS[ShadowMode.NON_SHADOW], (0.34, 0.71, 0.91)
_BLOCKER = SHADOW_COLORS[ShadowMode.PARTIAL_SHADOW]
_COLORS = {Part.REACHING: _LIT, Part.STOPPED: _STOPPED, Part.BLOCKER: _BLOCKER, Part.OCCLUDER: (0.90, 0.62, 0.0)}
_WIDTHS = {Part.REACHING: 0.13, Part.STOPPED: 0.13, Part.BLOCKER: 0.16, Part.OCCLUDER: 0.1}  # in ems
_RESTS_ON = {  # and what is said where the blocker is among them
    Certificate.FULL.name: ("hidden by", "and hidden by"),
    Certificate.CANDIDATES.name: ("can only be blocked by", "other candidates:"),
}
_UNSEEN = 0.6  # of the width of what is seen
_FADED = 0.18  # opacity of other lights than the one that is pointed at
_BESIDE = 0.2  # and of all of them where clusters of lights are drawn over them


def rows(ui: Ui) -> None:
    """In the inspector: each light, whether it gets here, and what blocks it; nothing while that is not known."""
    c = ui.controller
    heading("Shadow rays")
    p = c.preferences
    tip = (
        "in the picture, the shadow rays of the clicked point (I): yellow as far as light comes, then blue; outlined "
        "in red is what blocks it, in orange what a certificate names; dashes are hidden"
    )
    checkbox("Draw for a click", p.draw_explanation, lambda on: setattr(p, "draw_explanation", on), tip)
    answer = c.inspector.answer
    if answer is None:
        paragraph(unanswered(ui), QUIET)
        return
    if not answer.lights:
        paragraph("The scene has no lights.", QUIET)
    if answer.wrong.count:
        paragraph(wrong_in_words(answer.wrong), ERROR)
    receiver, listed = int(answer.frame.primitive[answer.y, answer.x]), answer.lights
    if len(listed) > lights.FEW:
        paragraph(summary(listed), QUIET)
        known, chosen = len(listed), lights.found(ui, "inspector")
        nearest = nearest_first([listed[light] for light in chosen if light < known])
        nearest.sort(key=lambda one: one.light not in answer.wrong.lights)  # what is wrong comes first
        listed = tuple(nearest[:MOST_LIGHTS])
    with light_rows("rays") as shown:
        for one in listed if shown else ():
            imgui.push_id(one.light)
            _row(ui, one, receiver, answer.wrong.lights.get(one.light))
            imgui.pop_id()
    if len(listed) == MOST_LIGHTS < len(answer.lights):
        paragraph(f"the nearest {MOST_LIGHTS} are listed and drawn", QUIET)


def summary(lights: Sequence[Explanation]) -> str:
    """How many lights get here, in full or in part."""
    due = [one for one in lights if one.due]
    lit = sum(one.reached == one.samples for one in due)
    dark = sum(one.reached == 0 for one in due)
    parts = {"lit": lit, "in part": len(due) - lit - dark, "in shadow": dark, "behind it": len(lights) - len(due)}
    return ", ".join(f"{count(number)} {name}" for name, number in parts.items() if number)


def unanswered(ui: Ui) -> str:
    """Why nothing is said of the shadow rays."""
    c = ui.controller
    selection, run = c.selection, c.runs.current
    if run is not None:
        return f"traced when the {run.name} has ended"
    if selection.picked is not None and selection.pixel is None:
        return "The clicked point is not visible from here. Its shadow rays are traced when it is in view again."
    if c.motion.lively:
        return "traced when nothing moves"
    return f"traced after {after(c)}" if after(c) else "being traced ..."


@contextmanager
def light_rows(name: str) -> Iterator[bool]:
    """A table of two columns that wrap, a light on the left and what is known of it; yields whether it is visible."""
    shown = imgui.begin_table(name, 2, int(imgui.TableFlags_.sizing_stretch_prop))
    if shown:
        imgui.table_setup_column("light", int(imgui.TableColumnFlags_.width_stretch), 1.0)
        imgui.table_setup_column("answer", int(imgui.TableColumnFlags_.width_stretch), 1.5)
    try:
        yield shown
    finally:
        if shown:
            imgui.end_table()


def wrong_in_words(wrong: WrongAnswers) -> str:
    """How much of what the picture shows at a pixel is not true, and where that is."""
    here = wrong.count - wrong.beyond
    text = f"The picture is wrong here: {here or wrong.beyond} shadow {'answer' if wrong.count == 1 else 'answers'}"
    if not here:
        return f"{text} at what is mirrored or seen through it (X lists the rays)."
    return text + (f", and {wrong.beyond} at what is mirrored or seen through it (X)." if wrong.beyond else ".")


def shown_in_words(wrong: WrongLight) -> str:
    """What the picture has for a light, and that it is wrong."""
    known = wrong.verdict.replace("_", " ").lower()
    if wrong.samples == 1:
        return f"{'lit' if wrong.lit else 'in shadow'} in the picture ({known}): wrong"
    return f"{wrong.lit} of {wrong.samples} samples lit in the picture ({known}): {wrong.wrong} wrong"


def _row(ui: Ui, one: Explanation, receiver: int, wrong: WrongLight | None) -> None:
    """A light; resting on it picks it out over the picture."""
    text, color = said(one)
    imgui.table_next_column()
    swatch(color)
    imgui.selectable(f"{ui.light_name(one.light)}##light", False)
    if imgui.is_item_hovered():
        ui.pointed_light = one.light
    imgui.table_next_column()
    if wrong is not None:
        paragraph(shown_in_words(wrong), ERROR)
    paragraph(text if wrong is None else f"truly {text}")
    _certificate(one.certificate, one.used)
    for sentence in sentences(ui, one, receiver):
        paragraph(sentence, QUIET)


def said(one: Explanation) -> tuple[str, tuple[float, float, float]]:
    """How much of a light gets here, in words, and its colour."""
    if not one.due:
        return "in its own shadow: this side faces away", ARRIVAL_COLORS[Arrival.AWAY]
    samples = f", all {one.samples} samples" if one.samples > 1 else ""
    if one.reached == one.samples:
        return f"lit{samples}", _LIT
    if one.reached == 0:
        return f"in shadow{samples}", ARRIVAL_COLORS[Arrival.DARK]
    most = 2 * one.reached > one.samples
    text = f"in the penumbra: {one.reached} of {one.samples} samples reach it"
    return text, ARRIVAL_COLORS[Arrival.MOST if most else Arrival.FEW]


def _certificate(name: str, used: bool) -> None:
    """The certificate and its colour, and whether the frame has looked it up."""
    if name.upper() not in Certificate.__members__ or name.upper() == Certificate.NONE.name:
        return
    certificate = Certificate[name.upper()]
    swatch(CERTIFICATE_COLORS[certificate])
    told = unused(certificate.name.lower())
    paragraph(f"proven {certificate.name.lower()}" if used else told)
    tooltip(CERTIFICATE_MEANING[certificate] if used else WHY_TRACED[told])


def sentences(ui: Ui, one: Explanation, receiver: int) -> list[str]:
    """What blocks a light on its way to a primitive, and what its certificate rests on besides; each is named once."""
    parts, certificate = [], one.certificate.upper()
    among = {Certificate.CANDIDATES.name: ", one of its candidates", Certificate.FULL.name: ", which hides all of it"}
    if one.blocker is not None:
        by = _own(ui, receiver) if one.blocker == receiver else _named(ui, one.blocker)
        parts.append(f"blocked by {by}{among.get(certificate, '') if one.blocker in one.named else ''}")
    others = others_named(one)
    if others:
        names = [_named(ui, number) if number != receiver else "its own surface" for number in others[:MOST_OCCLUDERS]]
        more = f" and {len(others) - MOST_OCCLUDERS} more" if len(others) > MOST_OCCLUDERS else ""
        first, besides = _RESTS_ON.get(certificate, ("certified by", "certified by"))
        parts.append(f"{besides if one.blocker in one.named else first} {', '.join(names)}{more}")
    return parts


def _own(ui: Ui, receiver: int) -> str:
    """A primitive that is in its own light."""
    scene = ui.controller.session.scene
    kind = kind_of(scene, receiver) if scene is not None and receiver < scene.primitive_count else "primitive"
    return f"its own surface: this {kind} shadows itself" + (", as the light grazes it" if kind == "triangle" else "")


def _named(ui: Ui, primitive: int) -> str:
    """A primitive as people find it again: its kind and number, its object and its material."""
    scene = ui.controller.session.scene
    return f"primitive {primitive}" if scene is None else primitive_in_words(scene, primitive)


def show(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Over the picture: the lights' ways to the point, and outlines of what blocks them."""
    c = ui.controller
    pointed, ui.pointed_light = ui.pointed_light, None  # the inspector says so in each frame
    answer, frame = c.inspector.answer, c.frame
    if answer is None or frame is None or c.selection.picked is None or not c.preferences.draw_explanation:
        return
    width, height = end.x - corner.x, end.y - corner.y

    def on_screen(at: tuple[float, float]) -> ImVec2:
        return ImVec2(corner.x + at[0] * width, corner.y + at[1] * height)

    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(corner, end, True)
    lines, beside = c.inspector.lines(frame), _BESIDE if c.cuts.cut is not None else 1.0
    point = place(frame, answer.lights[0].point) if answer.lights else None
    centre = on_screen(point) if point is not None else None
    radius = marks.radius_around_pixel(width / frame.width, height / frame.height)
    for shade in (True, False):
        for part, light, strokes in lines:
            alpha = beside if pointed is None else 1.0 if pointed == light else _FADED
            color = imgui.get_color_u32(with_alpha(SHADE, alpha) if shade else ImVec4(*_COLORS[part], alpha))
            for stroke in strokes:
                wide = em(_WIDTHS[part]) * (1.0 if stroke.seen else _UNSEEN) + (em(0.12) if shade else 0.0)
                ends = on_screen(stroke.start), on_screen(stroke.end)
                for start, stop in [ends] if centre is None else marks.outside(*ends, centre, radius):
                    draw.add_line(start, stop, color, max(1.0, wide))
    _ends(answer, frame, pointed, beside, on_screen, draw)
    if centre is not None:
        marks.ring(draw, centre, radius)
    draw.pop_clip_rect()


def _ends(
    answer: Answer,
    frame: Frame,
    pointed: int | None,
    beside: float,
    on_screen: Callable[[tuple[float, float]], ImVec2],
    draw: imgui.ImDrawList,
) -> None:
    """A disc at each light that is drawn, and a cross where its way ends before the point."""
    for one in answer.drawn:
        alpha = beside if pointed is None else 1.0 if pointed == one.light else _FADED
        at = place(frame, one.light_position)
        if at is not None:
            draw.add_circle_filled(on_screen(at), em(0.42), imgui.get_color_u32(with_alpha(SHADE, alpha)))
            draw.add_circle_filled(on_screen(at), em(0.3), imgui.get_color_u32(ImVec4(*_LIT, alpha)))
        stop = place(frame, one.blocked_at) if one.blocked_at is not None else None
        if stop is not None:
            marks.cross(draw, on_screen(stop), ImVec4(*_BLOCKER, alpha))
