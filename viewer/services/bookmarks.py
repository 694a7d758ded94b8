"""Places to come back to: kept in the preferences, for each scene its own, with a small picture of each."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tracer.frame import Frame
from viewer.output.thumbnail import as_text, from_text, thumbnail
from viewer.services.settings_controller import SettingsController
from viewer.state import codec
from viewer.state.notices import Notices
from viewer.state.preferences import Bookmark, Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState

LONGEST_NAME = 80


class Bookmarks:
    """`all` lists the bookmarks of the open scene."""

    def __init__(
        self, session: Session, preferences: Preferences, settings: SettingsController, notices: Notices
    ) -> None:
        self._session, self._preferences, self._settings, self._notices = session, preferences, settings, notices
        self._unpictured: list[Bookmark] = []  # whose own picture has not come yet

    @property
    def all(self) -> list[Bookmark]:
        scene = self._session.scene
        if scene is None:
            return []
        return self._preferences.bookmarks.setdefault(str(Path(scene.path).absolute()), [])

    def add(self, name: str = "") -> None:
        """Remember where we are now; its picture is taken of the next whole frame from there."""
        if self._session.scene is None:
            return
        mark = Bookmark(_tidy(name) or self._new_name(), codec.state_to_json(self._session.state))
        self.all.append(mark)
        self._unpictured.append(mark)
        self._settings.save()
        self._notices.say(f"bookmarked as {mark.name!r}")

    def replace(self, index: int) -> None:
        """Let a bookmark stand for where we are now."""
        mark = self.all[index]
        mark.state, mark.picture = codec.state_to_json(self._session.state), ""
        self._unpictured.append(mark)
        self._settings.save()
        self._notices.say(f"{mark.name!r} is this place now")

    def rename(self, index: int, name: str) -> None:
        """Give a bookmark another name; without one it keeps its own."""
        if _tidy(name):
            self.all[index].name = _tidy(name)
            self._settings.save()

    def move(self, index: int, to: int) -> None:
        """Bring a bookmark to another place in the list, and so to another key."""
        marks = self.all
        marks.insert(min(max(to, 0), len(marks) - 1), marks.pop(index))
        self._settings.save()

    def forget(self, index: int) -> None:
        gone = self.all.pop(index)
        self._unpictured = [mark for mark in self._unpictured if mark is not gone]
        self._settings.save()

    def find(self, index: int) -> ViewState | None:
        """Return the state of now with a bookmark's time, camera and view; None, and one line, where it is damaged."""
        here = self._session.state
        try:
            found = codec.state_from_json(self.all[index].state, here)
        except (ValueError, IndexError) as error:
            self._notices.say(f"this bookmark is damaged: {error}", error=True)
            return None
        draw = found.draw
        return replace(here, time=found.time, camera=found.camera).with_draw(
            view=draw.view, light=draw.light, wipe=draw.wipe, tone=draw.tone, spans=draw.spans, slice=draw.slice
        )

    def take_pictures(self, frame: Frame) -> None:
        """Take the pictures that are wanted, where this whole frame shows their places."""
        here = self._session.state
        if not self._unpictured or frame.camera != self._session.camera or frame.time != here.time:
            return
        shown = [mark for mark in self._unpictured if _same_place(mark, here)]
        # What was left before its picture came is pictured when somebody comes back to it.
        self._unpictured = [mark for mark in self._unpictured if not any(mark is done for done in shown)]
        if shown:
            picture = as_text(thumbnail(frame.color))
            for mark in shown:
                mark.picture = picture
            self._settings.save()

    def arrived(self, index: int) -> None:
        """Note that somebody goes to a bookmark: one without a picture gets one there."""
        if 0 <= index < len(self.all) and from_text(self.all[index].picture) is None:
            self._unpictured.append(self.all[index])

    def _new_name(self) -> str:
        """The frame's number where something moves, else the next number; with another number if it is taken."""
        session = self._session
        base = f"frame {session.frame}" if session.animated else f"place {len(self.all) + 1}"
        taken = {mark.name for mark in self.all}
        return next(n for n in (base, *(f"{base} ({k})" for k in range(2, len(taken) + 3))) if n not in taken)


def _same_place(mark: Bookmark, here: ViewState) -> bool:
    try:
        state = codec.state_from_json(mark.state)
    except ValueError:
        return False
    return (state.scene, state.time, state.camera) == (here.scene, here.time, here.camera)


def _tidy(name: str) -> str:
    return " ".join(name.split())[:LONGEST_NAME]
