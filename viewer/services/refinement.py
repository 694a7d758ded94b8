"""What follows a whole picture at rest: more samples of lamps, and further frames that know more about shadows.

The first whole frame of a view sets modes; more follow until one changes none, so that what is shown is what culling
saves from then on: what is examined anew takes one more frame.  Certificates are made within a budget: where the user
has chosen them, as the method or as the view, more frames follow, until none are left to make.  Elsewhere the time goes
into samples.

Shadow modes are those of a lamp as it is sampled, and are dropped when the number of its samples changes.  So all
frames of a motion have the same number, which the first frame at rest has as well, and the next has all of them."""

from __future__ import annotations

from dataclasses import replace

from tracer.frame import Settings
from tracer.method import Method
from tracer.scene.lights import Light, as_lamps
from tracer.statistics import FrameStatistics
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.views import View

MOST_LEARNING = 4
"""Frames at idle, at most, that follow the first of a view to learn its modes."""
MOST_FRAMES = 40
"""Frames at idle, at most, in which certificates are made."""
FIRST_LAMP_SAMPLES = 4


class Refinement:
    """Decides, each time a whole picture has come, whether one more of the same view is worth tracing.  `proves` says
    that they follow to make certificates, and not only to learn modes."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Start again: modes or certificates were lost, or the scene is another."""
        self._considered: tuple[RenderRequest, bool, bool] | None = None  # what was decided about last
        self._settled: RenderRequest | None = None  # the view that `_left` speaks of
        self._left = 0  # frames of it that may still follow
        self.proves = False

    def wants_another(self, newest: Traced | None, view: View, keep_tracing: bool) -> bool:
        """Whether one more frame should follow the newest; true once for each."""
        if newest is None or not newest.whole:
            return False
        request, statistics = newest.request, newest.frame.statistics
        proves = _is_about_certificates(request, view)
        before = self._considered
        if before is not None and before[0] is request and before[1] >= proves and before[2] >= keep_tracing:
            self._considered = request, before[1], keep_tracing
            return False
        self._considered = request, proves, keep_tracing
        if request.divisor > 1:
            return keep_tracing
        if _view_of(request) != self._settled or proves > self.proves:
            self._settled, self.proves = _view_of(request), proves
            self._left = MOST_FRAMES if proves else MOST_LEARNING
        elif not _has_learnt(statistics, self.proves):
            self._left = 0
        another = keep_tracing or self._left > 0
        self._left -= another
        return another


def _has_learnt(statistics: FrameStatistics, proves: bool) -> bool:
    """Whether the next frame of the same view knows more than this one did: certificates, or else modes."""
    changes = statistics.mode_changes
    if proves or changes is None:
        return proves and statistics.certificates > 0
    return changes.fully_rendered + changes.examined_anew + changes.gained > 0


def _view_of(request: RenderRequest) -> RenderRequest:
    """The request without what varies between frames of the same view."""
    return replace(request, settings=request.settings.recording_only(), serial=0, refines=False)


def _is_about_certificates(request: RenderRequest, view: View) -> bool:
    """Whether the user has chosen certificates, as the method or as the view."""
    method = Method.parse(request.settings.method)
    return method.has_certificates and (not method.adaptive or view is View.CERTIFICATE)


def has_lamps(lights: tuple[Light, ...], settings: Settings) -> bool:
    """Return whether any light is no point, by these settings."""
    return any(light.kind != "point" for light in as_lamps(lights, settings.lamp_radius, None))


class LampSamples:
    """How many samples the lamps of a scene have.  `wanted` are those that there should be at rest, and `any` says
    whether any light is no point."""

    def __init__(self) -> None:
        self._lights: tuple[Light, ...] = ()
        self._by_scene: dict[float | None, int] = {}  # samples that the scene says, by radius; 0 without lamps
        self.wanted, self.any = 1, False

    def update(self, lights: tuple[Light, ...], settings: Settings) -> None:
        """Take up the lights that there are, and what the user has set."""
        if lights is not self._lights:
            self._lights, self._by_scene = lights, {}
        self.wanted = self.most(settings)
        self.any = self._by_scene[settings.lamp_radius] > 0

    def most(self, settings: Settings) -> int:
        """Return the samples of the lamp that has the most; 1 where all lights are points, or there are none."""
        radius = settings.lamp_radius
        if radius not in self._by_scene:  # there may be thousands of lights, and it is asked for many times a frame
            lamps = (light for light in as_lamps(self._lights, radius, None) if light.kind != "point")
            self._by_scene[radius] = max((lamp.samples for lamp in lamps), default=0)
        by_scene = self._by_scene[radius]
        return max(by_scene, 1) if settings.lamp_samples is None or by_scene == 0 else settings.lamp_samples

    @property
    def first(self) -> int:
        """How many there are in motion, and in the first frame at rest."""
        return min(FIRST_LAMP_SAMPLES, self.wanted)
