"""The table of objects and primitives: found by what is typed, sorted by a click, selected in the picture as well."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.scene_table import Listing, SceneTable
from viewer.state.row_filter import HELP, HINTS
from viewer.state.scene_rows import Level
from viewer.window.finding import FindState
from viewer.window.panels import find_rows, lights
from viewer.window.panels.lights import LightFilters
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, clipped, count, em, fitted, paragraph, same_line_for, tooltip

_FIELD, _LIGHT = 12.0, 8.0  # ems of width, at least, for the filter, and for the name of a light
_LEVEL_TIPS = {
    Level.OBJECTS: "one row for each object, and for each named part of the static geometry",
    Level.PRIMITIVES: "one row for each triangle, sphere and cone",
}


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    table = c.table
    table.watch()
    table.held = False
    if c.session.scene is None:
        paragraph("Open a scene to list its objects and primitives.", QUIET)
        return
    _tools(ui, table)
    listing = table.listing
    if listing is None:
        paragraph("The table is made when the picture is whole.", QUIET)
        return
    _said(ui, table, listing)
    # The table scrolls sideways by itself; a window around it says so, which else would seem too wide for its content.
    if imgui.begin_child("around", ImVec2(0.0, 0.0), 0, int(imgui.WindowFlags_.horizontal_scrollbar)):
        find_rows.show(ui, table, listing)
    imgui.end_child()


def _tools(ui: Ui, table: SceneTable) -> None:
    """What rows are, the filter, the light, and saving, in one line where there is room."""
    for number, level in enumerate(Level):
        if number:
            same_line_for(level.value)
        if imgui.radio_button(level.value, table.level is level):
            table.level = level
        tooltip(_LEVEL_TIPS[level])
    style = imgui.get_style()
    icon = imgui.calc_text_size(icons.ICON_FA_FLOPPY_DISK).x
    save = icon + 2.0 * style.frame_padding.x + style.item_spacing.x + 1.0
    edge = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x
    if imgui.get_item_rect_max().x + em(_FIELD + _LIGHT) + save <= edge:
        imgui.same_line(0.0, em(1.0))
    room = imgui.get_content_region_avail().x - save
    light = min(em(_LIGHT + 3.0), 0.4 * room)
    imgui.set_next_item_width(room - light - imgui.get_style().item_spacing.x)
    _filter(ui, table)
    imgui.same_line()
    imgui.set_next_item_width(light)
    _light(ui, table)
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FLOPPY_DISK}##save"):
        table.save()
    tooltip("save these rows as CSV, in this order")


def _filter(ui: Ui, table: SceneTable) -> None:
    state = ui.state(FindState)
    if state.focus:
        imgui.set_keyboard_focus_here()
        state.focus = False
    hint = f"{icons.ICON_FA_MAGNIFYING_GLASS}  {HINTS[table.level]}"
    shown = fitted(hint, imgui.calc_item_width() - 2.0 * imgui.get_style().frame_padding.x)
    changed, text = imgui.input_text_with_hint(f"##filter{table.level.value}", shown, table.order.text)
    if changed:
        table.filter(text)
    if imgui.is_item_deactivated() and (
        imgui.is_key_down(imgui.Key.enter) or imgui.is_key_down(imgui.Key.keypad_enter)
    ):
        listing = table.listing
        if listing is not None and listing.order == table.order and len(listing.rows):
            table.select(int(listing.rows[0]))
    tooltip(HELP)


def _light(ui: Ui, table: SceneTable) -> None:
    """Which light shadow modes are of."""
    c = ui.controller
    label = "all lights" if table.all_lights else ui.light_name(c.session.light)
    if imgui.begin_combo("##light", label):
        if imgui.is_window_appearing():
            ui.state(LightFilters).texts["find"] = ""
        if imgui.selectable("all lights", table.all_lights)[0]:
            table.all_lights = True
        for number in list(lights.found(ui, "find"))[:64]:
            chosen = not table.all_lights and c.session.light == number
            if imgui.selectable(f"{ui.light_name(number)}##{number}", chosen)[0]:
                table.all_lights = False
                c.settings.set_light(number)
        imgui.end_combo()
    tooltip("the light that shadow modes are of (L: the next one), or all lights together")


def _said(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """How many rows there are, what is wrong with the filter, and what became of the selected row."""
    if listing.problem and listing.order == table.order:
        clipped(listing.problem, ERROR)
        return
    found, rows = len(listing.rows), listing.table.rows
    noun = listing.table.level.value.lower()
    said = f"{count(rows)} {noun}" if found == rows else f"{count(found)} of {count(rows)} {noun}"
    row = table.selected
    if row >= 0 and found < rows and ui.cached("find-there", listing, row, lambda: table.place_of(row)) is None:
        clipped(f"{said}; what is selected is not among them", QUIET)
        imgui.same_line()
        if imgui.small_button("Show all"):
            table.filter("")
            table.chosen = -1  # it is scrolled to
        return
    edits = ui.controller.session.edits
    if edits.hidden or edits.hidden_primitives:
        imgui.text_colored(QUIET, said)
        imgui.same_line()
        if imgui.small_button("Show everything"):
            ui.controller.editing.show_everything()
        tooltip("what is hidden comes back; is:hidden finds it")
        return
    clipped(said, QUIET)
