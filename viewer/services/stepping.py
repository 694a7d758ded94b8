"""The paper's text run line by line for the pixel that is selected: where the user is in it, over several frames.

Where somebody looks, each frame that is shown is run, as a query.  Frames of the same view join those that are there,
so that one can step on into them, and back; stepping on past the end of the newest traces the same frame once more."""

from __future__ import annotations

from collections.abc import Callable

from tracer.culling.modes import DYNAMIC, INIT
from tracer.frame import Frame
from tracer.inspect.paper_steps import PaperSteps, Step, paper_steps
from tracer.renderer import Renderer
from viewer.services.inspector import Selection
from viewer.services.render_request import Ask, Newest, Traced
from viewer.state.picking import Pick, Seen, seen_of

MOST_KEPT = 16  # frames

Answer = tuple[Frame, PaperSteps | str | None]
"""A frame and its steps, or why it has none; None where the renderer has gone on to another frame."""


def run_text(renderer: Renderer, frame: Frame, x: int, y: int, cancelled: Callable[[], bool]) -> Answer:
    """Run the paper's text for a pixel of a frame."""
    try:
        return frame, paper_steps(renderer, frame, x, y, cancelled)
    except LookupError:
        return frame, None
    except ValueError as problem:
        return frame, f"No steps: {problem}."


class Stepping:
    """`runs` has the steps of each frame, and what was seen in it; the step that is shown is number `place` of number
    `frame`.  `problem` says why there are none, `shown` that somebody looks, `wanted` what to do in the next frame."""

    def __init__(self, selection: Selection, query: Ask, trace_again: Callable[[], None]) -> None:
        self._selection, self._query, self._trace_again = selection, query, trace_again
        self._of: Pick | None = None
        self._watched, self._newest = False, Newest()
        self._forget("", None)

    def _forget(self, problem: str, taken: object) -> None:
        self._newest.forget()
        self._taken = taken  # what the frame that was run last sees: all of its samples have it
        self.wanted: Callable[[], None] | None = None
        self.runs: list[tuple[Seen, PaperSteps]] = []
        self.frame, self.place, self.shown, self.problem = 0, 0, False, problem

    def watch(self) -> None:
        """Say that somebody looks, in each frame of the window."""
        self._watched = True

    def update(self, traced: Traced | None, idle: bool) -> None:
        """Take up what has been run, and run the newest picture, `traced`, when `idle`."""
        picked, at = self._selection.picked, self._selection.pixel
        if picked is not self._of:
            self._of = picked
            self._forget("", None)
        self.shown, self._watched = self._watched, False
        if not self.shown or not idle or traced is None or not traced.whole or at is None:
            return
        if self._taken is traced.frame.primitive:
            return
        self._newest.take(self._query(run_text, traced.frame, *at))
        if self._newest.problem:
            self._forget(f"No steps: {self._newest.problem}.", traced.frame.primitive)
        answer: Answer | None = self._newest.answer  # of the frame before, perhaps
        if answer is not None and answer[1] is not None and answer[0].primitive is not self._taken:
            self._take(answer[0], answer[1])

    def _take(self, frame: Frame, found: PaperSteps | str) -> None:
        """Add the steps of a frame, and go there if that is wanted, or if it is another view or has forgotten modes."""
        if isinstance(found, str):
            self._forget(found, frame.primitive)
            return
        self._taken, self.problem = frame.primitive, ""
        before, run = [(seen, steps.method) for seen, steps in self.runs[-1:]], (seen_of(frame), found)
        known = frame.modes_before[list(found.modes)].tolist()
        forgotten = INIT in known and set(known) <= {INIT, DYNAMIC}
        if self.wanted is not None or forgotten or before != [(run[0], found.method)]:
            self.runs = [*self.runs[1 - MOST_KEPT :], run]
            self.frame, self.place = len(self.runs) - 1, 0
            wanted, self.wanted = self.wanted, None
            if wanted is not None:
                wanted()
        elif len(self.runs) < MOST_KEPT:
            self.runs.append(run)

    @property
    def now(self) -> PaperSteps | None:
        """The steps of the frame that one is in."""
        return self.runs[self.frame][1] if self.runs else None

    def step_in(self, frame: Frame) -> Step | None:
        """The step that is shown, if it speaks of what this frame shows."""
        there = self.shown and self.now is not None and self.runs[self.frame][0] == seen_of(frame)
        return self.now.steps[self.place] if there and self.now is not None else None

    def go(self, by: int) -> None:
        """Go a step on or back, also into the frame after this one, or before it."""
        if self.now is None:
            return
        place = self.place + by
        if place >= len(self.now.steps):
            self._go_on(lambda: None)
            return
        self.wanted = None  # whoever goes back waits for no frame any more
        if place >= 0:
            self.place = place
        elif self.frame:
            self.frame -= 1
            self.place = len(self.now.steps) - 1

    def go_to_change(self) -> None:
        """Go to the next step that changes a mode; past the last one to the end of the frame, and then on."""
        if self.now is None:
            return
        steps, last = self.now.steps, len(self.now.steps) - 1
        if self.place == last:
            self._go_on(self.go_to_change)
        else:
            self.place = next((at for at in range(self.place + 1, last) if steps[at].changes), last)

    def _go_on(self, there: Callable[[], None]) -> None:
        """Go to the first step of the next frame, once it is there, and do something there."""
        if self.frame == len(self.runs) - 1:
            self.wanted = there
            self._trace_again()
        else:
            self.frame, self.place = self.frame + 1, 0
            there()
