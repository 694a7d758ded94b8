"""How the window looks: fonts, sizes and the theme, by the screen's own density and the user's scale."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui, implot

from viewer.window import palette
from viewer.window.density import Density

FONT = "fonts/Roboto/Roboto-Regular.ttf"
ICONS = "fonts/Font_Awesome_6_Free-Solid-900.otf"
FONT_SIZE = 15.0


def load_fonts() -> None:
    """The text font with the icons merged into it."""
    hello_imgui.load_font(FONT, FONT_SIZE)
    merged = hello_imgui.FontLoadingParams(merge_to_last_font=True)
    hello_imgui.load_font(ICONS, FONT_SIZE * 0.85, merged)


# What ImGui has for letters of FONT_SIZE, and scales once, when a window is made.
_LENGTHS = {
    "child_rounding": 3.0, "columns_min_spacing": 6.0, "docking_separator_size": 2.0, "log_slider_deadzone": 4.0,
    "drag_drop_target_border_size": 2.0, "drag_drop_target_padding": 3.0, "indent_spacing": 21.0,
    "input_text_cursor_size": 1.0, "scrollbar_padding": 2.0, "separator_size": 1.0, "tab_bar_overline_size": 1.0,
    "tab_min_width_shrink": 80.0, "tree_lines_size": 1.0, "window_border_hover_padding": 4.0,
    "color_marker_size": 3.0,
}  # fmt: skip

_applied: tuple[float, str] = (0.0, "")
_density = Density()


def update(theme: str, scale: float) -> bool:
    """Set all styles for this theme, the screen's density and the user's scale; whether anything has changed."""
    global _applied
    _density.update()
    style = imgui.get_style()
    style.font_scale_main = scale  # the fonts are drawn anew at the size that comes of it
    # Hello ImGui knows the size of letters only while a frame is under way.
    wanted = (style.font_size_base * style.font_scale_main * style.font_scale_dpi, theme)
    if wanted[0] <= 0.0 or wanted == _applied:
        return False
    _applied = wanted
    palette.apply(theme)
    _style_widgets(wanted[0])
    _style_plots(wanted[0])
    return True


def forget() -> None:
    """A new window has no style yet."""
    global _applied, _density
    _applied, _density = (0.0, ""), Density()


def fill_windows(filled: bool) -> None:
    """Whether windows that begin from here on have a background: what is drawn over the cleared screen needs none."""
    none = ImVec4(0.0, 0.0, 0.0, 0.0)
    imgui.get_style().set_color_(int(imgui.Col_.window_bg), palette.BACKGROUND if filled else none)


def _style_widgets(em: float) -> None:
    style = imgui.get_style()
    style.window_padding = _whole(0.55 * em, 0.45 * em)
    style.frame_padding = ImVec2(0.45 * em, 0.22 * em)
    style.item_spacing = _whole(0.45 * em, 0.32 * em)
    style.item_inner_spacing = ImVec2(0.35 * em, 0.3 * em)
    style.cell_padding = ImVec2(0.25 * em, 0.12 * em)
    style.scrollbar_size = 0.75 * em
    style.grab_min_size = 0.7 * em
    style.frame_rounding = style.grab_rounding = 0.22 * em
    style.popup_rounding = style.window_rounding = style.tab_rounding = 0.25 * em
    style.scrollbar_rounding = 0.4 * em
    for name, length in _LENGTHS.items():
        setattr(style, name, max(1.0, math.floor(length * em / FONT_SIZE)))
    style.window_border_size = style.popup_border_size = style.child_border_size = 1.0
    style.frame_border_size = style.tab_bar_border_size = 0.0
    style.separator_text_border_size = 1.0
    style.separator_text_padding = ImVec2(0.6 * em, 0.15 * em)
    style.window_menu_button_position = imgui.Dir.none


def _whole(x: float, y: float) -> ImVec2:
    """Whole pixels: lists would come out by parts of one shorter than their rows, and get a scrollbar."""
    return ImVec2(math.floor(x), math.floor(y))


def _style_plots(em: float) -> None:
    style = implot.get_style()
    style.plot_padding = ImVec2(0.35 * em, 0.3 * em)
    style.label_padding = ImVec2(0.25 * em, 0.2 * em)
    style.legend_padding = ImVec2(0.4 * em, 0.25 * em)
    style.legend_inner_padding = ImVec2(0.25 * em, 0.15 * em)
    style.plot_border_size = 0.0
    style.set_color_(int(implot.Col_.frame_bg), ImVec4(0, 0, 0, 0))
    style.set_color_(int(implot.Col_.plot_bg), palette.PLOT)
    style.set_color_(int(implot.Col_.axis_grid), _with(palette.GRID, 0.12))
    style.set_color_(int(implot.Col_.axis_text), palette.AXIS_TEXT)
    style.set_color_(int(implot.Col_.title_text), palette.TITLE)
    style.set_color_(int(implot.Col_.legend_text), palette.TITLE)
    style.set_color_(int(implot.Col_.legend_bg), _with(palette.PLOT, 0.75))
    style.set_color_(int(implot.Col_.legend_border), ImVec4(0, 0, 0, 0))


def _with(color: ImVec4, alpha: float) -> ImVec4:
    return ImVec4(color.x, color.y, color.z, alpha)
