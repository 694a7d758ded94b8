"""What if: lights off or elsewhere, objects hidden, static or moving, without another file.

`Session.edits` says what is wanted; `apply` brings it about on the render thread, which alone may touch the world.
Lights that move and dynamic objects that are hidden only change the scene of a renderer, which drops what no longer
holds (`Renderer.scene`).  All else takes another renderer, with trees of its own where geometry is another.  The
renderer of the scene as it was read is kept, with all that it knows.  What edits change is seen by comparing the
picture with the one before them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace

from tracer.carry_modes import carry_modes
from tracer.frame import Settings
from tracer.renderer import Renderer
from tracer.scene.edits import NO_EDITS, Edited, Edits, edited
from tracer.scene.model import Cancelled, Scene
from tracer.scene.things import things
from viewer.services.render_thread import RenderThread
from viewer.state.comparison import Side
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.util.messages import KNOWN, Failure, failure

Show = Callable[[Edited, Renderer], None]


def makes(edits: Edits, scene: Scene) -> Hashable:
    """Return what decides which renderer a scene with these edits needs: all but places of lights and hidden objects
    that can move anyway."""
    in_place = {thing.name for thing in things(scene) if thing.moves} - dict(edits.static).keys()
    return replace(edits, moved_lights=(), hidden=edits.hidden - in_place)


@dataclass
class EditTask:
    """Makes the edits on the render thread; then `found` is set, or `problem`, unless it was cancelled.

    From its beginning on the renderer's scene may be another than the session's: no picture must be asked for until it
    is `done`, and what it has `found` is taken up.  `first` is the renderer of the scene as it was read, whose modes it
    `forgets` if it is not in use."""

    shown: Edited
    edits: Edits
    first: Renderer
    forgets: bool
    settings: Settings
    done: bool = False
    found: tuple[Edited, Renderer] | None = None
    problem: Failure | None = None

    def work(self, renderer: Renderer, cancelled: Callable[[], bool]) -> None:
        try:
            self.found = self._made(renderer, cancelled)
        except Cancelled:
            pass
        except Exception as problem:
            self.problem = failure(problem, "the scene could not be changed", KNOWN)
        self.done = True

    def _made(self, before: Renderer, cancelled: Callable[[], bool]) -> tuple[Edited, Renderer]:
        def progress(_label: str, _fraction: float) -> None:
            if cancelled():
                raise Cancelled("cancelled")

        if self.forgets and self.first is not before:
            self.first.reset_modes()
        scene = self.shown.original
        made, made_of = edited(scene, self.edits), makes(self.edits, scene)
        if made_of in (NO_EDITS, makes(self.shown.edits, scene)):
            renderer = self.first if made_of == NO_EDITS else before
            renderer.scene = renderer.world.scene = made.scene
        else:
            renderer = Renderer(made.scene, self.settings, progress)
            carry_modes(before, self.shown, renderer, made)
        return made, renderer


class Editing:
    """See the module.  `before` is the picture before the edits, to be compared with."""

    def __init__(
        self,
        session: Session,
        renderer: RenderThread,
        notices: Notices,
        locked: Callable[[], bool],
        show: Show,
        without_undo: Callable[[Callable[[], None]], None],
        again: Callable[[], None],
    ) -> None:
        """Nothing is changed while `locked()`, which says so itself.  `show(edited, renderer)` is called with each
        scene when it is ready to be traced, `again()` where an edit has come to nothing: without another frame, nothing
        could be asked about what is shown.  What changes within `without_undo` is no step of undo."""
        self._session, self._renderer, self._notices = session, renderer, notices
        self._locked, self._show, self._without_undo, self._again = locked, show, without_undo, again
        self._first: Renderer | None = None
        self._forgets = False  # whether all modes have been forgotten, those of the first renderer as well
        self._task: EditTask | None = None
        self.before: Side | None = None

    def enter(self, renderer: Renderer) -> None:
        """Begin with another scene, whose renderer this is."""
        self._first, self._forgets, self._task, self.before = renderer, False, None, None

    @property
    def at_work(self) -> bool:
        """Whether the render thread makes edits, so that no picture may be asked for."""
        return self._task is not None

    @property
    def under_way(self) -> bool:
        """Whether what is shown is not what is wanted."""
        shown = self._session.edited
        return self.at_work or (shown is not None and shown.edits != self._session.edits)

    def forget_modes(self) -> None:
        """Let what is known of shadows in the scene as it was read be forgotten, too, if that is not shown."""
        self._forgets = True

    @property
    def now(self) -> Edits:
        """What is wanted."""
        return self._session.edits

    def change(self, edits: Edits) -> None:
        """Want these edits, as far as the scene has what they name."""
        if self._session.original is not None and not self._locked():
            self._want(edits.within(self._session.original))

    def clear(self) -> None:
        """Take all edits back."""
        self.change(NO_EDITS)

    def show_everything(self) -> None:
        """Show all objects and primitives again; other edits stay."""
        self.change(replace(self.now, hidden=frozenset(), hidden_primitives=frozenset()))

    def apply(self, running: bool, seen: bool) -> None:
        """Take up what has been made, and have made what is wanted now: not while a run has the render thread, and once
        some of what was made last has been `seen`."""
        session, task = self._session, self._task
        if task is not None and task.done:
            self._task = None
            if task.problem is not None:
                self._notices.report(task.problem)
                self._without_undo(self._give_up)
            if task.found is not None and task.shown.original is session.original:
                self._show(*task.found)
                seen = False  # of this scene, nothing yet
            else:
                self._again()
        shown, first = session.edited, self._first
        if self._task is None and seen and not running and shown is not None and first is not None:
            if shown.edits != session.edits:
                self._task = EditTask(shown, session.edits, first, self._forgets, session.settings)
                self._forgets = False
                self._renderer.perform(self._task.work)

    def _give_up(self) -> None:
        if self._session.edited is not None:
            self._want(self._session.edited.edits)

    def _want(self, edits: Edits) -> None:
        self._session.change(edits=edits)
        self._session.light_to_come = None
