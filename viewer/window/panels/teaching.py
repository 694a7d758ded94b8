"""In the inspector: which pictures and pixels have taught the modes of a primitive, and the way back to them.

A picture's number is that in the plots, which count all that the window has traced; frames are those of the path."""

from __future__ import annotations

from imgui_bundle import imgui

from tracer.culling.modes import OcclusionMode, ShadowMode
from tracer.mode_origins import NEVER, Origin
from viewer.services.teachers import Teacher
from viewer.state.picking import Pick
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, paragraph, tooltip


def of_occlusion(ui: Ui, pick: Pick) -> None:
    """Since which frame the primitive is fully rendered."""
    taught = ui.controller.history.taught(pick)
    if taught is not None and taught.whole != NEVER and pick.occlusion is OcclusionMode.FULLY_RENDERED:
        _frame(ui, "since", taught.whole, None, "whole", f"FULLY_RENDERED: seen as a whole in picture {taught.whole}")


def of_light(ui: Ui, pick: Pick, light: int, mode: ShadowMode) -> None:
    """Which frames have set the shadow mode of a light, one for each answer that was met."""
    taught = ui.controller.history.taught(pick)
    if taught is None or mode is ShadowMode.INIT or light >= len(taught.lights):
        return
    lesson = taught.lights[light]
    for lit, number in ((False, lesson.blocked), (True, lesson.lit)):
        if number != NEVER:
            found = ui.controller.teachers.of(number, light, lit)
            word = "lit" if lit else "blocked"
            _frame(ui, word, number, found, f"{light} {word}", sentence(mode, ui.light_name(light), lesson, found))
    if mode is not ShadowMode.PARTIAL_SHADOW and (lesson.blocked != NEVER or lesson.lit != NEVER):
        paragraph("never seen lit" if mode is ShadowMode.FULL_SHADOW else "never seen blocked", QUIET)


def sentence(mode: ShadowMode, light: str, lesson: Origin, found: Teacher | None) -> str:
    """A mode and who taught it, as one reads it in the tooltip."""
    by = "" if found is None else f" ({pixels_in_words(found)})"
    if mode is ShadowMode.PARTIAL_SHADOW:
        both = f"blocked first in picture {lesson.blocked}, lit first in picture {lesson.lit}"
        return f"{mode.name} for {light}: {both}{by}"
    number, never = (lesson.blocked, "lit") if mode is ShadowMode.FULL_SHADOW else (lesson.lit, "blocked")
    return f"{mode.name} for {light}: set in picture {number}{by}, never seen {never}"


def pixels_in_words(found: Teacher) -> str:
    """The pixels that met an answer."""
    if found.pixel is None:
        return "by reflected or refracted rays"
    more = f" and {found.count - 1} more" if found.count > 1 else ""
    return f"pixel {found.pixel[0]}, {found.pixel[1]}{more}"


def _frame(ui: Ui, word: str, number: int, found: Teacher | None, key: str, tip: str) -> None:
    """A line: what was met, a button that leads to the frame, and the pixel."""
    c = ui.controller
    imgui.text_colored(QUIET, word)
    _beside(f"picture {number}", imgui.get_style().item_spacing.x)
    kept = c.history.records.get(number) is not None
    imgui.begin_disabled(not kept)
    if imgui.small_button(f"picture {number}##taught {key}"):
        c.navigator.go(number, point=_point(ui, number, found))
    imgui.end_disabled()
    where = c.navigator.name_of(number)
    tooltip(f"{tip}\n\nGo to {where}" if kept else f"{tip}\n\nThis picture is no longer kept.")
    if found is not None:
        paragraph(pixels_in_words(found), QUIET)


def _beside(label: str, gap: float) -> None:
    """Go on in this line if a small button with such a label fits into what is left of it."""
    width = imgui.calc_text_size(label).x + 2.0 * imgui.get_style().frame_padding.x
    right = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + gap + width <= right:
        imgui.same_line(0.0, gap)


def _point(ui: Ui, number: int, found: Teacher | None) -> tuple[float, float] | None:
    """The pixel that taught, as a point of the picture of its frame."""
    moment = ui.controller.history.records.get(number)
    if found is None or found.pixel is None or moment is None:
        return None
    x, y = found.pixel
    return (x + 0.5) / moment.settings.width, (y + 0.5) / moment.settings.height
