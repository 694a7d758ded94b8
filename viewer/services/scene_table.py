"""The table of objects and primitives: what the newest whole picture knows of each, filtered and in order.

All of it is worked out on a thread of its own, and only while somebody looks at the table; the window never waits.
What is typed or clicked takes effect at once, and a newer picture of the same scene as soon as the pointer is not on
the table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tracer.editing.edits import Edited
from tracer.frame import Frame
from tracer.scene.model import Progress
from viewer.output import exports
from viewer.services.capture_service import CaptureService
from viewer.services.editing import Editing
from viewer.services.inspector import Selection
from viewer.services.jobs import Job
from viewer.services.render_request import Traced, is_same_picture
from viewer.state.notices import Notices
from viewer.state.parts import parts_of
from viewer.state.preferences import Preferences
from viewer.state.row_filter import FilterError, Order, listed
from viewer.state.scene_rows import Level, Table, tables_of
from viewer.state.session import Session


@dataclass(frozen=True, eq=False)
class Source:
    """What tables are made of; shadow modes are those for `light`."""

    now: Edited
    frame: Frame
    light: int

    @cached_property
    def tables(self) -> dict[Level, Table]:
        """Both tables, made by the first job that asks."""
        return tables_of(self.now, self.frame, self.light)


@dataclass(frozen=True, eq=False)
class Listing:
    """A table, and the numbers of its rows that are seen, in their order, (rows,) int32; where the filter is not
    understood, `problem` says why, and the rows are those of before."""

    source: Source
    table: Table
    rows: NDArray[np.int32]
    order: Order
    problem: str = ""


class SceneTable:
    """`level` is what rows are, `orders` what is asked of each level; where the pointer is on the table (`pointed_at`),
    rows must not move."""

    def __init__(
        self, session: Session, selection: Selection, preferences: Preferences, notices: Notices,
        files: CaptureService, editing: Editing, wake: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        self.selection, self._session, self._wake = selection, session, wake
        self._preferences, self._notices, self._files, self._editing = preferences, notices, files, editing
        self.level = Level.OBJECTS
        self.orders = dict.fromkeys(Level, Order(column="pixels", descending=True))
        self.visible = self.pointed_at = self._watched = False
        self._source: Source | None = None
        self._listings: dict[Level, Listing] = {}
        self._job: Job[Listing] | None = None
        self._asked: object = None  # what the newest job was started for; where it fails, it is not tried again

    @property
    def listing(self) -> Listing | None:
        """What is known of the level that is looked at; None while nothing is."""
        return self._listings.get(self.level)

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
        self.orders[self.level] = replace(self.order, text=text)

    def sort(self, column: str, descending: bool) -> None:
        """Sort by a column."""
        self.orders[self.level] = replace(self.order, column=column, descending=descending)

    def open_part(self, part: int) -> None:
        """List the primitives of a part."""
        original = self._session.original
        if original is not None:
            self.level = Level.PRIMITIVES
            name = parts_of(original).names[part].replace('"', "")
            self.filter(f'object="{name}"')

    def select(self, row: int) -> None:
        """Select a row's object or primitive in the picture."""
        selection = self.selection
        done = selection.select_part(row) if self.level is Level.OBJECTS else selection.select_primitive(row)
        if not done:
            self._notices.say(
                "it is hidden: its eye shows it again" if self.is_hidden(row) else "it has no place at this time"
            )

    @property
    def selected(self) -> int:
        """The row of what is selected in the picture, -1 for none."""
        picked, now = self.selection.picked, self._session.edited
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
        """The name of a row's object; a scene must be open."""
        assert self._session.original is not None
        parts = parts_of(self._session.original)
        return parts.names[row if self.level is Level.OBJECTS else int(parts.part_of[row])]

    def save(self) -> None:
        """Write the rows that are seen as CSV into the folder of the pictures."""
        listing, scene = self.listing, self._session.scene
        if listing is None or scene is None:
            self._notices.say("there is no table yet: open the panel Find")
        elif self._session.edits != listing.source.now.edits or listing.order != self.order:
            self._notices.say("the table is not up to date yet: save it when the picture shows the edited scene")
        else:
            folder, name = self._preferences.picture_folder, f"{scene.path.stem}-{self.level.value.lower()}"
            write = lambda path: exports.write_rows(listing.table, listing.rows, path)  # noqa: E731
            self._files.write(lambda: exports.save(folder, name, ".csv", write))

    # --- one frame of the window -----------------------------------------------------------------

    def watch(self) -> None:
        """Somebody looks at the table in this frame of the window."""
        self._watched = True

    def update(self, traced: Traced | None) -> None:
        """Take up what has been made, and have made what is missing; `traced` is the newest picture, None where it is
        none of the session's."""
        self.visible, self._watched = self._watched, False
        self._session.counting = self.visible
        now = self._session.edited
        if self._source is not None and (now is None or self._source.now.original is not now.original):
            self._source, self._listings = None, {}
        if self._job is not None and self._job.done:
            made, failure, self._job = self._job.result, self._job.failure, None
            if failure is not None:
                self._notices.report(failure)
            if made is not None and self._source is not None and made.source.now.original is self._source.now.original:
                self._listings[made.table.level] = made
        if not self.visible or now is None or self._job is not None:
            return
        light, last = self._session.draw.light, self._source
        if traced is not None and traced.complete:
            frame, same = traced.frame, last is not None and last.now is now and last.light == light
            # Further samples of a picture count wrong answers only.
            stays = self.pointed_at or (last and is_same_picture(last.frame, frame) and last.frame.wrong is frame.wrong)
            if not (same and stays):
                self._source = Source(now, frame, light)
        if self._source is not None:
            self._make(self._source)

    def _make(self, source: Source) -> None:
        """Have a listing made, unless this is what was asked for last."""
        level, order, before = self.level, self.order, self.listing
        asked = source, level, order
        if asked == self._asked:
            return

        def work(_: Progress) -> Listing:
            table = source.tables[level]
            try:
                return Listing(source, table, listed(table, order), order)
            except FilterError as error:
                rows = before.rows if before is not None else np.arange(table.rows, dtype=np.int32)
                return Listing(source, table, rows, order, str(error))

        self._asked, self._job = asked, Job("The table", work, self._wake)
