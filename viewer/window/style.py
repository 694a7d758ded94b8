"""How the window looks: fonts, lengths and the two themes, by the screen's own density and the user's scale.

The colours that panels name change their values with the theme, so that whoever holds one draws in the theme that is
on.  What lies over the picture keeps its own colours, dark behind light words, as the picture is no theme's."""

from __future__ import annotations

import math
import sys
from functools import cache

from imgui_bundle import ImVec2, ImVec4, glfw_utils, hello_imgui, imgui, implot

import glfw  # after imgui_bundle, which brings the library that both must share  # isort: skip

from viewer.state.preferences import THEMES


def rgb(code: str, alpha: float = 1.0) -> ImVec4:
    """A colour by its hexadecimal digits."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return ImVec4(red, green, blue, alpha)


# Name: dark, light.
_NAMED = {
    "BACKGROUND": ("1E2127", "F4F5F7"),
    "QUIET": ("9EA6B2", "5A6270"),
    "WARNING": ("F5BD4F", "8F5B00"),
    "ERROR": ("FF786B", "BE2416"),
    "TEAL": ("4FD1C5", "0B7F77"),  # these six are of curves, and none is near a mode's
    "VIOLET": ("B18CFF", "6A3FC4"),
    "CONTRAST": ("E8EAEE", "22262C"),
    "TAN": ("C8A27A", "8A5A2B"),
    "ROSE": ("FF8FA3", "C2334D"),
    "LIME": ("A8D672", "4F7F1F"),
    "GREY": ("8C94A3", "8C94A3"),
    "MARK": ("F2F5FA", "20242B"),
    "PLOT": ("16181D", "FFFFFF"),
    "GRID": ("FFFFFF", "000000"),
    "AXIS_TEXT": ("A2A9B5", "4C5462"),
    "TITLE": ("C9CED6", "2A3038"),
}
_COLORS = {name: rgb(dark) for name, (dark, _) in _NAMED.items()}
(
    BACKGROUND, QUIET, WARNING, ERROR, TEAL, VIOLET, CONTRAST, TAN, ROSE, LIME, GREY, MARK,
    PLOT, GRID, AXIS_TEXT, TITLE,
) = _COLORS.values()  # fmt: skip
ON_PICTURE_ERROR = rgb(_NAMED["ERROR"][0])

# Colours, dark and light, an opacity, and what of ImGui has them.
_SLOTS = (
    ("E4E7EC", "1C2026", 1.0, "text input_text_cursor"),
    ("7B828E", "7A818C", 1.0, "text_disabled"),
    ("1E2127", "F4F5F7", 1.0, "window_bg"),
    ("1E2127", "F4F5F7", 0.0, "child_bg scrollbar_bg"),
    ("262A32", "FFFFFF", 0.98, "popup_bg"),
    ("343A45", "C6CBD3", 1.0,
     "border separator resize_grip tab_dimmed_selected_overline table_border_strong tree_lines"),
    ("2C313B", "E0E4EA", 1.0, "frame_bg checkbox_selected_bg"),
    ("363D49", "D5DBE4", 1.0, "frame_bg_hovered button"),
    ("3F4856", "C0C8D4", 1.0, "frame_bg_active scrollbar_grab"),
    ("181A1F", "DDE1E7", 1.0, "title_bg title_bg_active title_bg_collapsed tab tab_dimmed menu_bar_bg"),
    ("5A6475", "98A1AF", 1.0, "scrollbar_grab_hovered scrollbar_grab_active"),
    ("6CB2F5", "1C67B5", 1.0, "text_link check_mark slider_grab_active separator_active resize_grip_active nav_cursor"),
    ("4E92D6", "4E92D6", 0.6, "slider_grab docking_preview"),
    ("41506A", "BDD3EC", 1.0, "button_hovered"),
    ("3A6EA5", "94BDE6", 1.0, "button_active header_active text_selected_bg"),
    ("34506F", "C4DAF1", 0.8, "header"),
    ("3D5F86", "B3D0EE", 1.0, "header_hovered tab_hovered"),
    ("4E92D6", "4E92D6", 1.0, "separator_hovered resize_grip_hovered plot_histogram"),
    ("2A303A", "FFFFFF", 1.0, "tab_selected"),
    ("4E92D6", "2F79C4", 1.0, "tab_selected_overline"),
    ("242932", "EEF0F4", 1.0, "tab_dimmed_selected"),
    ("121418", "D3D7DD", 1.0, "docking_empty_bg"),
    ("FFFFFF", "000000", 0.03, "table_row_bg_alt"),
    ("262A32", "E0E4EA", 1.0, "table_header_bg"),
    ("343A45", "D3D7DD", 1.0, "table_border_light"),
    ("0C0D10", "20242B", 0.45, "modal_window_dim_bg"),
)  # fmt: skip


def apply_colors(theme: str) -> None:
    """Give every colour its value in this theme, ImGui's among them."""
    which = THEMES.index(theme)
    for color, codes in zip(_COLORS.values(), _NAMED.values(), strict=True):
        now = rgb(codes[which])
        color.x, color.y, color.z = now.x, now.y, now.z
    style = imgui.get_style()
    for *both, opacity, slots in _SLOTS:
        for slot in slots.split():
            style.set_color_(int(getattr(imgui.Col_, slot)), rgb(both[which], opacity))


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
_window = cache(glfw_utils.glfw_window_hello_imgui)  # which looks through the stack each time it is asked
_first: tuple[float, float] | None = None  # how large Hello ImGui makes letters on the first screen, and its density


