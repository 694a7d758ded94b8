"""Results of experiments, zoom tests and hunts as columns and in words, for panels, commands and files alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path
from typing import Any, Generic, TypeVar

from tracer.experiments import counterexample, experiment, zoom
from tracer.experiments.counterexample import Counterexample
from tracer.experiments.experiment import REFERENCE, Row
from tracer.experiments.titles import WRONG_PIXELS, FactorStep
from tracer.experiments.zoom import Change, Step
from tracer.method import title_of
from tracer.scene.lights import number_of
from tracer.scene.model import Scene
from tracer.util.text import MOST_PERCENT, mode_in_words, printable, saved
from viewer.state.methods import BY_MODES
from viewer.util.numbers import memory

T = TypeVar("T")


@dataclass(frozen=True)
class Column(Generic[T]):
    """A column of a table: its heading, what that means, and what it says of a row; `wrong` says of which rows that is
    bad, and `text` that it holds words.

    Columns stand in the order in which they matter: where there is no room for all, the last are left out."""

    heading: str
    meaning: str
    cell: Callable[[T], str]
    wrong: Callable[[T], bool] = lambda row: False
    text: bool = False


# --- experiments -----------------------------------------------------------------------------------


def _compared(cell: Callable[[Row], str]) -> Callable[[Row], str]:
    """A cell of what a method is against the reference; empty for that."""
    return lambda row: cell(row) if row.method != REFERENCE else ""


def _speed_up(row: Row) -> str:
    spread = row.speed_up_spread
    return f"{row.speed_up:.2f}" + (f" ± {spread:.2f}" if math.isfinite(spread) else "")


METHOD: Column[Any] = Column("method", "which shadow rays are not traced", lambda row: row.method, text=True)
TITLED = replace(METHOD, cell=lambda row: title_of(row.method))
"""The same for the window, where methods have their readable names."""
SPEED_UP = Column("speed-up", "speed-up over none, all frames", _compared(_speed_up))
WRONG: Column[Row] = Column(
    "wrong", "wrong answers (of rays due)", lambda row: f"{row.wrong:,} ({row.wrong_part:.3%})",
    wrong=lambda row: row.wrong > 0,
)  # fmt: skip
TABLE_1: tuple[Column[Row], ...] = (
    SPEED_UP,
    Column("rays saved", "shadow rays saved (of rays due)", _compared(lambda row: saved(row.saved_part))),
    Column("steps saved", "traversal steps saved, average", _compared(lambda row: saved(row.average_steps))),
    Column("tests saved", "intersection tests saved, average", _compared(lambda row: saved(row.average_tests))),
    WRONG,
    Column("median frame", "time of a frame, median", lambda row: f"{1000.0 * row.frame_seconds:,.0f} ms"),
    Column("most steps (frame)", "most traversal steps saved (frame)",
           _compared(lambda row: f"{saved(row.most_steps)} ({row.most_steps_frame})")),
    Column("most tests (frame)", "most intersection tests saved (frame)",
           _compared(lambda row: f"{saved(row.most_tests)} ({row.most_tests_frame})")),
    Column("extra / pixel", "extra occlusion tests per pixel", lambda row: f"{row.extra_tests_per_pixel:.3f}"),
    Column("all frames", "time of all frames", lambda row: f"{row.path_seconds:,.2f} s"),
    Column("preparing", "time of all frames that was spent on preparing",
           lambda row: f"{row.build_seconds:,.2f} s" if row.build_seconds >= 0.005 else ""),
    Column("memory", "memory of the method", lambda row: memory(row.memory_bytes) if row.memory_bytes else ""),
)  # fmt: skip
"""What the paper's Table 1 says of a method."""


def table_1(results: experiment.Results) -> list[Column[Row]]:
    """Return the columns that mean anything: wrong answers are counted only where frames were verified, and then rays
    that are culled are traced as well, which takes time."""
    return [column for column in TABLE_1 if column is not (SPEED_UP if results.settings.get("verify") else WRONG)]


