"""The table of objects and primitives: found by what is typed, sorted by a click, selected in the picture as well.

Only the rows that are seen are drawn, however many there are."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui
from imgui_bundle.immapp import icons_fontawesome_6 as icons

from viewer.services.scene_table import Listing, SceneTable
from viewer.state.palette import OCCLUSION, SHADOW
from viewer.state.row_filter import HELP, HINT
from viewer.state.scene_rows import COLUMNS, Column, Level
from viewer.util.numbers import several
from viewer.window.ui import Ui
from viewer.window.widgets import ERROR, QUIET, count, em, one_of, paragraph, right, seen_rows, swatch, tooltip

_FIELD, _NUMBER = 12.0, 4.2  # ems of width: of the filter at least, and of a number
_COLORS = {
    "occlusion": {int(mode): one.color for mode, one in OCCLUSION.items()},
    "shadow": {int(mode): one.color for mode, one in SHADOW.items()},
}
_LEVEL_TIPS = {
    Level.OBJECTS: "one row for each object, and for each named part of the static geometry; double-click one to list "
    "its primitives",
    Level.PRIMITIVES: "one row for each triangle, sphere and cone",
}


@dataclass
class FindState:
    """`focus` asks for the keyboard above the table; `enters` says that Enter was pressed there, and the row that it
    selects is to come.  `drawn` rows were drawn last, in the order `order`, and the row `shown` has been scrolled
    to."""

    focus: bool = False
    enters: bool = False
    drawn: int = 0
    order: object = None
    shown: int = -1


def show(ui: Ui) -> None:
    """The panel."""
    c = ui.controller
    table = c.table
    table.watch()
    table.pointed_at = False
    if c.session.scene is None:
        paragraph("Open a scene to list its objects and primitives.", QUIET)
        return
    _tools(ui, table)
    listing = table.listing
    if listing is None:
        paragraph("The table is listed when the picture is complete.", QUIET)
        return
    _take_enter(ui, table, listing)
    _said(ui, table, listing)
    # The table scrolls sideways by itself; a window around it says so, which else would seem too wide for its content.
    if imgui.begin_child("around", ImVec2(0.0, 0.0), 0, int(imgui.WindowFlags_.horizontal_scrollbar)):
        _table(ui, table, listing)
    imgui.end_child()


def _tools(ui: Ui, table: SceneTable) -> None:
    """What rows are, the filter, and saving, in one line where there is room."""
    table.level = one_of(((level, level.value, _LEVEL_TIPS[level]) for level in Level), table.level)
    imgui.same_line()
    beside = em(2.0) + imgui.get_style().item_spacing.x
    if imgui.get_content_region_avail().x < em(_FIELD) + beside:
        imgui.new_line()
    imgui.set_next_item_width(imgui.get_content_region_avail().x - beside)
    _filter(ui, table)
    imgui.same_line()
    if imgui.button(f"{icons.ICON_FA_FLOPPY_DISK}##save", ImVec2(em(2.0), 0.0)):
        table.save()
    tooltip("save these rows as CSV, in this order")


def _filter(ui: Ui, table: SceneTable) -> None:
    state = ui.state(FindState)
    if state.focus:
        imgui.set_keyboard_focus_here()
        state.focus = False
    hint = f"{icons.ICON_FA_MAGNIFYING_GLASS}  {HINT}"
    changed, text = imgui.input_text_with_hint(f"##filter{table.level.value}", hint, table.order.text)
    if changed:
        table.filter(text)
        state.enters = False
    entered = imgui.is_key_down(imgui.Key.enter) or imgui.is_key_down(imgui.Key.keypad_enter)
    if imgui.is_item_deactivated() and entered:
        state.enters = True
    tooltip(HELP)


def _take_enter(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """Select the first row, once the rows are those that were typed for."""
    state = ui.state(FindState)
    if state.enters and listing.order == table.order:
        state.enters = False
        if len(listing.rows) and not listing.problem:
            table.select(int(listing.rows[0]))


def _said(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """How many rows there are, what is wrong with the filter, and what became of the selected row."""
    if listing.problem and listing.order == table.order:
        paragraph(listing.problem, ERROR)
        return
    found, rows, row = len(listing.rows), listing.table.rows, table.selected
    edits, noun = ui.controller.session.edits, listing.table.level.value.lower()[:-1]
    said = several(rows, noun) if found == rows else f"{count(found)} of {several(rows, noun)}"
    if row >= 0 and _place_of(ui, listing, row) is None:
        said += "; the selection is not among them"
    elif not found and listing.table.level is Level.OBJECTS:
        said += "; materials and textures are those of primitives"
    paragraph(said, QUIET)
    if edits.hidden or edits.hidden_primitives:
        imgui.same_line()
        if imgui.small_button("Show everything"):
            ui.controller.editing.show_everything()
        tooltip("show all that is hidden; the filter is:hidden lists it")


def _place_of(ui: Ui, listing: Listing, row: int) -> int | None:
    """How many rows are seen above a row; None where it is not among them."""
    found = ui.cached("place of a row", listing, row, lambda: (listing.rows == row).nonzero()[0])
    return int(found[0]) if len(found) else None


# --- rows -------------------------------------------------------------------------------------------


def _table(ui: Ui, table: SceneTable, listing: Listing) -> None:
    """The table itself, which scrolls both ways."""
    state, columns = ui.state(FindState), COLUMNS[listing.table.level]
    kinds = imgui.TableFlags_
    flags = kinds.scroll_x | kinds.scroll_y | kinds.row_bg | kinds.resizable | kinds.reorderable | kinds.hideable
    flags |= kinds.sortable | kinds.borders_inner_v | kinds.sizing_fixed_fit
    if not imgui.begin_table(f"table{listing.table.level.value}", len(columns), int(flags)):
        return
    imgui.table_setup_scroll_freeze(1, 1)
    for number, column in enumerate(columns):
        _set_up(table, number, column)
    imgui.table_next_row(int(imgui.TableRowFlags_.headers))
    for number, column in enumerate(columns):
        if imgui.table_set_column_index(number):
            imgui.table_header(column.title)
            tooltip(column.tip)
    _sort(table, columns)
    table.pointed_at = imgui.is_window_hovered()
    wanted, selected = _to_show(ui, table, listing), table.selected
    state.drawn, height = 0, imgui.get_text_line_height() + 2.0 * imgui.get_style().cell_padding.y
    for place in seen_rows(len(listing.rows), height, wanted):
        row = int(listing.rows[place])
        imgui.table_next_row()
        imgui.table_set_column_index(0)
        _row(ui, table, listing, row, row == selected, place == wanted)
        state.drawn += 1
    imgui.end_table()


def _set_up(table: SceneTable, number: int, column: Column) -> None:
    kinds = imgui.TableColumnFlags_
    flags = kinds.prefer_sort_descending if column.numeric and column.name != "number" else kinds.prefer_sort_ascending
    if number == 0:
        flags |= kinds.no_hide | kinds.no_reorder
    if column.name == table.order.column:
        flags |= kinds.default_sort
    imgui.table_setup_column(column.title, int(flags), em(_NUMBER) if column.numeric else 0.0)


def _sort(table: SceneTable, columns: tuple[Column, ...]) -> None:
    """Take over what was clicked in the headers."""
    specs = imgui.table_get_sort_specs()
    if specs is None or not specs.specs_dirty:
        return
    if specs.specs_count:
        one = specs.get_specs(0)
        table.sort(columns[one.column_index].name, one.get_sort_direction() == imgui.SortDirection.descending)
    specs.specs_dirty = False


def _to_show(ui: Ui, table: SceneTable, listing: Listing) -> int | None:
    """The place of the row to bring to the eye, once it is there: of what was selected elsewhere, or in another order,
    whose first rows are seen where nothing is selected."""
    state = ui.state(FindState)
    if listing.order != table.order or (state.order, state.shown) == (listing.order, table.selected):
        return None
    another, state.order, state.shown = state.order != listing.order, listing.order, table.selected
    place = _place_of(ui, listing, table.selected)
    if place is None and another:
        imgui.set_scroll_y(0.0)
    return place


def _row(ui: Ui, table: SceneTable, listing: Listing, row: int, selected: bool, wanted: bool) -> None:
    """The cells of a row, which has been begun; it is scrolled to where it is `wanted`."""
    imgui.push_id(row)
    flags = imgui.SelectableFlags_.span_all_columns | imgui.SelectableFlags_.allow_double_click
    flags |= imgui.SelectableFlags_.allow_overlap
    if imgui.selectable("##row", selected, int(flags))[0]:
        table.select(row)
        ui.state(FindState).shown = table.selected  # where it is
        if imgui.is_mouse_double_clicked(0) and table.level is Level.OBJECTS:
            table.open_part(row)
    if wanted and not imgui.is_item_visible():
        imgui.set_scroll_here_y(0.5)
    imgui.same_line(0.0, 0.0)
    hidden = table.is_hidden(row)
    _eye(table, row, hidden)
    if hidden:
        imgui.push_style_color(imgui.Col_.text, QUIET)
    for number, column in enumerate(COLUMNS[listing.table.level]):
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
    icon = icons.ICON_FA_EYE_SLASH if hidden else icons.ICON_FA_EYE
    color = imgui.get_color_u32(imgui.Col_.text if on_it or hidden else imgui.Col_.text_disabled)
    imgui.get_window_draw_list().add_text(imgui.get_item_rect_min(), color, icon)
    if on_it:
        tooltip("show it again" if hidden else "hide it: the picture is traced without it")
    imgui.same_line(0.0, em(0.3))


def _cell(listing: Listing, column: Column, row: int) -> None:
    text, values = listing.table.cell(column.name, row), listing.table.columns.get(column.name)
    if column.numeric:
        right(text, ERROR if column.name == "wrong" and text not in ("0", "-") else None)
        return
    if column.name in _COLORS and values is not None:
        color = _COLORS[column.name].get(int(values.numbers[row]))
        if color is not None:
            swatch(color)
    imgui.text_unformatted(text)
