"""What culling saves now, above the picture: one sentence, and a bar of the shadow rays by what became of them."""

from __future__ import annotations

from dataclasses import replace

from imgui_bundle import ImVec2, imgui

from tracer.culling.fate import Fate
from viewer.services.controller import Controller
from viewer.state.palette import FATE_COLORS, Color, label_color
from viewer.state.savings import LONGEST, PALE, Bar, Clause, Part, Standing, Tone, bar_of, fitting, sentence
from viewer.state.views import View
from viewer.util.numbers import count
from viewer.views.legend import BACKDROP, TEXT
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, em, fitted, packed, tooltip

LEAST = 14.0
"""Ems of height that there must be for the picture, sentence and bar; with less, these are not shown."""
_GAP, _PAD = 0.3, 0.35  # ems between sentence and bar, and beside the words of a part
_STRIPE = 0.55  # ems from stripe to stripe of what would be
_COLORS = {Tone.PLAIN: None, Tone.QUIET: QUIET, Tone.WRONG: ERROR}


def standing(c: Controller) -> Standing:
    """What is known of the newest frame beside its counters."""
    tracing, baseline, frame, run = c.scheduler, c.baseline, c.frame, c.runs.current
    proves = ""
    if frame is not None and tracing.certifies:
        at, most = tracing.refinement.progress
        far = f" (picture {at} of at most {most})" if most else ""
        proves = f"proving{far}: {count(frame.statistics.certificates)} made in the last"
    return Standing(
        baseline.measured,
        baseline.moving,
        baseline.moving or tracing.awaits or c.renderer.busy,
        proves,
        tracing.refinement.ended_early and not proves,
        baseline.why_not,
        run.name if run is not None and run.is_shown else "",
        "" if run is not None else c.settings.switched_off,
    )


def height(ui: Ui, room: ImVec2) -> float:
    """What sentence and bar take of the room for the picture; it depends on the room and the method's name alone, so
    that the picture stays where it is."""
    if not ui.controller.preferences.savings or room.y < em(LEAST):
        return 0.0
    return _lines(ui, room.x) * imgui.get_text_line_height() + em(_GAP) + _bar_height() + em(_GAP)


def _lines(ui: Ui, width: float) -> int:
    return 1 if imgui.calc_text_size(ui.controller.session.settings.method + LONGEST).x <= width else 2


def _bar_height() -> float:
    return imgui.get_text_line_height() + em(0.1)


