"""Takes what should be seen, and gives frames of it: a quick part first, the whole, more samples of lamps, further
frames until modes settle, and more samples a pixel.

`request` asks the render thread for the next frame of these, once in each frame of the window, and `take` returns what
has come.  Nothing is asked for twice, and nothing at all while a run has the render thread.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from tracer.experiments.runner import Run
from tracer.frame import Frame, Settings
from tracer.method import Method
from tracer.one_light import with_light
from tracer.renderer import Renderer
from tracer.scene.model import Camera
from tracer.settings import RECORDS
from viewer.services import refinement
from viewer.services.frame_budget import AT_ONCE, FrameBudget, Plan, divided
from viewer.services.refinement import LampSamples, Refinement
from viewer.services.render_request import RenderRequest, Traced, Warmup
from viewer.services.render_thread import RenderThread
from viewer.services.runs import missing_in, shown_of
from viewer.state.methods import NO_CULLING, with_base
from viewer.state.preferences import Preferences
from viewer.state.readings import can_draw, records_fates, records_lights
from viewer.state.session import Session
from viewer.state.views import View


@dataclass(frozen=True)
class FrameInputs:
    """What else decides how a frame is traced: the `size`, in pixels, that there is room for (0 where it is hidden),
    whether anything is `moving`, the `run` that is under way, whether the scene is being `edited`, whether the kernels
    that make certificates are `ready`, the `second` method that traces each frame once more (none where it is empty),
    and the point of the picture that matters most, its `focus`."""

    size: tuple[int, int] = (0, 0)
    moving: bool = False
    run: Run | None = None
    edited: bool = False
    ready: bool = True
    second: str = ""
    focus: tuple[float, float] | None = None


@dataclass(frozen=True)
class FrozenFrame:
    """A frame that stays as it was found, with one sample a pixel: what it shows, the frames before it that set its
    modes, and what was chosen then."""

    time: float
    camera: Camera
    method: str
    samples: int
    warmup: Warmup


class FrameScheduler:
    """`traced` is the newest frame with the request it answers; `inputs` are those of the last request."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        thread: RenderThread,
        wake: Callable[[], None] = lambda: None,
        budget: FrameBudget | None = None,
    ) -> None:
        self._session, self._preferences, self._thread, self._wake = session, preferences, thread, wake
        self.inputs = FrameInputs()
        self.traced: Traced | None = None
        self.budget = budget or FrameBudget()
        self.refinement = Refinement()
        self.lamps = LampSamples(session)
        self._serial = 0
        self._frozen: FrozenFrame | None = None
        self._refines = False  # whether the last frame was asked for to refine what is known
        self._asked: RenderRequest | None = None
        self._chosen: Settings | None = None  # by the user, when that was asked for
        self._coarse_first = False  # what should be seen is another picture than the last
        self._new = False  # the scene
        self._failed: RenderRequest | None = None

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
            self._coarse_first = False
            if not traced.request.refinement_seconds:  # else it took its time for certificates, not for its pixels
                pixels = traced.frame.width * traced.frame.height
                self.budget.observe(traced.first, pixels, self.lamps.most(traced.request.settings))
        self.traced = traced
        return traced

    def show(self, traced: Traced) -> None:
        """Take a frame that was not asked for here; what should be seen is asked for again after it."""
        self.traced, self._asked = traced, None

    def record_light(self) -> None:
        """Have the chosen light recorded for the newest frame, where the view needs it and the frame lacks it, as there
        are too many lights to record all of them in every frame."""
        frame, view, light = self.frame, self._session.draw.view, self._session.draw.light
        if frame is None or not (view.needs_lights and view.of_light) or light >= frame.lights:
            return
        if not (frame.settings.record_lights or can_draw(frame, view, light)):
            answer = self._thread.query(_with_light, frame, light)
            if answer.done() and not answer.cancelled() and answer.exception() is None and self.traced is not None:
                found: Frame = answer.result()  # with as many samples, or fewer: the light is the same
                frame = replace(frame, asked=found.asked, reached=found.reached, only_light=light)
                self.traced = replace(self.traced, frame=frame)

    # --- what is forgotten, and traced again --------------------------------------------------------

    def forget(self) -> None:
        """Begin with another scene: it has no frame yet, and its pixels cost something else."""
        self.traced = self._asked = None
        self._new = True
        self.budget.forget()
        self.forget_modes()

    def take_edits(self, same: bool) -> None:
        """Trace the scene with other edits; `same` says that primitives and lights have the numbers that they had.

        If they have not, the newest frame means nothing any more."""
        if not same:
            self.traced = None
        self._asked = None
        self.refinement.forget()
        self.trace_once_more()

    def trace_once_more(self) -> None:
        """Trace what was traced last once more."""
        self._serial += 1

    def trace_again(self) -> None:
        """Trace the same frame once more for the user: culling may know more now.  One under way is let finish."""
        if not self._thread.busy:
            self.trace_once_more()

    def forget_modes(self) -> None:
        """Note that nothing is known about shadows any more."""
        self.refinement.forget()
        self.trace_once_more()

    def freeze(self, warmup: Warmup) -> None:
        """Forget all modes, trace these frames, and then what is looked at now, with one sample a pixel; no further
        frame follows, as that would know more, until something else is looked at, or asked for."""
        session, s = self._session, self._session.settings
        self.forget_modes()
        self._frozen = FrozenFrame(session.time, session.camera, s.method, s.samples, warmup)

    def give_up(self) -> None:
        """Note that what was asked for has failed: it will not come."""
        self._failed = self._asked

    # --- the next frame -----------------------------------------------------------------------------

    def request(self, inputs: FrameInputs) -> None:
        """Ask for the frame that should come next, unless it has been asked for, or is there."""
        self.inputs = inputs
        session = self._session
        if inputs.run is not None or inputs.edited:
            self._asked = None  # what was asked for has been dropped
            return
        if session.scene is None or min(self.full_size) < 1:
            return
        if self._new:  # what the scene brings into the window changes the room for its picture
            self._new = False
            self._wake()
            return
        at_rest = not inputs.moving and not session.playing
        if at_rest and not self.refines_lamps and self._should_refine():
            self._serial += 1
            self._refines = True
        if at_rest and self._asked is not None and not self._shows_session(self._asked):
            self._coarse_first = True
        coarse = inputs.moving or self._coarse_first
        self._refines = self._refines and not coarse and not session.playing
        wanted = self._next_request(coarse)
        made = self._asked or self._whole_with(wanted.samples)
        if made is None or not self._answers(made, wanted):
            self._asked, self._chosen = wanted, session.settings
            self._thread.submit(wanted)
        elif wanted == self._asked and not wanted.quick and not self._asked.final:
            # Asked for in motion, and still wanted now that nothing moves: it comes before what is on its way.
            self._asked = replace(wanted, final=True)
            self._thread.hurry(self._asked)

    def _should_refine(self) -> bool:
        """Whether, at rest, one more frame of the same view will know more about shadows."""
        keeps_tracing = self._session.pace.keep_tracing
        if self.is_frozen and not keeps_tracing:
            return False
        return self.refinement.wants_another(self.traced, self._session.draw.view, keeps_tracing)

    def _next_request(self, coarse: bool) -> RenderRequest:
        session, (width, height) = self._session, self.full_size
        lamp_samples = self._next_lamp_samples(coarse)
        plan = self._plan(coarse, lamp_samples)
        width, height = divided(width, height, plan.divisor)
        settings, samples = replace(self.settings, width=width, height=height, samples=1), self.samples_wanted
        if lamp_samples < self.lamps.wanted:
            settings, samples = replace(settings, lamp_samples=lamp_samples), 1
        return RenderRequest(
            session.time,
            session.camera,
            settings,
            plan.divisor,
            self._serial,
            refinement.SECONDS if self._refines else 0.0,
            samples,
            self._second,
            parts=plan.parts,
            quick=coarse or session.playing,
            focus=self.inputs.focus,
            warmup=self._frozen.warmup if self._frozen is not None and self.is_frozen else None,
        )

    def _plan(self, coarse: bool, lamp_samples: int) -> Plan:
        """Return how the frame comes about: at once where it refines what is shown, and where each is to be whole."""
        playing = self._session.playing
        adds_lamp_samples = not coarse and not playing and lamp_samples > refinement.first(self.lamps.wanted)
        if self._refines or adds_lamp_samples or self._each_is_whole:
            return AT_ONCE
        return self.budget.plan(*self.full_size, self._frame_seconds, coarse, playing, lamp_samples)

    @property
    def _each_is_whole(self) -> bool:
        """Whether no frame is shown before all of it has been traced."""
        return not self._session.pace.progressive or (self._session.playing and self._session.pace.every_frame)

    @property
    def _frame_seconds(self) -> float:
        """That a frame may take until some of it is shown: half of it where each is traced twice."""
        return (0.5 if self.inputs.second else 1.0) / self._session.pace.target_fps

    @property
    def _second(self) -> str:
        """The second method, or the one without culling until what makes certificates has been compiled."""
        second = self.inputs.second
        waits = bool(second) and not self.inputs.ready and Method.parse(second).has_certificates
        return with_base(second, NO_CULLING) if waits else second

    def _next_lamp_samples(self, coarse: bool) -> int:
        """Return how many samples lamps have in the next frame."""
        if self._each_is_whole:
            return self.lamps.wanted
        if coarse or self._session.playing:
            return self.lamps.in_motion(self.budget, self.full_size, self._frame_seconds)
        asked, traced = self._asked, self.traced
        if asked is None or asked.divisor > 1 or not self._shows_session(asked):
            return self.lamps.at_rest(None, False)
        return self.lamps.at_rest(asked.settings, traced is not None and traced.whole and traced.request == asked)

    @property
    def settings(self) -> Settings:
        """What the user has set, with modes; verified, and with more recorded, where the view needs that and there is
        memory for it.

        Until what makes certificates is ready, still being compiled, it is traced without: the picture is the same."""
        session, view, (width, height) = self._session, self._session.draw.view, self.full_size
        lights = len(session.scene.lights) if session.scene is not None else 0
        method = session.settings.method
        if not self.inputs.ready and Method.parse(method).has_certificates:
            method = with_base(method, NO_CULLING)
        return replace(
            session.settings,
            method=method,
            verify=session.settings.verify or view.needs_verify,
            record_work=view.needs_work or session.counting,
            record_lights=records_lights(view, width * height, lights),
            record_fates=records_fates(view, width * height, lights),
            modes=not Method.parse(method).clusters,  # which would look at single lights for these alone
            certificate_seconds=self._session.pace.certificate_share * self._frame_seconds,
        )

    def _answers(self, made: RenderRequest, wanted: RenderRequest) -> bool:
        """Return whether what answers one request answers another, as it holds the same or more."""
        if made == wanted:
            return True
        as_made = replace(wanted, settings=_recording(wanted.settings, made.settings))
        same = as_made == made and self._session.settings == self._chosen
        return same and not missing_buffers(made.settings, wanted.settings)

    def _whole_with(self, samples: int) -> RenderRequest | None:
        """Return what the newest frame answers, if it is whole and has so many samples a pixel."""
        traced = self.traced
        whole = traced is not None and traced.whole and traced.frame.settings.samples >= samples
        return traced.request if traced is not None and whole else None

    def _shows_session(self, asked: RenderRequest) -> bool:
        """Return whether a request is for what the session looks at now, however finely."""
        session = self._session
        if asked.second != self._second:
            return False
        settings = _as_asked(self.settings, asked.settings)
        return (session.time, session.camera, settings) == (asked.time, asked.camera, asked.settings)

    # --- what the newest frame is -------------------------------------------------------------------

    @property
    def awaits(self) -> bool:
        """Whether a frame that was asked for has not come yet, or not all of it; its further samples do not count."""
        asked, traced = self._asked, self.traced
        if asked is None or asked is self._failed:
            return False
        return traced is None or not traced.whole or traced.request != asked

    @property
    def adds_samples(self) -> bool:
        """Whether the frame that was asked for is there, and more samples a pixel are to come."""
        asked = self._asked
        if asked is None or asked is self._failed or self.awaits:
            return False
        return self.samples_shown < asked.samples

    @property
    def certifies(self) -> bool:
        """Whether the picture is there, and another is to come because certificates can be made for it."""
        refines = self._asked is not None and self._asked.refinement_seconds > 0.0
        return refines and self.refinement.proves and self.awaits and not self.outdated

    @property
    def becoming_finer(self) -> bool:
        """Whether a part of the picture is shown and the whole of the same view is to come."""
        partly = self.traced is not None and (self.traced.request.divisor > 1 or not self.traced.whole)
        return partly and not self._session.playing

    @property
    def shows_edits(self) -> bool:
        """Whether some of a picture has come since the scene was edited, or was to be traced again."""
        return self.traced is not None and self.traced.request.serial == self._serial

    @property
    def lamp_samples_shown(self) -> int:
        """How many samples the lamps of the newest frame have, that with the most."""
        return self.lamps.most(self.traced.frame.settings) if self.traced is not None else 0

    @property
    def refines_lamps(self) -> bool:
        """Whether a whole picture is shown, and the same with more samples of lamps is to come."""
        traced = self.traced
        shown = traced is not None and traced.whole and self._shows_session(traced.request)
        return shown and self.lamp_samples_shown < self.lamps.wanted

    @property
    def samples_shown(self) -> int:
        """How many samples a pixel has; 0 while not all have one."""
        return self.traced.frame.settings.samples if self.traced is not None and self.traced.whole else 0

    @property
    def samples_wanted(self) -> int:
        """How many it should have at rest."""
        return 1 if self.is_frozen else self._session.settings.samples

    @property
    def is_frozen(self) -> bool:
        """Whether the picture stays as it was found, with one sample a pixel."""
        s, frozen = self._session, self._frozen
        now = (s.time, s.camera, s.settings.method, s.settings.samples)
        return frozen is not None and now == (frozen.time, frozen.camera, frozen.method, frozen.samples)

    @property
    def outdated(self) -> bool:
        """Whether the newest frame was traced with other settings than those now chosen, or lacks what they ask for."""
        if self.frame is None or self.inputs.run is not None:
            return False
        had, wanted = self.frame.settings, self.settings
        return missing_buffers(had, wanted) or _as_asked(wanted, had) != had

    @property
    def full_size(self) -> tuple[int, int]:
        """The resolution at rest: the window's, or the fixed one (0, 0 while there is nowhere to show it)."""
        pace, size = self._session.pace, self.inputs.size
        return (pace.width, pace.height) if pace.fixed_size and min(size) > 0 else size

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
        view = self._session.draw.view
        return view if self.frame is None or can_draw(self.frame, view, self._session.draw.light) else View.COLOR

    @property
    def title(self) -> str:
        """The view, and the light where it shows one; before it what a run that is under way is at."""
        view, wanted, run = self.drawn_view, self._session.draw.view, self.inputs.run
        title = f"{view.label}, light {self._session.light_number}" if view.of_light else view.label
        if run is not None:
            lacks = wanted is not view and missing_in(run, wanted)
            return f"{shown_of(run)}   {title}{f' (this run {lacks})' if lacks else ''}"
        if wanted is view:
            return title
        settings = self.settings
        comes = settings.record_fates if wanted.needs_fates else wanted.needs_more
        if not (settings.record_lights if wanted is View.LIGHTS else comes):  # the picture says why
            return f"{wanted.label}: none here, {view.label.lower()} shown"
        return f"{wanted.label}: {'verifying' if wanted.needs_verify else 'counting'} ..."


def _with_light(renderer: Renderer, frame: Frame, light: int, _cancelled: Callable[[], bool]) -> Frame:
    return with_light(renderer, frame, light)


def _recording(settings: Settings, other: Settings) -> Settings:
    """Return settings with as much recorded as others."""
    return replace(settings, **{name: getattr(other, name) for name in RECORDS})


def _as_asked(settings: Settings, asked: Settings) -> Settings:
    """Return settings at the size, with as much recorded and as much time for certificates, as others."""
    same = ("width", "height", "modes", "patient", "samples", "lamp_samples", "certificate_seconds")
    return replace(_recording(settings, asked), **{name: getattr(asked, name) for name in same})


def missing_buffers(had: Settings, wanted: Settings) -> bool:
    """Return whether something is to be recorded that was not."""
    return any(getattr(wanted, name) and not getattr(had, name) for name in RECORDS)