def content_scale() -> float:
    """What the desktop wants everything enlarged by on the window's screen; needs a window."""
    # On macOS windows are measured in points, and are enlarged with their letters.
    return 1.0 if sys.platform == "darwin" else float(max(glfw.get_window_content_scale(_window())))


def _scale_letters() -> None:
    """Let letters be as large on this screen as they were on others: the window may be dragged to another."""
    global _first
    now, style = content_scale(), imgui.get_style()
    if _first is None:
        _first = style.font_scale_dpi, now
    letters, then = _first
    if now > 0.0 and then > 0.0:
        style.font_scale_dpi = letters * now / then


def update(theme: str, scale: float) -> bool:
    """Set all styles for this theme, the screen's density and the user's scale; whether anything has changed."""
    global _applied
    _scale_letters()
    style = imgui.get_style()
    style.font_scale_main = scale  # the fonts are drawn anew at the size that comes of it
    # Hello ImGui knows the size of letters only while a frame is under way.
    wanted = (style.font_size_base * style.font_scale_main * style.font_scale_dpi, theme)
    if wanted[0] <= 0.0 or wanted == _applied:
        return False
    _applied = wanted
    apply_colors(theme)
    _style_widgets(wanted[0])
    _style_plots(wanted[0])
    return True


def forget() -> None:
    """A new window has no style yet."""
    global _applied, _first
    _applied, _first = (0.0, ""), None
    _window.cache_clear()


def fill_windows(filled: bool) -> None:
    """Whether windows that begin from here on have a background: what is drawn over the cleared screen needs none."""
    none = ImVec4(0.0, 0.0, 0.0, 0.0)
    imgui.get_style().set_color_(int(imgui.Col_.window_bg), BACKGROUND if filled else none)


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
    style.plot_min_size = ImVec2(6.0 * em, 5.0 * em)
    style.plot_padding = ImVec2(0.35 * em, 0.3 * em)
    style.label_padding = ImVec2(0.25 * em, 0.2 * em)
    style.legend_padding = ImVec2(0.4 * em, 0.25 * em)
    style.legend_inner_padding = ImVec2(0.25 * em, 0.15 * em)
    style.plot_border_size = 0.0
    style.set_color_(int(implot.Col_.frame_bg), ImVec4(0, 0, 0, 0))
    style.set_color_(int(implot.Col_.plot_bg), PLOT)
    style.set_color_(int(implot.Col_.axis_grid), _with(GRID, 0.12))
    style.set_color_(int(implot.Col_.axis_text), AXIS_TEXT)
    style.set_color_(int(implot.Col_.title_text), TITLE)
    style.set_color_(int(implot.Col_.legend_text), TITLE)
    style.set_color_(int(implot.Col_.legend_bg), _with(PLOT, 0.75))
    style.set_color_(int(implot.Col_.legend_border), ImVec4(0, 0, 0, 0))


def _with(color: ImVec4, alpha: float) -> ImVec4:
    return ImVec4(color.x, color.y, color.z, alpha)
