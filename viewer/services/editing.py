"""What if: lights off or elsewhere, objects hidden, static or moving, without another file.

`Session.edits` says what is wanted; `apply` brings it about on the render thread, which alone may touch the world.
Lights that move and dynamic objects that are hidden only change the scene of a renderer, which drops what no longer
holds (`Renderer.scene`).  All else takes another renderer, with trees of its own where geometry is another.  The
renderer of the scene as it was read is kept, with all that it knows, and so are those used last.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace

from tracer.carry_modes import carry_modes
from tracer.frame import Settings
from tracer.renderer import Renderer
from tracer.scene.edits import NO_EDITS, Edited, Edits, edited
from tracer.scene.lights import Vector
from tracer.scene.model import Cancelled, Scene
from tracer.scene.things import things
from viewer.services.render_thread import RenderThread
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.util.messages import KNOWN, Failure, failure

KEPT = 2
"""Renderers that are kept besides that of the scene as it was read."""

Show = Callable[[Edited, Renderer], None]


@dataclass
class Kept:
    """Renderers by what their scenes are made of, those used last at the end; and that of the scene as it was read."""

    first: Renderer
    others: dict[Hashable, Renderer]
    outdated: bool = False  # whether all modes have been forgotten since, but those of the one in use

    def find(self, made_of: Hashable) -> Renderer | None:
        return self.first if made_of == NO_EDITS else self.others.get(made_of)

    def keep(self, made_of: Hashable, renderer: Renderer) -> None:
        if renderer is not self.first:
            self.others.pop(made_of, None)
            self.others[made_of] = renderer
            while len(self.others) > KEPT:
                del self.others[next(iter(self.others))]

    def forget_modes(self, used: Renderer) -> None:
        """Forget what renderers know that are not the one in use, if they are outdated."""
        if self.outdated:
            self.outdated = False
            self.others = {made_of: renderer for made_of, renderer in self.others.items() if renderer is used}
            if self.first is not used:
                self.first.reset_modes()


def makes(edits: Edits, scene: Scene) -> Hashable:
    """What decides which renderer a scene with these edits needs: all but places of lights and hidden objects that can
    move anyway."""
    in_place = {thing.name for thing in things(scene) if thing.moves} - dict(edits.static).keys()
    return replace(edits, moved_lights=(), hidden=edits.hidden - in_place)


class EditTask:
    """Makes the edits on the render thread; then `found` is set, or `problem`, unless it was cancelled.

    From its beginning on the renderer's scene may be another than the session's: no picture must be asked for until it
    is `done`, and what it has `found` is taken up."""

    def __init__(self, shown: Edited, edits: Edits, kept: Kept, settings: Settings) -> None:
        self.scene, self.edits, self._shown, self._kept, self._settings = shown.original, edits, shown, kept, settings
        self.done = False
        self.found: tuple[Edited, Renderer] | None = None
        self.problem: Failure | None = None

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

        self._kept.forget_modes(before)
        made, made_of = edited(self.scene, self.edits), makes(self.edits, self.scene)
        renderer = self._kept.find(made_of)
        if renderer is None:
            renderer = Renderer(made.scene, self._settings, progress)
            carry_modes(before, self._shown, renderer, made)
        else:
            renderer.scene = renderer.world.scene = made.scene
        self._kept.keep(made_of, renderer)
        return made, renderer


class Editing:
    """See the module; nothing is changed while `locked()`, which says so itself.  While edits are `put_aside`, the
    scene is shown as it was read."""

    def __init__(
        self,
        session: Session,
        renderer: RenderThread,
        notices: Notices,
        locked: Callable[[], bool],
        show: Show,
        without_undo: Callable[[Callable[[], None]], None] = lambda change: change(),
        again: Callable[[], None] = lambda: None,
    ) -> None:
        """`show(edited, renderer)` is called with each scene when it is ready to be traced, `again()` where an edit has
        come to nothing: without another frame, nothing could be asked about what is shown.  What changes within
        `without_undo` is no step of undo."""
        self._session, self._renderer, self._notices = session, renderer, notices
        self._locked, self._show, self._without_undo, self._again = locked, show, without_undo, again
        self._kept: Kept | None = None
        self._task: EditTask | None = None
        self.put_aside = False

    def enter(self, renderer: Renderer) -> None:
        """Begin with another scene, whose renderer this is."""
        self._kept, self._task, self.put_aside = Kept(renderer, {}), None, False

    @property
    def at_work(self) -> bool:
        """Whether the render thread makes edits, so that no picture may be asked for."""
        return self._task is not None

    @property
    def under_way(self) -> bool:
        """Whether what is shown is not what is wanted, or not for long."""
        shown = self._session.edited
        return self.at_work or (shown is not None and shown.edits != self._session.edits)

    def forget_modes(self) -> None:
        """Let what is known of shadows in scenes with other edits than these be forgotten."""
        if self._kept is not None:
            self._kept.outdated = True

    # --- what can be changed ------------------------------------------------------------------------

    @property
    def now(self) -> Edits:
        """What is wanted."""
        return self._session.edits

    def change(self, edits: Edits) -> None:
        """Want these edits, as far as the scene has what they name."""
        original = self._session.original
        if original is not None and not self._locked():
            self._session.change(edits=edits.within(original))
            self._session.light_to_come = None

    def hide(self, name: str, hidden: bool = True) -> None:
        """Hide an object, or show it again, by the name of its thing (`tracer.scene.things`)."""
        self.change(self.now.with_thing(name, not hidden))

    def hide_primitive(self, number: int, hidden: bool = True) -> None:
        """Hide a primitive, or show it again; its number is that in the scene as it was read."""
        self.change(self.now.with_primitive(number, not hidden))

    def show_everything(self) -> None:
        """Show all objects and primitives again; other edits stay."""
        self.change(replace(self.now, hidden=frozenset(), hidden_primitives=frozenset()))

    def switch(self, light: int, on: bool) -> None:
        """Switch a light on or off, by its number in the scene as it was read."""
        self.change(self.now.with_light(light, on))

    def move_light(self, light: int, place: Vector | None) -> None:
        """Put a light elsewhere, None for where it was."""
        self.change(self.now.with_light_at(light, place))

    def make_static(self, name: str, static: bool = True) -> None:
        """Let an object that moves stay where it is now, or go on."""
        self.change(self.now.with_static(name, self._session.time if static else None))

    def let_move(self, name: str, moving: bool = True) -> None:
        """Let a static object be one that can move, or not."""
        self.change(self.now.with_moving(name, moving))

    def clear(self) -> None:
        """Take all edits back."""
        self.change(NO_EDITS)

    def show_without(self) -> None:
        """Put all edits aside."""
        self.put_aside = self.put_aside or not self._locked()

    # --- bringing it about --------------------------------------------------------------------------

    def _give_up(self) -> None:
        self.put_aside = False
        if self._session.edited is not None:
            self._session.change(edits=self._session.edited.edits)
            self._session.light_to_come = None

    def apply(self, running: bool, seen: bool) -> None:
        """Take up what has been made, and have made what is wanted now: not while a run has the render thread, and once
        some of what was made last has been `seen`."""
        session, task = self._session, self._task
        if task is not None and task.done:
            self._task = None
            if task.problem is not None:
                self._notices.report(task.problem)
                self._without_undo(self._give_up)
            if task.found is not None and task.scene is session.original:
                self._show(*task.found)
                seen = False  # of this scene, nothing yet
            else:
                self._again()
        shown, kept = session.edited, self._kept
        wanted = NO_EDITS if self.put_aside else session.edits
        if self._task is None and seen and not running and shown is not None and kept is not None:
            if shown.edits != wanted:
                self._task = EditTask(shown, wanted, kept, session.settings)
                self._renderer.perform(self._task)
