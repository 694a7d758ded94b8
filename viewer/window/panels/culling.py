"""The culling: its method and settings."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.method import Method
from tracer.setting import Setting
from viewer.services.controller import Controller
from viewer.state import verified
from viewer.window.panels.method_choice import method_list
from viewer.window.setting_rows import ALL, in_panel, setting_row, setting_switch
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    paragraph,
    properties,
    row,
    same_line_for,
    wide_button,
)

_PALE = 0.55
"""How much is left of what does nothing to the pictures of the chosen method."""
_OF_MODES = ("settings.symmetric", "settings.zoom_factor")


def show(ui: Ui) -> None:
    """Show the panel."""
    c = ui.controller
    method = Method.parse(c.session.settings.method)
    _method(ui)
    paragraph(trust(c), QUIET)

    def note(one: Setting) -> str:
        if one.path in _OF_MODES and not method.uses_modes:
            return f"\n{c.session.settings.method} does not cull by modes: it changes those kept for the views alone."
        return ""

    settings = in_panel(ui, "Culling")
    for place, one in enumerate(one for one in settings if one.kind is bool and one.within == ("settings",)):
        if place:
            same_line_for(one.label)
        with _pale_if(bool(note(one))):
            setting_switch(ui, one, note(one))
    with properties("culling", 8.2 if method.has_certificates else 6.5) as shown:
        for one in settings if shown else ():
            if one.kind is not bool:
                with _pale_if(bool(note(one))):
                    setting_row(ui, one, note(one))
    forget = f"Forget all modes and certificates{ui.key('Reset modes')}."
    if wide_button(f"{icons.ICON_FA_ERASER}  Reset modes", forget, 2):
        c.reset_modes()
    imgui.same_line()
    again = f"Trace the same frame once more, with what is known after the last one{ui.key('Trace again')}."
    if wide_button(f"{icons.ICON_FA_ROTATE_RIGHT}  Trace again", again):
        c.scheduler.trace_again()
    setting_switch(ui, ALL["pace.keep_tracing"])
    said = wrong_answers(c)
    if said is not None:  # at the end, where it moves nothing
        paragraph(*said)


@contextmanager
def _pale_if(pale: bool) -> Iterator[None]:
    imgui.push_style_var(imgui.StyleVar_.alpha, imgui.get_style().alpha * (_PALE if pale else 1.0))
    yield
    imgui.pop_style_var()


def _method(ui: Ui) -> None:
    """The base, and what is added to it."""
    c = ui.controller
    name = c.session.settings.method
    with properties("method", 4.0) as shown:
        if shown:
            row("Method", "which shadow rays are not traced, and what that trusts; C turns culling off and on")
            method_list(ui, "##method", name, lambda chosen: c.settings.change(method=chosen))


def trust(c: Controller) -> str:
    """What the chosen method trusts and whether it is exact, then what it does in the newest picture, and why."""
    frame, name = c.frame, c.session.settings.method
    kinds = Method.parse(name).kinds
    said = [kind.summary if len(kinds) == 1 else f"{kind.name}: {kind.summary}" for kind in kinds]
    if frame is not None and frame.settings.method == name and c.runs.current is None:
        said.append(frame.statistics.decision)
    return " ".join(filter(None, said))


def wrong_answers(c: Controller) -> tuple[str, ImVec4] | None:
    """What is wrong in the newest frame, and a colour; None where that is not known, or where the frame
    was traced with another method than the panel shows.  A run has figures of its own, in its panel."""
    if c.frame is None or not c.frame.settings.verify:
        return None
    if c.runs.current is not None:
        return f"wrong answers of the {c.runs.current.name} are in its own panel", QUIET
    if c.frame.settings.method != c.scheduler.settings.method:
        return None
    said, color = verified.in_words(c.frame.statistics), ERROR if verified.is_wrong(c.frame.statistics) else QUIET
    if not c.scheduler.settings.verify or c.session.settings.verify:
        return said, color
    return f"{said} (verified for the view {c.session.draw.view.label})", color
