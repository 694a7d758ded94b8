"""The picture before the edits, kept to compare what is shown with it."""

from __future__ import annotations

from enum import Enum

from tracer.frame import Frame
from tracer.scene.edits import NO_EDITS, Edited, Edits
from viewer.services.editing import Editing
from viewer.services.undo import Undo
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

    def __init__(self, session: Session, editing: Editing, undo: Undo) -> None:
        self._session, self._editing, self._undo = session, editing, undo
        self._kept: dict[int, Frame] = {}  # by samples of a pixel: all of one moment, place and size
        self._of: Edited | None = None
        self._now: Frame | None = None
        self._put_aside: Edits | None = None  # until a picture without them has come
        self._found: tuple[Frame, Frame, Effects] | None = None

    def forget(self) -> None:
        """Another scene is open."""
        self._kept, self._of, self._now, self._put_aside, self._found = {}, None, None, None, None

    def follow(self, whole: Frame | None, settled: bool) -> None:
        """Take up the newest whole frame, None where that is not of what is wanted; `settled` says that no better one
        is to come."""
        edited = self._session.edited
        self._now = whole if edited is not None and not self._editing.under_way else None
        if self._now is None or edited is None:
            return
        if edited.edits:
            self._put_aside = None  # somebody has brought them back, or made others
        else:
            if any(not same_place(kept, self._now) for kept in self._kept.values()):
                self._kept = {}
            self._kept[self._now.settings.samples], self._of = self._now, edited
            if self._put_aside is not None and settled:
                edits, self._put_aside = self._put_aside, None
                self._undo.overlook(lambda: self._editing.change(edits))

    def take_anew(self) -> None:
        """Put the edits aside until a picture without them has come from here."""
        if self._session.edits and self._put_aside is None:
            self._put_aside = self._session.edits
            self._undo.overlook(lambda: self._editing.change(NO_EDITS))

    @property
    def taking(self) -> bool:
        """Whether the edits are put aside for a moment."""
        return self._put_aside is not None

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
