"""Over the picture, for what was clicked: its rays to the lights and what blocks them, what hides it, and where it
is itself; and why a view has nothing to show."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui

from tracer.culling.modes import OcclusionMode
from tracer.frame import Frame
from tracer.inspect.projection import Stroke, strokes
from tracer.inspect.reasons import Why
from tracer.method import title_of
from viewer.state.methods import missing, with_base
from viewer.state.palette import BLOCKED, CANDIDATES, HELD, OCCLUSION, UNKNOWN
from viewer.state.picking import outline_of, points_of, primitive_points
from viewer.window.panels import rays
from viewer.window.panels.area import BACK, FRONT, SHADE, WHITE, Area, Pen
from viewer.window.panels.links import Pointed
from viewer.window.ui import Ui
from viewer.window.widgets import em, paragraph, tooltip

_BLOCKER, _NAMED = ImVec4(*BLOCKED, 1.0), ImVec4(*CANDIDATES, 1.0)  # what blocks, and what the answer rests on
_MOST_NAMED = 8  # of which so many are outlined
_OUTLINE = 0.13  # width in ems
_HIDER = ImVec4(*OCCLUSION[OcclusionMode.PARTIALLY_OCCLUDED].color, 1.0)
_SAME, _MISSED = ImVec4(*UNKNOWN, 1.0), ImVec4(*OCCLUSION[OcclusionMode.FULLY_RENDERED].color, 1.0)
_STEPPED = ImVec4(*HELD, 1.0)  # what a step of the paper speaks of
_SIDE = 0.5  # ems, of a pixel's square at least
_NOTE, _LEAST = 26.0, 8.0  # in ems of width: of a note, and of a picture that has room for one


def show(ui: Ui, area: Area) -> None:
    """Draw all that is to be seen of what was clicked, or is pointed at."""
    frame = ui.controller.frame
    if frame is None:
        return
    made = Pen(area, frame)
    rays.draw(ui, made, frame)
    _why(ui, made, frame)
    _occluded_selection(ui, made, frame)
    _step(ui, made, frame)


# --- why -------------------------------------------------------------------------------------------


def _why(ui: Ui, made: Pen, frame: Frame) -> None:
    """What blocks the chosen light, what hides the clicked primitive, the pixels that the clicked one is compared with,
    and what the pointer's link stands for."""
    c = ui.controller
    state = ui.state(Pointed)
    link, state.link = state.link, None  # the panel says so in each frame
    found, in_place = c.inspector.why, c.inspector.names_pixels_of(frame)
    if c.selection.picked is not None and c.session.draw.rays and found is not None:
        for one in found.reasons[c.session.draw.light : c.session.draw.light + 1]:  # of the light that is chosen
            for number in one.named[:_MOST_NAMED]:
                _outline(ui, made, frame, number, _NAMED, f"named {number}")
            if one.blocker >= 0:
                _outline(ui, made, frame, one.blocker, _BLOCKER, "blocker")
        by = None if found.coverage is None else found.coverage.occluded
        if by is not None and not by.at_edge and by.primitive >= 0:
            _outline(ui, made, frame, by.primitive, _HIDER, "occluder")
        if by is not None and in_place and by.pixel != (found.x, found.y):
            made.square(*_square_of(made, frame, by.pixel), _HIDER)
        if in_place and c.selection.pixel == (found.x, found.y):
            _figure_3(made, frame, found)
    if link is not None and link.primitive is not None:
        _outline(ui, made, frame, link.primitive, WHITE, "pointed link")
    if link is not None and link.pixel is not None and in_place:
        made.square(*_square_of(made, frame, link.pixel), WHITE)


def _outline(ui: Ui, made: Pen, frame: Frame, primitive: int, color: ImVec4, name: str) -> None:
    scene = ui.controller.session.scene
    if scene is None or primitive >= scene.primitive_count:
        return
    pieces = ui.cached(
        name, frame, primitive, lambda: _projected(frame, outline_of(primitive_points(scene, primitive, frame.time)))
    )
    made.strokes(pieces, color, _OUTLINE, around=WHITE if color is _BLOCKER else SHADE)


