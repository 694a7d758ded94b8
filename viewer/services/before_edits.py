"""The picture before the edits, kept to compare what is shown with it."""

from __future__ import annotations

from enum import Enum

from tracer.frame import Frame
from tracer.scene.edits import NO_EDITS, Edited
from viewer.services.editing import Editing
from viewer.state.edit_effects import Effects, effects, same_place
from viewer.state.session import Session


class Lack(Enum):
    """Why nothing can be compared now."""

    NONE = ""
    NO_EDITS = "Nothing is edited."
    NO_FRAME = "The picture is being traced."
    ELSEWHERE = "There is no picture without the edits from here, at this time and in this size."


class BeforeEdits:
    """Keeps whole frames of the scene as it was read; `effects` compares the newest frame with them."""

    def __init__(self, session: Session, editing: Editing) -> None:
        self._session, self._editing = session, editing
        self.forget()

    def forget(self) -> None:
        """Another scene is open."""
        self._kept: dict[int, Frame] = {}  # by samples of a pixel: all of one moment, place and size
        self._of: Edited | None = None
        self._now: Frame | None = None
        self._edits = NO_EDITS  # those that are put aside
        self._found: tuple[Frame, Frame, Effects] | None = None

    def take(self, whole: Frame | None, settled: bool) -> None:
        """Take up the newest whole frame, None where that is not of the scene as it is edited now; `settled` says that
        no better one is to come."""
        session, editing, edited = self._session, self._editing, self._session.edited
        if session.edits != self._edits:
            editing.put_aside = False  # somebody wants others
        self._now = whole if not editing.under_way else None
        if whole is None or edited is None or edited.edits:
            return
        if any(not same_place(kept, whole) for kept in self._kept.values()):
            self._kept = {}
        self._kept[whole.settings.samples], self._of = whole, edited
        if settled:
            editing.put_aside = False

    def take_anew(self) -> None:
        """Put the edits aside until a picture without them has come from here, or other edits are wanted."""
        if self._session.edits:
            self._edits = self._session.edits
            self._editing.show_without()

    @property
    def taking(self) -> bool:
        """Whether the edits are put aside for a moment."""
        return self._editing.put_aside

    @property
    def lack(self) -> Lack:
        """Why there is nothing to compare."""
        if not self._session.edits:
            return Lack.NO_EDITS
        if self._now is None:
            return Lack.NO_FRAME
        return Lack.NONE if self._reference is not None else Lack.ELSEWHERE

    @property
    def _reference(self) -> Frame | None:
        """The kept frame that is most like the newest: of as many samples, if there is one."""
        now = self._now
        if now is None or not self._kept:
            return None
        found = self._kept.get(now.settings.samples) or next(iter(self._kept.values()))
        return found if same_place(found, now) else None

    @property
    def frame(self) -> Frame | None:
        """The newest frame, where it can be compared."""
        return self._now if self.lack is Lack.NONE else None

    @property
    def effects(self) -> Effects | None:
        """What has changed; None where there is nothing to compare (`lack`)."""
        before, now, edited = self._reference, self._now, self._session.edited
        if self.lack is not Lack.NONE or before is None or now is None or edited is None or self._of is None:
            return None
        if self._found is None or self._found[0] is not before or self._found[1] is not now:
            self._found = before, now, effects(before, self._of, now, edited)
        return self._found[2]
