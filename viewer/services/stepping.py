"""The paper's text run line by line for the pixel that is selected: where the user is in it, over several frames.

Each frame that is shown is run as a query, where somebody looks.  Frames that have been run are kept, so that one can
step back into them; stepping on past the end of the newest traces the same frame once more."""

from __future__ import annotations

from collections.abc import Callable

from tracer.frame import Frame
from tracer.inspect.paper_steps import PaperSteps, Step, paper_steps
from tracer.renderer import Renderer
from viewer.services.inspector import Selection
from viewer.services.render_request import Ask, Newest, Traced, is_same_picture
from viewer.state.picking import Pick, same_place

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
    """The steps of the selected pixel, frame after frame, and the one that is shown; `problem` says why there are
    none."""

    def __init__(self, selection: Selection, query: Ask, trace_again: Callable[[], None]) -> None:
        self._selection, self._query, self._trace_again = selection, query, trace_again
        self._newest = Newest()
        self._of: Pick | None = None
        self._frame: Frame | None = None  # that was run last
        self._watched = False
        self._wanted = ""  # where the user goes in the next frame: to its "first" step, or its first "change"
        self.frames: list[PaperSteps] = []
        self.frame = self.place = 0  # of the step that is shown: its frame, and its place there
        self.shown, self.problem = False, ""

    def watch(self) -> None:
        """Say that somebody looks, in each frame of the window."""
        self._watched = True

    def update(self, traced: Traced | None, idle: bool) -> None:
        """Take up what has been run, and run the newest picture, `traced`, when `idle`."""
        self.shown, self._watched = self._watched, False
        if self._selection.picked is not self._of:
            self._of, self._newest, self._frame = self._selection.picked, Newest(), None
            self.frames, self.frame, self.place, self._wanted, self.problem = [], 0, 0, "", ""
        at = self._selection.pixel
        if not self.shown or not idle or traced is None or not traced.whole or at is None:
            return
        if self._stays_with(traced):
            return
        self._newest.take(self._query(run_text, traced.frame, *at))
        if self._newest.answer is not None and is_same_picture(self._newest.answer[0], traced.frame):
            self._take(*self._newest.answer)

    def _stays_with(self, traced: Traced) -> bool:
        """Whether what has been run last is still what one wants to see."""
        last = self._frame
        if last is None or is_same_picture(last, traced.frame):
            return last is not None
        return bool(self.frames) and traced.request.refines and not self._wanted and same_place(last, traced.frame)

    def _take(self, frame: Frame, found: PaperSteps | str | None) -> None:
        if found is None:
            return
        self._frame, self.problem = frame, found if isinstance(found, str) else ""
        if isinstance(found, str):
            self.frames, self.frame, self.place = [], 0, 0
        else:
            self.frames = [*self.frames[1 - MOST_KEPT :], found]
            self.frame, self.place = len(self.frames) - 1, 0
            if self._wanted == "change":
                self.go_to_change()
        self._wanted = ""

    # --- where one is -------------------------------------------------------------------------------

    @property
    def now(self) -> PaperSteps | None:
        """The steps of the frame that one is in."""
        return self.frames[self.frame] if self.frames else None

    @property
    def step(self) -> Step | None:
        """The step that is shown."""
        return self.frames[self.frame].steps[self.place] if self.frames else None

    @property
    def waits(self) -> bool:
        """Whether the next frame is on its way."""
        return bool(self._wanted)

    def is_of(self, frame: Frame) -> bool:
        """Whether the step that is shown speaks of what this frame shows."""
        newest = self.shown and bool(self.frames) and self.frame == len(self.frames) - 1
        return newest and self._frame is not None and same_place(self._frame, frame)

    def go(self, by: int) -> None:
        """Go a step on or back, also into the frame after this one, or before it."""
        if self.now is None:
            return
        place = self.place + by
        if 0 <= place < len(self.now.steps):
            self.place = place
        elif place < 0 and self.frame > 0:
            self.frame -= 1
            self.place = len(self.now.steps) - 1
        elif place > 0:
            self._go_on("first")

    def go_to_change(self) -> None:
        """Go to the next step that changes a mode; past the last one to the end of the frame, and then on."""
        if self.now is None:
            return
        steps, last = self.now.steps, len(self.now.steps) - 1
        if self.place == last:
            self._go_on("change")
        else:
            self.place = next((at for at in range(self.place + 1, last) if steps[at].changes), last)

    def _go_on(self, wanted: str) -> None:
        """Go to the next frame, once it is there."""
        if self.frame < len(self.frames) - 1:
            self.frame, self.place = self.frame + 1, 0
            if wanted == "change":
                self.go_to_change()
        else:
            self._wanted = wanted
            self._trace_again()
