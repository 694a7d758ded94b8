"""Places to come back to: kept in the preferences, for each scene its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from viewer.services.settings_controller import SettingsController
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session, Snapshot


class Bookmarks:
    """`all` lists the bookmarks of the open scene."""

    def __init__(
        self, session: Session, preferences: Preferences, settings: SettingsController, notices: Notices
    ) -> None:
        self._session, self._preferences, self._settings, self._notices = session, preferences, settings, notices

    @property
    def all(self) -> list[dict]:
        """{"name": ..., "state": a snapshot's JSON} for each."""
        scene = self._session.scene
        if scene is None:
            return []
        return self._preferences.bookmarks.setdefault(str(Path(scene.path).absolute()), [])

    def add(self, name: str = "") -> None:
        """Remember where we are now."""
        if self._session.scene is None:
            return
        name = name.strip() or f"frame {self._session.frame}"
        self.all.append({"name": name, "state": self._session.snapshot().to_json()})
        self._settings.save()
        self._notices.say(f"bookmarked as {name!r}")

    def forget(self, index: int) -> None:
        del self.all[index]
        self._settings.save()

    def find(self, index: int) -> Snapshot | None:
        """Time, camera and view of a bookmark, without settings; None, and one line, where it is damaged."""
        try:
            return replace(Snapshot.from_json(self.all[index]["state"]), settings={})
        except (ValueError, KeyError, TypeError, IndexError) as error:
            self._notices.say(f"this bookmark is damaged: {error}", error=True)
            return None
