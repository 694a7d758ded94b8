"""What the chosen light sees, as the method `lightbuffer` keeps it: its cube, unfolded, with its legend."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from tracer.frame import Frame
from tracer.method import title_of
from tracer.renderer import Renderer
from tracer.scene.lights import named_light
from viewer.output.light_cube import Unfolded, by_depths, by_lists
from viewer.services.render_request import Newest
from viewer.state.views import LIGHT_CUBES
from viewer.window.panels import legend, lights
from viewer.window.ui import Ui
from viewer.window.widgets import QUIET, checkbox, em, paragraph


class CubeState(Newest):
    """The newest cube that was drawn: by distances of full shadow, or else by lengths of lists."""

    depths = False


def unfold(renderer: Renderer, frame: Frame, light: int, depths: bool, cancelled: object) -> Unfolded | str:
    """Unfold the cube of a light, or return why it has none, in a line."""
    cubes, name = frame.structures.get(LIGHT_CUBES, ()), named_light(renderer.scene.lights, light)
    if light >= len(cubes) or cubes[light].cube is None:
        why = cubes[light].why if light < len(cubes) else f"{title_of(frame.settings.method)} keeps none for it"
        return f"No light buffer of {name}: {why or 'there is nothing static'}."
    cube = cubes[light].cube
    return by_depths(cube) if depths else by_lists(cube, name)


def show(ui: Ui) -> None:
    """The panel."""
    c, state = ui.controller, ui.state(CubeState)
    if c.frame is not None:
        state.take(c.renderer.query(unfold, c.frame, c.session.draw.light, state.depths))
    checkbox("Distance at which full shadow begins", state.depths, lambda on: setattr(state, "depths", on))
    imgui.same_line()
    imgui.set_next_item_width(min(em(14.0), imgui.get_content_region_avail().x))
    lights.combo(ui, "light buffer", c.session.draw.light, c.settings.set_light)
    found = state.answer
    if not isinstance(found, Unfolded):
        paragraph(state.problem or found or "The light buffer is drawn when the picture is whole.", QUIET)
        return
    room, (down, across, _) = imgui.get_content_region_avail(), found.picture.shape
    scale = max(min((room.x - em(16.0)) / across, room.y / down), 0.1)
    texture = ui.graphics.textures.texture_id(found, small=False)
    if texture is not None:
        imgui.image(imgui.ImTextureRef(texture), ImVec2(across * scale, down * scale))
        imgui.same_line()
    legend.draw(found.legend)
