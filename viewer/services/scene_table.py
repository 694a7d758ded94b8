"""The table of objects and primitives: what the newest whole picture knows of each, filtered and in order.

All of it is worked out on a thread of its own, and only while somebody looks at the table; the window never waits.
What is typed or clicked takes effect at once.  A newer picture brings newer numbers at once, but the rows stay in their
places while the pointer is on them or something moves, and those that stand equal keep their order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tracer.frame import Frame
from tracer.scene.edits import Edited
from tracer.scene.model import Progress
from viewer.output import exports
from viewer.services.capture_service import CaptureService
from viewer.services.editing import Editing
from viewer.services.jobs import Job
from viewer.services.render_request import Traced
from viewer.services.selection import Selection
from viewer.state.notices import Notices
from viewer.state.parts import parts_of
from viewer.state.preferences import Preferences
from viewer.state.row_filter import Listing, Order, listed
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
        editing: Editing,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self._session, self._selection, self._wake = session, selection, wake
        self._preferences, self._notices, self._files, self._editing = preferences, notices, files, editing
        self.level = Level.OBJECTS
        self.orders = dict.fromkeys(Level, Order(column="pixels", descending=True))
        self.all_lights = self.visible = self.held = self._watched = False
        self.chosen = 0  # the serial of the selection that was made here last, or has been shown
        self._source: _Source | None = None  # the newest
        self._made: dict[Level, _Made] = {}
        self._job: Job[_Made] | None = None
        self._asked: object = None  # what the newest job was started for; where it fails, it is not tried again
        self._told = ""  # why the last has failed

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
            name = parts_of(original).names[part].replace('"', "")
            self.filter(f'object="{name}"')

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
        edits, by_number = self._session.edits, self.level is Level.PRIMITIVES
        return self._object_of(row) in edits.hidden or (by_number and row in edits.hidden_primitives)

    def hide(self, row: int, hidden: bool = True) -> None:
        """Hide a row's object or primitive, or show it again, with the object that it belongs to."""
        edits = self._editing.now
        if self.level is Level.OBJECTS or not hidden:
            edits = edits.with_thing(self._object_of(row), not hidden)
        if self.level is Level.PRIMITIVES:
            edits = edits.with_primitive(row, not hidden)
        self._editing.change(edits)

    def _object_of(self, row: int) -> str:
        """The name of a row's object, "" where no scene is open."""
        original = self._session.original
        if original is None:
            return ""
        parts = parts_of(original)
        return parts.names[row if self.level is Level.OBJECTS else int(parts.part_of[row])]

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
        """Write the rows that are seen as CSV into the folder of the pictures."""
        made, scene = self._made.get(self.level), self._session.scene
        if made is None or scene is None:
            self._notices.say("there is no table yet: open the panel Find")
        elif self._session.edits != made.source.now.edits or made.listing.order != self.order or not made.in_order:
            self._notices.say("the table is not up to date yet: save it when the picture shows the edited scene")
        else:
            table, rows, folder = made.listing.table, made.listing.rows, self._preferences.picture_folder
            name = f"{scene.path.stem}-{table.level.value.lower()}"
            self._files.write(
                lambda: exports.save(folder, name, ".csv", lambda path: exports.write_rows(table, rows, path))
            )

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
        if not self.visible or now is None or self._job is not None:
            return
        if traced is not None and traced.whole and traced.request.divisor == 1:
            newest = _Source(now, traced.frame, None if self.all_lights else self._session.draw.light)
            if self._source is None or not newest.is_like(self._source):
                self._source = newest
        if self._source is not None:
            self._make(self._source, self.held or moving)

    def _make(self, source: _Source, stays: bool) -> None:
        """Have a listing made, unless it is there or has failed: in order, or, where rows `stay`, as they are."""
        level, order, made, before = self.level, self.order, self._made.get(self.level), self.listing
        done = made is not None and made.source is source and made.listing.order == order
        asked = (source, level, order, stays)
        if asked == self._asked or (done and made is not None and (made.in_order or stays)):
            return
        known = next((one.tables for one in self._made.values() if one.source is source), None)

        def work(_: Progress) -> _Made:
            tables = known or tables_of(source.now, source.frame, source.light)
            table = tables[level]
            if stays and before is not None and before.order == order and before.table.rows == table.rows:
                if len(before.rows):
                    return _Made(source, tables, Listing(table, before.rows, order, before.problem), False)
            return _Made(source, tables, listed(table, order, before), True)

        self._asked, self._job = asked, Job("The table", work, self._wake)

    def _take(self, job: Job[_Made]) -> None:
        if job.failure is not None:
            if job.failure.text != self._told:  # once, while pictures come that it fails for alike
                self._notices.report(job.failure)
            self._told = job.failure.text
        made = job.result
        if made is not None and self._source is not None and made.source.now.original is self._source.now.original:
            self._told = ""
            self._made[made.listing.table.level] = made
