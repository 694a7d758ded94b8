"""What became of the rays of the pixel that was clicked.

The rays come with the reasons that the pixel's inspector has.  They are listed only while somebody looks."""

from __future__ import annotations

from tracer.frame import Frame
from tracer.told_rays import RayTree
from viewer.output.ray_rows import Filter, Key, RayRows, Row, unfolded
from viewer.services.pixel_inspector import PixelInspector
from viewer.services.selection import Selection
from viewer.state.session import Session


class RayInspector:
    """`tree` is what is known of the clicked pixel's rays, and `rows` lists it, None while nothing is.  `shown` says
    which shadow rays are to be seen, `pointed` is the row that the pointer is on."""

    def __init__(self, session: Session, selection: Selection, inspector: PixelInspector) -> None:
        self._session, self._selection, self._inspector = session, selection, inspector
        self._watched = self.visible = False
        self.shown = Filter()
        self.pointed: Row | None = None
        self._forget()

    def _forget(self) -> None:
        self.tree: RayTree | None = None
        self.rows: RayRows | None = None
        self._toggled: set[Key] = set()
        self._selected: Key | None = None
        self._listed: list[tuple[int, Row]] | None = None

    def watch(self) -> None:
        """Somebody looks at the rays in this frame of the window."""
        self._watched = True

    def update(self, frame: Frame | None) -> None:
        """Take up the rays that are known of the clicked pixel, if somebody looks; `frame` is the newest, None where
        nothing may be asked."""
        self.visible, self._watched = self._watched, False
        if self._selection.picked is None or frame is None:
            self._forget()
        elif self.visible:
            why = self._inspector.answer.why if self._inspector.answer is not None else None
            if why is not None and why.tree is not None and why.tree is not self.tree:
                self.tree = why.tree
                self.refilter(self.shown)
            then = self.tree.frame if self.tree is not None else frame
            if then.time != frame.time or then.settings.method != frame.settings.method:
                self.tree = self.rows = self._listed = None

    def refilter(self, shown: Filter) -> None:
        """Show these shadow rays."""
        self.shown, scene = shown, self._session.scene
        self.rows = RayRows(self.tree, scene, shown) if self.tree is not None and scene is not None else None
        self._listed = None

    @property
    def seen(self) -> list[tuple[int, Row]]:
        """The rows that are seen, with their levels."""
        if self._listed is None:
            self._listed = [] if self.rows is None else list(unfolded(self.rows.top, self.is_open))
        return self._listed

    def is_open(self, row: Row) -> bool:
        """Whether what is below a row is seen: at first, what is below rays on their way."""
        return (len(row.places) == 0) != (row.key in self._toggled)

    def toggle(self, row: Row) -> None:
        """Fold or unfold a row."""
        self._toggled ^= {row.key}
        self._listed = None

    @property
    def selected(self) -> Row | None:
        """The selected row, None where it is not seen."""
        return next((row for _, row in self.seen if row.key == self._selected), None)

    def select(self, row: Row | None) -> None:
        """Select a row, or none."""
        self._selected = None if row is None else row.key
