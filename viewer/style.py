"""How the window looks: fonts and colours, sized by the screen's own density."""

from __future__ import annotations

from imgui_bundle import ImVec2, ImVec4, hello_imgui, imgui, implot

FONT = "fonts/Roboto/Roboto-Regular.ttf"
ICONS = "fonts/Font_Awesome_6_Free-Solid-900.otf"
FONT_SIZE = 15.0


def load_fonts() -> None:
    """The text font with the icons merged into it."""
    hello_imgui.load_font(FONT, FONT_SIZE)
    merged = hello_imgui.FontLoadingParams(merge_to_last_font=True)
    hello_imgui.load_font(ICONS, FONT_SIZE * 0.85, merged)


def _rgb(code: str, alpha: float = 1.0) -> ImVec4:
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (0, 2, 4))
    return ImVec4(red, green, blue, alpha)


BACKGROUND = _rgb("1E2127")
_COLORS = {
    imgui.Col_.text: _rgb("E4E7EC"),
    imgui.Col_.text_disabled: _rgb("7B828E"),
    imgui.Col_.window_bg: BACKGROUND,
    imgui.Col_.child_bg: _rgb("1E2127", 0.0),
    imgui.Col_.popup_bg: _rgb("262A32", 0.98),
    imgui.Col_.border: _rgb("343A45"),
    imgui.Col_.frame_bg: _rgb("2C313B"),
    imgui.Col_.frame_bg_hovered: _rgb("363D49"),
    imgui.Col_.frame_bg_active: _rgb("3F4856"),
    imgui.Col_.title_bg: _rgb("181A1F"),
    imgui.Col_.title_bg_active: _rgb("181A1F"),
    imgui.Col_.title_bg_collapsed: _rgb("181A1F"),
    imgui.Col_.menu_bar_bg: _rgb("181A1F"),
    imgui.Col_.scrollbar_bg: _rgb("1E2127", 0.0),
    imgui.Col_.scrollbar_grab: _rgb("3F4652"),
    imgui.Col_.scrollbar_grab_hovered: _rgb("525B6B"),
    imgui.Col_.scrollbar_grab_active: _rgb("616C7F"),
    imgui.Col_.check_mark: _rgb("6CB2F5"),
    imgui.Col_.slider_grab: _rgb("4E92D6", 0.6),
    imgui.Col_.slider_grab_active: _rgb("6CB2F5", 0.7),
    imgui.Col_.button: _rgb("343B47"),
    imgui.Col_.button_hovered: _rgb("41506A"),
    imgui.Col_.button_active: _rgb("3A6EA5"),
    imgui.Col_.header: _rgb("34506F", 0.8),
    imgui.Col_.header_hovered: _rgb("3D5F86"),
    imgui.Col_.header_active: _rgb("3A6EA5"),
    imgui.Col_.separator: _rgb("343A45"),
    imgui.Col_.separator_hovered: _rgb("4E92D6"),
    imgui.Col_.separator_active: _rgb("6CB2F5"),
    imgui.Col_.resize_grip: _rgb("343A45"),
    imgui.Col_.resize_grip_hovered: _rgb("4E92D6"),
    imgui.Col_.resize_grip_active: _rgb("6CB2F5"),
    imgui.Col_.tab: _rgb("181A1F"),
    imgui.Col_.tab_hovered: _rgb("3D5F86"),
    imgui.Col_.tab_selected: _rgb("2A303A"),
    imgui.Col_.tab_selected_overline: _rgb("4E92D6"),
    imgui.Col_.tab_dimmed: _rgb("181A1F"),
    imgui.Col_.tab_dimmed_selected: _rgb("242932"),
    imgui.Col_.tab_dimmed_selected_overline: _rgb("343A45"),
    imgui.Col_.docking_preview: _rgb("4E92D6", 0.6),
    imgui.Col_.docking_empty_bg: _rgb("121418"),
    imgui.Col_.plot_histogram: _rgb("4E92D6"),
    imgui.Col_.table_row_bg_alt: _rgb("FFFFFF", 0.025),
    imgui.Col_.text_selected_bg: _rgb("3A6EA5", 0.8),
    imgui.Col_.nav_cursor: _rgb("6CB2F5"),
    imgui.Col_.modal_window_dim_bg: _rgb("0C0D10", 0.55),
}


_applied_em = 0.0


def follow_density() -> None:
    """Set all styles for the screen the window is on; does nothing until its density changes."""
    global _applied_em
    em = hello_imgui.em_size()
    if em > 0.0 and em != _applied_em:
        _applied_em = em
        _style_widgets(em)
        _style_plots(em)


def fill_windows(filled: bool) -> None:
    """Whether windows that begin from here on have a background: what is drawn over the cleared screen needs none."""
    imgui.get_style().set_color_(int(imgui.Col_.window_bg), BACKGROUND if filled else ImVec4(0.0, 0.0, 0.0, 0.0))


def _style_widgets(em: float) -> None:
    style = imgui.get_style()
    for slot, color in _COLORS.items():
        style.set_color_(int(slot), color)
    style.window_padding = ImVec2(0.55 * em, 0.45 * em)
    style.frame_padding = ImVec2(0.45 * em, 0.22 * em)
    style.item_spacing = ImVec2(0.45 * em, 0.32 * em)
    style.item_inner_spacing = ImVec2(0.35 * em, 0.3 * em)
    style.cell_padding = ImVec2(0.25 * em, 0.12 * em)
    style.scrollbar_size = 0.75 * em
    style.grab_min_size = 0.7 * em
    style.frame_rounding = style.grab_rounding = 0.22 * em
    style.popup_rounding = style.window_rounding = style.tab_rounding = 0.25 * em
    style.scrollbar_rounding = 0.4 * em
    style.window_border_size = style.popup_border_size = 1.0
    style.frame_border_size = style.tab_bar_border_size = 0.0
    style.separator_text_border_size = 1.0
    style.separator_text_padding = ImVec2(0.6 * em, 0.15 * em)
    style.window_menu_button_position = imgui.Dir.none


def _style_plots(em: float) -> None:
    style = implot.get_style()
    style.plot_padding = ImVec2(0.35 * em, 0.3 * em)
    style.label_padding = ImVec2(0.25 * em, 0.2 * em)
    style.legend_padding = ImVec2(0.4 * em, 0.25 * em)
    style.legend_inner_padding = ImVec2(0.25 * em, 0.15 * em)
    style.plot_border_size = 0.0
    style.set_color_(int(implot.Col_.frame_bg), ImVec4(0, 0, 0, 0))
    style.set_color_(int(implot.Col_.plot_bg), _rgb("16181D"))
    style.set_color_(int(implot.Col_.axis_grid), _rgb("FFFFFF", 0.12))
    style.set_color_(int(implot.Col_.axis_text), _rgb("A2A9B5"))
    style.set_color_(int(implot.Col_.title_text), _rgb("C9CED6"))
    style.set_color_(int(implot.Col_.legend_bg), _rgb("16181D", 0.75))
    style.set_color_(int(implot.Col_.legend_border), _rgb("000000", 0.0))