def show(ui: Ui, width: float) -> None:
    """Both, from the cursor on."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.session.scene is None:
        return
    if c.session.draw.view is not View.FATE:
        ui.fate_shown = None
    start, lines = imgui.get_cursor_pos(), _lines(ui, width)
    told = sentence(frame, standing(c))
    _write(tuple(_with_key(ui, clause) if clause.command else clause for clause in told), start, width, lines)
    imgui.set_cursor_pos(ImVec2(start.x, start.y + lines * imgui.get_text_line_height() + em(_GAP)))
    bar = ui.cached("savings", frame, 0, lambda: bar_of(frame))
    _draw(ui, bar, width)


def _with_key(ui: Ui, clause: Clause) -> Clause:
    """The clause with the key of the command that it names."""
    key = ui.key(clause.command)
    return replace(clause, text=clause.text + key, short=clause.short and clause.short + key)


def _places(clauses: tuple[Clause, ...], width: float, lines: int) -> list[tuple[float, int, str]]:
    """Where each clause begins, in which of so many lines, and its text with what is between it and the next."""
    places: list[tuple[float, int, str]] = []
    x, line, told = 0.0, 0, [clause for clause in clauses if clause.text]
    for number, clause in enumerate(told):
        text = clause.text + (", " if number + 1 < len(told) else "")
        if x and line + 1 < lines and x + imgui.calc_text_size(text.rstrip()).x > width:
            x, line = 0.0, line + 1
        places.append((x, line, text))
        x += imgui.calc_text_size(text).x
    return places


def _write(clauses: tuple[Clause, ...], start: ImVec2, width: float, lines: int) -> None:
    """Clause after clause, the last line above the bar; as much of the sentence in short as must be, and what is too
    long then ends in an ellipsis."""

    def fits(told: tuple[Clause, ...]) -> bool:
        return all(x + imgui.calc_text_size(text.rstrip()).x <= width for x, _, text in _places(told, width, lines))

    clauses = fitting(clauses, fits)
    places = _places(clauses, width, lines)
    below = start.y + (lines - 1 - places[-1][1]) * imgui.get_text_line_height()
    for clause, (x, line, text) in zip(clauses, places, strict=True):
        if x >= width:
            return  # what comes before has ended in an ellipsis
        imgui.set_cursor_pos(ImVec2(start.x + x, below + line * imgui.get_text_line_height()))
        shown = text if x + imgui.calc_text_size(text.rstrip()).x <= width else fitted(text, width - x)
        color = _COLORS[clause.tone]
        if color is not None:
            imgui.push_style_color(imgui.Col_.text, color)
        imgui.text_unformatted(shown)
        if color is not None:
            imgui.pop_style_color()
        tooltip("\n".join(filter(None, (clause.text if shown != text else "", clause.tip))))


def _draw(ui: Ui, bar: Bar, width: float) -> None:
    """The parts beside each other, each as wide as its share."""
    corner, high = imgui.get_cursor_screen_pos(), _bar_height()
    draw, done = imgui.get_window_draw_list(), 0
    draw.add_rect_filled(corner, ImVec2(corner.x + width, corner.y + high), packed(BACKDROP), em(0.15))
    for part in bar.parts:
        left, right = (corner.x + width * rays / part.due for rays in (done, done + part.rays))
        done += part.rays
        at, end = ImVec2(round(left), corner.y), ImVec2(max(round(right), round(left) + 1.0), corner.y + high)
        imgui.set_cursor_screen_pos(at)
        if imgui.invisible_button(f"{part.name}##savings", ImVec2(end.x - at.x, high)):
            _show_pixels(ui, part.fate, bar.would)
        hovered = imgui.is_item_hovered()
        _fill(draw, FATE_COLORS[part.fate], at, end, bar.would)
        if hovered:
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
        if hovered or ui.fate_shown is part.fate:
            draw.add_rect(at, end, imgui.get_color_u32(imgui.Col_.text), 0.0, thickness=2.0)
        next_light = f"Next light{ui.key('Next light')}"
        tooltip(f"{part.in_words()}\nClick: the pixels whose rays to the chosen light these are. {next_light}")
        _label(draw, part, at, end, bar.would)


def _show_pixels(ui: Ui, fate: Fate, would: bool) -> None:
    """Show which pixels' rays to the chosen light became that, or, where these stand out already, all again; where they
    only would, the modes by which they would."""
    shown = ui.fate_shown is fate
    ui.fate_shown = None if shown or would else fate
    ui.controller.session.set_draw(view=View.SHADOW if would else View.FATE)


def _fill(draw: imgui.ImDrawList, color: Color, at: ImVec2, end: ImVec2, hatched: bool) -> None:
    if not hatched:
        draw.add_rect_filled(at, end, packed(color))
        return
    high, step = end.y - at.y, em(_STRIPE)
    draw.add_rect_filled(at, end, packed(color, PALE))
    draw.push_clip_rect(at, end, True)
    x = at.x - (at.x % step) - high
    while x < end.x:
        draw.add_line(ImVec2(x, end.y), ImVec2(x + high, at.y), packed(color), 0.3 * step)
        x += step
    draw.pop_clip_rect()


def _label(draw: imgui.ImDrawList, part: Part, at: ImVec2, end: ImVec2, hatched: bool) -> None:
    """The part's name and share, or the share alone, as far as there is room."""
    text = part.label(lambda text: imgui.calc_text_size(text).x, end.x - at.x - 2.0 * em(_PAD))
    if not text:
        return
    size = imgui.calc_text_size(text)
    x, y = round(at.x + em(_PAD)), round(at.y + (end.y - at.y - size.y) / 2.0)
    if hatched:
        back = ImVec2(x - 0.2 * em(1.0), at.y), ImVec2(x + size.x + 0.2 * em(1.0), end.y)
        draw.add_rect_filled(*back, packed(BACKDROP, 0.8))
    draw.add_text(ImVec2(x, y), packed(TEXT if hatched else label_color(FATE_COLORS[part.fate])), text)