LEVEL = 0.03  # part of 1 by which times may differ that are called as fast as each other


def verdicts(rows: Sequence[Row], verified: bool) -> list[str]:
    """Say in a sentence for each method what it saves, and whether it is right or, unless it is `verified`, faster."""
    paper, said = next((row for row in rows if row.method == BY_MODES), None), []
    for row in (row for row in rows if row.method != REFERENCE):
        steps = f"{saved(row.average_steps)} of the traversal steps of shadow rays saved"
        if row.average_steps < -MOST_PERCENT:  # 12.6 × as many
            steps = f"{saved(row.average_steps)} traversal steps of shadow rays"
        if paper is not None and row is not paper and 0.0 < paper.average_steps < 0.5 * row.average_steps:
            steps += f", {row.average_steps / paper.average_steps:.1f} times as many as by {title_of(BY_MODES)}"
        right = f", {row.wrong:,} wrong answer{'s' * (row.wrong != 1)}" if row.wrong else ", no wrong answer"
        low, high = row.speed_up - row.speed_up_spread, row.speed_up + row.speed_up_spread
        if low > 1.0 or high < 1.0:
            speed = f", {'faster' if low > 1.0 else 'slower'} than tracing all: {row.speed_up:.2f} times as fast"
        elif max(abs(low - 1.0), abs(high - 1.0)) <= LEVEL:
            speed = f", as fast as tracing all within {LEVEL:.0%}"
        else:
            speed = ", too few frames to say whether it is faster than tracing all"
        said.append(f"{title_of(row.method)}: {steps}{right if verified else speed}.")
    return said


_PUBLISHED = {
    "Kitchen": "19.8% of the steps (59.5% at most), 24.5% of the tests (59.8% at most), 0.173 extra tests per pixel",
    "Robot": "7.4% of the steps (19.5% at most), 9.5% of the tests (29.6% at most), 0.149 extra tests per pixel",
}


def published(results: experiment.Results) -> list[str]:
    """Return what the paper's Table 1 says, and whether that is of the same scene."""
    known = Path(results.scene).stem.capitalize() in _PUBLISHED
    other = [] if known else ["The paper has no figures for this scene, but for two scenes of BART."]
    return [*other, *(f"{scene}, in the paper, saved: {said}." for scene, said in _PUBLISHED.items())]


FEW_FRAMES = 30
"""Fewer than that are said to be few."""
PREPARING = 0.05
"""The part of a method's time from which on it is worth a word that this was preparing."""


def caveats(results: experiment.Results, in_window: bool = False) -> list[str]:
    """Return what else the times depend on, in half sentences; `in_window` says that they were measured beside one."""
    settings, few = results.settings, []
    if len(results.frames) < FEW_FRAMES:
        few = [f"{len(results.frames)} frames teach few modes, longer runs save more"]
    if settings.get("verify"):
        return ["no speed-up is given, as verifying takes time: it traces the culled rays as well", *few]
    said = ["times include what the window takes meanwhile, those of the command bench do not"] if in_window else []
    if "accelerator" in settings:
        said.append(f"rays go through the {settings['accelerator']}: speed-ups depend on the tree")
    for method, seconds in results.build_seconds.items():
        share = sum(seconds) / max(sum(results.methods[method]["frame_seconds"]), 1e-9)
        if share >= PREPARING:
            said.append(f"{share:.0%} of the time of {title_of(method)} is preparing")
    if len(results.frames) > 1:
        said.append("±: two standard errors over the frames")
    return said + few


# --- zoom tests ------------------------------------------------------------------------------------


