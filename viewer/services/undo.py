"""Undo and redo of settings, view, light, tone, comparison, zoom, camera and edits of the scene.

Nobody has to announce a change: what holds is compared from one of the window's frames to the next.  Changes that
belong together are one step: all of a drag, all of a flight until the camera rests, all turns of the wheel until it
does.  Time, and what a run does, are no steps.  How a mesh is read is one, which takes a while to be brought back: the
mesh is read again."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.mesh_options import MeshOptions
from tracer.scene.model import Camera
from viewer.services.motion import Motion
from viewer.state import edits as scene_edits
from viewer.state.choices import Choices, differences
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session

MOST = 200
"""Steps that are kept."""
_CAMERA = "camera"
_BY_STROKES = {"tone", "zoom"}  # what the wheel or a key changes little by little
_STROKE = 0.6  # seconds from one to the next, at most, for both to be one step


@dataclass(frozen=True)
class Place:
    """All that a step can bring back; `camera` is None while it follows the scene's own path, `time` where the step is
    not about going to another time."""

    choices: Choices
    camera: Camera | None
    meshes: MeshOptions
    edits: Edits = NO_EDITS
    time: float | None = None


@dataclass(frozen=True)
class Step:
    """What was done, in a few words, and what held before and after."""

    name: str
    before: Place
    after: Place


@dataclass(frozen=True)
class _Coming:
    """What is brought back once the mesh has been read for it, what to say then, and the steps as they were before."""

    place: Place
    said: str
    done: list[Step]
    undone: list[Step]


@dataclass
class _Open:
    """A step that may go on."""

    before: Place
    fields: dict[str, str] = field(default_factory=dict)


class Undo:
    """See the module.  `held` is to be set while the user holds something, as in a drag."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        motion: Motion,
        notices: Notices,
        locked: Callable[[], bool],
        read_as: Callable[[MeshOptions], None] = lambda meshes: None,
        reading: Callable[[], bool] = lambda: False,
    ) -> None:
        """Nothing is brought back while `locked()`, which says so itself.  `read_as` begins to read the open mesh in
        another way, and `reading()` says whether a scene is being read."""
        self._session, self._preferences, self._motion = session, preferences, motion
        self._notices, self._locked = notices, locked
        self._read_as, self._reading = read_as, reading
        self._coming: _Coming | None = None
        self.held = False
        self._done: list[Step] = []
        self._undone: list[Step] = []
        self._open: _Open | None = None
        self._changed_at = 0.0
        self._last: Place | None = None
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

    def call_next(self, name: str, with_time: bool = False) -> None:
        """Give a name to what is about to change, which is a step of its own; `with_time`, it brings back the time as
        well."""
        self.follow()
        self._close()
        self._name, self._time = name, self._session.time if with_time else None

    def clear(self) -> None:
        """Forget all steps, as another scene is open."""
        self._done, self._undone, self._open, self._last, self._name = [], [], None, None, ""
        self._time = None
        self._coming = None

    def overlook(self, change: Callable[[], None]) -> None:
        """Let something change that follows from a step, and is none itself."""
        self.follow()
        change()
        if self._last is not None:
            self._last = self._place()

    def follow(self) -> None:
        """Take up what has changed since the last time."""
        if self._coming is not None and not self._come():
            return
        now = self._place()
        if now is None:
            return
        if self._last is None:
            self._last = now
            return
        changed = _changes(self._last, now)
        name, self._name = self._name, ""
        before, self._time = self._time, None
        moved = before is not None and before != self._session.time
        if name and (changed or moved):
            self._close()
            then, after = self._last, now
            if moved:
                then, after = replace(then, time=before), replace(now, time=self._session.time)
            self._add(Step(name, then, after))
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
        if self._locked() or self._coming is not None:
            return
        self.follow()
        self._close()
        if not self._done:
            self._notices.say("there is nothing to undo")
            return
        before = list(self._done), list(self._undone)
        step = self._done.pop()
        self._undone.append(step)
        self._start(step.before, f"undone: {step.name}", *before)

    def redo(self) -> None:
        """Do again what was undone last."""
        if self._locked() or self._coming is not None:
            return
        self.follow()
        self._close()
        if not self._undone:
            self._notices.say("there is nothing to redo")
            return
        before = list(self._done), list(self._undone)
        step = self._undone.pop()
        self._done.append(step)
        self._start(step.after, f"redone: {step.name}", *before)

    # --- inside ----------------------------------------------------------------------------------

    @property
    def _goes_on(self) -> bool:
        """Whether more may come of the step that is open."""
        if self._open is None:
            return False
        strokes = self._open.fields.keys() <= _BY_STROKES and time.monotonic() < self._changed_at + _STROKE
        return self.held or strokes or (_CAMERA in self._open.fields and self._motion.handled)

    def _close(self) -> None:
        """End the step that is open; what has come back to where it was is none."""
        opened, self._open = self._open, None
        if opened is None or self._last is None:
            return
        fields = _changes(opened.before, self._last)
        if fields:
            self._add(Step(_name_of(fields), opened.before, self._last))

    def _add(self, step: Step) -> None:
        self._done = [*self._done, step][-MOST:]
        self._undone = []

    def _start(self, place: Place, said: str, done: list[Step], undone: list[Step]) -> None:
        """Bring a place back, now or once its mesh is read; `done` and `undone` are the steps as they were before."""
        if place.meshes == self._session.meshes:
            self._bring(place, said)
        else:
            self._coming = _Coming(place, said, done, undone)
            self._read_as(place.meshes)

    def _come(self) -> bool:
        """Bring back what a mesh is being read for, or forget of it where nothing has come of the reading; whether
        either is done."""
        coming = self._coming
        if coming is None or self._reading():
            return coming is None
        self._coming = None
        if coming.place.meshes == self._session.meshes:
            self._bring(coming.place, coming.said)
        else:
            self._done, self._undone = coming.done, coming.undone
        return True

    def _bring(self, place: Place, said: str) -> None:
        session = self._session
        place.choices.put_into(session, self._preferences)
        if place.time is not None:
            session.time, session.playing = place.time, False
        if place.camera != session.free_camera:
            start = session.camera
            self._motion.halt()
            session.free_camera = place.camera
            if place.camera is not None:
                self._motion.glide(place.camera, start)
        session.want(place.edits, place.choices.light)
        self._last = replace(place, edits=session.edits, time=None)
        self._notices.say(said)

    def _place(self) -> Place | None:
        session = self._session
        if session.scene is None:
            return None
        # On its way the camera is where it goes: a glide is one step, and one that undo began is none.
        camera = self._motion.destination or session.free_camera
        return Place(Choices.of(session, self._preferences), camera, session.meshes, session.edits)


def _changes(before: Place, after: Place) -> dict[str, str]:
    changed = differences(before.choices, after.choices)
    if before.meshes != after.meshes:
        return changed | {"meshes": _in_words(before.meshes, after.meshes)}  # which has a first camera of its own
    if before.camera != after.camera:
        onto = "camera onto the scene's path" if after.camera is None else "camera"
        changed[_CAMERA] = onto
    return changed | scene_edits.differences(before.edits, after.edits)


def _name_of(fields: dict[str, str]) -> str:
    first, *others = fields.values()
    return f"{first} and {len(others)} more" if len(others) > 1 else " and ".join([first, *others])


def _in_words(before: MeshOptions, after: MeshOptions) -> str:
    """How a mesh is read now, where it was read in another way before."""
    if before.studio != after.studio:
        return f"studio {'on' if after.studio else 'off'}"
    if before.up != after.up:
        return f"{after.up} up" if after.up is not None else "up as it was guessed"
    return f"crease angle {after.crease:g}°" if after.crease is not None else "usual crease angle"
