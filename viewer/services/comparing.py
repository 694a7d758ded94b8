"""Comparing the live picture, B, with A: one that was kept, or the same traced by a second method."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from tracer.frame import Frame
from tracer.method import Method, title_of
from viewer.services.frame_scheduler import FrameScheduler
from viewer.state.comparison import Compare, CompareMode, Side
from viewer.state.draw_options import DrawOptions, Slice
from viewer.state.methods import BY_MODES, NO_CULLING
from viewer.state.notices import Notices
from viewer.state.session import Session
from viewer.state.views import View, can_draw
from viewer.util.numbers import several, whole_percent
from viewer.views import values_of
from viewer.views.compare import Difference, difference_of

NOTHING_KEPT = "Nothing is kept as A yet: choose Keep as A."


@dataclass(frozen=True)
class Seen:
    """A and B in one of the window's frames, and how they are seen: `shows_a` while A alone is, and with their signed
    `difference` while that is."""

    a: Side
    b: Side
    mode: CompareMode
    shows_a: bool = False
    difference: Difference | None = None

    @property
    def has_line(self) -> bool:
        """Whether A is left of a line, and B right of it."""
        return self.mode is CompareMode.WIPE and not self.shows_a

    @property
    def names(self) -> tuple[str, str]:
        """What the picture calls the two."""
        return f"A  {self.a.named(self.b)}", f"B  {self.b.named(self.a)}"


class Comparing:
    """`kept` is A as it was kept, `held` says that A is to be seen while a key is held, and `seen` is what is seen in
    this frame of the window, None where only B is; the rest is in the state."""

    def __init__(self, session: Session, scheduler: FrameScheduler, notices: Notices) -> None:
        self._session, self._scheduler, self._notices = session, scheduler, notices
        self.kept: Side | None = None
        self.held = False
        self.seen: Seen | None = None
        self._difference: tuple[tuple[Frame, Frame, View, int, Slice], Difference | None] | None = None

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
        frame, session = self._scheduler.frame, self._session
        if frame is None:
            return None
        name, number = session.scene.path.stem if session.scene else "", session.frame_at(frame.time)
        return Side(frame, self._scheduler.drawn_view, session.draw.light, name, number, session.light_number)

    @property
    def a(self) -> Side | None:
        """What it is compared with, as far as it is there: in the view of B, or as a picture where its frame has
        nothing for that."""
        b, traced, found = self.b, self._scheduler.traced, self.kept
        if b is None or traced is None:
            return None
        if self.state.second:
            found = replace(b, frame=traced.second) if traced.second is not None else None
        if found is None:
            return None
        view = b.view if can_draw(found.frame, b.view, b.light) else View.COLOR
        return replace(found, view=view, light=b.light, light_number=b.light_number)

    def update(self) -> None:
        """Decide what is seen in this frame of the window."""
        if self.state.on and self._session.draw.view is View.WIPE:  # one line is enough
            self.end()
            self._notices.say("the comparison with A has ended: this wipe compares with the right picture")
        a, b, mode = self.a if self.state.on else None, self.b, self.state.mode
        if a is None or b is None:
            self.seen = self._difference = None
            return
        shows_a = self.held and mode is not CompareMode.SIDE
        found = self.difference(a, b) if mode is CompareMode.DIFFERENCE else None
        if mode is CompareMode.DIFFERENCE and found is None:
            mode = CompareMode.FLIP
        self.seen = Seen(a, b, mode, shows_a, None if shows_a else found)

    @property
    def remark(self) -> str:
        """What is to be known about the two, in a line: sizes that differ, or why nothing is compared."""
        a, b, state = self.a, self.b, self.state
        if not state.on:
            return ""
        if a is None or b is None:
            return f"Tracing by {title_of(state.second)} as well ..." if state.second else NOTHING_KEPT
        if a.view is not b.view:
            return f"A has nothing for the view {b.view.label}: its picture is shown. Keep A again in this view."
        sizes = [f"{side.frame.width} x {side.frame.height}" for side in (a, b)]
        if sizes[0] != sizes[1]:
            coarse = self._scheduler.traced is not None and self._scheduler.traced.request.divisor > 1
            return "" if coarse else f"A has {sizes[0]} pixels, B {sizes[1]}: A is shown in B's size."
        samples = a.frame.settings.samples, b.frame.settings.samples
        if samples[0] != samples[1]:
            had = several(samples[0], "sample")
            return f"A has {had} a pixel, B {samples[1]}: edges differ by that. Keep A again at as many."
        return ""

    def difference(self, a: Side, b: Side) -> Difference | None:
        """Return B - A in the view of B, found once; None where A has nothing for it."""
        of = a.frame, b.frame, b.view, b.light, self._session.draw.slice
        if self._difference is None or self._difference[0] != of:
            found = None
            if can_draw(a.frame, b.view, b.light) and can_draw(b.frame, b.view, b.light):
                draw = DrawOptions(view=b.view, light=b.light, slice=self._session.draw.slice)
                found = difference_of(values_of(a.frame, draw), values_of(b.frame, draw))
            self._difference = of, found
        return self._difference[1]

    def limit(self, found: Difference) -> float:
        """Return the range of a difference: as it fits, and smaller with more exposure."""
        return found.stats.limit * 2.0**-self._session.draw.tone.exposure

    def span(self, view: View) -> tuple[float, float] | None:
        """Return the range that maps of numbers have: chosen, or one for both pictures, so that a colour means the same
        in A and in B; None for what each frame has."""
        chosen, a = replace(self._session.draw, view=view).span, self.a if self.state.on else None
        if chosen or a is None or not view.has_range or (b := self.b) is None or {a.view, b.view} != {view}:
            return chosen
        lows, highs = zip(view.declared.span(a.frame), view.declared.span(b.frame), strict=True)
        return min(lows), max(highs)

    # --- what the user does ----------------------------------------------------------------------

    def keep(self) -> None:
        """Keep what is shown now as A."""
        b = self.b
        if b is None:
            self._notices.say("there is no picture to keep yet", error=True)
            return
        self.kept = b
        self.trace_by("")
        part = b.frame.statistics.part
        coarse = f"; {whole_percent(part)} of its pixels are shaded" if part < 1.0 else ""
        self._notices.say(f"kept as A: {b.method}, {b.view_in_words}, frame {b.number}{coarse}")

    def forget(self) -> None:
        """Clear A: forget what was kept."""
        self.kept = None
        if not self.state.second:
            self.end()

    def start(self, mode: CompareMode) -> None:
        """Compare in this way."""
        self.change(on=True, mode=mode)
        if self._session.draw.view is View.WIPE:  # one line is enough
            self._session.set_draw(view=View.COLOR)
        if not self.state.second and self.kept is None:
            self._notices.say(NOTHING_KEPT)

    def toggle(self, mode: CompareMode) -> None:
        """Compare in this way, or no longer if that is done already."""
        if self.state.on and self.state.mode is mode:
            self.end()
        else:
            self.start(mode)

    def next_mode(self) -> None:
        """Compare in the next of all ways; after the last in the first."""
        modes = list(CompareMode)
        self.start(modes[(modes.index(self.state.mode) + 1) % len(modes)] if self.state.on else self.state.mode)

    def end(self) -> None:
        """Show B alone."""
        self.change(on=False)
        self.held = False

    @property
    def other_method(self) -> str:
        """The method that the chosen one is compared with unless another is said: `none`, or by the paper's modes."""
        return NO_CULLING if Method.parse(self._session.settings.method).culls else BY_MODES

    def trace_by(self, method: str) -> None:
        """Trace A by this method, live; "" for a picture that was kept."""
        self.change(second=method)

    def toggle_methods(self) -> None:
        """Trace each frame by a second method as well, side by side, or no longer."""
        if self.second_method:
            self.end()
            return
        second = self.state.second
        self.trace_by(second if second and second != self._session.settings.method else self.other_method)
        self.start(CompareMode.SIDE)

    @property
    def second_method(self) -> str:
        """The method by which frames are traced as well, while that is to be seen; else ""."""
        return self.state.second if self.state.on else ""
