"""What became of the rays of the pixel that was clicked, and the way of one of them through the trees.

The rays come with the reasons of the shadow inspector.  The way of one is asked of the render thread, which alone may
touch the world, and answered between two frames; the window never waits.  Rays are listed only where they are seen.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Protocol, cast

from tracer.frame import Frame
from tracer.geometry.accelerators import ACCELERATORS
from tracer.geometry.visits import Visit
from tracer.geometry.world import World
from tracer.ray_tree import visits_of
from tracer.renderer import Renderer
from tracer.scene.model import Cancelled
from tracer.told_rays import RayTree
from viewer.output.ray_rows import Key, RayRows, Row, unfolded
from viewer.services.render_request import Question, Traced, Traces
from viewer.services.selection import Selection
from viewer.state.ray_lines import RayLine, ray_lines
from viewer.state.session import Session
from viewer.state.verdicts import Filter

STEP_SECONDS = 0.25  # that each step is shown while they are played


class OtherWorlds:
    """The scene in the structure that is not traced with, built when somebody asks for it first."""

    def __init__(self) -> None:
        self._world: World | None = None

    def of(self, renderer: Renderer, accelerator: str, moment: float, cancelled: Callable[[], bool]) -> World:
        """The scene at a moment in this structure; raises Cancelled once `cancelled()` is true."""
        if renderer.world.accelerator == accelerator:
            return renderer.world

        def progress(_label: str, _part: float) -> None:
            if cancelled():
                raise Cancelled("cancelled")

        kept = self._world
        if kept is None or kept.scene is not renderer.scene or kept.accelerator != accelerator:
            self._world = kept = World(renderer.scene, moment, accelerator, progress)
        kept.place(moment)
        return kept


class StepsQuestion:
    """The nodes that a ray of a tree enters, in one of the structures: `found`, once there is an answer."""

    def __init__(self, tree: RayTree, row: Row, accelerator: str, worlds: OtherWorlds) -> None:
        self.tree, self.key, self.accelerator = tree, row.key, accelerator
        self._ray, self._place = row.ray, int(row.places[0]) if len(row.places) else None
        self._worlds = worlds
        self.found: list[Visit] | None = None
        self.dropped = False

    @property
    def time(self) -> float:
        return self.tree.frame.time

    def answer(self, renderer: Traces) -> None:
        if self.dropped:
            return
        try:
            world = self._worlds.of(cast(Renderer, renderer), self.accelerator, self.time, lambda: self.dropped)
            self.found = visits_of(world, self.tree, self._ray, self._place)
        except Cancelled:
            pass


class Answers(Protocol):
    """The part of `RenderThread` that is used here."""

    def ask(self, question: Question) -> None: ...


class RayInspector:
    """`tree` is what is known of the clicked pixel's rays, and `rows` lists it, None while nothing is.  `shown` says
    which shadow rays are to be seen, `pointed` is the row that the pointer is on.  `visits` are the nodes that the
    selected ray enters in the structure `accelerator`, of which `step` is looked at, and `playing` says that they pass
    by."""

    def __init__(self, session: Session, selection: Selection, renderer: Answers) -> None:
        self._session, self._selection, self._renderer = session, selection, renderer
        self._seen = self.visible = False
        self._worlds = OtherWorlds()
        self.shown = Filter()
        self.accelerator = ""
        self.pointed: Row | None = None
        self._steps: StepsQuestion | None = None
        self._forget()

    def _forget(self) -> None:
        self.tree: RayTree | None = None
        self.rows: RayRows | None = None
        self._toggled: set[Key] = set()
        self._selected: Key | None = None
        self._lines: tuple[RayTree, Frame, Filter, list[RayLine]] | None = None
        self._list: tuple[RayRows, int, list[tuple[int, Row]]] | None = None
        self._changes = 0
        self._forget_steps()

    def _forget_steps(self) -> None:
        if self._steps is not None:
            self._steps.dropped = True
        self._steps = None
        self.step, self.playing, self._stepped = 0, False, 0.0

    # --- one frame of the window -----------------------------------------------------------------

    def watch(self) -> None:
        """Somebody looks at the rays in this frame of the window."""
        self._seen = True

    def follow(self, traced: Traced | None, tree: RayTree | None) -> None:
        """Take up the rays that are known of the clicked pixel, if somebody looks; `traced` is the newest frame, None
        where nothing may be asked."""
        self.visible, self._seen = self._seen, False
        picked = self._selection.picked
        if picked is None or traced is None or not self.visible:
            if self.tree is not None and (picked is None or traced is None):
                self._forget()
            return
        if tree is not None and tree is not self.tree:
            self.tree = tree
            self.refilter(self.shown)
        if self.tree is not None and _is_outdated(self.tree, traced.frame):
            self.tree = self.rows = None
        self._follow_steps()

    def refilter(self, shown: Filter) -> None:
        """Show these shadow rays."""
        self.shown, scene = shown, self._session.scene
        self.rows = RayRows(self.tree, scene, shown) if self.tree is not None and scene is not None else None
        self._changes += 1

    # --- rows ------------------------------------------------------------------------------------

    @property
    def seen(self) -> list[tuple[int, Row]]:
        """The rows that are seen, with their levels."""
        rows = self.rows
        if rows is None:
            return []
        if self._list is None or self._list[:2] != (rows, self._changes):
            self._list = rows, self._changes, list(unfolded(rows.top, self.is_open))
        return self._list[2]

    def is_open(self, row: Row) -> bool:
        """Whether what is below a row is seen: at first, what is below rays on their way."""
        return (len(row.places) == 0) != (row.key in self._toggled)

    def toggle(self, row: Row) -> None:
        """Fold or unfold a row."""
        self._toggled ^= {row.key}
        self._changes += 1

    @property
    def selected(self) -> Row | None:
        """The selected row, None where it is not seen."""
        return next((row for _, row in self.seen if row.key == self._selected), None)

    def select(self, row: Row | None) -> None:
        """Select a row, or none."""
        key = None if row is None else row.key
        if key != self._selected:
            self._selected = key
            self._forget_steps()

    def lines(self, frame: Frame) -> list[RayLine]:
        """What is to be drawn on a frame."""
        if self.tree is None:
            return []
        if self._lines is None or self._lines[:3] != (self.tree, frame, self.shown):
            self._lines = self.tree, frame, self.shown, ray_lines(frame, self.tree, self.shown)
        return self._lines[3]

    # --- the way of one ray ----------------------------------------------------------------------

    def _follow_steps(self) -> None:
        row, tree = self.selected, self.tree
        if row is None or not row.single or tree is None:
            self._forget_steps()
            return
        wanted = self.accelerator or tree.frame.settings.accelerator
        steps = self._steps
        if steps is None or (steps.tree, steps.key, steps.accelerator) != (tree, row.key, wanted):
            if steps is not None:
                steps.dropped = True
                if steps.key != row.key or steps.accelerator != wanted:
                    self.step = 0
            self._steps = StepsQuestion(tree, row, wanted, self._worlds)
            self._renderer.ask(self._steps)
        self.step = min(self.step, max(len(self.visits) - 1, 0)) if self.visits else self.step
        if self.playing and self.visits and time.monotonic() >= self._stepped + STEP_SECONDS:
            self.go(1)
            self.playing = self.step + 1 < len(self.visits)

    @property
    def visits(self) -> list[Visit]:
        """The nodes that the selected ray enters; none while that is not known."""
        return self._steps.found or [] if self._steps is not None else []

    @property
    def walked(self) -> bool:
        """Whether it is known which nodes the selected ray enters."""
        return self._steps is not None and self._steps.found is not None

    @property
    def structure(self) -> str:
        """The structure whose nodes are shown."""
        return self.accelerator or (self.tree.frame.settings.accelerator if self.tree is not None else ACCELERATORS[0])

    def go(self, steps: int) -> None:
        """So many steps forward or back."""
        self.step = min(max(self.step + steps, 0), max(len(self.visits) - 1, 0))
        self._stepped = time.monotonic()

    def play(self) -> None:
        """Let the steps pass by, from the first one on if the last is shown; or stop."""
        self.playing = not self.playing and bool(self.visits)
        if self.playing and self.step + 1 >= len(self.visits):
            self.step = 0
        self._stepped = time.monotonic()


def _is_outdated(tree: RayTree, frame: Frame) -> bool:
    """Whether a tree is of another moment than a frame, or of what another method did."""
    then = tree.frame
    return then.time != frame.time or then.settings.method != frame.settings.method
