"""The view: what is shown of the frame, at which resolution, and what its colours mean."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.renderer import Frame
from viewer.panels.widgets import (
    QUIET,
    WARNING,
    checkbox,
    count,
    em,
    heading,
    paragraph,
    properties,
    row,
    tooltip,
    wide_button,
)
from viewer.ui import CaptureKind, Ui
from viewer.views import GREY, LegendRow, View, color_map, occlusion_legend, shadow_legend

_RESOLUTIONS = ((256, 256), (512, 512), (800, 600), (1024, 1024), (1280, 720), (1920, 1080))
_GRADIENT_STEPS = 24


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    views = list(View)
    with properties("view", 5.0) as shown:
        if shown:
            row("View", "keys 1 to 7")
            chosen = views.index(c.session.view)
            changed, index = imgui.combo("##view", chosen, [f"{v.title}" for v in views])
            if changed:
                c.set_view(views[index])
            if c.session.view is View.SHADOW and c.session.scene is not None and c.session.scene.lights:
                row("Light", "L and Shift+L")
                names = [f"{i}  {light.name}" for i, light in enumerate(c.session.scene.lights)]
                changed, light = imgui.combo("##light", c.session.light, names)
                if changed:
                    c.set_light(light)
            if c.session.view not in (View.COLOR, View.NORMAL, View.DEPTH):
                row("Shading", "how much of the picture's light and shade shows under the colours")
                _, c.preferences.shading = imgui.slider_float("##shading", c.preferences.shading, 0.0, 1.0, "%.2f")
    if c.frame is not None:
        _legend(ui, c.frame)
    p = c.preferences
    checkbox("Outlines", p.outlines, lambda on: setattr(p, "outlines", on), "borders between primitives (B)")
    _resolution(ui)
    _screenshots(ui)


def _legend(ui: Ui, frame: Frame) -> None:
    """What the colours stand for, and how much of the frame each is."""
    view, light = ui.controller.session.view, ui.controller.session.light
    tip = view.explanation
    if view is View.OCCLUSION:
        _table(ui.cached("occlusion", frame, 0, lambda: occlusion_legend(frame)))
    elif view is View.SHADOW:
        rows = ui.cached("shadow", frame, light, lambda: shadow_legend(frame, light))
        if rows:
            _table(rows)
        else:
            tip = "Culling does not cover this light: its shadow rays are all traced."
            paragraph(tip, WARNING)
            return
    elif view is View.DEPTH and ui.display is not None:
        near, far = ui.display.depth_range
        _gradient(f"{near:.4g}", f"{far:.4g}", reverse=True)
    elif view is View.PIXEL_COUNT:
        zoom = frame.settings.zoom_factor
        _gradient(f"1/{zoom:.3g}", f"{zoom:.3g} x", "as many")
        _swatch(GREY)
        imgui.text_unformatted("never fully rendered")
    paragraph(tip, QUIET)


def _table(rows: list[LegendRow]) -> None:
    flags = int(imgui.TableFlags_.sizing_stretch_prop | imgui.TableFlags_.row_bg)
    if not imgui.begin_table("legend", 3, flags):
        return
    imgui.table_setup_column("mode", int(imgui.TableColumnFlags_.width_stretch), 1.7)
    imgui.table_setup_column("pixels", int(imgui.TableColumnFlags_.width_stretch), 0.8)
    imgui.table_setup_column("primitives", int(imgui.TableColumnFlags_.width_stretch), 1.0)
    for title in ("mode", "pixels", "primitives"):
        imgui.table_next_column()
        if title == "mode":
            imgui.text_colored(QUIET, title)
        else:
            _right(title, QUIET)
    for entry in rows:
        imgui.table_next_column()
        _swatch(entry.color)
        imgui.text_unformatted(entry.name.replace("_", " ").lower())
        tooltip(f"{entry.name}: {entry.meaning}")
        imgui.table_next_column()
        _right(f"{100.0 * entry.pixel_share:.1f} %")
        tooltip(f"{count(entry.pixels)} primary pixels")
        imgui.table_next_column()
        _right(count(entry.primitives))
        tooltip(f"{100.0 * entry.primitive_share:.2f} % of all primitives")
    imgui.end_table()


def _right(text: str, color: ImVec4 | None = None) -> None:
    """Text at the right edge of its column."""
    room = imgui.get_content_region_avail().x - imgui.calc_text_size(text).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(0.0, room))
    if color is None:
        imgui.text_unformatted(text)
    else:
        imgui.text_colored(color, text)


def _swatch(color: tuple[float, float, float]) -> None:
    side = imgui.get_text_line_height()
    at = imgui.get_cursor_screen_pos()
    end = ImVec2(at.x + 0.8 * side, at.y + 0.9 * side)
    start = ImVec2(at.x, at.y + 0.1 * side)
    imgui.get_window_draw_list().add_rect_filled(start, end, imgui.get_color_u32(ImVec4(*color, 1.0)), em(0.15))
    imgui.dummy(ImVec2(0.8 * side, side))
    imgui.same_line(0.0, em(0.4))


def _gradient(low: str, high: str, middle: str = "", reverse: bool = False) -> None:
    """The colour map as a bar, with its ends named under it."""
    colors = color_map(_GRADIENT_STEPS + 1)
    if reverse:
        colors = colors[::-1]
    at, width, height = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x, em(0.8)
    draw = imgui.get_window_draw_list()
    for i in range(_GRADIENT_STEPS):
        left, right = (imgui.get_color_u32(ImVec4(*map(float, colors[i + k]), 1.0)) for k in (0, 1))
        start = ImVec2(at.x + width * i / _GRADIENT_STEPS, at.y)
        end = ImVec2(at.x + width * (i + 1) / _GRADIENT_STEPS, at.y + height)
        draw.add_rect_filled_multi_color(start, end, left, right, right, left)
    imgui.dummy(ImVec2(width, height))
    left_edge = imgui.get_cursor_pos_x()
    imgui.text_unformatted(low)
    if middle:
        imgui.same_line(left_edge + (width - imgui.calc_text_size(middle).x) / 2.0)
        imgui.text_unformatted(middle)
    imgui.same_line(left_edge + width - imgui.calc_text_size(high).x)
    imgui.text_unformatted(high)


def _resolution(ui: Ui) -> None:
    c = ui.controller
    p = c.preferences
    heading("Resolution")
    checkbox("Fixed", p.fixed_resolution, lambda on: setattr(p, "fixed_resolution", on), "else that of the window")
    if p.fixed_resolution:
        imgui.same_line()
        imgui.set_next_item_width(-em(2.2))
        changed, size = imgui.input_int2("##size", [p.fixed_width, p.fixed_height])
        if changed:
            p.fixed_width, p.fixed_height = (min(max(n, 1), 8192) for n in size)
        imgui.same_line()
        if imgui.button(icons.ICON_FA_CHEVRON_DOWN, (-1.0, 0.0)):
            imgui.open_popup("sizes")
        if imgui.begin_popup("sizes"):
            for width, height in _RESOLUTIONS:
                if imgui.menu_item(f"{width} x {height}", "", False, True)[0]:
                    p.fixed_width, p.fixed_height = width, height
            imgui.end_popup()
    tip = "trace coarser frames while the camera moves, to hold the frame rate"
    checkbox("Coarser in motion", p.dynamic_resolution, lambda on: setattr(p, "dynamic_resolution", on), tip)
    with properties("quality", 5.0) as shown:
        if shown:
            if p.dynamic_resolution:
                row("Hold", "frames per second to hold in motion")
                changed, fps = imgui.slider_float("##fps", p.target_fps, 2.0, 60.0, "%.0f fps")
                p.target_fps = min(max(fps, 1.0), 240.0) if changed else p.target_fps
            row("Samples", "rays per pixel")
            samples = [1, 4, 9, 16]
            now = samples.index(c.session.settings.samples) if c.session.settings.samples in samples else 0
            changed, index = imgui.combo("##samples", now, [str(n) for n in samples])
            if changed:
                c.change(samples=samples[index])


def _screenshots(ui: Ui) -> None:
    p = ui.controller.preferences
    heading("Pictures")
    if wide_button(f"{icons.ICON_FA_CAMERA}  Save", "the picture alone (F12)", 2):
        ui.capture_wanted = CaptureKind.PICTURE
    imgui.same_line()
    if wide_button(f"{icons.ICON_FA_DISPLAY}  With panels", "the whole window (Shift+F12)"):
        ui.capture_wanted = CaptureKind.WINDOW
    with properties("pictures", 5.0) as shown:
        if shown:
            row("Folder", "where pictures are saved")
            hint = str(ui.default_folder)
            _, p.screenshot_folder = imgui.input_text_with_hint("##folder", hint, p.screenshot_folder)
            tooltip(p.screenshot_folder or hint)
            row("Name", "template of the file's name")
            _, p.screenshot_template = imgui.input_text("##template", p.screenshot_template)
            tooltip(ui.template_help)
