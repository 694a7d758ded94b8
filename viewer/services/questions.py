"""Questions that come before something is lost: opening a scene, or quitting, while a run is under way.

A question is shown by the window until one of its answers is chosen; what is done of a run is kept in any case."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from tracer.experiments.runner import Run
from viewer.services.capture_service import CaptureService
from viewer.services.jobs import Job
from viewer.services.runs import Runs

_KEPT = "What is done is kept, and can still be saved from its panel."
_SAVED = "Figures, table and plot of what is done can be saved beside the pictures."
_WRITTEN = "What is done is on disk already."
_COLLECTED = ("bookmarks", "presets", "recent", "tour", "last")  # which resetting the settings leaves

Do = Callable[[], None]


@dataclass(frozen=True)
class Question:
    """`answers` are names and what they do; the first changes nothing, and Escape chooses it.  `at_end`, if there is
    any, is done without an answer once `run` has ended."""

    title: str
    text: str
    answers: tuple[tuple[str, Do], ...]
    run: Run | None = None
    at_end: Do | None = None


class Questions:
    """`question` is the one to be answered now; a newer one takes its place."""

    def __init__(self, runs: Runs, captures: CaptureService, wake: Do = lambda: None) -> None:
        self._runs, self._captures, self._wake = runs, captures, wake
        self.question: Question | None = None
        self._leaving: tuple[Do, Run] | None = None  # how to quit once the results of a run are written
        self._files: list[Job[Path]] | None = None

    def answer(self, name: str) -> None:
        """Choose an answer of the question, by its name."""
        question, self.question = self.question, None
        if question is not None:
            dict(question.answers)[name]()

    def drop(self) -> None:
        """Let the question go without an answer."""
        self.question = None

    def before_opening(self, name: str, go_on: Do) -> None:
        """Open something, at once or, while a run is under way, when the user agrees."""

        def stop() -> None:
            self._runs.stop()
            go_on()

        run = self._runs.current
        kept = _KEPT if run is not None and self._runs.exports_of(run) else _WRITTEN
        self._ask_to_stop(f"open {name}", kept, go_on, ("Stop and open", stop), at_end=go_on)

    def before_losing_edits(self, name: str, go_on: Do) -> None:
        """Open another scene when the user agrees to lose the edits of the one that is open."""
        text = "The edits of the scene that is open are lost. Copy as command keeps them."
        self.question = Question(f"Open {name}?", text, (("Keep the scene", self.drop), ("Open", go_on)))

    def before_quitting(self, leave: Do) -> None:
        """Quit, at once or, while a run is under way, when the user agrees."""
        run = self._runs.current

        def save() -> None:
            assert run is not None
            self._runs.stop()
            self._leaving, self._files = (leave, run), None

        saving = [("Save and quit", save)] if run is not None and self._runs.exports_of(run) else []
        self._ask_to_stop("quit", _SAVED if saving else _WRITTEN, leave, *saving, ("Quit", leave))

    def _ask_to_stop(self, goal: str, kept: str, go_on: Do, *answers: tuple[str, Do], at_end: Do | None = None) -> None:
        run = self._runs.current
        if run is None or run.stopping:
            go_on()
            return
        ways = ("Keep running", self.drop), *answers
        self.question = Question(f"Stop the {run.name} and {goal}?", kept, ways, run, at_end)
        self._wake()

    def before_resetting(self, reset: Callable[[Collection[str]], None]) -> None:
        """Reset all settings when the user agrees, except the fields of the preferences that `reset` gets."""
        self.question = Question(
            "Reset all settings?",
            "View, culling, quality, keys, theme, sizes and the picture folder go back to their defaults. Bookmarks, "
            "presets and recent scenes stay.",
            (("Keep them", self.drop), ("Reset", lambda: reset(_COLLECTED))),
        )

    def leave_when_saved(self) -> None:
        """Quit when the results have been written that were to be saved; stay if they could not be.  What waited for a
        run that has ended meanwhile goes on."""
        question = self.question
        if question is not None and question.run is not None and question.run.done and question.at_end is not None:
            self.drop()
            question.at_end()
        if self._leaving is None or not self._leaving[1].done:
            return
        leave, run = self._leaving
        if self._files is None:
            before = len(self._captures.saving)
            for ending in self._runs.exports_of(run):
                self._runs.export(run, ending)
            self._files = self._captures.saving[before:]
        elif all(job.done for job in self._files):
            self._leaving = None
            if all(job.failure is None for job in self._files):
                leave()
