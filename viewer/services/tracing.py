"""What is asked of the render thread so that the picture keeps up with the session, and what has come.

Each picture comes fast, with a part of its pixels shaded, and becomes whole where nothing newer is wanted;
at rest it gets more samples a pixel.  Nothing is asked for twice, and nothing at all while a run has the
render thread to itself.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING

from tracer.frame import Frame, Settings
from tracer.method import base_of, certifies
from viewer.services.governor import AT_ONCE, Governor, Plan, divided
from viewer.services.render_thread import RenderRequest, Traced
from viewer.state.methods import with_base
from viewer.state.views import View

if TYPE_CHECKING:
    from viewer.services.controller import Controller

LESSONS = 40  # frames at rest that certificates are made in, at most
PATIENCE = 0.4  # seconds that these may give them: the picture is there, and a motion ends them at once


class Tracing:
    """`traced` is the newest frame with the request it answers."""

    def __init__(self, controller: Controller, governor: Governor | None = None) -> None:
        self._c = controller
        self.traced: Traced | None = None
        self._known: Frame | None = None  # the last that was whole and of the window's resolution
        self.governor = governor or Governor()
        self._serial = 0
        self._considered: RenderRequest | None = None  # the whole picture that was last learnt from
        self._settled: RenderRequest | None = None
        self._lessons = 0  # frames at rest that may still be traced to learn from
        self._learning = False  # whether such a one was asked for last
        self._asked: RenderRequest | None = None
        self._chosen: Settings | None = None
        self._glance = False
        self._new = False

    @property
    def frame(self) -> Frame | None:
        return self.traced.frame if self.traced is not None else None

    def forget(self) -> None:
        """Another scene: it has no frame yet, and its pixels cost something else."""
        self.traced = self._known = self._asked = self._settled = self._considered = None
        self._new = True
        self.governor.forget()

    def again(self, modes_are_lost: bool = False) -> None:
        """Trace what was traced last once more."""
        self._serial += 1
        if modes_are_lost:
            self._settled = self._known = None

    def reconsider(self) -> None:
        """What is there may teach more than was wanted of it so far."""
        self._considered = self._settled = None

    def interrupted(self) -> None:
        """What was asked for may never come: it is asked for anew."""
        self._asked = None

    def show(self, traced: Traced) -> None:
        """Take up a frame that was not asked for here; what should be seen is asked for anew after it."""
        self.traced = traced
        self.interrupted()

    def take(self) -> Traced | None:
        """The newest frame that the render thread has made, once."""
        traced = self._c.render.take()
        if traced is None:
            return None
        if self.traced is None or self.traced.request is not traced.request:
            self._glance = False
            if not traced.request.patience:  # else it took its time for certificates, not for its pixels
                self.governor.observe(traced.first, traced.frame.width * traced.frame.height)
        self.traced = self._with_modes(traced)
        return self.traced

    def _with_modes(self, traced: Traced) -> Traced:
        """Modes are those of a resolution: what is coarser than the window shows what its last whole picture knew."""
        frame, known = traced.frame, self._known
        if traced.request.divisor == 1:
            self._known = frame if traced.whole else known
        elif known is not None and known.settings.keeps_modes and len(known.modes) == len(frame.modes):
            frame = replace(
                frame,
                modes=known.modes,
                pixel_count=known.pixel_count,
                highest_count=known.highest_count,
                statistics=replace(frame.statistics, by_modes=known.statistics.by_modes),
            )
            return replace(traced, frame=frame)
        return traced

    def _settle(self) -> None:
        """At rest the first whole picture of a view teaches the modes; a second one shows what they save.  Certificates
        are made within a budget: where the user has chosen them, as the method or as the view, more frames follow,
        until none are wanted; elsewhere the time goes into samples."""
        traced = self.traced
        if traced is None or not traced.whole or traced.request is self._considered:
            return
        request, self._considered = traced.request, traced.request
        seen = replace(request.settings, verify=False, record_work=False)
        view = replace(request, settings=seen, serial=0, patience=0.0)
        learns = request.divisor == 1
        if learns and view != self._settled:
            self._settled = view
            certified = base_of(seen.method) == "certified" or self._c.session.view is View.CERTIFICATE
            self._lessons = LESSONS if certified and certifies(seen.method) else 1
        elif traced.frame.statistics.certificates == 0:
            self._lessons = 0
        if self._c.preferences.keep_tracing or (learns and self._lessons > 0):
            self._lessons -= 1
            self._serial += 1
            self._learning = True

    def ask(self) -> None:
        """Ask for what should be seen now, unless it has been asked for, or is there."""
        c, session = self._c, self._c.session
        width, height = self.full_size
        if session.scene is None or width < 1 or height < 1 or c.runner.current is not None:
            return
        if self._new:  # what the scene brings into the window changes the room for its picture
            self._new = False
            c.wake()
            return
        if not c.moving and not session.playing:
            self._settle()
        if self._jumped():  # the next picture is another: it may come coarse at first, if that must be
            self._glance = True
        moving = c.moving or self._glance
        self._learning = self._learning and not moving and not session.playing
        plan = self._plan(width, height, moving)
        width, height = divided(width, height, plan.divisor)
        settings = replace(self.settings, width=width, height=height, samples=1)
        patience = PATIENCE if self._learning else 0.0
        wanted = RenderRequest(
            session.time, session.camera, settings, plan.divisor, self._serial, patience, session.settings.samples,
            plan.parts, moving or session.playing, focus=c.hovered,
        )  # fmt: skip
        if self._answered(wanted):
            self._make_final(wanted)
            return
        self._asked, self._chosen = wanted, session.settings
        c.render.submit(wanted)

    def _make_final(self, wanted: RenderRequest) -> None:
        """What was asked for in motion and is still wanted when nothing moves comes before what is on its way."""
        asked = self._asked
        if asked is not None and wanted == asked and not wanted.quick and not asked.final:
            self._asked = replace(wanted, final=True)
            self._c.render.hurry(self._asked)

    def _plan(self, width: int, height: int, coarse: bool) -> Plan:
        """How the picture is to come about: at once where it is traced to learn more, and where each is to be whole."""
        c, preferences = self._c, self._c.preferences
        if self._learning or not preferences.dynamic_resolution or (c.session.playing and preferences.every_frame):
            return AT_ONCE
        return self.governor.plan(width, height, 1.0 / preferences.target_fps, coarse, c.session.playing)

    @property
    def settings(self) -> Settings:
        """What the user has set, with modes; verified and with its work recorded where the view needs that.  While what
        makes certificates is still being compiled it is traced without: the picture is the same."""
        s, method = self._c.session, self._c.session.settings.method
        verify = s.settings.verify or s.view.needs_verify
        if certifies(method) and not self._c.opener.certifies:
            method = with_base(method, "none")
        seconds = self._c.preferences.certificate_share / self._c.preferences.target_fps
        return replace(
            s.settings,
            method=method,
            verify=verify,
            record_work=s.view.needs_work,
            modes=True,
            certificate_seconds=seconds,
        )

    def _answered(self, wanted: RenderRequest) -> bool:
        """Whether a frame has been asked for, or is there.  One that holds more for a view serves the next view."""
        if wanted == self._asked or self._same_picture(wanted):
            return True
        if self._c.session.settings != self._chosen:
            return False
        settings = wanted.settings
        for verify, work in product({settings.verify, True}, {settings.record_work, True}):
            fuller = replace(wanted, settings=replace(settings, verify=verify, record_work=work))
            if fuller == self._asked or self._same_picture(fuller):
                return True
        return False

    def _same_picture(self, wanted: RenderRequest) -> bool:
        traced = self.traced
        if traced is None or self._asked is not None:  # what was asked for last comes, if it is not this
            return False
        return traced.whole and traced.request == wanted and traced.frame.settings.samples >= wanted.samples

    def _jumped(self) -> bool:
        """Whether, at rest, something else is to be seen than was last asked for; to learn more is to see the same."""
        session, asked = self._c.session, self._asked
        if asked is None or session.playing or self._c.moving:
            return False
        settings = _as_asked(self.settings, asked.settings)
        return (session.time, session.camera, settings) != (asked.time, asked.camera, asked.settings)

    # --- what the newest frame is ----------------------------------------------------------------

    @property
    def becoming_finer(self) -> bool:
        """Whether a part of the picture is shown and the whole of the same view is to come."""
        partly = self.traced is not None and (self.traced.request.divisor > 1 or not self.traced.whole)
        return partly and not self._c.session.playing

    @property
    def samples_shown(self) -> int:
        """How many samples a pixel has; 0 while not all have one."""
        return self.traced.frame.settings.samples if self.traced is not None and self.traced.whole else 0

    @property
    def samples_wanted(self) -> int:
        """How many it is to have at rest."""
        return self._c.session.settings.samples

    @property
    def outdated(self) -> bool:
        """Whether the newest frame was traced with other settings than those now chosen, or lacks what they ask for."""
        if self.frame is None or self._c.runner.current is not None:
            return False
        had, wanted = self.frame.settings, self.settings
        lacks = (wanted.verify and not had.verify) or (wanted.record_work and not had.record_work)
        return lacks or _as_asked(wanted, had) != had

    @property
    def full_size(self) -> tuple[int, int]:
        """The resolution at rest: the window's, or the fixed one (0, 0 while there is nowhere to show it)."""
        p, size = self._c.preferences, self._c.size
        return (p.fixed_width, p.fixed_height) if p.fixed_resolution and min(size) > 0 else size

    @property
    def traced_full_size(self) -> tuple[int, int]:
        """The size whose aspect the newest frame has: its own, or what it is a coarser version of."""
        if self.traced is None:
            return 1, 1
        frame, divisor = self.traced.frame, self.traced.request.divisor
        return frame.width * divisor, frame.height * divisor

    @property
    def magnified(self) -> int:
        """How many of the screen's pixels show one of the newest frame's, from side to side; 1 at least."""
        if self.frame is None:
            return 1
        width, height = self._c.size
        return max(1, round(min(width / self.frame.width, height / self.frame.height)))

    @property
    def drawn_view(self) -> View:
        """The view to draw the newest frame in: the picture while one that needs more of a frame waits for it."""
        view = self._c.session.view
        return view if self.frame is None or view.can_draw(self.frame) else View.COLOR

    @property
    def title(self) -> str:
        """The view, and the light where it shows one; before it what a run that is under way is at."""
        view, run = self.drawn_view, self._c.runner.current
        title = f"{view.label}, light {self._c.session.light}" if view.of_light else view.label
        wanted = self._c.session.view
        if run is not None:
            lacks = wanted is not view and run.lacks(wanted)
            return f"showing {run.label_shown}   {title}{f' (this run {lacks})' if lacks else ''}"
        if wanted is view:
            return title
        if not (wanted.needs_verify or wanted.needs_work):  # why is told over the picture
            return f"{wanted.label}: none here, {view.label.lower()} shown"
        return f"{wanted.label}: {'verifying' if wanted.needs_verify else 'counting'} ..."


def _as_asked(settings: Settings, asked: Settings) -> Settings:
    """Settings at the size, with as much recorded and as much time for certificates, as others."""
    return replace(
        settings,
        width=asked.width,
        height=asked.height,
        verify=asked.verify,
        record_work=asked.record_work,
        modes=asked.modes,
        patient=asked.patient,
        samples=asked.samples,
        certificate_seconds=asked.certificate_seconds,
    )
