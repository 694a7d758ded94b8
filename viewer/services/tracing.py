"""What the render thread is asked for, so that the picture keeps up with the session, and what has come.

Each picture comes fast, with a part of its pixels shaded, and becomes whole unless something newer is wanted; at idle
lamps get more samples, and then it gets more samples a pixel.  Nothing is asked for twice, and nothing at all while a
run has the render thread.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from tracer.frame import Frame, Settings
from tracer.method import Method
from tracer.scene.model import Camera
from viewer.services import lamps, refinement
from viewer.services.governor import AT_ONCE, Governor, Plan, divided
from viewer.services.lamps import LampSteps
from viewer.services.refinement import Refinement
from viewer.services.render_request import Pictures, RenderRequest, Traced, Warmup
from viewer.services.requests import as_asked, fulfils, lacks, settings_for
from viewer.services.runs import Run
from viewer.state.learnt import Learnt
from viewer.state.methods import NO_CULLING, with_base
from viewer.state.preferences import Preferences
from viewer.state.readings import can_draw
from viewer.state.session import Session
from viewer.state.views import View


@dataclass(frozen=True)
class Conditions:
    """What else decides how a picture is traced: the `size`, in pixels, that there is room for (0 where it is hidden),
    whether anything is `moving`, the `run` that is under way, whether the scene is being `edited`, whether the kernels
    that make certificates are `ready`, and the point of the picture that matters most, its `focus`."""

    size: tuple[int, int] = (0, 0)
    moving: bool = False
    run: Run | None = None
    edited: bool = False
    ready: bool = True
    focus: tuple[float, float] | None = None


@dataclass(frozen=True)
class FrozenFrame:
    """A picture that stays as it was found, with one sample a pixel: what it shows, the frames before it that set the
    modes, and what was chosen then."""

    time: float
    camera: Camera
    method: str
    samples: int
    warmup: Warmup


class Tracing:
    """`traced` is the newest frame with the request it answers; `now` are the conditions of the last `ask`."""

    def __init__(
        self,
        session: Session,
        preferences: Preferences,
        renderer: Pictures,
        locked: Callable[[], bool] = lambda: False,
        wake: Callable[[], None] = lambda: None,
        governor: Governor | None = None,
        forgotten: Callable[[], None] = lambda: None,
    ) -> None:
        """Nothing is traced again on the user's behalf while `locked()`, which says so itself.  `forgotten()` is called
        when all modes are to be.  `second` is the method that traces each frame once more; none where it is empty."""
        self.second = ""
        self._session, self._preferences, self._renderer = session, preferences, renderer
        self._locked, self._wake, self._forgotten = locked, wake, forgotten
        self.now = Conditions()
        self.traced: Traced | None = None
        self.governor = governor or Governor()
        self.refinement = Refinement()
        self.lamps = LampSteps(session)
        self.learnt = Learnt()
        self._serial = 0
        self._frozen: FrozenFrame | None = None
        self._refines = False  # whether the last picture was asked for to refine what is known
        self._asked: RenderRequest | None = None
        self._chosen: Settings | None = None
        self._glance = False
        self._new = False
        self._failed: RenderRequest | None = None

    @property
    def frame(self) -> Frame | None:
        return self.traced.frame if self.traced is not None else None

    def forget(self) -> None:
        """Begin with another scene: it has no frame yet, and its pixels cost something else."""
        self.traced = self._asked = None
        self._new = True
        self.learnt.forget()
        self.refinement.forget()
        self.governor.forget()

    def follow_edits(self, same: bool) -> None:
        """The scene is edited otherwise; `same` says that primitives and lights have the numbers that they had.

        If they have not, the newest frame means nothing any more."""
        if not same:
            self.traced = None
        self._asked = None
        self.learnt.confuse()
        self.refinement.forget()
        self.again()

    @property
    def shows_edits(self) -> bool:
        """Whether some of a picture has come since the scene was edited, or was to be traced again."""
        return self.traced is not None and self.traced.request.serial == self._serial

    def again(self) -> None:
        """Trace what was traced last once more."""
        self._serial += 1

    def trace_again(self) -> None:
        """Trace the same frame once more for the user: culling may know more now.  One under way is let finish."""
        if not self._renderer.busy:
            self.again()

    def reset_modes(self) -> None:
        """Forget all that is known about shadows, and look again."""
        if not self._locked():
            self._renderer.reset_modes()
            self._forgotten()
            self.learnt.forget()
            self.refinement.forget()
            self.again()

    def complete(self, frame: Frame, more: Frame) -> None:
        """Show the frame with what has been found out about it since, unless another has come."""
        if self.traced is not None and self.traced.frame is frame:
            self.traced = replace(self.traced, frame=more)

    def show(self, traced: Traced) -> None:
        """Take a frame that was not asked for here; what should be seen is asked for again after it."""
        self.traced, self._asked = traced, None

    def take(self) -> Traced | None:
        """The newest frame that the render thread has made, once."""
        traced = self._renderer.take()
        if traced is None:
            return None
        if self.traced is None or self.traced.request is not traced.request:
            self._glance = False
            if not traced.request.refinement_seconds:  # else it took its time for certificates, not for its pixels
                pixels = traced.frame.width * traced.frame.height
                self.governor.observe(traced.first, pixels, self.lamps.most(traced.request.settings))
        self.traced = traced
        return traced

    def ask(self, now: Conditions) -> None:
        """Ask for what should be seen now, unless it has been asked for, or is there."""
        self.now = now
        session, (width, height) = self._session, self.full_size
        if now.run is not None or now.edited:
            self._asked = None  # what was asked for has been dropped
            return
        if session.scene is None or width < 1 or height < 1:
            return
        if self._new:  # what the scene brings into the window changes the room for its picture
            self._new = False
            self._wake()
            return
        if not now.moving and not session.playing and not self.refines_lamps:
            self._refine()
        if self._jumped():  # the next picture is another one, and may be coarse at first
            self._glance = True
        moving = now.moving or self._glance
        self._refines = self._refines and not moving and not session.playing
        lamp_samples = self._next_lamp_samples(width, height, moving)
        plan = self._plan(width, height, moving, lamp_samples)
        width, height = divided(width, height, plan.divisor)
        settings = replace(self.settings, width=width, height=height, samples=1)
        samples = self.samples_wanted
        if lamp_samples < self.lamps.wanted:
            settings, samples = replace(settings, lamp_samples=lamp_samples), 1
        seconds = refinement.SECONDS if self._refines else 0.0
        wanted = RenderRequest(
            session.time, session.camera, settings, plan.divisor, self._serial, seconds, samples, self._second,
            plan.parts, moving or session.playing, focus=now.focus,
            warmup=self._frozen.warmup if self._frozen is not None and self.is_frozen else None,
        )  # fmt: skip
        if self._answered(wanted):
            self._make_final(wanted)
            return
        self._asked, self._chosen = wanted, session.settings
        self._renderer.submit(wanted)

    def freeze(self, warmup: Warmup) -> None:
        """Forget all modes, trace these frames, and then what is looked at now, with one sample a pixel; no further
        picture follows, as that would know more, until something else is looked at, or asked for."""
        session, s = self._session, self._session.settings
        self._frozen = FrozenFrame(session.time, session.camera, s.method, s.samples, warmup)

    def _refine(self) -> None:
        """At idle, let one more frame of the same view follow where it will know more about shadows."""
        if self.is_frozen and not self._preferences.keep_tracing:
            return
        if self.refinement.wants_another(self.traced, self._session.view, self._preferences.keep_tracing):
            self._serial += 1
            self._refines = True

    def _make_final(self, wanted: RenderRequest) -> None:
        """What was asked for in motion and is still wanted when nothing moves comes before what is on its way."""
        asked = self._asked
        if asked is not None and wanted == asked and not wanted.quick and not asked.final:
            self._asked = replace(wanted, final=True)
            self._renderer.hurry(self._asked)

    def _plan(self, width: int, height: int, coarse: bool, lamp_samples: int) -> Plan:
        """How the picture is to come about: at once where it refines what is shown, and where each is to be whole."""
        playing = self._session.playing
        adds = not coarse and not playing and lamp_samples > lamps.first(self.lamps.wanted)
        if self._refines or adds or self._each_is_whole:
            return AT_ONCE
        return self.governor.plan(width, height, self._frame_seconds, coarse, playing, lamp_samples)

    @property
    def _each_is_whole(self) -> bool:
        """Whether no picture is shown before all of it has been traced."""
        return not self._preferences.dynamic_resolution or (self._session.playing and self._preferences.every_frame)

    @property
    def _frame_seconds(self) -> float:
        """That a picture may take until some of it is shown: half of a frame's where each is traced twice."""
        return (0.5 if self.second else 1.0) / self._preferences.target_fps

    @property
    def _second(self) -> str:
        """The second method, or the one without culling until what makes certificates has been compiled."""
        waits = bool(self.second) and not self.now.ready and Method.parse(self.second).has_certificates
        return with_base(self.second, NO_CULLING) if waits else self.second

    # --- samples of lamps ------------------------------------------------------------------------

    def _next_lamp_samples(self, width: int, height: int, moving: bool) -> int:
        """How many samples lamps have in the next picture, of this size."""
        if self._each_is_whole:
            return self.lamps.wanted
        if moving or self._session.playing:
            return self.lamps.in_motion(self.governor, (width, height), self._frame_seconds)
        asked, traced = self._asked, self.traced
        if asked is None or asked.divisor > 1 or not self._shows_session(asked):
            return self.lamps.at_rest(None, False)
        return self.lamps.at_rest(asked.settings, traced is not None and traced.whole and traced.request == asked)

    def _shows_session(self, asked: RenderRequest) -> bool:
        """Whether a request is for what the session looks at now, however finely."""
        session = self._session
        if asked.second != self._second:
            return False
        settings = as_asked(self.settings, asked.settings)
        return (session.time, session.camera, settings) == (asked.time, asked.camera, asked.settings)

    @property
    def lamp_samples_shown(self) -> int:
        """How many samples the lamps of the newest picture have, that with the most."""
        return self.lamps.most(self.traced.frame.settings) if self.traced is not None else 0

    @property
    def refines_lamps(self) -> bool:
        """Whether a whole picture is shown, and the same with more samples of lamps is to come."""
        traced = self.traced
        shown = traced is not None and traced.whole and self._shows_session(traced.request)
        return shown and self.lamp_samples_shown < self.lamps.wanted

    @property
    def settings(self) -> Settings:
        """What the user has set, and what else the next picture needs."""
        seconds = self._preferences.certificate_share * self._frame_seconds
        width, height = self.full_size
        return settings_for(self._session, seconds, self.now.ready, width * height)

    def _answered(self, wanted: RenderRequest) -> bool:
        """Whether a frame has been asked for, or is there.  One that holds more than the view needs will do."""
        made = self._asked or self._whole_of(wanted.samples)
        if made is None:
            return False
        return made == wanted or (self._session.settings == self._chosen and fulfils(made, wanted))

    def _whole_of(self, samples: int) -> RenderRequest | None:
        """What the newest frame answers, if it is whole and has so many samples a pixel."""
        traced = self.traced
        whole = traced is not None and traced.whole and traced.frame.settings.samples >= samples
        return traced.request if traced is not None and whole else None

    def _jumped(self) -> bool:
        """Whether, at idle, something else is to be seen than was last asked for; to refine is to see the same."""
        asked = self._asked
        if asked is None or self._session.playing or self.now.moving:
            return False
        return not self._shows_session(asked)

    # --- what the newest frame is ----------------------------------------------------------------

    def give_up(self) -> None:
        """What was asked for has failed: it will not come."""
        self._failed = self._asked

    @property
    def awaits(self) -> bool:
        """Whether a picture that was asked for has not come yet, or not all of it; its further samples do not count."""
        asked, traced = self._asked, self.traced
        if asked is None or asked is self._failed:
            return False
        return traced is None or not traced.whole or traced.request != asked

    @property
    def adds_samples(self) -> bool:
        """Whether the picture that was asked for is there, and more samples a pixel are to come."""
        asked = self._asked
        if asked is None or asked is self._failed or self.awaits:
            return False
        return self.samples_shown < asked.samples

    @property
    def certifies(self) -> bool:
        """Whether the picture is there, and another is to come because certificates can be made for it."""
        asked = self._asked
        refines = asked is not None and asked.refinement_seconds > 0.0
        return refines and self.refinement.proves and self.awaits and not self.outdated

    @property
    def becoming_finer(self) -> bool:
        """Whether a part of the picture is shown and the whole of the same view is to come."""
        partly = self.traced is not None and (self.traced.request.divisor > 1 or not self.traced.whole)
        return partly and not self._session.playing

    @property
    def samples_shown(self) -> int:
        """How many samples a pixel has; 0 while not all have one."""
        return self.traced.frame.settings.samples if self.traced is not None and self.traced.whole else 0

    @property
    def samples_wanted(self) -> int:
        """How many it should have at idle."""
        return 1 if self.is_frozen else self._session.settings.samples

    @property
    def is_frozen(self) -> bool:
        """Whether the picture stays as it was found, with one sample a pixel."""
        s = self._session
        now = (s.time, s.camera, s.settings.method, s.settings.samples)
        held = self._frozen
        return held is not None and now == (held.time, held.camera, held.method, held.samples)

    @property
    def outdated(self) -> bool:
        """Whether the newest frame was traced with other settings than those now chosen, or lacks what they ask for."""
        if self.frame is None or self.now.run is not None:
            return False
        had, wanted = self.frame.settings, self.settings
        return lacks(had, wanted) or as_asked(wanted, had) != had

    @property
    def full_size(self) -> tuple[int, int]:
        """The resolution at idle: the window's, or the fixed one (0, 0 while there is nowhere to show it)."""
        p, size = self._preferences, self.now.size
        return (p.fixed_width, p.fixed_height) if p.fixed_resolution and min(size) > 0 else size

    @property
    def magnified(self) -> int:
        """How many of the screen's pixels show one of the newest frame's, from side to side; 1 at least."""
        if self.frame is None:
            return 1
        width, height = self.now.size
        return max(1, round(min(width / self.frame.width, height / self.frame.height)))

    @property
    def drawn_view(self) -> View:
        """The view to draw the newest frame in: the picture while one that needs more of a frame waits for it."""
        view = self._session.view
        return view if self.frame is None or can_draw(self.frame, view, self._session.light) else View.COLOR

    def _comes(self, view: View) -> bool:
        """Whether the frame that is asked for holds what the view needs."""
        if view is View.LIGHTS:
            return self.settings.record_lights
        return self.settings.records_fates if view.needs_fates else view.needs_more

    @property
    def title(self) -> str:
        """The view, and the light where it shows one; before it what a run that is under way is at."""
        view, run = self.drawn_view, self.now.run
        title = f"{view.label}, light {self._session.light_number}" if view.of_light else view.label
        wanted = self._session.view
        if run is not None:
            lacks = wanted is not view and run.lacks(wanted)
            return f"{run.showing}   {title}{f' (this run {lacks})' if lacks else ''}"
        if wanted is view:
            return title
        if not self._comes(wanted):  # the picture says why
            return f"{wanted.label}: none here, {view.label.lower()} shown"
        return f"{wanted.label}: {'verifying' if wanted.needs_verify else 'counting'} ..."