def changes_in_words(changes: Sequence[Change]) -> list[str]:
    """Say what changes, e.g. "lights 0, 2: init → non-shadow"; lights that change alike are named together."""
    alike: dict[tuple[bool, str, str], list[str]] = {}
    for change in changes:
        alike.setdefault((change.light is None, change.before, change.after), []).append(str(change.light))
    said = []
    for (own, before, after), lights in alike.items():
        whose = "" if own else f"light{'s' * (len(lights) > 1)} {', '.join(lights)}: "
        said.append(f"{whose}{mode_in_words(before)} → {mode_in_words(after)}")
    return said


STEPS: tuple[Column[FactorStep], ...] = (
    Column("factor", "zoom factor", lambda row: f"{row[0]:g}"),
    Column("step", "number of the step; the camera first stays where it is", lambda row: f"{row[1].number}"),
    Column("pixels", "pixels that the primitive covers", lambda row: f"{row[1].pixels:,}"),
    Column("wrong", WRONG_PIXELS, lambda row: f"{row[1].wrong_of_primitive:,}",
           wrong=lambda row: row[1].wrong_of_primitive > 0),
    Column("changes", "modes that change", lambda row: "; ".join(changes_in_words(row[1].changes)), text=True),
    Column("in picture", "wrong pixels of the whole picture", lambda row: f"{row[1].wrong:,}"),
    Column("highest", "pixels of its last examination", lambda row: f"{row[1].highest:,}"),
    Column("distance", "from the camera to the primitive", lambda row: f"{row[1].distance:.4g}"),
)  # fmt: skip


# --- hunts -----------------------------------------------------------------------------------------


def findings(scene: Scene, finds: Sequence[Counterexample]) -> tuple[Column[Counterexample], ...]:
    """Return the columns of findings in a scene."""

    def light(find: Counterexample) -> str:
        return f"{number_of(scene.lights, find.light)}" + (f" (+{find.more_lights})" if find.more_lights else "")

    return (
        Column("#", "the worst first", lambda find: f"{1 + finds.index(find)}"),
        Column("off by", "difference of the colour from the right one, of 1", lambda find: f"{find.difference:.3f}"),
        Column("pixel", "column and row, from the upper left", lambda find: f"{find.x}, {find.y}"),
        Column("frame", "frame of the path, or the one that it is near",
               lambda find: counterexample.frame_of(find, scene)),
        Column("light", "light whose answer is wrong (+ others that are wrong in the same way)", light),
        Column("primitive", "primitive at which the light is wrong: number and object",
               lambda find: printable(f"{find.primitive} of {scene.name_of(find.primitive)}"), text=True),
        Column("culled by", "mode that culling goes by", lambda find: mode_in_words(find.verdict), text=True),
        Column("traced", "what tracing the shadow ray says", lambda find: "blocked" if find.lit else "lit", text=True),
        Column("learnt", "what taught the mode", lambda find: counterexample.taught_by(find, scene), text=True),
        Column("wrong pixels", "wrong pixels of its picture", lambda find: f"{find.pixels:,}"),
    )  # fmt: skip


# --- tables for files -------------------------------------------------------------------------------


def table_of(results: experiment.Results | zoom.Results) -> tuple[list[str], list[Sequence[object]]]:
    """Return the headings and the rows of results, parts of 1 and seconds as they are.

    Of a zoom test that is a row for each step of each factor."""
    if isinstance(results, experiment.Results):
        return [f.name for f in fields(Row)], [astuple(row) for row in experiment.table(results)]
    plain = [f.name for f in fields(Step) if f.name not in ("camera", "shadows", "changes")]
    lights = max((len(step.shadows) for approach in results.approaches for step in approach.steps), default=0)
    rows: list[Sequence[object]] = []
    for approach in results.approaches:
        for step in approach.steps:
            values = [getattr(step, name) for name in plain]
            changes = "; ".join(changes_in_words(step.changes))
            rows.append([approach.factor, *values, *(mode or "" for mode in step.shadows), changes])
    return ["factor", *plain, *(f"shadow_{light}" for light in range(lights)), "changes"], rows
