"""What a light sees, as the method `lightbuffer` keeps it: its cube, unfolded, and what a direction's list holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui
from numpy.typing import NDArray

from tracer.culling.lightbuffer.tell import LightCube, listed
from tracer.frame import Frame
from tracer.method import Method
from tracer.why_in_words import primitive_in_words
from viewer.output.light_cube import CubeSeen, cell_at, cross_of, depths_legend, lists_legend, seen
from viewer.state.methods import with_additions
from viewer.state.readings import LIGHT_CUBES
from viewer.views.legend import Legend
from viewer.views.legend_layout import Layout, fitting
from viewer.window.panels import legend, lights
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, em, paragraph, properties, row, swatch, wide_button

PANEL = "Light buffer"
LISTS, DEPTHS = range(2)
_MOST_NAMED = 8
_MARK, _DARK = ImVec4(1.0, 1.0, 1.0, 0.9), ImVec4(0.0, 0.0, 0.0, 0.8)
_LEGEND = 15.0  # ems of width beside the cross
_CHOICES = 11.0  # ems beside the legend that choices need


@dataclass
class CubeState:
    """What the light's cube shows, by its number."""

    shows: int = 0


@dataclass(eq=False)
class _Picture:
    """A cross as a texture that stays as it is (`viewer.window.shots`)."""

    cross: NDArray[np.uint8]

    def pixels(self) -> NDArray[np.uint8]:
        return self.cross

    def thumbnail(self, height: int) -> NDArray[np.uint8]:
        return self.cross


def show(ui: Ui) -> None:
    """The panel."""
    state = ui.state(CubeState)
    c = ui.controller
    frame = c.frame
    if frame is None or c.session.scene is None:
        paragraph("There is no picture yet.", QUIET)
        return
    if LIGHT_CUBES not in frame.structures:
        _offer(ui, frame)
        return
    cubes: tuple[LightCube, ...] = frame.structures[LIGHT_CUBES]
    light = c.session.light
    found = cubes[light] if light < len(cubes) else None
    if found is None or found.cube is None:
        why = found.why if found is not None else f"only the first {len(cubes)} lights have one"
        _choose(ui)
        name = ui.light_name(light)
        paragraph(f"{name[0].upper()}{name[1:]} has no light buffer, and its rays are traced: {why or 'none is made'}.")
        return
    cube = found.cube
    drawn: CubeSeen = ui.cached("cube", cube, None, lambda: seen(cube))
    colors, told = (drawn.list_colors, lists_legend) if state.shows == LISTS else (drawn.depth_colors, depths_legend)
    name = ui.light_name(light)
    picture: _Picture = ui.cached("cube picture", cube, state.shows, lambda: _Picture(cross_of(colors)))
    described: Legend = ui.cached("cube legend", cube, (state.shows, name), lambda: told(drawn, name))
    _show(ui, found, drawn, picture, described)


def _choose(ui: Ui) -> None:
    """Which light, and what of its cube."""
    state = ui.state(CubeState)
    with properties("light buffer", 4.0) as shown:
        if shown:
            row("Light", f"whose cube is shown{ui.keys('Next light', 'Previous light')}")
            lights.combo(ui)
            row("Shown", "what is known of each cell, or how far from the light all is in shadow")
            for number, name in enumerate(("lists", "full shadow")):
                if number and imgui.get_content_region_avail().x > em(10.0):
                    imgui.same_line(0.0, em(0.6))
                if imgui.radio_button(f"{name}##cube", state.shows == number):
                    state.shows = number


def _offer(ui: Ui, frame: Frame) -> None:
    """Why there is nothing to see, and a button that changes it."""
    method = Method.parse(frame.settings.method)
    paragraph(f"The method {method} keeps no light buffers: what each light sees in each direction.")
    if wide_button("Use lightbuffer##instead", "cull by the light buffer alone", 2):
        ui.controller.settings.change(method="lightbuffer")
    if method.kind.name != "none":
        imgui.same_line()
        if wide_button("Add lightbuffer##add", f"keep {method}, and ask light buffers what it leaves"):
            ui.controller.settings.change(method=with_additions(str(method), ["lightbuffer"]))


