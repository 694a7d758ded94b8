"""What culling saves now, above the picture: one sentence, and a bar of the shadow rays by what became of them."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from tracer.method import title_of
from viewer.services.controller import Controller
from viewer.services.frame_scheduler import Activity
from viewer.state.palette import DARK, FATES, LIGHT, label_color
from viewer.state.savings import LONGEST, WOULD_OPACITY, Clause, Part, Standing, Tone, bar_of, placed, sentence
from viewer.state.views import View
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, em, fitted, packed, tooltip, width_of, write

LEAST = 14.0
"""Ems of height that there must be for the picture, sentence and bar; with less, these are not shown."""
_GAP, _PAD = 0.3, 0.35  # ems between sentence and bar, and beside the label of a part


def standing(c: Controller) -> Standing:
    """Return what is known of the newest frame beside its counters."""
    run = c.runs.current
    name = run.name if run is not None and run.is_shown else ""
    return Standing(c.baseline.measured, c.scheduler.activity is Activity.CERTIFYING, c.baseline.why_not, name)


def height(ui: Ui, room: ImVec2) -> float:
    """Return what sentence and bar take of the room for the picture; it depends on the room and the method's name
    alone, so that the picture stays where it is."""
    if not ui.controller.preferences.savings or room.y < em(LEAST):
        return 0.0
    return (_lines(ui, room.x) + 1) * imgui.get_text_line_height() + em(0.1 + 2.0 * _GAP)


def _lines(ui: Ui, width: float) -> int:
    return 1 if imgui.calc_text_size(title_of(ui.controller.session.settings.method) + LONGEST).x <= width else 2


def show(ui: Ui, width: float) -> None:
    """Draw both, from the cursor on."""
    c = ui.controller
    frame = c.frame
    if frame is None or c.session.scene is None:
        return
    if c.session.draw.view is not View.FATE:
        ui.fate_shown = None
    start, lines = imgui.get_cursor_pos(), _lines(ui, width)
    _write(ui, sentence(frame, standing(c)), start, width, lines)
    imgui.set_cursor_pos(ImVec2(start.x, start.y + lines * imgui.get_text_line_height() + em(_GAP)))
    _draw(ui, ui.cached("savings", frame, 0, lambda: bar_of(frame)), width)


def _write(ui: Ui, clauses: tuple[Clause, ...], start: ImVec2, width: float, lines: int) -> None:
    """Clause after clause, in so many lines; what is too long ends in an ellipsis, and is told under the pointer."""
    x, line = 0.0, 0
    for number, clause in enumerate(clauses):
        text = clause.text + (ui.key(clause.command) if clause.command else "") + ", " * (number + 1 < len(clauses))
        if x and line + 1 < lines and x + imgui.calc_text_size(text.rstrip()).x > width:
            x, line = 0.0, line + 1
        if x >= width:
            return
        imgui.set_cursor_pos(ImVec2(start.x + x, start.y + line * imgui.get_text_line_height()))
        shown = text if x + imgui.calc_text_size(text.rstrip()).x <= width else fitted(text, width - x)
        color = QUIET if clause.tone is Tone.QUIET else ERROR if clause.tone is Tone.WRONG else None
        write(shown, color)
        tooltip("\n".join(filter(None, (clause.text if shown != text else "", clause.tip))))
        x += imgui.calc_text_size(text).x


def _draw(ui: Ui, bar: tuple[Part, ...], width: float) -> None:
    """The parts side by side, each as wide as its share; a click shows the pixels of one."""
    corner, draw = imgui.get_cursor_screen_pos(), imgui.get_window_draw_list()
    high, next_light = imgui.get_text_line_height() + em(0.1), f"Next light{ui.key('Next light')}"
    for part, left, right, label_at, beside in placed(bar, corner.x, width, width_of, em(_PAD)):
        inset, right = 0.5 * (high - (right - left)) if beside else 0.0, max(right, left + 1)
        edge = right if label_at is None else max(right, label_at + width_of(part.label))
        imgui.set_cursor_screen_pos(ImVec2(left, corner.y))
        if imgui.invisible_button(f"{part.name}##{'beside' if beside else 'savings'}", ImVec2(edge - left, high)):
            _show_pixels(ui, part)
        start, end = ImVec2(left, corner.y + inset), ImVec2(right, corner.y + high - inset)
        draw.add_rect_filled(start, end, packed(DARK))
        draw.add_rect_filled(start, end, packed(FATES[part.fate].color, WOULD_OPACITY if part.would else 1.0))
        if imgui.is_item_hovered():
            imgui.set_mouse_cursor(imgui.MouseCursor_.hand)
        if imgui.is_item_hovered() or (ui.fate_shown is part.fate and not beside):
            draw.add_rect(start, end, imgui.get_color_u32(imgui.Col_.text), 0.0, thickness=2.0)
        tooltip(f"{part.in_words()}\nClick: the pixels whose rays to the chosen light these are. {next_light}")
        if label_at is not None:
            on_color = packed(LIGHT if part.would else label_color(FATES[part.fate].color))
            color = imgui.get_color_u32(imgui.Col_.text) if beside else on_color
            draw.add_text(ImVec2(label_at, corner.y + round(em(0.05))), color, part.label)


def _show_pixels(ui: Ui, part: Part) -> None:
    """Show which pixels' rays to the chosen light became that, or, where these stand out already, all again; where they
    only would, the modes by which they would."""
    ui.fate_shown = None if ui.fate_shown is part.fate or part.would else part.fate
    ui.controller.session.set_draw(view=View.SHADOW if part.would else View.FATE)
