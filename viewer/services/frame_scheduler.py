"""Takes what should be seen, and gives frames of it: a quick part first, the whole, more samples of lamps, further
frames until modes settle, and more samples a pixel.

`request` asks the render thread for the next frame of these, once in each frame of the window, and `take` returns what
has come.  Nothing is asked for twice, and nothing at all while a run has the render thread."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from enum import Enum
from typing import Any, NamedTuple

from tracer.frame import Frame
from tracer.inspect.one_light import with_light
from tracer.renderer import Renderer
from viewer.services.frame_budget import AT_ONCE, FrameBudget, Plan, divided
from viewer.services.frame_inputs import FrameInputs
from viewer.services.refinement import LampSamples, Refinement
from viewer.services.render_request import FramesBefore, Newest, RenderRequest, Traced, as_asked, missing_buffers
from viewer.services.render_thread import RenderThread
from viewer.services.runs import missing_in, shown_of
from viewer.state.methods import can_ask, missing
from viewer.state.picking import same_place
from viewer.state.view_state import ViewState
from viewer.state.views import Record, View, can_draw
from viewer.views import view_of


class Activity(Enum):
    """What comes next of a picture."""

    RESTING = "nothing"
    TRACING = "a frame, or the rest of it"
    SAMPLING_LAMPS = "the whole picture that is shown, with more samples of lamps"
    CERTIFYING = "the picture that is shown, with more certificates"
    ADDING_SAMPLES = "more samples a pixel"


class FrameScheduler:
    """`traced` is the newest frame with the request it answers; `inputs` are those of the last request."""

    def __init__(self, thread: RenderThread, wake: Callable[[], None] = lambda: None) -> None:
        self._thread, self._wake = thread, wake
        self.inputs = FrameInputs()
        self.traced: Traced | None = None
        self.budget, self.refinement, self.lamps = FrameBudget(), Refinement(), LampSamples()
        self._serial = 0
        self._frozen: tuple[object, FramesBefore] | None = None  # what stays as it was found, and the frames before it
        self._refines = False  # whether the last frame was asked for to refine what is known
        self._asked: RenderRequest | None = None
        self._new = False  # the scene
        self._failed: RenderRequest | None = None
        self._newest = Newest()  # layers that the renderer was asked for
        self._used: _Layers | None = None
        self._counted = 0  # percent of those that are on their way

    # --- what is given ----------------------------------------------------------------------------

    @property
    def frame(self) -> Frame | None:
        return self.traced.frame if self.traced is not None else None

    def take(self) -> Traced | None:
        """Return the newest frame that the render thread has made, once."""
        traced = self._thread.take()
        if traced is None:
            return None
        if self.traced is None or self.traced.request is not traced.request:
            if not traced.request.refines:  # else it took its time for certificates, not for its pixels
                pixels = traced.frame.width * traced.frame.height
                self.budget.observe(traced.first, pixels, self.lamps.most(traced.request.settings))
        self.traced = traced
        return traced

    def record_light(self) -> None:
        """Have what the view shows found for the newest frame, where the frame lacks it: the chosen light, as there
        are too many lights to record all of them in every frame, or what views ask the renderer for."""
        frame, draw = self.frame, self.inputs.state.draw
        if frame is None or self.inputs.run is not None or draw.light >= frame.lights:
            return
        lacks = not (frame.settings.record_lights or can_draw(frame, draw.view, draw.light))
        if lacks and draw.view.records is Record.LIGHTS and draw.view.of_light:
            answer = self._thread.query(_with_light, frame, draw.light)
            if answer.done() and not answer.cancelled() and answer.exception() is None and self.traced is not None:
                found: Frame = answer.result()  # with as many samples, or fewer: the light is the same
                frame = replace(frame, asked=found.asked, reached=found.reached, only_light=draw.light)
                self.traced = replace(self.traced, frame=frame)
        if can_ask(frame, draw.view):
            self._newest.take(self._thread.query(_asked, frame, draw.view, draw.light, self._report))
            self._show_layers(frame, self._newest.answer)

    def _report(self, part: float) -> None:
        """Note which part of the layers is there, as the renderer's threads say, and show it."""
        percent = int(100.0 * part) % 100
        if percent > self._counted or percent == 0:  # threads report in any order
            self._counted = percent
            self._wake()

    def _show_layers(self, frame: Frame, found: _Layers | None) -> None:
        """Give the newest frame what was found last: for the frame before, until its own is there."""
        draw = self.inputs.state.draw
        if found is None or found.of != (draw.view, draw.light) or not same_place(found.frame, frame):
            return
        if self.traced is not None and (found is not self._used or not can_draw(frame, draw.view, draw.light)):
            self.traced = replace(self.traced, frame=replace(frame, layers=frame.layers | found.layers))
            self._used = found

    # --- what is forgotten, and traced again --------------------------------------------------------

    def forget(self) -> None:
        """Begin with another scene: it has no frame yet, and its pixels cost something else."""
        self.traced = self._asked = None
        self._new = True
        self.budget.forget()
        self.forget_modes()

    def trace_once_more(self) -> None:
        """Trace what was traced last once more."""
        self._serial += 1

    def trace_again(self) -> None:
        """Trace the same frame once more for the user: culling may know more now.  One under way is let finish."""
        if not self._thread.busy:
            self.trace_once_more()

    def forget_modes(self) -> None:
        """Note that nothing is known about shadows any more, and trace what was traced last once more."""
        self.refinement.forget()
        self.trace_once_more()

    def freeze(self, state: ViewState, warmup: FramesBefore) -> None:
        """Forget all modes, trace these frames, and then a state, with one sample a pixel; no further frame follows, as
        that would know more, until something else is looked at, or asked for."""
        self.forget_modes()
        self._frozen = _what_freezes(state), warmup

    def give_up(self) -> None:
        """Note that what was asked for has failed: it will not come."""
        self._failed = self._asked

    # --- the next frame -----------------------------------------------------------------------------

    def request(self, inputs: FrameInputs) -> None:
        """Ask for the frame that should come next, unless it has been asked for, or is there."""
        self.inputs = inputs
        self.lamps.update(inputs.scene.lights if inputs.scene is not None else (), inputs.state.settings)
        if inputs.run is not None or inputs.edited:
            self._asked = None  # what was asked for has been dropped
            return
        if inputs.scene is None or min(self.inputs.full_size) < 1:
            return
        if self._new:  # what the scene brings into the window changes the room for its picture
            self._new = False
            self._wake()
            return
        if inputs.at_rest and not self._lacks_lamp_samples and self._should_refine():
            self._serial += 1
            self._refines = True
        self._refines = self._refines and inputs.at_rest
        wanted = self._next_request()
        made = self._asked
        if made is None and self.traced is not None and self.samples_shown >= wanted.samples:
            made = self.traced.request  # it holds what is wanted already
        if made is None or not made.covers(wanted):
            if inputs.inspected and self._is_to_be_seen_before(wanted):
                return  # else the next frame of a film would begin before this one is asked about
            self._asked = wanted
            self._thread.submit(wanted)

    def _is_to_be_seen_before(self, wanted: RenderRequest) -> bool:
        """Return whether what was asked for last is still to come, and is worth it though something else is wanted."""
        coming = self._coming
        if coming is None or coming.serial != self._serial:  # forgetting modes has cut it short
            return False
        return not wanted.supersedes(coming, self._is_shown(coming))

    def _should_refine(self) -> bool:
        """Whether, at rest, one more frame of the same view will know more about shadows."""
        view, keep_tracing = self.inputs.state.draw.view, self.inputs.state.pace.keep_tracing
        stays = self.is_frozen and not keep_tracing
        return not stays and self.refinement.wants_another(self.traced, view, keep_tracing)

    def _next_request(self) -> RenderRequest:
        now, lamp_samples = self.inputs, self._next_lamp_samples()
        plan = self._plan(lamp_samples)
        width, height = divided(*now.full_size, plan.divisor)
        settings, samples = replace(now.settings, width=width, height=height, samples=1), self.samples_wanted
        if lamp_samples < self.lamps.wanted:
            settings, samples = replace(settings, lamp_samples=lamp_samples), 1
        return RenderRequest(
            now.state.time, now.camera, settings, plan.divisor, self._serial,
            self._refines, samples, now.second_method,
            parts=plan.parts, quick=not now.at_rest, focus=now.focus,
            warmup=self._frozen[1] if self._frozen is not None and self.is_frozen else None,
        )  # fmt: skip

    def _plan(self, lamp_samples: int) -> Plan:
        """Return how the frame comes about: at once where it refines what is shown, and where each is to be whole."""
        now = self.inputs
        if self._refines or (now.at_rest and lamp_samples > self.lamps.first) or now.each_is_whole:
            return AT_ONCE
        return self.budget.plan(*now.full_size, now.frame_seconds, now.moving, now.playing, lamp_samples)

    def _next_lamp_samples(self) -> int:
        """Return how many samples lamps have in the next frame: all of them once a picture with fewer is there."""
        now, lamps = self.inputs, self.lamps
        return lamps.wanted if (self._shows_inputs and now.at_rest) or now.each_is_whole else lamps.first

    # --- what the newest frame is -------------------------------------------------------------------

    @property
    def _coming(self) -> RenderRequest | None:
        """What was asked for last, unless that has failed."""
        return None if self._asked is self._failed else self._asked

    def _is_shown(self, request: RenderRequest) -> bool:
        """Return whether the newest frame, or what there is of it, answers this."""
        return self.traced is not None and self.traced.request == request

    @property
    def activity(self) -> Activity:
        """What is to come of what was asked for."""
        coming, traced = self._coming, self.traced
        if coming is None:
            return Activity.RESTING
        if traced is not None and traced.whole and self._is_shown(coming):
            return Activity.ADDING_SAMPLES if self.samples_shown < coming.samples else Activity.RESTING
        if self._lacks_lamp_samples:
            return Activity.SAMPLING_LAMPS
        certifies = coming.refines and self.refinement.proves and not self.outdated
        return Activity.CERTIFYING if certifies else Activity.TRACING

    @property
    def becoming_finer(self) -> bool:
        """Whether a part of the picture is shown and the whole of the same view is to come."""
        return self.traced is not None and not self.traced.complete and not self.inputs.playing

    @property
    def shows_edits(self) -> bool:
        """Whether some of a picture has come since the scene was edited, or was to be traced again."""
        return self.traced is not None and self.traced.request.serial == self._serial

    @property
    def lamp_samples_shown(self) -> int:
        """How many samples the lamps of the newest frame have, that with the most."""
        return self.lamps.most(self.traced.frame.settings) if self.traced is not None else 0

    @property
    def _shows_inputs(self) -> bool:
        """Whether there is a whole picture of what should be seen now, however finely."""
        if self.traced is None or not self.traced.whole:
            return False
        now, shown = self.inputs, self.traced.request
        wanted = now.state.time, now.camera, now.second_method, as_asked(self.inputs.settings, shown.settings)
        return wanted == (shown.time, shown.camera, shown.second, shown.settings)

    @property
    def _lacks_lamp_samples(self) -> bool:
        """Whether the same picture with more samples of lamps should follow."""
        return self._shows_inputs and self.lamp_samples_shown < self.lamps.wanted

    @property
    def samples_shown(self) -> int:
        """How many samples a pixel has; 0 while not all have one."""
        return self.traced.frame.settings.samples if self.traced is not None and self.traced.whole else 0

    @property
    def samples_wanted(self) -> int:
        """How many it should have at rest."""
        return 1 if self.is_frozen else self.inputs.state.settings.samples

    @property
    def is_frozen(self) -> bool:
        """Whether the picture stays as it was found, with one sample a pixel."""
        return self.freezes(self.inputs.state)

    def freezes(self, state: ViewState) -> bool:
        """Return whether the picture of a state would stay so."""
        return self._frozen is not None and self._frozen[0] == _what_freezes(state)

    @property
    def outdated(self) -> bool:
        """Whether the newest frame was traced with other settings than those now chosen, or lacks what they ask for."""
        if self.frame is None or self.inputs.run is not None:
            return False
        had, wanted = self.frame.settings, self.inputs.settings
        return missing_buffers(had, wanted) or as_asked(wanted, had) != had

    @property
    def magnified(self) -> int:
        """How many of the screen's pixels show one of the newest frame's, from side to side; 1 at least."""
        if self.frame is None:
            return 1
        width, height = self.inputs.size
        return max(1, round(min(width / self.frame.width, height / self.frame.height)))

    @property
    def drawn_view(self) -> View:
        """The view to draw the newest frame in: the picture while one that needs more of a frame waits for it."""
        draw = self.inputs.state.draw
        return draw.view if self.frame is None or can_draw(self.frame, draw.view, draw.light) else View.COLOR

    @property
    def title(self) -> str:
        """The view, and the light where it shows one; before it what a run that is under way is at."""
        now, view = self.inputs, self.drawn_view
        draw, run = now.state.draw, now.run
        title = view_of(view).title(draw, now.scene.lights if now.scene is not None else ())
        if run is not None:
            lacks = draw.view is not view and missing_in(run, draw.view)
            return f"{shown_of(run)}   {title}{f' (this run {lacks})' if lacks else ''}"
        if self.frame is None or draw.view is view:
            return title
        settings, asks = self.inputs.settings, can_ask(self.frame, draw.view)
        comes = settings.record_fates if draw.view.records is Record.FATES else asks or draw.view.records is not None
        comes &= draw.view.asks is None or missing(draw.view, self.frame) is None
        if not (settings.record_lights if draw.view is View.LIGHTS else comes):  # the picture says why
            return f"{draw.view.label}: not available here, {view.label.lower()} shown"
        counted = f" {self._counted} %" if self._counted and asks else ""
        return f"{draw.view.label}: {'verifying' if draw.view.records is Record.VERIFY else 'counting'}{counted} ..."


def _with_light(renderer: Renderer, frame: Frame, light: int, _cancelled: Callable[[], bool]) -> Frame:
    return with_light(renderer, frame, light)


class _Layers(NamedTuple):
    """What the renderer has found of a frame for a view and a light."""

    of: tuple[View, int]
    frame: Frame
    layers: dict[str, Any]


def _asked(
    renderer: Renderer, frame: Frame, view: View, light: int, report: Callable[[float], None],
    cancelled: Callable[[], bool],
) -> _Layers | None:  # fmt: skip
    report(0.0)
    try:
        assert view.asks is not None, "it can be asked"
        return _Layers((view, light), frame, view.asks(renderer, frame, light, cancelled, report))
    except LookupError:  # lights have moved on in another frame, which will be asked about
        return None


def _what_freezes(state: ViewState) -> object:
    return state.time, state.camera, state.settings.method, state.settings.samples
