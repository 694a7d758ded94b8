"""Undo and redo: a list of states.

Nobody has to announce a change: the state is compared from one of the window's frames to the next.  Changes that belong
together are one step: all of a drag, all of a flight until the camera rests, all turns of the wheel until it does.
Time by itself, and what a run does, are no steps.  How a mesh is read is one, which takes a while to be brought
back: the mesh is read again."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from tracer.scene.mesh_options import MeshOptions
from tracer.setting import ALWAYS, settings_of
from viewer.services.motion import Motion
from viewer.state import edits as scene_edits
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.state.view_state import ViewState

MOST_STEPS = 200
_CAMERA = "camera"
_BY_STROKES = {"draw.tone.exposure", "draw.tone.white", "draw.zoom"}  # changed little by little, by the wheel or a key
_STROKE_SECONDS = 0.6  # from one stroke to the next, at most, for both to be one step


@dataclass(frozen=True)
class Step:
    """What was done, in a few words, and what held before and after; `with_time`, it goes to another time as well."""

    name: str
    before: ViewState
    after: ViewState
    with_time: bool = False


@dataclass(frozen=True)
class _Coming:
    """What is brought back once the mesh has been read for it, what to say then, and the steps as they were before."""

    state: ViewState
    with_time: bool
    said: str
    done: list[Step]
    undone: list[Step]


@dataclass
class _Open:
    """A step that may go on."""

    before: ViewState
    fields: dict[str, str] = field(default_factory=dict)


class Undo:
    """See the module.  `held` is to be set while the user holds something, as in a drag."""

    def __init__(
        self,
        session: Session,
        motion: Motion,
        notices: Notices,
        locked: Callable[[], bool],
        read_as: Callable[[MeshOptions], None] = lambda meshes: None,
        reading: Callable[[], bool] = lambda: False,
    ) -> None:
        """Nothing is brought back while `locked()`, which says so itself.  `read_as` begins to read the open mesh in
        another way, and `reading()` says whether a scene is being read."""
        self._session, self._motion, self._notices, self._locked = session, motion, notices, locked
        self._read_as, self._reading = read_as, reading
        self.held = False
        self.clear()

    def clear(self) -> None:
        """Forget all steps, as another scene is open."""
        self._done: list[Step] = []
        self._undone: list[Step] = []
        self._open: _Open | None = None
        self._coming: _Coming | None = None
        self._last: ViewState | None = None
        self._changed_at = 0.0
        self._name = ""
        self._time: float | None = None  # before what is about to change, if that goes to another time

    @property
    def undoes(self) -> str:
        """What would be undone; "" where there is nothing."""
        if self._open is not None:
            return _name_of(self._open.fields)
        return self._done[-1].name if self._done else ""

    @property
    def redoes(self) -> str:
        """What would be done again; "" where there is nothing."""
        return self._undone[-1].name if self._undone and self._open is None else ""

    def begin_step(self, name: str, with_time: bool = False) -> None:
        """Name what is about to change, which is a step of its own; `with_time`, it brings back the time as well."""
        self.note_changes()
        self._close()
        self._name, self._time = name, self._session.time if with_time else None

    def without_undo(self, change: Callable[[], None]) -> None:
        """Let something change that follows from a step, and is none itself."""
        self.note_changes()
        change()
        if self._last is not None:
            self._last = self._state()

    def note_changes(self) -> None:
        """Take up what has changed since the last frame of the window."""
        if self._coming is not None and not self._come():
            return
        now = self._state()
        if now is None:
            return
        if self._last is None:
            self._last = now
            return
        changed = {} if now == self._last else _changes(self._last, now)
        name, self._name = self._name, ""
        before, self._time = self._time, None
        moved = before is not None and before != now.time
        if name and (changed or moved):
            self._close()
            then = self._last if before is None else replace(self._last, time=before)
            self._add(Step(name, then, now, with_time=moved))
        elif changed:
            if self._open is not None and not changed.keys() <= self._open.fields.keys():
                self._close()
            self._open = self._open or _Open(self._last)
            self._open.fields |= changed
            self._changed_at = time.monotonic()
        self._last = now
        if not self._goes_on:
            self._close()

    def undo(self) -> None:
        """Bring back what held before the newest step."""
        self._go("undo")

    def redo(self) -> None:
        """Do again what was undone last."""
        self._go("redo")

    # --- inside ----------------------------------------------------------------------------------

    def _go(self, way: str) -> None:
        if self._locked() or self._coming is not None:
            return
        self.note_changes()
        self._close()
        back = way == "undo"
        steps, others = (self._done, self._undone) if back else (self._undone, self._done)
        if not steps:
            self._notices.say(f"there is nothing to {way}")
            return
        before = list(self._done), list(self._undone)
        step = steps.pop()
        others.append(step)
        state = step.before if back else step.after
        self._start(_Coming(state, step.with_time, f"{way}ne: {step.name}", *before))

    @property
    def _goes_on(self) -> bool:
        """Whether more may come of the step that is open."""
        if self._open is None:
            return False
        fields = self._open.fields.keys()
        strokes = fields <= _BY_STROKES and time.monotonic() < self._changed_at + _STROKE_SECONDS
        return self.held or strokes or (_CAMERA in fields and self._motion.is_dragging)

    def _close(self) -> None:
        """End the step that is open; what has come back to where it was is none."""
        opened, self._open = self._open, None
        if opened is None or self._last is None:
            return
        fields = _changes(opened.before, self._last)
        if fields:
            self._add(Step(_name_of(fields), opened.before, self._last))

    def _add(self, step: Step) -> None:
        self._done = [*self._done, step][-MOST_STEPS:]
        self._undone = []

    def _start(self, coming: _Coming) -> None:
        """Bring a state back, now or once its mesh is read."""
        if coming.state.meshes == self._session.meshes:
            self._bring(coming)
        else:
            self._coming = coming
            self._read_as(coming.state.meshes)

    def _come(self) -> bool:
        """Bring back what a mesh is being read for, or forget of it where nothing has come of the reading; whether
        either is done."""
        coming = self._coming
        if coming is None or self._reading():
            return coming is None
        self._coming = None
        if coming.state.meshes == self._session.meshes:
            self._bring(coming)
        else:
            self._done, self._undone = coming.done, coming.undone
        return True

    def _bring(self, coming: _Coming) -> None:
        session, wanted, playing = self._session, coming.state, self._session.playing
        start = session.camera
        if not coming.with_time:
            wanted = replace(wanted, time=session.time)
        self._motion.halt()
        session.restore(wanted)
        session.change(compare=wanted.compare)
        session.playing = playing and not coming.with_time
        if wanted.camera is not None and wanted.camera != start:
            self._motion.glide(wanted.camera, start)
        self._last = self._state()
        self._notices.say(coming.said)

    def _state(self) -> ViewState | None:
        session = self._session
        if session.scene is None:
            return None
        # On its way the camera is where it goes: a glide is one step, and one that undo began is none.
        return replace(session.state, camera=self._motion.destination or session.state.camera)


def _changes(old: ViewState, new: ViewState) -> dict[str, str]:
    """What has changed from the one to the other: for each field, in a few words, what it is now."""
    changed = {
        one.path: one.in_words(one.get(new))
        for one in settings_of(ViewState)
        if one.stored == ALWAYS and one.get(old) != one.get(new)
    }
    changed |= {f"comparison.{name}": said for name, said in old.compare.changes(new.compare).items()}
    if old.meshes != new.meshes:
        return changed | {"meshes": _meshes_in_words(old.meshes, new.meshes)}  # which has a first camera of its own
    if old.camera != new.camera:
        changed[_CAMERA] = "camera onto the scene's path" if new.camera is None else "camera"
    return changed | scene_edits.differences(old.edits, new.edits)


def _name_of(fields: dict[str, str]) -> str:
    first, *others = fields.values()
    return f"{first} and {len(others)} more" if len(others) > 1 else " and ".join([first, *others])


def _meshes_in_words(before: MeshOptions, after: MeshOptions) -> str:
    """How a mesh is read now, where it was read in another way before."""
    if before.studio != after.studio:
        return f"studio {'on' if after.studio else 'off'}"
    if before.up != after.up:
        return f"{after.up} up" if after.up is not None else "up as it was guessed"
    return f"crease angle {after.crease:g}°" if after.crease is not None else "usual crease angle"
