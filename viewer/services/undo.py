"""Undo and redo: a list of states, and where in it we are.

Nobody has to announce a change: the state is compared from one of the window's frames to the next.  Changes that belong
together are one step: all of a drag, all of a flight until the camera rests, all turns of the wheel until it does.
Time by itself, and what a run does, are no steps.  A mesh that is read in another way is another scene."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from viewer.services.motion import Motion
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.state.view_state import CAMERA, ViewState, changes

MOST_STEPS = 200
_MOST_NAMED = 2  # changes that make the name of a step
_BY_STROKES = {"draw.tone.exposure", "draw.tone.white", "draw.zoom"}  # changed little by little, by the wheel or a key
_STROKE_SECONDS = 0.6  # from one stroke to the next, at most, for both to be one step


@dataclass(frozen=True)
class Step:
    """A state, and what was done to come to it: in a few words, and in `details` where these are not all; `with_time`,
    it went to another time as well."""

    name: str
    details: str
    state: ViewState
    with_time: bool = False


class Undo:
    """See the module.  `held` is to be set while the user holds something, as in a drag."""

    def __init__(
        self, session: Session, motion: Motion, notices: Notices, locked: Callable[[], bool],
        reset_modes: Callable[[], None],
    ) -> None:  # fmt: skip
        """Nothing is brought back while `locked()`, which says so itself."""
        self._session, self._motion, self._notices, self._locked = session, motion, notices, locked
        self._reset_modes = reset_modes
        self.held = False
        self.clear()

    def clear(self) -> None:
        """Forget all steps, as another scene is open."""
        self._steps: list[Step] = []
        self._at = 0  # the step whose state is shown, which is kept up to date
        self._open: set[str] = set()  # what has changed in the newest step, where that may go on
        self._changed_at = 0.0
        self._named = "", False

    @property
    def undoes(self) -> str:
        """What would be undone; "" where there is nothing."""
        return self._steps[self._at].name if self._at > 0 else ""

    def details(self, ahead: int) -> str:
        """Return all that would be undone, or with 1 `ahead` done again, where its name does not say so."""
        at = self._at + ahead
        return self._steps[at].details if 0 < at < len(self._steps) else ""

    @property
    def redoes(self) -> str:
        """What would be done again; "" where there is nothing."""
        return self._steps[self._at + 1].name if self._at + 1 < len(self._steps) else ""

    def begin_step(self, name: str, with_time: bool = False) -> None:
        """Name what is about to change, which is a step of its own; `with_time`, it brings back the time as well."""
        self.note_changes()
        self._close()
        self._named = name, with_time

    def without_undo(self, change: Callable[[], None]) -> None:
        """Let something change that follows from a step, and is none itself."""
        self.note_changes()
        change()
        self._keep_up()

    def note_changes(self) -> None:
        """Take up what has changed since the last frame of the window."""
        now = self._state()
        if now is None:
            return
        if self._steps and self._steps[0].state.meshes != now.meshes:
            self.clear()
        if not self._steps:
            self._steps = [Step("", "", now)]
        last = self._steps[self._at].state
        changed = {} if now == last else changes(last, now)
        (name, with_time), self._named = self._named, ("", False)
        moved = with_time and now.time != last.time
        if name and (changed or moved):
            self._close()
            self._add(Step(name, "", now, moved))
        elif changed:
            if not changed.keys() <= self._open:
                self._close()
                self._add(Step("", "", now))
            self._open |= changed.keys()
            self._changed_at = time.monotonic()
            self._steps[-1] = Step(*_names_of(changes(self._steps[-2].state, now)), now)
        self._keep_up()
        if not self._goes_on:
            self._close()

    def undo(self) -> None:
        """Bring back what held before the newest step."""
        self._go(-1, "undo")

    def redo(self) -> None:
        """Do again what was undone last."""
        self._go(1, "redo")

    # --- inside ----------------------------------------------------------------------------------

    def _go(self, by: int, way: str) -> None:
        if self._locked():
            return
        self.note_changes()
        self._close()
        to = self._at + by
        if not 0 <= to < len(self._steps):
            self._notices.say(f"there is nothing to {way}")
            return
        session, wanted, done = self._session, self._steps[to].state, self._steps[max(to, self._at)]
        start, playing = session.camera, session.playing
        self._motion.halt()
        session.restore(wanted if done.with_time else replace(wanted, time=session.time))
        session.change(compare=wanted.compare)
        session.playing = playing and not done.with_time
        if wanted.camera is not None and wanted.camera != start:
            self._motion.glide(wanted.camera, start)
        self._at = to
        self._keep_up()
        anew = done.with_time and session.state.depends_on_modes
        if anew:  # else those of where one went would stay, as of the frames that led to a wrong pixel
            self._reset_modes()
        self._notices.say(f"{way}ne: {done.details or done.name}{': modes are learnt anew' if anew else ''}")

    def _add(self, step: Step) -> None:
        self._steps = [*self._steps[: self._at + 1], step][-MOST_STEPS - 1 :]
        self._at = len(self._steps) - 1

    @property
    def _goes_on(self) -> bool:
        """Whether more may come of the step that is open."""
        strokes = self._open <= _BY_STROKES and time.monotonic() < self._changed_at + _STROKE_SECONDS
        return bool(self._open) and (self.held or strokes or (CAMERA in self._open and self._motion.is_dragging))

    def _close(self) -> None:
        """End the step that is open; what has come back to where it was is none."""
        if self._open and not self._steps[-1].name:
            self._at -= 1
            self._steps.pop()
            self._keep_up()
        self._open = set()

    def _keep_up(self) -> None:
        now = self._state()
        if now is not None and self._steps:
            self._steps[self._at] = replace(self._steps[self._at], state=now)

    def _state(self) -> ViewState | None:
        session = self._session
        if session.scene is None:
            return None
        # On its way the camera is where it goes: a glide is one step, and one that undo began is none.
        return replace(session.state, camera=self._motion.destination or session.state.camera)


def _names_of(changed: dict[str, str]) -> tuple[str, str]:
    many = len(changed) > _MOST_NAMED
    return f"{len(changed)} changes" if many else " and ".join(changed.values()), ", ".join(changed.values()) * many
