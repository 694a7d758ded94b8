"""Changes of settings, checked, and the file in which the person's choices are kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from tracer.method import Method
from tracer.util.setting import Setting
from viewer.state import codec
from viewer.state.methods import NO_CULLING, with_additions
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences, save_preferences
from viewer.state.session import Session

SAVED_EVERY = 2.0
"""Seconds, where preferences have changed."""


class SettingsController:
    """Settings of tracing stay as they are while `locked()`, which says so itself."""

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices, locked: Callable[[], bool]
    ) -> None:
        self._session, self._preferences, self._notices, self._locked = session, preferences, notices, locked
        self._stored = self._tried = self._now()  # as others have seen them; what could not be stored, too
        self._looked = time.monotonic()
        self._thread = ThreadPoolExecutor(1, "shadowcull preferences")
        self._writing: Future[None] | None = None

    def set(self, one: Setting, value: Any) -> None:
        """Change a setting of the state or of the preferences; a wrong value is one line and changes nothing."""
        if one.within == ("settings",):
            self.change(**{one.name: value})
        elif problem := one.problem(value):
            self._notices.say(problem, error=True)
        elif one.within:
            self._session.state = one.put(self._session.state, value)
        else:
            setattr(self._preferences, one.name, value)

    def change(self, **changes: Any) -> None:
        """Change fields of `tracer.Settings`; a value that is no good is reported in one line and changes nothing."""
        if self._locked():
            return
        state = self._session.state.with_settings(**changes)
        try:
            state.settings.validated()
        except ValueError as error:
            self._notices.say(str(error), error=True)
            return
        self._note_method()
        self._session.state = state

    def set_light(self, light: int) -> None:
        """Choose the light of the views that show one; past the last comes the first."""
        lights = len(self._session.scene.lights) if self._session.scene is not None else 0
        self._session.set_draw(light=light % lights if lights else 0)

    def toggle_culling(self) -> None:
        """Turn culling off, and on again."""
        self.change(method=self.switched_off or NO_CULLING)

    @property
    def switched_off(self) -> str:
        """The method that comes back when culling is turned on: that which culled last, with what was added to it while
        it was off; nothing while it is on."""
        now = Method.parse(self._session.settings.method)
        return "" if now.culls else with_additions(self._preferences.method, now.additions)

    def _note_method(self) -> None:
        """Note the method that culls, to come back to."""
        method = self._session.settings.method
        if Method.parse(method).culls:
            self._preferences.method = method

    def reset(self, kept: Collection[str]) -> None:
        """Set everything to its default, except these fields of the preferences."""
        if self._locked():
            return
        self._preferences.reset(kept)
        now, usual = self._session.state, codec.recalled({})
        self._session.change(settings=usual.settings, pace=usual.pace)
        self._session.set_draw(**{name: getattr(usual.draw, name) for name in codec.remembered(now)["draw"]})
        self.save()
        self._notices.say("settings reset")

    # --- the file --------------------------------------------------------------------------------

    def save(self) -> None:
        """Write the preferences to their file soon, beside what other windows have written.

        That is done on a thread, so that the window waits for neither the disk nor another window."""
        self._tried = data = self._now()

        def write() -> None:
            problem = save_preferences(data, base=self._stored)
            if problem is None:
                self._stored = data
            else:
                self._notices.say(problem, error=True)

        if self._writing is not None:
            self._writing.cancel()  # what has not begun is old
        self._writing = self._thread.submit(write)

    def finish(self) -> None:
        """Save, and wait until it is done."""
        self.save()
        if self._writing is not None:
            self._writing.result()

    def save_changes(self, moving: bool = False) -> None:
        """Save what was changed, now and then, so that little is lost with the program; not while anything moves."""
        now, writing = time.monotonic(), self._writing
        if not moving and now >= self._looked + SAVED_EVERY and (writing is None or writing.done()):
            self._looked = now
            if self._now() != self._tried:
                self.save()

    def _now(self) -> dict[str, Any]:
        """The preferences as they are stored, with the state that the next window starts with."""
        self._note_method()
        self._preferences.state = codec.remembered(self._session.state)
        return codec.to_json(self._preferences)
