"""What if: lights off or elsewhere, objects hidden, static or moving, without another file.

`Session.edits` says what is wanted; `apply` brings it about on the render thread, which alone may touch the world.
Lights that move and dynamic objects that are hidden only change the scene of a renderer, which drops what no longer
holds (`Renderer.scene`).  All else takes another renderer, with trees of its own where geometry is another.  The
renderer of the scene as it was read is kept, with all that it knows.  What edits change is seen by comparing the
picture with the one before them."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from concurrent.futures import Future
from dataclasses import replace
from functools import partial

from tracer.editing.carry_modes import carry_modes
from tracer.editing.edits import NO_EDITS, Edited, Edits, edited
from tracer.frame import Settings
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled, Scene
from tracer.scene.things import things
from viewer.services.render_thread import RenderThread
from viewer.state.comparison import Side
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.util.messages import KNOWN, failure

Made = tuple[Edited, Renderer]
Show = Callable[[Edited, Renderer], None]


def makes(edits: Edits, scene: Scene) -> Hashable:
    """Return what decides which renderer a scene with these edits needs: all but places of lights and hidden objects
    that can move anyway."""
    in_place = {thing.name for thing in things(scene) if thing.moves} - dict(edits.static).keys()
    return replace(edits, moved_lights=(), hidden=edits.hidden - in_place)


def make(
    shown: Edited, edits: Edits, first: Renderer, forgets: bool, settings: Settings,
    before: Renderer, cancelled: Callable[[], bool],
) -> Made:  # fmt: skip
    """Return the scene that is `shown` with other edits, and its renderer; on the render thread.  Raises Cancelled.

    From its beginning on the scene of the renderer `before` may be another than the session's: no picture must be asked
    for until what it returns is taken up.  `first` is the renderer of the scene as it was read, whose modes it
    `forgets` if it is not in use."""

    def progress(_label: str, _fraction: float) -> None:
        if cancelled():
            raise Cancelled("cancelled")

    if forgets and first is not before:
        first.reset_modes()
    made, made_of = edited(shown.original, edits), makes(edits, shown.original)
    if made_of in (NO_EDITS, makes(shown.edits, shown.original)):
        renderer = first if made_of == NO_EDITS else before
        renderer.scene = renderer.world.scene = made.scene
    else:
        renderer = Renderer(made.scene, settings, progress)
        carry_modes(before, shown, renderer, made)
    return made, renderer


class Editing:
    """See the module.  `before` is the picture before the edits, to be compared with."""

    def __init__(
        self, session: Session, renderer: RenderThread, notices: Notices, locked: Callable[[], bool], show: Show,
        without_undo: Callable[[Callable[[], None]], None], again: Callable[[], None],
    ) -> None:  # fmt: skip
        """Nothing is changed while `locked()`, which says so itself.  `show(edited, renderer)` is called with each
        scene when it is ready to be traced, `again()` where an edit has come to nothing: without another frame, nothing
        could be asked about what is shown.  What changes within `without_undo` is no step of undo."""
        self._session, self._renderer, self._notices = session, renderer, notices
        self._locked, self._show, self._without_undo, self._again = locked, show, without_undo, again
        self._first: Renderer | None = None
        self._forgets = False  # whether all modes have been forgotten, those of the first renderer as well
        self._making: Future[Made] | None = None
        self.before: Side | None = None

    def enter(self, renderer: Renderer) -> None:
        """Begin with another scene, whose renderer this is."""
        self._first, self._forgets, self._making, self.before = renderer, False, None, None

    @property
    def at_work(self) -> bool:
        """Whether the render thread makes edits, so that no picture may be asked for."""
        return self._making is not None

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
        session, made = self._session, self._making
        if made is not None and made.done():
            self._making = None
            problem = None if made.cancelled() else made.exception()
            if made.cancelled() or problem is not None:
                self._again()
            else:
                self._show(*made.result())
                seen = False  # of this scene, nothing yet
            if problem is not None:
                self._notices.report(failure(problem, "the scene could not be changed", KNOWN))
                self._without_undo(self._give_up)
        shown, first = session.edited, self._first
        if self._making is None and seen and not running and shown is not None and first is not None:
            if shown.edits != session.edits:
                work = partial(make, shown, session.edits, first, self._forgets, session.settings)
                self._making, self._forgets = self._renderer.perform(work), False

    def _give_up(self) -> None:
        if self._session.edited is not None:
            self._want(self._session.edited.edits)

    def _want(self, edits: Edits) -> None:
        self._session.change(edits=edits)
        self._session.light_to_come = None