def _projected(frame: Frame, lines: list) -> list[Stroke]:
    return [stroke for line in lines for stroke in strokes(frame, line)]


def _figure_3(made: Pen, frame: Frame, found: Why) -> None:
    """The clicked pixel and its left and upper neighbours, as in the paper's Figure 3; where pixels are small, larger
    than they are."""
    middle, (width, height) = _square_of(made, frame, (found.x, found.y))
    for one in found.references:
        color = _HIDER if one.occluded else _MISSED if one.tested else _SAME
        across, down = one.pixel[0] - found.x, one.pixel[1] - found.y
        made.square(ImVec2(middle.x + across * width, middle.y + down * height), (width, height), color)
    if found.references:
        made.square(middle, (width, height), WHITE)


def _square_of(made: Pen, frame: Frame, pixel: tuple[int, int]) -> tuple[ImVec2, tuple[float, float]]:
    """The middle of a pixel on the screen, and the size of its square there."""
    middle = made.to_screen((pixel[0] + 0.5) / frame.width, (pixel[1] + 0.5) / frame.height)
    return middle, (max(made.pixel[0], em(_SIDE)), max(made.pixel[1], em(_SIDE)))


def _step(ui: Ui, made: Pen, frame: Frame) -> None:
    """The pixels and primitives that the line of the paper's text speaks of."""
    step = ui.controller.stepping.step_in(frame)
    for number in dict.fromkeys(step.primitives[:_MOST_NAMED] if step is not None else ()):
        _outline(ui, made, frame, number, _STEPPED, f"stepped {number}")
    for number, pixel in enumerate(step.pixels if step is not None else ()):
        made.square(*_square_of(made, frame, pixel), _STEPPED if number else WHITE)


# --- what is selected -------------------------------------------------------------------------------


def _occluded_selection(ui: Ui, made: Pen, frame: Frame) -> None:
    """Where what is selected lies behind something, as dashed lines."""
    c = ui.controller
    now, picked, at = c.session.edited, c.selection.picked, c.selection.pixel
    if now is None or picked is None:
        return
    if at is not None and (picked.part is not None or frame.primitive[at[1], at[0]] == picked.primitive):
        return

    def lines() -> list[Stroke]:
        return _projected(frame, outline_of(points_of(now, picked, frame.time)))

    made.strokes(ui.cached("occluded selection", frame, picked, lines), WHITE, 0.12, behind=0.75)


def show_missing(ui: Ui, corner: ImVec2, end: ImVec2) -> None:
    """Say why a view has nothing to show, in a note below the picture's upper third, and offer the method that has."""
    c, run, room = ui.controller, ui.controller.runs.current, end.x - corner.x - em(2.0)
    found = missing(c.session.draw.view, c.frame, c.renderer.busy) if c.frame is not None else None
    if found is None or room < em(_LEAST):
        return
    width = min(em(_NOTE), room)
    imgui.set_cursor_screen_pos(ImVec2((corner.x + end.x - width) / 2.0, corner.y + (end.y - corner.y) / 3.0))
    imgui.push_style_color(imgui.Col_.child_bg, BACK)
    flags = imgui.ChildFlags_.auto_resize_y | imgui.ChildFlags_.always_use_window_padding
    if imgui.begin_child("missing", ImVec2(width, 0.0), int(flags)):
        paragraph(found.text, FRONT)
        imgui.begin_disabled(run is not None)
        if found.base and imgui.button(f"Use {title_of(found.base)}###instead"):
            c.settings.change(method=with_base(c.session.settings.method, found.base))
        imgui.end_disabled()
        if run is not None:
            tooltip(f"Not while the {run.name} runs. Escape stops it.")
    imgui.end_child()
    imgui.pop_style_color()
