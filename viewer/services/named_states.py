"""States under a name, kept in the preferences: bookmarks, which are places in a scene, and presets, settings."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from viewer.state import codec
from viewer.state.methods import ADAPTIVE, BY_MODES
from viewer.state.notices import Notices
from viewer.state.preferences import NamedState, Preferences
from viewer.state.session import Session
from viewer.state.view_state import ViewState

LONGEST_NAME = 60


class NamedStates:
    """What bookmarks and presets have in common; `kind` is what one is called, `reserved` are names that none has."""

    kind = ""
    reserved: Collection[str] = ()

    def __init__(
        self, session: Session, preferences: Preferences, notices: Notices, write: Callable[[], None],
        refuses: Callable[[], bool] = lambda: False, begin_step: Callable[[str], None] = lambda name: None,
    ) -> None:  # fmt: skip
        """`write` writes the preferences to their file.  Nothing is applied while `refuses()`, which says so itself;
        `begin_step` names the step of undo that follows."""
        self._session, self._preferences, self._notices, self._write = session, preferences, notices, write
        self._refuses, self._begin_step = refuses, begin_step

    @property
    def all(self) -> list[NamedState]:
        """Those that the user has saved, in their order."""
        raise NotImplementedError

    def kept(self) -> dict[str, Any]:
        """Return what is saved of the state that is shown."""
        return codec.state_to_json(self._session.state)

    def save(self, name: str) -> bool:
        """Save what is shown under a name, in the place of one that has it; returns whether that could be done."""
        name = " ".join(name.split())[:LONGEST_NAME]
        if self._refused(name, "saved"):
            return False
        found = next((one for one in self.all if one.name == name), None)
        if found is None:
            self.all.append(NamedState(name, self.kept()))
        else:
            found.state = self.kept()
        self._write()
        self._notices.say(f"{self.kind} {'saved' if found is None else 'replaced'}: {name}")
        return True

    def rename(self, index: int, name: str) -> None:
        """Give one another name, unless that cannot be."""
        name, one = " ".join(name.split())[:LONGEST_NAME], self.all[index]
        if not self._refused(name, "renamed", {other.name for other in self.all if other is not one}):
            one.name = name
            self._write()

    def _refused(self, name: str, done: str, taken: Collection[str] = ()) -> bool:
        """Return whether none may have this name, and say why."""
        problem = "" if name else "give it a name"
        problem = f"there is a {self.kind} {name} already" if name in taken else problem
        problem = f"{name} comes with the program; choose another name" if name in self.reserved else problem
        if problem:
            self._notices.say(f"{self.kind} not {done}: {problem}", error=True)
        return bool(problem)

    def move(self, index: int, to: int) -> None:
        """Bring one to another place in the list."""
        self.all.insert(to, self.all.pop(index))
        self._write()

    def delete(self, index: int) -> None:
        gone = self.all.pop(index)
        self._write()
        self._notices.say(f"{self.kind} deleted: {gone.name}")


class Bookmarks(NamedStates):
    """Places in the open scene: camera, time and view."""

    kind = "bookmark"

    @property
    def all(self) -> list[NamedState]:
        scene = self._session.scene
        if scene is None:
            return []
        return self._preferences.bookmarks.setdefault(str(Path(scene.path).absolute()), [])

    def add(self) -> None:
        """Save this place under a new name."""
        self.save("")

    def save(self, name: str) -> bool:
        """See `NamedStates`; without a name it gets a new one: the frame's number where something moves, else the
        next."""
        session, taken = self._session, {mark.name for mark in self.all}
        if session.scene is None:
            return False
        base = f"frame {session.frame}" if session.animated else f"place {len(taken) + 1}"
        names = (base, *(f"{base} ({k})" for k in range(2, len(taken) + 3)))
        return super().save(name if name.strip() else next(new for new in names if new not in taken))

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


# --- presets ---------------------------------------------------------------------------------------


@dataclass
class BuiltIn(NamedState):
    """A preset that comes with the program: what its state says nothing of stays as it is."""

    tip: str


BUILT_IN = (
    BuiltIn(
        "As in the paper",
        {
            "settings": {
                "method": BY_MODES, "symmetric": False, "zoom_factor": 4.0, "depth": 10, "samples": 1, "verify": False,
                "lamp_radius": 0.0, "lamp_samples": None,
            },
            "pace": {
                "fixed_size": True, "width": 512, "height": 512, "progressive": False, "every_frame": True,
                "keep_tracing": False,
            },
        },
        "The paper's method, tested one way, with zoom factor 4, 10 bounces, one ray a pixel and point lights; every "
        "frame of the animation is traced in full at 512 x 512. (The tree stays the one that is chosen; the command "
        "bench takes the paper's kd-tree.)",
    ),
    BuiltIn(
        "Quick and exact",
        {
            "settings": {"method": ADAPTIVE, "verify": False, "samples": 16},
            "pace": {"fixed_size": False, "progressive": True, "every_frame": False},
        },
        "The method that culls where that is quicker, in the size of the window, refined while nothing moves.",
    ),
)  # fmt: skip
OF_THE_MOMENT = {"spans", "zoom", "slice", "caption", "savings", "magnified"}
"""Options of drawing that belong to what is shown at the time: no preset keeps them."""


class Presets(NamedStates):
    """Settings, and how frames are drawn: those that come with the program, and the user's."""

    kind = "preset"
    reserved = frozenset(preset.name for preset in BUILT_IN)

    @property
    def all(self) -> list[NamedState]:
        return self._preferences.presets

    @property
    def states(self) -> dict[str, dict[str, Any]]:
        """What each holds, by its name; those of the program first."""
        return {one.name: one.state for one in (*BUILT_IN, *self.all)}

    def kept(self) -> dict[str, Any]:
        state = super().kept()
        draw = {name: value for name, value in state["draw"].items() if name not in OF_THE_MOMENT}
        return {"settings": state["settings"], "draw": draw, "pace": state["pace"]}

    def apply(self, name: str) -> None:
        """Apply a preset; a damaged one is one line and changes nothing."""
        if self._refuses():
            return
        now = self._session.state
        stored = self.states.get(name, {})
        try:
            parts = {part: stored[part] for part in ("settings", "draw", "pace") if part in stored}
            if not parts:
                raise ValueError("it holds no settings")
            found = codec.state_from_json(parts, now).on_machine_of(now)
        except ValueError as error:
            self._notices.say(f"the preset {name} cannot be applied: {error}", error=True)
            return
        self._begin_step(f"preset {name}")
        lights = len(self._session.scene.lights) if self._session.scene is not None else 0
        self._session.state = found.with_draw(light=min(found.draw.light, max(lights - 1, 0)))
        self._notices.say(f"preset applied: {name}")
