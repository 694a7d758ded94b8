"""Places to come back to: kept in the preferences, for each scene its own, with a small picture of each."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tracer.frame import Frame
from viewer.output.thumbnail import as_text, from_text, thumbnail
from viewer.services.settings_controller import SettingsController
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session, Snapshot

LONGEST_NAME = 80


class Bookmarks:
    """`all` lists the bookmarks of the open scene."""

    def __init__(
        self, session: Session, preferences: Preferences, settings: SettingsController, notices: Notices
    ) -> None:
        self._session, self._preferences, self._settings, self._notices = session, preferences, settings, notices
        self._unpictured: list[dict] = []  # bookmarks whose own picture has not come yet

    @property
    def all(self) -> list[dict]:
        """{"name": ..., "state": a snapshot's JSON, "picture": a small JPEG as text, if there is one} for each."""
        scene = self._session.scene
        if scene is None:
            return []
        return self._preferences.bookmarks.setdefault(str(Path(scene.path).absolute()), [])

    def add(self, name: str = "") -> None:
        """Remember where we are now; its picture is taken of the next whole frame from there."""
        if self._session.scene is None:
            return
        name = _tidy(name) or self._new_name()
        mark = {"name": name, "state": self._session.snapshot().to_json()}
        self.all.append(mark)
        self._unpictured.append(mark)
        self._settings.save()
        self._notices.say(f"bookmarked as {name!r}")

    def replace(self, index: int) -> None:
        """Let a bookmark stand for where we are now."""
        mark = self.all[index]
        mark["state"] = self._session.snapshot().to_json()
        mark.pop("picture", None)
        self._unpictured.append(mark)
        self._settings.save()
        self._notices.say(f"{mark.get('name', '?')!r} is this place now")

    def rename(self, index: int, name: str) -> None:
        """Give a bookmark another name; without one it keeps its own."""
        if _tidy(name):
            self.all[index]["name"] = _tidy(name)
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

    def find(self, index: int) -> Snapshot | None:
        """Time, camera and view of a bookmark, without settings and edits; None, and one line, where it is damaged."""
        try:
            found = Snapshot.from_json(self.all[index]["state"])
            return replace(found, settings={}, edits=self._session.edits)
        except (ValueError, KeyError, TypeError, IndexError) as error:
            self._notices.say(f"this bookmark is damaged: {error}", error=True)
            return None

    def follow(self, frame: Frame, whole: bool) -> None:
        """Take the pictures that are wanted, where this frame shows their places."""
        if not whole or not self._unpictured:
            return
        session = self._session
        if frame.camera != session.camera or frame.time != session.time:
            return
        here = session.snapshot().to_json()
        shown = [mark for mark in self._unpictured if _same_place(mark.get("state"), here)]
        # What was left before its picture came is pictured when somebody comes back to it.
        self._unpictured = [mark for mark in self._unpictured if not any(mark is done for done in shown)]
        if shown:
            picture = as_text(thumbnail(frame.color))
            for mark in shown:
                mark["picture"] = picture
            self._settings.save()

    def arrived(self, index: int) -> None:
        """Somebody goes to a bookmark: one without a picture gets one there."""
        if 0 <= index < len(self.all) and from_text(self.all[index].get("picture")) is None:
            self._unpictured.append(self.all[index])

    def _new_name(self) -> str:
        """The frame's number where something moves, else the next number; with another number if it is taken."""
        session = self._session
        base = f"frame {session.frame}" if session.animated else f"place {len(self.all) + 1}"
        taken = {mark.get("name") for mark in self.all}
        return next(n for n in (base, *(f"{base} ({k})" for k in range(2, len(taken) + 3))) if n not in taken)


def _same_place(one: object, other: dict) -> bool:
    return isinstance(one, dict) and all(one.get(name) == other[name] for name in ("scene", "time", "camera"))


def _tidy(name: str) -> str:
    return " ".join(name.split())[:LONGEST_NAME]