def _show(ui: Ui, found: LightCube, drawn: CubeSeen, picture: _Picture, described: Legend) -> None:
    """The cross, and beside it, or around it in a narrow panel, what it shows and what the pointer is on."""
    beside = imgui.get_content_region_avail().x > 2.2 * em(_LEGEND)
    if not beside:
        _choose(ui)
    room = imgui.get_content_region_avail()
    side = drawn.lengths.shape[1]
    across, down = (room.x - em(_LEGEND + 1.0), room.y) if beside else (room.x, 0.62 * room.y)
    scale = max(min(across / (4.0 * side), down / (3.0 * side)), 0.05)
    cell = _cross(ui, picture, side, scale)
    if beside:
        imgui.same_line(0.0, em(1.0))
    if imgui.begin_child("told"):
        line, most = imgui.get_text_line_height(), imgui.get_content_region_avail().x
        layout = fitting(described, lambda text: float(imgui.calc_text_size(text).x), line, most, 1e6)
        apart = beside and layout is not None and most - layout.width > em(_CHOICES)
        if apart and layout is not None:  # there is little room below
            _legend(layout)
            imgui.same_line(0.0, em(0.8))
            imgui.begin_child("choices")
        if beside:
            _choose(ui)
        if cell is not None:  # what is asked for comes first, where there is little room
            _tell(ui, found, drawn, cell)
        if layout is not None and not apart:
            _legend(layout)
        if cell is None:
            paragraph("Point at a cell: what its list holds is said here.", QUIET)
        if apart:
            imgui.end_child()
    imgui.end_child()


def _legend(layout: Layout) -> None:
    """The legend at the cursor."""
    legend.draw_layout(imgui.get_window_draw_list(), layout, imgui.get_cursor_screen_pos())
    imgui.dummy(ImVec2(layout.width, layout.height))


def _cross(ui: Ui, picture: _Picture, side: int, scale: float) -> tuple[int, int, int] | None:
    """The cross, each cell so many pixels wide, and the cell that the pointer is on."""
    corner, size = imgui.get_cursor_screen_pos(), ImVec2(4.0 * side * scale, 3.0 * side * scale)
    imgui.invisible_button("cube", size)
    hovered, mouse, draw = imgui.is_item_hovered(), imgui.get_io().mouse_pos, imgui.get_window_draw_list()
    texture = ui.shots.texture_id(picture, small=False) if ui.shots is not None else None
    if texture is not None:
        draw.add_image(imgui.ImTextureRef(texture), corner, ImVec2(corner.x + size.x, corner.y + size.y))
    x, y = int((mouse.x - corner.x) / scale), int((mouse.y - corner.y) / scale)
    cell = cell_at(side, x, y) if hovered and 0 <= x < 4 * side and 0 <= y < 3 * side else None
    if cell is not None:
        middle = ImVec2(corner.x + (x + 0.5) * scale, corner.y + (y + 0.5) * scale)
        half = 0.5 * max(scale, em(0.5))
        start, end = (ImVec2(middle.x + s * half, middle.y + s * half) for s in (-1.0, 1.0))
        draw.add_rect(start, end, imgui.get_color_u32(_DARK), 0.0, 3.0)
        draw.add_rect(start, end, imgui.get_color_u32(_MARK), 0.0, 1.5)
    return cell


def said(found: LightCube, drawn: CubeSeen, cell: tuple[int, int, int]) -> tuple[str, tuple[int, ...]]:
    """What is known of a cell (face, row, column) of a cube, in words, and the primitives in its list."""
    assert found.cube is not None
    length, depth = int(drawn.lengths[cell]), float(drawn.depths[cell])
    names = listed(found.cube, *cell)
    shadow = f", and full shadow begins {depth:.4g} from the light" if np.isfinite(depth) else ""
    if length == 0:
        return "Nothing static is in this direction.", ()
    if length > 0:
        return f"{length} in the list{shadow}:", names
    if np.isfinite(depth):
        return (
            f"Covered by one triangle, {depth:.4g} from the light: before it is nothing, behind it full shadow:",
            names,
        )
    return "More than are tested: rays that end here are traced.", ()


def _tell(ui: Ui, found: LightCube, drawn: CubeSeen, cell: tuple[int, int, int]) -> None:
    scene = ui.controller.session.scene
    text, names = said(found, drawn, cell)
    red, green, blue = (drawn.list_colors if ui.state(CubeState).shows == LISTS else drawn.depth_colors)[cell].tolist()
    swatch((red, green, blue))
    paragraph(text)
    for number in names[:_MOST_NAMED]:
        named = primitive_in_words(scene, number) if scene is not None and number < scene.primitive_count else ""
        paragraph(named or f"primitive {number}", QUIET)
