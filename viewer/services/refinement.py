"""What follows a whole picture at rest: more samples of lamps, and further frames that know more about shadows.

The first whole frame of a view sets modes; more follow until one changes none, so that what is shown is what culling
saves from then on: what is examined anew takes one more frame.  Certificates are made within a budget: where the user
has chosen them, as the method or as the view, more frames follow, until none are left to make.  Elsewhere the time goes
into samples.

Shadow modes are those of a lamp as it is sampled, and are dropped when the number of its samples changes.  So all
frames of a motion have the same number, with which the frame that follows at rest begins as well; and each step takes
four times as many samples as the one before, so that there are few of them.
"""

from __future__ import annotations

from dataclasses import replace

from tracer.frame import Settings
from tracer.method import Method
from tracer.scene.lights import Light, as_lamps
from tracer.statistics import FrameStatistics
from viewer.services.frame_budget import FrameBudget
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.session import Session
from viewer.state.views import View

MOST_LEARNING = 4
"""Frames at idle, at most, that follow the first of a view to learn its modes."""
MOST_FRAMES = 40
"""Frames at idle, at most, in which certificates are made."""
SECONDS = 0.4
"""That each of these may spend on certificates: the picture is there already, and a movement ends them at once."""
FEWEST_LAMP_SAMPLES = 4
"""Samples of a lamp in the first frame at rest, and in motion where there is time for them."""
LAMP_SAMPLES_GROWTH = 4
MOST_RADII = 16
"""Radii of lamps whose samples are known at once."""
OFFERED = (1, 4, 16, 64, 256)
"""Samples of lamps to choose from; the scene may say any other number."""


class Refinement:
    """Decides, each time a whole picture has come, whether one more of the same view is worth tracing.  `ended_early`
    says that none is to come though more certificates could be made."""

    def __init__(self) -> None:
        self._considered: RenderRequest | None = None  # the last picture that was decided about
        self._settled: RenderRequest | None = None  # the view that `_left` speaks of
        self._left = 0  # frames of it that may still follow
        self._proves = False  # whether they follow to make certificates, or else to learn modes
        self._certificates_shown = False
        self.ended_early = False

    def forget(self) -> None:
        """Start again: modes or certificates were lost, or the scene is another."""
        self._considered = self._settled = None
        self.ended_early = False

    def wants_another(self, newest: Traced | None, view: View, keep_tracing: bool) -> bool:
        """Whether one more frame should follow the newest; true once for each."""
        if newest is None:
            return False
        shows, self._certificates_shown = self._certificates_shown, view is View.CERTIFICATE
        chosen = _is_about_certificates(newest.request, View.COLOR)
        if self._certificates_shown and not shows and newest.frame.statistics.certificates and not chosen:
            self.forget()  # more can be made for this view to show
        if not newest.whole or newest.request is self._considered:
            return False
        self._considered = newest.request
        refines = newest.request.divisor == 1
        if refines and _view_of(newest.request) != self._settled:
            self._settled = _view_of(newest.request)
            self._proves = _is_about_certificates(newest.request, view)
            self._left = MOST_FRAMES if self._proves else MOST_LEARNING
        elif not _has_learnt(newest.frame.statistics, self._proves):
            self._left = 0
        makes = newest.frame.statistics.certificates > 0 and _is_about_certificates(newest.request, view)
        another = keep_tracing or (refines and self._left > 0)
        self.ended_early = makes and refines and not another
        if not another:
            return False
        self._left -= 1
        return True

    @property
    def proves(self) -> bool:
        """Whether frames follow to make certificates, and not only to learn modes."""
        return self._settled is not None and self._proves

    @property
    def progress(self) -> tuple[int, int]:
        """Which frame with certificates is under way, and how many there may be at most; 0, 0 while none is to follow
        for these."""
        return (MOST_FRAMES - self._left, MOST_FRAMES) if self.proves and self._left > 0 else (0, 0)


def _has_learnt(statistics: FrameStatistics, proves: bool) -> bool:
    """Whether the next frame of the same view knows more than this one did: certificates, or else modes."""
    changes = statistics.mode_changes
    if proves or changes is None:
        return proves and statistics.certificates > 0
    return changes.fully_rendered + changes.examined_anew + changes.gained > 0


def _view_of(request: RenderRequest) -> RenderRequest:
    """The request without what varies between frames of the same view."""
    return replace(request, settings=request.settings.recording_only(), serial=0, refinement_seconds=0.0)


def _is_about_certificates(request: RenderRequest, view: View) -> bool:
    """Whether the user has chosen certificates, as the method or as the view."""
    method = Method.parse(request.settings.method)
    return method.has_certificates and (not method.adaptive or view is View.CERTIFICATE)


def has_lamps(lights: tuple[Light, ...], settings: Settings) -> bool:
    """Return whether any light is no point, by these settings."""
    return any(light.kind != "point" for light in as_lamps(lights, settings.lamp_radius, None))


def first(most: int) -> int:
    """Return the samples of the first frame at rest, of so many in the end."""
    return most if most < 2 * FEWEST_LAMP_SAMPLES else FEWEST_LAMP_SAMPLES


def after(samples: int, most: int) -> int:
    """Return the samples of the frame after one with so many: the last step is skipped where it adds little."""
    more = FEWEST_LAMP_SAMPLES
    while more <= samples:
        more *= LAMP_SAMPLES_GROWTH
    return most if 2 * more > most else more


class LampSamples:
    """How many samples the lamps of the session's scene have in the next frame, and in the last at rest."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._lights: tuple[Light, ...] = ()
        self._by_scene: dict[float | None, int] = {}  # samples that the scene says, by radius; 0 without lamps
        self._moving: int | None = None  # samples while anything moves

    def most(self, settings: Settings) -> int:
        """Return the samples of the lamp that has the most; 1 where all lights are points, or there are none."""
        lights, radius = self._session.scene.lights if self._session.scene is not None else (), settings.lamp_radius
        if lights is not self._lights or len(self._by_scene) > MOST_RADII:
            self._lights, self._by_scene = lights, {}
        if radius not in self._by_scene:  # there may be thousands of lights, and it is asked for many times a frame
            lamps = (light for light in as_lamps(lights, radius, None) if light.kind != "point")
            self._by_scene[radius] = max((lamp.samples for lamp in lamps), default=0)
        by_scene = self._by_scene[radius]
        return max(by_scene, 1) if settings.lamp_samples is None or by_scene == 0 else settings.lamp_samples

    @property
    def wanted(self) -> int:
        """How many there should be at rest."""
        return self.most(self._session.settings)

    @property
    def any(self) -> bool:
        """Whether any light is no point, by the settings."""
        return self.most(self._session.settings) > 0 and self._by_scene[self._session.settings.lamp_radius] > 0

    def in_motion(self, budget: FrameBudget, size: tuple[int, int], seconds: float) -> int:
        """Return the samples of the next frame of this size, which there are so many seconds for; the same until
        `at_rest`, so that modes are of use."""
        if self._moving is None:
            self._moving = budget.moving_samples(*size, seconds)
        return min(self._moving, self.wanted)

    def at_rest(self, last: Settings | None, come: bool) -> int:
        """Return the samples of the next frame; `last` are the settings of the frame of the same view that was asked
        for last, and `come` says whether it is there, whole."""
        self._moving = None
        most = self.wanted
        if last is None:
            return first(most)
        has = self.most(last)
        return min(max(first(most), after(has, most) if come else has), most)
