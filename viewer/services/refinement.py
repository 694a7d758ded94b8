"""Frames that follow a whole picture at idle, because each of them knows more about shadows than the one before.

The first whole picture of a view sets modes; more follow until one changes none, so that what is shown is what culling
saves from then on: what is examined anew takes one more picture.  Certificates are made within a
budget: where the user has chosen them, as the method or as the view, more frames follow, until none are left to make.
Elsewhere the time goes into samples.
"""

from __future__ import annotations

from dataclasses import replace

from tracer.method import Method
from tracer.statistics import FrameStatistics
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.views import View

MOST_LEARNING = 4
"""Frames at idle, at most, that follow the first of a view to learn its modes."""
MOST_FRAMES = 40
"""Frames at idle, at most, in which certificates are made."""
SECONDS = 0.4
"""That each of these may spend on certificates: the picture is there already, and a movement ends them at once."""


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
