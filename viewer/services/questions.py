"""Questions that come before something is lost: opening a scene, or quitting, while a run is under way.

A question is shown by the window until one of its answers is chosen; what is done of a run is kept in any case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tracer.experiments.runner import Run
from viewer.services.capture_service import CaptureService
from viewer.services.jobs import Job
from viewer.services.runs import Runs

_KEPT = "They are kept, and can still be saved from its panel."
_SAVED = "Their figures, table and plot can be saved beside the pictures."
_WRITTEN = "They are written already, and stay."


@dataclass(frozen=True)
class Question:
    """`answers` are names and what they do; the first changes nothing, and Escape chooses it.  `options` may be
    ticked beside, which puts their names into `ticked`.  It is asked as long as `run`, if there is one, goes on."""

    title: str
    text: str
    answers: tuple[tuple[str, Callable[[], None]], ...]
    options: tuple[str, ...] = ()
    ticked: set[str] = field(default_factory=set)
    run: Run | None = None


class Questions:
    """`question` is the one to be answered now; a newer one takes its place."""

    def __init__(self, runs: Runs, captures: CaptureService, wake: Callable[[], None] = lambda: None) -> None:
        self._runs, self._captures, self._wake = runs, captures, wake
        self.question: Question | None = None
        self._leave: Callable[[], None] | None = None  # how to quit once the run's results are written
        self._run: Run | None = None
        self._files: list[Job[Path]] | None = None

    def answer(self, name: str) -> None:
        """Choose an answer of the question, by its name."""
        question, self.question = self.question, None
        if question is not None:
            dict(question.answers)[name]()

    def drop(self) -> None:
        """Let the question go without an answer."""
        self.question = None

    def before_opening(self, name: str, go_on: Callable[[], None]) -> None:
        """Open something, at once or, while a run is under way, when the user agrees."""
        run = self._under_way()
        if run is None:
            go_on()
            return

        def stop() -> None:
            self._runs.stop()
            go_on()

        self.question = Question(
            f"Stop the {run.name} and open {name}?",
            f"{_so_far(run)} {_KEPT if self._runs.exports_of(run) else _WRITTEN}",
            (("Keep running", _nothing), ("Stop and open", stop)),
            run=run,
        )
        self._wake()

    def before_quitting(self, leave: Callable[[], None]) -> None:
        """Quit, at once or, while a run is under way, when the user agrees."""
        run = self._under_way()
        if run is None:
            leave()
            return

        def save() -> None:
            self._runs.stop()
            self._leave, self._run, self._files = leave, run, None

        saving = [("Save and quit", save)] if self._runs.exports_of(run) else []
        self.question = Question(
            f"Stop the {run.name} and quit?",
            f"{_so_far(run)} {_SAVED if saving else _WRITTEN}",
            (("Keep running", _nothing), *saving, ("Quit", leave)),
            run=run,
        )
        self._wake()

    def before_resetting(self, reset: Callable[[list[str]], None]) -> None:
        """Reset all settings when the user agrees, except the fields of the preferences that `reset` gets: what was
        collected is reset where that is ticked."""
        fields = {
            "Forget bookmarks as well": "bookmarks",
            "Forget presets as well": "presets",
            "Forget recent scenes as well": "recent",
        }
        ticked: set[str] = set()

        def agree() -> None:
            kept = [name for option, name in fields.items() if option not in ticked]
            reset([*kept, "tour", "last"])

        self.question = Question(
            "Reset all settings?",
            "View, culling, quality, keys, theme, sizes and the picture folder go back to their defaults.",
            (("Keep them", _nothing), ("Reset", agree)),
            tuple(fields),
            ticked,
        )

    def leave_when_saved(self) -> None:
        """Quit when the results have been written that were to be saved; stay if they could not be.

        A question about a run that has ended meanwhile is none any more."""
        if self.question is not None and self.question.run is not None and self.question.run.done:
            self.drop()
        run = self._run
        if self._leave is None or run is None or not run.done:
            return
        if self._files is None:
            before = len(self._captures.saving)
            for ending in self._runs.exports_of(run):
                self._runs.export(run, ending)
            self._files = self._captures.saving[before:]
        elif all(job.done for job in self._files):
            leave, failed = self._leave, any(job.failure is not None for job in self._files)
            self._leave = self._run = self._files = None
            if not failed:
                leave()

    def _under_way(self) -> Run | None:
        run = self._runs.current
        return run if run is not None and not run.stopping else None


def _so_far(run: Run) -> str:
    done, frames = run.done_of
    return f"{done} of {frames} frames are done."


def _nothing() -> None:
    pass
