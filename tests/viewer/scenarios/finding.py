"""The table of objects and primitives: found, sorted, selected here and in the picture, hidden and shown."""

from __future__ import annotations

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from tests.viewer.fakes import wall_of_triangles
from viewer.services.scene_table import Listing
from viewer.state.scene_rows import Level
from viewer.window.menus import ANY_POPUP
from viewer.window.panels.find import FindState

ROWS_SEEN = 60  # at most, in a window of these sizes


def finding(d: Driver) -> None:
    """A user looks for things in a scene of thousands of primitives."""
    c, table = d.c, d.c.table
    path = d.folder / "wall.aff"
    path.write_text(wall_of_triangles(40, 30, (0, -9)))  # as many are seen as there are behind them
    d.open(path)
    assert not c.session.counting, "nobody looks at the table yet"

    # Ctrl+F opens it, and what is typed goes into its filter.
    d.press("Ctrl+F")
    _known(d)
    assert c.frame.settings.record_work and table.level is Level.OBJECTS
    d.click("//Find/Primitives")
    listing = _known(d)
    assert listing.table.rows == len(listing.rows) == c.session.scene.primitive_count
    assert 2 < d.ui.state(FindState).drawn < ROWS_SEEN, "only rows that are seen are drawn"
    d.press("Ctrl+F").type("pixels>0")
    listing = _known(d)
    assert table.order.text == "pixels>0" and 0 < len(listing.rows) < listing.table.rows
    d.press("Enter")
    assert c.selection.picked.primitive == listing.rows[0], "Enter selects the first row"
    d.context.item_input("//Find/##filterPrimitives")
    d.type("pixel")
    table.filter("number>7")  # whose rows are still to come when Enter is pressed, as in a large scene
    d.press("Enter")
    d.wait(lambda: c.selection.picked.primitive > 7, "the first of the rows that came", 20.0)
    d.context.item_input("//Find/##filterPrimitives")
    d.press("Ctrl+Shift+P")
    assert imgui.is_popup_open("##command palette", ANY_POPUP), "the palette comes while one types"
    d.press("Escape")

    # A row in the far middle selects in the picture; a click in the picture scrolls to its row.
    table.filter("")
    listing = _known(d)
    d.pick(*d.places(c.frame.primitive >= 0, reach=1)[0])
    clicked = c.selection.picked.primitive
    assert clicked == table.selected
    d.hover(f"//Find/**/{_id(clicked)}/##row")
    assert 2 < d.ui.state(FindState).drawn < ROWS_SEEN
    last = int(listing.rows[-1])
    c.selection.select_primitive(last)
    d.frames(4)
    d.click(f"//Find/**/{_id(last)}/##row")
    picked = c.selection.picked
    assert picked.primitive == last and picked.x == -1, "what has no pixel can be selected"

    # The headers sort.
    before = listing.rows
    d.click("//Find/**/Number")
    listing = _known(d)
    assert (np.diff(listing.rows) == 1).all() and not np.array_equal(before, listing.rows)

    # F goes to what is selected, wherever it is.
    camera = c.session.camera
    d.press("F").settle()
    assert c.session.camera != camera and c.selection.pixel is not None
    assert c.frame.primitive[c.selection.pixel[1], c.selection.pixel[0]] == last

    # The eye hides it and shows it again.
    d.click(f"//Find/**/{_id(last)}/eye").settle()
    assert c.session.edits.hidden_primitives == {last} and (c.session.edited.primitives != last).all()
    d.click("//Find/Show everything").settle()
    assert not c.session.edits and c.session.scene is c.session.original

    # An object's own list, and its outline.
    d.click("//Find/Objects")
    listing = _known(d)
    part = int(listing.rows[0])
    left, top, _, bottom = d.place(f"//Find/**/{_id(part)}/##row")
    d.move_to(left + 35.0, 0.5 * (top + bottom)).click_here()  # on its name, at no column's edge
    assert c.selection.picked.part == part
    shown = d.shown()
    d.press("Escape")
    assert c.selection.picked is None and (shown != d.shown()).any(), "the outline goes with the selection"
    table.open_part(part)
    assert len(_known(d).rows) == int(listing.table.columns["primitives"].numbers[part])
    _entered(d)
    d.show_panel("Log")
    assert not table.visible and not c.session.counting


def _entered(d: Driver) -> None:
    """Enter selects the first row, once it is there, of either level; where there is none, a line says why."""
    for level, text in ((Level.OBJECTS, "wall"), (Level.PRIMITIVES, "triangle"), (Level.OBJECTS, "triangle")):
        d.click(f"//Find/{level.value}")
        d.c.selection.clear()
        d.press("Ctrl+F", "Ctrl+A").type(text).press("Enter")
        rows = _known(d).rows
        assert (len(rows) == 0) == ((level, text) == (Level.OBJECTS, "triangle"))
        assert d.c.table.selected == (int(rows[0]) if len(rows) else -1), (level, text)
    d.expect("0 of 1 object; materials and textures are those of primitives")


def _known(d: Driver) -> Listing:
    """The listing as it is asked for, of the newest picture."""
    table = d.c.table
    d.settle()

    def there() -> bool:
        listing = table.listing
        counted = listing is not None and listing.table.columns["saved"] is not None
        return counted and not table.busy and listing.order == table.order

    d.wait(there, "the table", 20.0).frames(3)
    return table.listing


def _id(row: int) -> str:
    """How the test engine writes a number that was pushed as an identity."""
    return f"$${row}"
