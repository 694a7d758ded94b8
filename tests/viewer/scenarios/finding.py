"""The table of objects and primitives: found, sorted, selected here and in the picture, hidden and shown."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from viewer.services.scene_table import Listing
from viewer.state.scene_rows import Level
from viewer.window.menus import ANY_POPUP
from viewer.window.panels.find import FindState

KEY = imgui.Key
ROWS_SEEN = 60  # at most, in a window of these sizes
WIDE, HIGH = 40, 30
KITCHEN = Path(__file__).resolve().parents[4] / "shared" / "bart" / "kitchen" / "kitchen.aff"


def finding(d: Driver) -> None:
    """A user looks for things in a scene of thousands of primitives."""
    d.settle()
    c, table = d.c, d.c.table
    path = d.folder / "wall.aff"
    path.write_text(_wall())
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
    d.press("Ctrl+F")
    d.type("pixels>0")
    listing = _known(d)
    assert table.order.text == "pixels>0" and 0 < len(listing.rows) < listing.table.rows
    d.context.key_press(KEY.enter)
    d.frames(3)
    first = int(listing.rows[0])
    assert c.selection.picked.primitive == first, "Enter selects the first row"
    d.context.item_input("//Find/##filterPrimitives")
    d.type("pixel")
    table.filter("number>7")  # whose rows are still to come when Enter is pressed, as in a large scene
    d.context.key_press(KEY.enter)
    d.wait(lambda: c.selection.picked.primitive > 7, "the first of the rows that came", 20.0)
    d.context.item_input("//Find/##filterPrimitives")
    d.press("Ctrl+Shift+P")
    assert imgui.is_popup_open("##command palette", ANY_POPUP), "the palette comes while one types"
    d.context.key_press(KEY.escape)
    d.frames(3)

    # A row in the far middle selects in the picture; a click in the picture scrolls to its row.
    table.filter("")
    listing = _known(d)
    frame = c.frame
    y, x = _inside(frame.primitive)
    d.pick((x + 0.5) / frame.width, (y + 0.5) / frame.height)
    clicked = int(frame.primitive[y, x])
    assert c.selection.picked.primitive == clicked == table.selected
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
    d.press(KEY.f)
    d.wait(lambda: not c.motion.is_dragging, "the end of the flight", 20.0)
    d.settle()
    assert c.session.camera != camera and c.selection.pixel is not None
    assert c.frame.primitive[c.selection.pixel[1], c.selection.pixel[0]] == last

    # The eye hides it and shows it again.
    d.click(f"//Find/**/{_id(last)}/eye")
    d.wait(lambda: not c.editing.under_way and c.session.edits.hidden_primitives == {last}, "one primitive less", 60.0)
    d.settle()
    assert (c.session.edited.primitives != last).all()
    d.click("//Find/Show everything")
    d.wait(lambda: not c.editing.under_way and not c.session.edits, "all primitives", 60.0)
    d.settle()

    # An object's own list, and its outline.
    d.click("//Find/Objects")
    listing = _known(d)
    part = int(listing.rows[0])
    left, top, _, bottom = d.place(f"//Find/**/{_id(part)}/##row")
    d.context.mouse_move_to_pos((left + 35.0, 0.5 * (top + bottom)))  # on its name, at no column's edge
    d.context.mouse_click(0)
    d.frames(3)
    assert c.selection.picked.part == part
    shown = d.shown()
    d.press(KEY.escape)
    d.frames(3)
    assert c.selection.picked is None and (shown != d.shown()).any(), "the outline goes with the selection"
    table.open_part(part)
    assert len(_known(d).rows) == int(listing.table.columns["primitives"].numbers[part])
    _in_the_kitchen(d)
    d.show_panel("Plots")
    assert not table.visible and not c.session.counting


def _in_the_kitchen(d: Driver) -> None:
    """Enter selects the first row, once it is there, in a scene whose table takes a while."""
    if not KITCHEN.is_file():
        return
    c, table = d.c, d.c.table
    d.open(KITCHEN)
    for level, text in ((Level.OBJECTS, "stool"), (Level.PRIMITIVES, "wood"), (Level.OBJECTS, "wood")):
        d.click(f"//Find/{level.value}")
        c.selection.clear()
        d.press("Ctrl+F")
        d.press("Ctrl+A")
        d.type(text)
        d.context.key_press(KEY.enter)
        rows = _known(d).rows
        assert table.selected == (int(rows[0]) if len(rows) else -1), (level, text)
    d.expect("0 of 35 objects; materials and textures are those of primitives")


def _wall() -> str:
    """As many triangles behind those that are seen as there are seen."""
    lines = ["v", "from 20 15 40", "at 20 15 0", "up 0 1 0", "angle 40", "hither 0.1", "resolution 8 8", "l 1 9 30"]
    lines.append("f 1 0 0 1 0 1 0 1")
    for z in (0, -9):
        for x, y in np.ndindex(WIDE, HIGH):
            lines.append(f"p 3\n{x} {y} {z}\n{x + 1} {y} {z}\n{x} {y + 1} {z + 0.5}")
    return "\n".join(lines) + "\n"


def _known(d: Driver) -> Listing:
    """The listing as it is asked for, of the newest picture."""
    table = d.c.table
    d.frames(3)
    d.settle()

    def there() -> bool:
        listing = table.listing
        counted = listing is not None and listing.table.columns["saved"] is not None
        return counted and not table.busy and listing.order == table.order

    d.wait(there, "the table", 20.0)
    d.frames(3)
    return table.listing


def _id(row: int) -> str:
    """How the test engine writes a number that was pushed as an identity."""
    return f"$${row}"


def _inside(primitive: np.ndarray) -> tuple[int, int]:
    """A pixel in the middle of those whose neighbours show the same primitive."""
    same = [np.roll(primitive, by, axis) == primitive for axis in (0, 1) for by in (-1, 1)]
    found = np.argwhere(np.logical_and.reduce([primitive >= 0, *same]))
    y, x = found[len(found) // 2]
    return int(y), int(x)
