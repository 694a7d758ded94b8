"""The table is made beside the window, stays in order, selects in the picture, and is saved."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.fakes import TINY_SCENE, make_frame, make_scene
from tracer.editing.edits import Edits, edited
from viewer.output.exports import write_rows
from viewer.services import scene_table
from viewer.services.scene_table import Listing, SceneTable
from viewer.state.scene_rows import COLUMNS, Level, Values, tables_of


@pytest.fixture
def table(desk: Desk) -> SceneTable:
    """The table of the tiny scene's primitives, looked at."""
    table, tick = desk.c.table, desk.tick
    table.level = Level.PRIMITIVES

    def watching() -> None:
        table.watch()
        tick()

    desk.tick = watching  # type: ignore[method-assign]
    known(desk)
    return table


def known(desk: Desk) -> Listing:
    """The listing as it is asked for, of the newest picture."""
    table = desk.c.table

    def there() -> bool:
        listing = table.listing
        work = listing is not None and listing.table.columns["saved"] is not None
        return work and not table.busy and listing.order == table.order

    desk.rest()
    desk.until(there)
    return table.listing


def test_rows_stay_as_they_are_under_the_pointer(desk: Desk, table: SceneTable) -> None:
    before = known(desk)
    table.pointed_at = True
    desk.c.motion.move(ELSEWHERE)
    desk.until(lambda: desk.c.frame.camera == ELSEWHERE)
    assert known(desk) is before, "the pointer is on it"
    table.sort("number", True)
    assert known(desk).rows.tolist() == sorted(before.rows.tolist(), reverse=True), "a click counts at once"
    table.pointed_at = False
    desk.until(lambda: table.listing.source.frame.camera == ELSEWHERE)
    desk.c.settings.change(samples=3, verify=True)
    desk.until(lambda: table.listing.source.frame.settings.samples == 3)  # wrong answers are counted in all samples


def test_filters_that_are_not_understood_leave_the_rows(desk: Desk, table: SceneTable) -> None:
    table.filter("pixels>2")
    before = known(desk).rows.tolist()
    table.filter("pixels>2x")
    after = known(desk)
    assert after.rows.tolist() == before and "2x is no number" in after.problem
    for text, rows in (("9" * 5000, 0), ("-" + "9" * 5000, after.table.rows), ("number:" + "9" * 5000, 0)):
        table.filter(text)
        assert len(known(desk).rows) == rows and not table.listing.problem, "a number of any length"


def test_no_frame_of_another_scene_reaches_the_table(desk: Desk, table: SceneTable, tmp_path: Path) -> None:
    other = tmp_path / "other.aff"
    other.write_text(TINY_SCENE + "p 3\n0 0 0\n1 0 0\n0 1 0\n")
    before = desk.c.session.scene.primitive_count
    table.filter("kind:triangle")  # a job is under way
    desk.tick()
    tick, seen = desk.tick, []

    def checked() -> None:
        tick()
        if table.listing is not None:
            seen.append((desk.c.session.scene.primitive_count, table.listing.table.rows))

    desk.tick = checked  # type: ignore[method-assign]
    desk.open(other)
    known(desk)
    assert desk.c.session.scene.primitive_count == before + 1
    assert seen and all(rows == primitives for primitives, rows in seen)


def test_what_cannot_be_made_is_told_and_not_tried_again(
    desk: Desk, table: SceneTable, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, tried, told = known(desk), [], []
    monkeypatch.setattr(scene_table, "listed", lambda *_: tried.append(1) or [][0])
    monkeypatch.setattr(desk.c.notices, "report", lambda failure, *_: told.append(failure.text))
    table.filter("wall")
    desk.until(lambda: told)
    for _ in range(20):
        desk.tick()
    assert len(tried) == len(told) == 1 and not table.busy and table.listing is before
    monkeypatch.undo()
    table.filter("pixels>0")
    assert known(desk).order.text == "pixels>0" and not table.listing.problem


def test_things_are_hidden_and_shown_again(desk: Desk, table: SceneTable) -> None:
    total = known(desk).table.rows
    sphere = desk.c.session.scene.triangle_count
    table.select(0)
    table.hide(sphere)
    table.save()
    assert "not up to date" in desk.said and not desk.c.captures.busy and table.is_hidden(sphere)
    listing = known(desk)
    assert listing.table.rows == total and desk.c.session.scene.primitive_count == total - 1
    assert listing.table.cell("hidden", sphere) == "hidden" and listing.table.cell("pixels", sphere) == "0"
    assert table.selected == 0, "what is selected stays so"
    table.select(sphere)
    assert "hidden" in desk.said and table.selected == 0
    table.hide(sphere, False)
    assert known(desk).table.cell("pixels", sphere) != "0" and not table.is_hidden(sphere)


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_rows_are_saved_as_they_are_seen(desk: Desk, table: SceneTable, tmp_path: Path) -> None:
    table.filter("kind:triangle")
    listing = known(desk)
    table.save()
    desk.rest()
    assert "saved" in desk.said
    (path,) = (tmp_path / "pictures").glob("*.csv")
    rows = read(path)
    assert [int(row["Number"]) for row in rows] == listing.rows.tolist() and len(rows) > 0
    pixels = listing.table.columns["pixels"].numbers[listing.rows].tolist()
    assert [int(row["Pixels"]) for row in rows] == pixels == sorted(pixels, reverse=True), "most pixels come first"


def test_names_and_what_is_not_known_are_written_so_that_they_are_read_again(tmp_path: Path) -> None:
    table = tables_of(edited(make_scene(), Edits()), make_frame(), 0)[Level.PRIMITIVES]
    table.columns["object"] = Values(table.columns["object"].numbers, ('a, "quoted"\nname', "train"))
    write_rows(table, np.arange(7, dtype=np.int32)[::-1], tmp_path / "rows.csv")
    rows = read(tmp_path / "rows.csv")
    assert [row["Number"] for row in rows] == list("6543210") and rows[0]["Object"] == 'a, "quoted"\nname'
    assert {row["Texture"] for row in rows} == {""} and "Untraced" not in rows[0]
    assert set(rows[0]) <= {column.title for column in COLUMNS[Level.PRIMITIVES]}
