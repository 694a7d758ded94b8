"""Changes of settings, view and light: checked, put into the session, and remembered."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection
from copy import deepcopy
from dataclasses import asdict, replace
from typing import Any

from tracer.method import Method
from viewer.state.methods import NO_CULLING, with_additions
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences, save_preferences
from viewer.state.session import Session
from viewer.state.views import View

RESTED = 2.0
"""Seconds that preferences are as they are before they are saved."""


class SettingsController:
    """Settings stay as they are while `locked()`, which says so itself."""

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices, locked: Callable[[], bool]
    ) -> None:
        self._session, self._preferences, self._notices, self._locked = session, preferences, notices, locked
        self._stored = self._tried = asdict(preferences)  # as others have seen them; what could not be stored, too
        self._looked = time.monotonic()
        self._seen: dict[str, Any] = {}
        self._problem: str | None = None
        self._told: str | None = None
        self._writer: threading.Thread | None = None

    def change(self, **changes: Any) -> None:
        """Change fields of `tracer.Settings`; a value that is no good is reported in one line and changes nothing."""
        if self._locked():
            return
        try:
            settings = replace(self._session.settings, **changes)
            settings.validated()
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        self._session.settings = settings
        self._preferences.keep(settings)

    def set_view(self, view: View) -> None:
        self._session.view = view
        self._preferences.view = view.value

    def set_light(self, light: int) -> None:
        """Choose the light of the views that show one; past the last comes the first."""
        lights = len(self._session.scene.lights) if self._session.scene is not None else 0
        self._session.light = light % lights if lights else 0

    def toggle_culling(self) -> None:
        """Off, and on again."""
        self.change(method=self.switched_off or NO_CULLING)

    @property
    def switched_off(self) -> str:
        """The method that comes back when culling is turned on: that which culled last, with what was added to it while
        it was off; nothing while it is on."""
        now = Method.parse(self._session.settings.method)
        return "" if now.culls else with_additions(self._preferences.method, now.additions)

    def reset(self, kept: Collection[str]) -> None:
        """Set everything to its default, except these fields of the preferences."""
        if self._locked():
            return
        self._preferences.reset(kept)
        self._session.settings = self._preferences.settings()
        self._session.view = self._preferences.chosen_view()
        self.save()
        self._notices.say("settings reset")

    def save(self) -> None:
        """Write the preferences to their file, beside what other windows have written; a failure is reported in one
        line."""
        if self._writer is not None:
            self._writer.join()
        self._write(deepcopy(self._preferences))
        self._told = self._problem
        if self._problem:
            self._notices.say(self._problem, error=True)

    def follow(self) -> None:
        """Save, on a thread, what was changed and has rested for a moment, so that little is lost with the program; a
        failure is reported once."""
        now = time.monotonic()
        if now < self._looked + RESTED or (self._writer is not None and self._writer.is_alive()):
            return
        if self._problem and self._problem != self._told:
            self._notices.say(self._problem, error=True)
        self._told = self._problem
        self._looked, before, self._seen = now, self._seen, asdict(self._preferences)
        if self._seen == before and self._seen != self._tried:
            self._writer = threading.Thread(target=self._write, args=(deepcopy(self._preferences),), name="saving")
            self._writer.start()

    def _write(self, preferences: Preferences) -> None:
        self._tried = asdict(preferences)
        self._problem = save_preferences(preferences, base=self._stored)
        if self._problem is None:
            self._stored = self._tried
