"""Comparing the live picture, B, with A: one that was kept, or the same traced by a second method.

What is drawn of the two, and what is told, is decided here; `viewer.state.comparison` says what the words mean.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from tracer.frame import Frame
from tracer.method import Method, bases
from viewer.services.frame_scheduler import FrameScheduler
from viewer.state.comparison import Compare, CompareMode, Side, Source, named, sizes_in_words
from viewer.state.draw_options import DrawOptions, Slice
from viewer.state.methods import BY_MODES, NO_CULLING
from viewer.state.notices import Notices
from viewer.state.readings import can_draw
from viewer.state.session import Session
from viewer.state.views import View
from viewer.util.numbers import whole_percent
from viewer.views import values_of
from viewer.views.compare import Difference, difference_of


class Comparing:
    """`kept` is A as it was kept, `held` says that A is to be seen while a key is held; the rest is in the state."""

    def __init__(self, session: Session, scheduler: FrameScheduler, notices: Notices) -> None:
        self._session, self._scheduler, self._notices = session, scheduler, notices
        self.kept: Side | None = None
        self.held = False
        self._difference: tuple[Side, Side, Slice, Difference | None] | None = None
        self._span: tuple[Frame, Frame, dict[View, tuple[float, float]]] | None = None

    @property
    def state(self) -> Compare:
        """Whether and how pictures are compared."""
        return self._session.state.compare

    def change(self, **fields: Any) -> None:
        """Compare otherwise."""
        self._session.change(compare=replace(self.state, **fields))

    # --- what is compared ------------------------------------------------------------------------

    @property
    def b(self) -> Side | None:
        """The live picture."""
        frame = self._scheduler.frame
        return None if frame is None else self._side(frame, self._scheduler.drawn_view)

    @property
    def a(self) -> Side | None:
        """What it is compared with, as far as it is there."""
        state, session = self.state, self._session
        if state.source is Source.METHOD:
            second = self._scheduler.traced.second if self._scheduler.traced is not None else None
            if second is None:
                return None
            view = self._scheduler.drawn_view
            return self._side(second, view if can_draw(second, view, session.draw.light) else View.COLOR)
        kept = self.kept
        if kept is not None and state.same_view and can_draw(kept.frame, session.draw.view, session.draw.light):
            view, light = self._scheduler.drawn_view, session.draw.light
            return replace(kept, view=view, light=light, light_number=session.light_number)
        if kept is not None and not can_draw(kept.frame, kept.view, kept.light):
            return replace(kept, view=View.COLOR)  # what it showed is gone, as a tree is with its world
        return kept

    def _side(self, frame: Frame, view: View) -> Side:
        session = self._session
        name = session.scene.path.stem if session.scene is not None else ""
        return Side(frame, view, session.draw.light, name, session.frame_at(frame.time), session.light_number)

    @property
    def sides(self) -> tuple[Side, Side] | None:
        """A and B, while both are there and are to be compared."""
        if not self.state.on:
            return None
        a, b = self.a, self.b
        return None if a is None or b is None else (a, b)

    def names(self, a: Side, b: Side) -> tuple[str, str]:
        """What the picture calls the two."""
        return f"A  {named(a, b)}", f"B  {named(b, a)}"

    @property
    def remark(self) -> str:
        """What is to be known about the two, in a line: sizes that differ, or why nothing is compared."""
        a, b, state = self.a, self.b, self.state
        if a is None and state.source is Source.KEPT:
            return "Nothing is kept as A yet: choose Keep as A." if state.on else ""
        if a is None or b is None:
            return f"Tracing by {state.second} as well ..." if state.on else ""
        if state.on and state.mode is CompareMode.DIFFERENCE and self.difference(a, b) is None:
            return f"A has nothing for the view {b.view.label}: choose another view, or keep A in this one."
        if state.on and state.source is Source.METHOD and a.view is not b.view:
            return f"The frame by {a.method} has nothing for the view {b.view.label}: its picture is shown."
        coarse = self._scheduler.traced is not None and self._scheduler.traced.request.divisor > 1
        return "" if coarse and state.source is Source.KEPT else sizes_in_words(a.frame, b.frame)

    def difference(self, a: Side, b: Side) -> Difference | None:
        """B - A in the view of B; None where A has nothing for it."""
        known, cut = self._difference, self._session.draw.slice
        same = known is not None and known[0].frame is a.frame and known[1].frame is b.frame
        if known is not None and same and (known[1].view, known[1].light, known[2]) == (b.view, b.light, cut):
            return known[3]
        found = None
        if can_draw(a.frame, b.view, b.light) and can_draw(b.frame, b.view, b.light):
            draw = DrawOptions(view=b.view, light=b.light, slice=cut)
            found = difference_of(values_of(a.frame, draw), values_of(b.frame, draw))
        self._difference = a, b, cut, found
        return found

    def limit(self, found: Difference) -> float:
        """The range of a difference, as chosen or as it fits."""
        return self.state.limit or found.stats.limit

    def span(self, view: View) -> tuple[float, float] | None:
        """The range that maps of numbers have: chosen, or one for both pictures, so that a colour means the same in A
        and in B; None for what each frame has."""
        chosen, sides = replace(self._session.draw, view=view).span, self.sides
        if chosen is not None or sides is None or not view.has_range or {side.view for side in sides} != {view}:
            return chosen
        frames = sides[0].frame, sides[1].frame
        if self._span is None or self._span[0] is not frames[0] or self._span[1] is not frames[1]:
            self._span = (*frames, {})
        spans = self._span[2]
        if view not in spans:
            both = [view.declared.span(frame) for frame in frames]
            spans[view] = min(low for low, _ in both), max(high for _, high in both)
        return spans[view]

    # --- what the user does ----------------------------------------------------------------------

    def keep(self) -> None:
        """Keep what is shown now as A."""
        b = self.b
        if b is None:
            self._notices.say("there is no picture to keep yet", error=True)
            return
        self.kept = b
        self.change(source=Source.KEPT)
        part = b.frame.statistics.part
        coarse = f", of which {whole_percent(part)} of the pixels are shaded yet" if part < 1.0 else ""
        self._notices.say(f"kept as A: {b.method}, {b.view.label.lower()}, frame {b.number}{coarse}")

    def forget(self) -> None:
        """Clear A: forget what was kept."""
        self.kept = self._difference = None
        if self.state.source is Source.KEPT:
            self.end()

    def start(self, mode: CompareMode) -> None:
        """Compare in this way."""
        self.change(on=True, mode=mode)
        if self._session.draw.view is View.WIPE:  # one line is enough
            self._session.set_draw(view=View.COLOR)
        if self.state.source is Source.KEPT and self.kept is None:
            self._notices.say(self.remark)

    def toggle(self, mode: CompareMode) -> None:
        """Compare in this way, or no longer if that is done already."""
        if self.state.on and self.state.mode is mode:
            self.end()
        else:
            self.start(mode)

    def next_mode(self) -> None:
        """Compare in the next of all ways; after the last in the first."""
        modes = list(CompareMode)
        now = modes.index(self.state.mode)
        self.start(modes[(now + 1) % len(modes)] if self.state.on else self.state.mode)

    def end(self) -> None:
        self.change(on=False)
        self.held = False
        self._difference = self._span = None

    def use(self, source: Source) -> None:
        """Take A from here."""
        self.change(source=source, second=self.state.second or self._other_method())

    def trace_by(self, method: str) -> None:
        """Let this be the second method, and compare with it."""
        self.change(source=Source.METHOD, second=method)

    def toggle_methods(self) -> None:
        """Trace each frame by a second method as well, side by side, or no longer."""
        if self.state.on and self.state.source is Source.METHOD:
            self.end()
            return
        if self.state.second == self._session.settings.method:
            self.change(second="")
        self.use(Source.METHOD)
        self.start(CompareMode.SIDE)

    def _other_method(self) -> str:
        """What is worth comparing with the method that is chosen: none at all, or else the paper's."""
        culls = Method.parse(self._session.settings.method).culls
        names = [kind.name for kind in bases()]
        return NO_CULLING if culls and NO_CULLING in names else BY_MODES

    # --- one frame -------------------------------------------------------------------------------

    def end_beside_wipe(self) -> None:
        """End the comparison where the wipe against the right picture is chosen: one line is enough."""
        if self.state.on and self._session.draw.view is View.WIPE:
            self.end()
            self._notices.say("the comparison with A has ended: this wipe compares with the right picture")

    @property
    def second_method(self) -> str:
        """The method by which frames are traced as well, while that is to be seen; else ""."""
        return self.state.second if self.state.on and self.state.source is Source.METHOD else ""

    def blinks(self) -> bool:
        """Whether the window must be drawn again and again."""
        return self.state.on and self.state.mode is CompareMode.BLINK and self.sides is not None
