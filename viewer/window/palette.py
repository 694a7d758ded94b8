"""The window's two themes: what every colour is in each.

The colours that panels name change their values with the theme, so that whoever holds one draws in the theme that is
on.  What lies over the picture keeps its own colours, dark behind light words, as the picture is no theme's."""

from __future__ import annotations

from imgui_bundle import ImVec4, imgui

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
    "GOOD": ("5CCCA3", "0B7A54"),
    "BLUE": ("408FDB", "1F6FBF"),
    "GREEN": ("00B887", "00875F"),
    "ORANGE": ("EDA31A", "C77700"),
    "SKY": ("8CC7F2", "4A9FDB"),
    "PINK": ("DB87B8", "B85590"),
    "YELLOW": ("F0E342", "B8A200"),
    "GREY": ("8C94A3", "8C94A3"),
    "MARK": ("F2F5FA", "20242B"),
    "PLOT": ("16181D", "FFFFFF"),
    "GRID": ("FFFFFF", "000000"),
    "AXIS_TEXT": ("A2A9B5", "4C5462"),
    "TITLE": ("C9CED6", "2A3038"),
}
_COLORS = {name: rgb(dark) for name, (dark, _) in _NAMED.items()}
(
    BACKGROUND, QUIET, WARNING, ERROR, GOOD, BLUE, GREEN, ORANGE, SKY, PINK, YELLOW, GREY, MARK,
    PLOT, GRID, AXIS_TEXT, TITLE,
) = _COLORS.values()  # fmt: skip
ON_PICTURE_ERROR = rgb("FF786B")

# ImGui's colours: dark, light; with an opacity where it is not 1.
_SLOTS: dict[imgui.Col_, tuple[str, str] | tuple[str, str, float]] = {
    imgui.Col_.text: ("E4E7EC", "1C2026"),
    imgui.Col_.text_disabled: ("7B828E", "7A818C"),
    imgui.Col_.window_bg: ("1E2127", "F4F5F7"),
    imgui.Col_.child_bg: ("1E2127", "F4F5F7", 0.0),
    imgui.Col_.popup_bg: ("262A32", "FFFFFF", 0.98),
    imgui.Col_.border: ("343A45", "C3C8D0"),
    imgui.Col_.frame_bg: ("2C313B", "E0E4EA"),
    imgui.Col_.frame_bg_hovered: ("363D49", "D3DAE4"),
    imgui.Col_.frame_bg_active: ("3F4856", "C5CFDC"),
    imgui.Col_.title_bg: ("181A1F", "DDE1E7"),
    imgui.Col_.title_bg_active: ("181A1F", "DDE1E7"),
    imgui.Col_.title_bg_collapsed: ("181A1F", "DDE1E7"),
    imgui.Col_.menu_bar_bg: ("181A1F", "E6E9EE"),
    imgui.Col_.scrollbar_bg: ("1E2127", "F4F5F7", 0.0),
    imgui.Col_.scrollbar_grab: ("3F4652", "BCC2CC"),
    imgui.Col_.scrollbar_grab_hovered: ("525B6B", "A3ABB8"),
    imgui.Col_.scrollbar_grab_active: ("616C7F", "8C96A6"),
    imgui.Col_.checkbox_selected_bg: ("2C313B", "E0E4EA"),
    imgui.Col_.text_link: ("6CB2F5", "1C67B5"),
    imgui.Col_.check_mark: ("6CB2F5", "1C67B5"),
    imgui.Col_.slider_grab: ("4E92D6", "4E92D6", 0.6),
    imgui.Col_.slider_grab_active: ("6CB2F5", "2F79C4", 0.7),
    imgui.Col_.button: ("343B47", "D8DDE5"),
    imgui.Col_.button_hovered: ("41506A", "BDD3EC"),
    imgui.Col_.button_active: ("3A6EA5", "94BDE6"),
    imgui.Col_.header: ("34506F", "C4DAF1", 0.8),
    imgui.Col_.header_hovered: ("3D5F86", "B3D0EE"),
    imgui.Col_.header_active: ("3A6EA5", "94BDE6"),
    imgui.Col_.separator: ("343A45", "C9CED6"),
    imgui.Col_.separator_hovered: ("4E92D6", "4E92D6"),
    imgui.Col_.separator_active: ("6CB2F5", "2F79C4"),
    imgui.Col_.resize_grip: ("343A45", "C9CED6"),
    imgui.Col_.resize_grip_hovered: ("4E92D6", "4E92D6"),
    imgui.Col_.resize_grip_active: ("6CB2F5", "2F79C4"),
    imgui.Col_.tab: ("181A1F", "DDE1E7"),
    imgui.Col_.tab_hovered: ("3D5F86", "B3D0EE"),
    imgui.Col_.tab_selected: ("2A303A", "FFFFFF"),
    imgui.Col_.tab_selected_overline: ("4E92D6", "2F79C4"),
    imgui.Col_.tab_dimmed: ("181A1F", "DDE1E7"),
    imgui.Col_.tab_dimmed_selected: ("242932", "EEF0F4"),
    imgui.Col_.tab_dimmed_selected_overline: ("343A45", "C3C8D0"),
    imgui.Col_.docking_preview: ("4E92D6", "4E92D6", 0.6),
    imgui.Col_.docking_empty_bg: ("121418", "D3D7DD"),
    imgui.Col_.plot_histogram: ("4E92D6", "4E92D6"),
    imgui.Col_.table_row_bg_alt: ("FFFFFF", "000000", 0.03),
    imgui.Col_.table_header_bg: ("262A32", "E0E4EA"),
    imgui.Col_.table_border_light: ("343A45", "D3D7DD"),
    imgui.Col_.table_border_strong: ("343A45", "C3C8D0"),
    imgui.Col_.text_selected_bg: ("3A6EA5", "94BDE6", 0.8),
    imgui.Col_.nav_cursor: ("6CB2F5", "2F79C4"),
    imgui.Col_.modal_window_dim_bg: ("0C0D10", "20242B", 0.45),
    imgui.Col_.input_text_cursor: ("E4E7EC", "1C2026"),
    imgui.Col_.tree_lines: ("343A45", "C3C8D0"),
}


def apply(theme: str) -> None:
    """Give every colour its value in this theme, ImGui's among them."""
    which = THEMES.index(theme)
    for color, codes in zip(_COLORS.values(), _NAMED.values(), strict=True):
        now = rgb(codes[which])
        color.x, color.y, color.z = now.x, now.y, now.z
    style = imgui.get_style()
    for slot, (*slot_codes, opacity) in ((slot, (*found, 1.0)[:3]) for slot, found in _SLOTS.items()):
        style.set_color_(int(slot), rgb(slot_codes[which], opacity))
