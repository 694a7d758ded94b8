"""The table of objects and primitives: what the newest whole picture knows of each, filtered and in order.

All of it is worked out on a thread of its own, and only while somebody looks at the table; the window never waits.
What is typed or clicked takes effect at once.  A newer picture brings newer numbers at once, but the rows stay in their
places while the pointer is on them or something moves, and those that stand equal keep their order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tracer.frame import Frame
from tracer.scene.edits import Edited
from tracer.scene.model import Progress
from viewer.output import exports
from viewer.output.rows_csv import write_rows
from viewer.services.capture_service import CaptureService
from viewer.services.jobs import Job
from viewer.services.render_request import Traced
from viewer.services.selection import Selection
from viewer.state.notices import Notices
from viewer.state.parts import parts_of
from viewer.state.preferences import Preferences
from viewer.state.row_filter import Listing, Order, listed, quoted
from viewer.state.scene_rows import Level, Table, tables_of
from viewer.state.session import Session


@dataclass(frozen=True, eq=False)
class _Source:
    """What tables are made of; with `light` None, shadow modes are those for all lights together."""

    now: Edited
    frame: Frame
    light: int | None

    def is_like(self, other: _Source) -> bool:
        """Whether the tables of another would be the same: further samples of a picture count nothing."""
        names = ("primitive", "modes", "cells", "saved", "due_rays", "wrong")
        same = all(getattr(self.frame, name) is getattr(other.frame, name) for name in names)
        return same and (self.now is other.now and self.light == other.light)


@dataclass(frozen=True)
class _Made:
    """Both tables of a source, and one of them as it is listed; `in_order` says that its rows have been sorted anew."""

    source: _Source
    tables: dict[Level, Table]
    listing: Listing
    in_order: bool


class Hides(Protocol):
    """The part of `Editing` that is used here."""

    def hide(self, name: str) -> None: ...

    def show(self, name: str) -> None: ...

    def hide_primitive(self, number: int, hidden: bool = True) -> None: ...


class SceneTable:
    """`level` is what rows are, `orders` what is asked of each level; with `all_lights` shadow modes are those for all
    lights together, else for the session's.  `held` says that the rows must not move under the pointer."""

    def __init__(
        self,
        session: Session,
        selection: Selection,
        preferences: Preferences,
        notices: Notices,
        files: CaptureService,
        editing: Hides,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._selection, self._wake = session, selection, wake
        self._preferences, self._notices, self._files, self._editing = preferences, notices, files, editing
        self.level = Level.OBJECTS
        self.orders = {
            Level.OBJECTS: Order(column="pixels", descending=True),
            Level.PRIMITIVES: Order(column="pixels", descending=True),
        }
        self.all_lights = self.visible = self.held = self._watched = False
        self._saves = False  # whether the table is to be saved as soon as it is that of the edited scene
        self.chosen = 0  # the serial of the selection that was made here last, or has been shown
        self._source: _Source | None = None  # the newest
        self._made: dict[Level, _Made] = {}
        self._job: Job[_Made] | None = None
        self._asked: tuple[_Source, Level, Order] | None = None  # what the newest job was started for
        self._failed: tuple[_Source, Level, Order] | None = None  # what could not be made, and is not tried again
        self._told = ""  # and why

    @property
    def listing(self) -> Listing | None:
        """What is known of the level that is looked at; None while nothing is."""
        made = self._made.get(self.level)
        return None if made is None else made.listing

    @property
    def order(self) -> Order:
        return self.orders[self.level]

    @property
    def busy(self) -> bool:
        """Whether newer rows are on their way."""
        return self._job is not None

    # --- what the user does ----------------------------------------------------------------------

    def filter(self, text: str) -> None:
        """Show the rows that this finds."""
        self.orders[self.level] = Order(text, self.order.column, self.order.descending)

    def sort(self, column: str, descending: bool) -> None:
        """Sort by a column."""
        self.orders[self.level] = Order(self.order.text, column, descending)

    def open_part(self, part: int) -> None:
        """List the primitives of a part."""
        original = self._session.original
        if original is not None:
            self.level = Level.PRIMITIVES
            self.filter(f"object={quoted(parts_of(original).names[part])}")

    def select(self, row: int) -> None:
        """Select a row's object or primitive in the picture."""
        selection = self._selection
        done = selection.select_part(row) if self.level is Level.OBJECTS else selection.select_primitive(row)
        if not done:
            self._notices.say("it is hidden" if self.is_hidden(row) else "it is not in the scene at this time")
        self.chosen = selection.serial

    @property
    def selected(self) -> int:
        """The row of what is selected in the picture, -1 for none."""
        picked, now = self._selection.picked, self._session.edited
        if picked is None or now is None or not 0 <= picked.primitive < len(now.primitives):
            return -1
        number = int(now.primitives[picked.primitive])
        return int(parts_of(now.original).part_of[number]) if self.level is Level.OBJECTS else number

    def is_hidden(self, row: int) -> bool:
        """Whether a row's object or primitive is hidden, or is to be."""
        edits, original = self._session.edits, self._session.original
        if original is None:
            return False
        parts = parts_of(original)
        part = row if self.level is Level.OBJECTS else int(parts.part_of[row])
        return parts.names[part] in edits.hidden or (self.level is Level.PRIMITIVES and row in edits.hidden_primitives)

    def hide(self, row: int, hidden: bool = True) -> None:
        """Hide a row's object or primitive, or show it again, with the object that it belongs to."""
        original = self._session.original
        if original is None:
            return
        parts = parts_of(original)
        if self.level is Level.OBJECTS:
            (self._editing.hide if hidden else self._editing.show)(parts.names[row])
            return
        if not hidden:
            self._editing.show(parts.names[int(parts.part_of[row])])
        self._editing.hide_primitive(row, hidden)

    @property
    def selection_serial(self) -> int:
        """The number of the newest selection, here or in the picture."""
        return self._selection.serial

    def place_of(self, row: int) -> int | None:
        """How many rows are seen above a row; None where it is not among them."""
        listing = self.listing
        if listing is None or row < 0:
            return None
        found = np.flatnonzero(listing.rows == row)
        return int(found[0]) if len(found) else None

    def save(self) -> None:
        """Write the rows that are seen as CSV into the folder of the pictures, once they are those of the scene as it
        is edited."""
        if self.listing is None or self._session.scene is None:
            self._notices.say("there is no table yet: open the panel Find")
        elif self._is_stale:
            self._saves = True
            self._notices.say("the table will be saved when the picture shows the edited scene")
        else:
            self._write()

    @property
    def _is_stale(self) -> bool:
        """Whether rows are of the scene before it was edited, or not in the order that is asked for."""
        made, edited = self._made.get(self.level), self._session.edited
        if made is None or edited is not made.source.now or self._session.edits != made.source.now.edits:
            return True
        return made.listing.order != self.order or not made.in_order

    def _write(self) -> None:
        self._saves = False
        listing, scene = self.listing, self._session.scene
        if listing is None or scene is None:
            return
        name = f"{scene.path.stem}-{listing.table.level.value.lower()}"

        folder, table, rows = self._preferences.picture_folder, listing.table, listing.rows
        self._files.write(lambda: exports.save(folder, name, ".csv", lambda path: write_rows(table, rows, path)))

    # --- one frame of the window -----------------------------------------------------------------

    def watch(self) -> None:
        """Somebody looks at the table in this frame of the window."""
        self._watched = True

    def update(self, traced: Traced | None, moving: bool) -> None:
        """Take up what has been made, and have made what is missing; `traced` is the newest picture, None where it is
        none of the session's, and `moving` says that another follows soon."""
        self.visible, self._watched = self._watched, False
        self._session.counting = self.visible
        now = self._session.edited
        if self._source is not None and (now is None or self._source.now.original is not now.original):
            self._source, self._made = None, {}
        if self._job is not None and self._job.done:
            self._take(self._job)
            self._job = None
        if self._saves and (not self.visible or not self._is_stale):
            self._write()
        if not self.visible or now is None or self._job is not None:
            return
        if traced is not None and traced.whole and traced.request.divisor == 1:
            newest = _Source(now, traced.frame, None if self.all_lights else self._session.light)
            if self._source is None or not newest.is_like(self._source):
                self._source = newest
        asked = None if self._source is None else (self._source, self.level, self.order)
        if asked is not None and asked != self._failed and self._lacks(asked[0], self.held or moving):
            self._start(*asked, self.held or moving)

    def _lacks(self, source: _Source, stays: bool) -> bool:
        """Whether the listing is not that of the newest picture, or not in order though its rows need not stay."""
        made = self._made.get(self.level)
        if made is None or made.source is not source or made.listing.order != self.order:
            return True
        return not made.in_order and not stays

    def _start(self, source: _Source, level: Level, order: Order, stays: bool) -> None:
        before = self.listing
        known = next((made.tables for made in self._made.values() if made.source is source), None)

        def work(_: Progress) -> _Made:
            tables = known or tables_of(source.now, source.frame, source.light)
            table = tables[level]
            if stays and before is not None and before.order == order and before.table.rows == table.rows:
                if len(before.rows):
                    return _Made(source, tables, Listing(table, before.rows, order, before.problem), False)
            return _Made(source, tables, listed(table, order, before), True)

        self._asked, self._job = (source, level, order), Job("The table", work, self._wake)

    def _take(self, job: Job[_Made]) -> None:
        if job.failure is not None:
            self._failed = self._asked
            if job.failure.text != self._told:  # once, while pictures come that it fails for alike
                self._notices.report(job.failure)
            self._told = job.failure.text
        made = job.result
        if made is not None and self._source is not None and made.source.now.original is self._source.now.original:
            self._failed, self._told = None, ""
            self._made[made.listing.table.level] = made
