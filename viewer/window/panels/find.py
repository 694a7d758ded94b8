"""The table of objects and primitives: found by what is typed, sorted by a click, selected in the picture as well.

Only the rows that are seen are drawn, however many there are."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from tracer.culling.modes import OcclusionMode, ShadowMode
from viewer.services.scene_table import Listing, SceneTable
from viewer.state.palette import OCCLUSION_COLORS, SHADOW_COLORS
from viewer.state.row_filter import HELP, HINTS
from viewer.state.scene_rows import COLUMNS, Column, Level
from viewer.window.commands import FindState
from viewer.window.panels import lights
from viewer.window.ui import Ui
from viewer.window.widgets import (
    ERROR,
    QUIET,
    clipped,
    count,
    em,
    fitted,
    paragraph,
    right,
    same_line_for,
    swatch,
    tooltip,
)

_WIDTHS = {
    "number": 6.2, "kind": 4.4, "pixels": 4.8, "occlusion": 9.0, "shadow": 8.0, "due": 5.0, "saved": 5.0, "share": 4.6,
    "wrong": 4.2, "motion": 4.6, "primitives": 5.4, "seen": 4.4, "rendered": 5.4, "full_shadow": 5.4, "non_shadow": 4.4,
}  # fmt: skip
_NAME = 9.0  # ems, at least, for what has a name
_SHARES = {"object": 3.0, "material": 2.0, "texture": 2.0}
_COLORS = {
    "occlusion": {int(mode): color for mode, color in OCCLUSION_COLORS.items() if isinstance(mode, OcclusionMode)},
    "shadow": {int(mode): color for mode, color in SHADOW_COLORS.items() if isinstance(mode, ShadowMode)},
}
_FIELD, _LIGHT = 12.0, 8.0  # ems of width, at least, for the filter, and for the name of a light
_LEVEL_TIPS = {
    Level.OBJECTS: "one row for each object, and for each named part of the static geometry; double-click one to list "
    "its primitives",
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
        _table(ui, table, listing)
    imgui.end_child()


def _tools(ui: Ui, table: SceneTable) -> None:
    """What rows are, the filter, the light, and saving, in one line where there is room."""

    def choose_light(light: int | None) -> None:
        table.all_lights = light is None
        if light is not None:
            ui.controller.settings.set_light(light)

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
    shown = None if table.all_lights else ui.controller.session.draw.light
    lights.combo(ui, "find", shown, choose_light, lambda: choose_light(None))
    tooltip(f"the light that shadow modes are of{ui.key('Next light')}, or all lights together")
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
        clipped(f"{said}; the selection is not among them", QUIET)
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
        tooltip("show all that is hidden; the filter is:hidden lists it")
        return
    clipped(said, QUIET)


# --- rows -------------------------------------------------------------------------------------------


def _table(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """The table itself, which scrolls both ways."""
    state = ui.state(FindState)
    columns = COLUMNS[listing.table.level]
    kinds = imgui.TableFlags_
    flags = kinds.scroll_x | kinds.scroll_y | kinds.row_bg | kinds.resizable | kinds.reorderable | kinds.hideable
    flags |= kinds.sortable | kinds.borders_inner_v
    least = em(sum(_WIDTHS.get(column.name, _NAME) for column in columns) + 0.6 * len(columns))
    width = max(least, imgui.get_content_region_avail().x - imgui.get_style().scrollbar_size)
    state.drawn = 0
    name = f"table{listing.table.level.value}"
    if not imgui.begin_table(name, len(columns), int(flags), ImVec2(0.0, 0.0), width):
        return
    imgui.table_setup_scroll_freeze(1, 1)
    for number, column in enumerate(columns):
        _set_up(ui, table, number, column)
    _headers(columns)
    _sort(table, columns)
    _scroll(ui, table, listing)
    table.held = imgui.is_window_hovered()
    selected = table.selected
    clipper = imgui.ListClipper()
    # What it measures itself is a pixel too high for the first row, which shifts row 1000 out of sight.
    clipper.begin(len(listing.rows), state.height or -1.0)
    while clipper.step():
        above = 0.0
        for row in listing.rows[clipper.display_start : clipper.display_end].tolist():
            imgui.table_next_row()
            imgui.table_set_column_index(0)
            below = imgui.get_cursor_screen_pos().y
            state.height, above = (below - above if above else state.height), below
            _row(table, listing, columns, row, row == selected)
            state.drawn += 1
    clipper.end()
    imgui.end_table()


def _set_up(ui: Ui, table: SceneTable, number: int, column: Column) -> None:
    kinds = imgui.TableColumnFlags_
    scene = ui.controller.session.scene
    flags = kinds.prefer_sort_descending if column.numeric and column.name != "number" else kinds.prefer_sort_ascending
    if number == 0:
        flags |= kinds.no_hide | kinds.no_reorder
    if column.name == table.order.column:
        flags |= kinds.default_sort
    if column.name == "texture" and scene is not None and not scene.textures:
        flags |= kinds.disabled
    if column.name in _WIDTHS:
        imgui.table_setup_column(column.title, int(flags | kinds.width_fixed), em(_WIDTHS[column.name]))
    else:
        imgui.table_setup_column(column.title, int(flags | kinds.width_stretch), _SHARES[column.name])


def _headers(columns: tuple[Column, ...]) -> None:
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    for number, column in enumerate(columns):
        if imgui.table_set_column_index(number):
            imgui.table_header(column.title)
            tooltip(column.tip)


def _sort(table: SceneTable, columns: tuple[Column, ...]) -> None:
    """Take over what was clicked in the headers."""
    specs = imgui.table_get_sort_specs()
    if specs is None or not specs.specs_dirty:
        return
    if specs.specs_count:
        one = specs.get_specs(0)
        table.sort(columns[one.column_index].name, one.get_sort_direction() == imgui.SortDirection.descending)
    specs.specs_dirty = False


def _scroll(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """Bring the row of what was selected elsewhere to where it is seen, once it is there; in another order, too, whose
    first rows are seen where nothing is selected."""
    state = ui.state(FindState)
    serial, height = table.selection_serial, state.height
    if listing.order != table.order or height <= 0.0:
        return
    another, state.order = state.order != listing.order, listing.order
    if serial == table.chosen and not another:
        return
    table.chosen = serial
    place = table.place_of(table.selected)
    if place is None:
        imgui.set_scroll_y(0.0 if another else imgui.get_scroll_y())
        return
    room = imgui.get_window_height() - 3.0 * height
    top = place * height
    if not imgui.get_scroll_y() <= top <= imgui.get_scroll_y() + room:
        imgui.set_scroll_y(max(0.0, top - 0.5 * room))


def _row(table: SceneTable, listing: Listing, columns: tuple[Column, ...], row: int, selected: bool) -> None:
    """The cells of a row, which has been begun."""
    imgui.push_id(row)
    flags = imgui.SelectableFlags_.span_all_columns | imgui.SelectableFlags_.allow_double_click
    flags |= imgui.SelectableFlags_.allow_overlap
    if imgui.selectable("##row", selected, int(flags))[0]:
        table.select(row)
        if imgui.is_mouse_double_clicked(0) and table.level is Level.OBJECTS:
            table.open_part(row)
    imgui.same_line(0.0, 0.0)
    hidden = table.is_hidden(row)
    _eye(table, row, hidden)
    if hidden:
        imgui.push_style_color(imgui.Col_.text, QUIET)
    for number, column in enumerate(columns):
        if number == 0 or imgui.table_set_column_index(number):
            _cell(listing, column, row)
    if hidden:
        imgui.pop_style_color()
    imgui.pop_id()


def _eye(table: SceneTable, row: int, hidden: bool) -> None:
    """What hides a row's object or primitive, and shows it again."""
    side = imgui.get_text_line_height()
    if imgui.invisible_button("eye", ImVec2(1.4 * side, side)):
        table.hide(row, not hidden)
    on_it = imgui.is_item_hovered()
    at = imgui.get_item_rect_min()
    icon = icons.ICON_FA_EYE_SLASH if hidden else icons.ICON_FA_EYE
    color = imgui.get_color_u32(imgui.Col_.text if on_it or hidden else imgui.Col_.text_disabled)
    imgui.get_window_draw_list().add_text(at, color, icon)
    if on_it:
        tooltip("show it again" if hidden else "hide it: the picture is traced without it")
    imgui.same_line(0.0, em(0.3))


def _cell(listing: Listing, column: Column, row: int) -> None:
    text = listing.table.cell(column.name, row)
    if column.numeric:
        wrong = column.name == "wrong" and text not in ("0", "-")
        right(text, ERROR if wrong else None)
        return
    colors, values = _COLORS.get(column.name), listing.table.columns.get(column.name)
    if colors is not None and values is not None:
        color = colors.get(int(values.numbers[row]))
        if color is not None:
            swatch(color)
    imgui.text_unformatted(fitted(text, imgui.get_content_region_avail().x))
