"""Results of experiments and zoom tests in words and as rows, for tables, panels, plots and files alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, fields
from pathlib import Path

from tracer.experiments import experiment, lamp_experiment, zoom
from tracer.experiments.experiment import REFERENCE, Row
from tracer.experiments.lamp_experiment import LampResults, LampRow
from tracer.experiments.zoom import Approach, Change, Step
from tracer.method import Method
from viewer.state import terms
from viewer.util.numbers import memory, saved

# --- experiments -----------------------------------------------------------------------------------


def _compared(cell: Callable[[Row], str]) -> Callable[[Row], str]:
    """A cell of what a method is against the reference; empty for that."""
    return lambda row: cell(row) if row.method != REFERENCE else ""


def _speed_up(row: Row) -> str:
    spread = row.speed_up_spread
    return f"{row.speed_up:.2f}" + (f" ± {spread:.2f}" if math.isfinite(spread) else "")


WRONG = "wrong answers (of rays due)"
SPEED_UP = "speed-up over none, all frames"
LINES: tuple[tuple[str, Callable[[Row], str]], ...] = (
    ("shadow rays saved (of rays due)", _compared(lambda row: saved(row.saved_part))),
    ("traversal steps saved, average", _compared(lambda row: saved(row.average_steps))),
    ("  most (frame)", _compared(lambda row: f"{saved(row.most_steps)} ({row.most_steps_frame})")),
    ("intersection tests saved, average", _compared(lambda row: saved(row.average_tests))),
    ("  most (frame)", _compared(lambda row: f"{saved(row.most_tests)} ({row.most_tests_frame})")),
    ("extra occlusion tests per pixel", lambda row: f"{row.extra_tests_per_pixel:.3f}"),
    (WRONG, lambda row: f"{row.wrong:,} ({row.wrong_part:.3%})"),
    ("time of a frame, median", lambda row: f"{1000.0 * row.frame_seconds:,.0f} ms"),
    ("time of all frames", lambda row: f"{row.path_seconds:,.2f} s"),
    ("  of it preparing", lambda row: f"{row.build_seconds:,.2f} s" if row.build_seconds >= 0.005 else ""),
    (SPEED_UP, _compared(_speed_up)),
    ("memory of the method", lambda row: memory(row.memory_bytes) if row.memory_bytes else ""),
)
"""The table's lines: what each is called, and what it says of a method."""


def lines(verified: bool) -> list[tuple[str, Callable[[Row], str]]]:
    """Those that mean anything: wrong answers are counted only where frames were `verified`, and then traced rays that
    are culled are in the times."""
    return [line for line in LINES if line[0] != (SPEED_UP if verified else WRONG)]


def caveats(results: experiment.Results, in_window: bool = False) -> list[str]:
    """What else the times depend on, in half sentences; `in_window` says that they were measured beside one."""
    settings = results.settings
    if settings.get("verify"):
        return ["times include verifying, which traces culled rays, too: no speed-up is told"]
    said = ["times include what the window takes meanwhile, those of the command bench do not"] if in_window else []
    if "accelerator" in settings:
        said.append(f"rays go through the {settings['accelerator']}: speed-ups depend on the tree")
    for method, seconds in results.build_seconds.items():
        share = sum(seconds) / max(sum(results.methods[method]["frame_seconds"]), 1e-9)
        if share >= PREPARING:
            said.append(f"{share:.0%} of the time of {method} is preparing")
    if len(results.frames) > 1:
        said.append("±: two standard errors over the frames")
    return said


PREPARING = 0.05
"""The part of a method's time from which on it is worth a word that this was preparing."""

QUICKER = 1.03
"""Speed-up over the reference from which on a method is called quicker: less is within what clocks differ by."""
SAVING = 0.0005  # part of the work that is worth a word: less is shown as 0.0%


def leaders(rows: Sequence[Row], timed: bool = True) -> list[str]:
    """Which exact method is the best of several in each respect, a line for each, or that none is better than the
    reference; no lines where there is nothing to choose from.

    Nothing is said of time unless frames were `timed` for what they are: one that is verified traces all rays."""
    others = [row for row in rows if Method.parse(row.method).exact and not _measures_only(row.method)]
    others = [row for row in others if row.method != REFERENCE]
    if len(others) < 2:
        return []
    culling = [row for row in others if row.average_steps or row.average_tests]  # else it is only chance
    steps = _best(others, lambda row: row.average_steps, SAVING)
    tests = _best(others, lambda row: row.average_tests, SAVING)
    beyond_chance = [row for row in culling if row.speed_up - row.speed_up_spread > 1.0]
    time = _best(beyond_chance, lambda row: row.speed_up, QUICKER)
    none = f"{REFERENCE}; no other"
    lines = [
        "fewest steps, of exact methods: "
        + (f"{steps.method} ({saved(steps.average_steps)} saved)" if steps else f"{none} saves any"),
        "fewest tests, of exact methods: "
        + (f"{tests.method} ({saved(tests.average_tests)} saved)" if tests else f"{none} saves any"),
        "least time, of exact methods: "
        + (f"{time.method} ({time.speed_up:.2f} times as fast as {REFERENCE})" if time else f"{none} is quicker"),
    ]
    return lines if timed else lines[:2]


def _best(rows: Sequence[Row], figure: Callable[[Row], float], least: float) -> Row | None:
    """The row with the largest figure; None where that is not worth naming."""
    best = max(rows, key=figure, default=None)
    return best if best is not None and figure(best) >= least else None


def _measures_only(method: str) -> bool:
    return any(kind.measures for kind in Method.parse(method).kinds)


def frames_in_words(results: experiment.Results) -> str:
    """Which frames of which path there are, e.g. "frames 0 to 19 of 200" or "70 of 100 frames, stopped"."""
    done, path = len(results.frames), results.path_frames
    if results.planned < path:
        first, last = results.frames[0], results.frames[-1]
        text = f"frames {first} to {last} of {path}" if done > 1 else f"frame {first} of {path}"
    elif done < path:
        text = f"{done} of {path} frames"
    else:
        text = f"{done} frames over the whole path" if done > 1 else "1 frame"
    return text + ", stopped" * results.stopped


# --- zoom tests ------------------------------------------------------------------------------------


def happenings(approach: Approach) -> list[Step]:
    """The steps where something happens: a mode changes, or the primitive's wrong pixels become more or fewer."""
    wrong_before = [0, *(step.wrong_of_primitive for step in approach.steps)]
    return [s for s, wrong in zip(approach.steps, wrong_before) if s.changes or s.wrong_of_primitive != wrong]


def changes_in_words(changes: Sequence[Change]) -> list[str]:
    """What changes in a step, e.g. "lights 0, 2: init → non shadow"; lights that change alike are named together."""
    return [f"{who}{_spoken(before)} → {_spoken(after)}" for who, before, after in _gathered(changes)]


def modes_in_words(changes: Sequence[Change]) -> str:
    """The modes that are new in a step, shorter: "fully rendered, lights 0, 2: non shadow"."""
    return ", ".join(f"{who}{_spoken(after)}" for who, _, after in _gathered(changes))


def _gathered(changes: Sequence[Change]) -> list[tuple[str, str, str]]:
    """(whose mode, before, after), the occlusion mode first."""
    lights: dict[tuple[str, str], list[str]] = {}
    for change in changes:
        if change.light is not None:
            lights.setdefault((change.before, change.after), []).append(str(change.light))
    own = [("", change.before, change.after) for change in changes if change.light is None]
    return own + [(f"light{'s' * (len(n) > 1)} {', '.join(n)}: ", *modes) for modes, n in lights.items()]


def _spoken(mode: str) -> str:
    return mode.replace("_", " ").lower()


def zoom_title(results: zoom.Results) -> str:
    """Which test this is, in one line."""
    name, (width, height) = Path(results.scene).name, results.size
    return f"{name}, {results.time:.3f} s, towards primitive {results.primitive}, {width} × {height}"


NEVER_WHOLE = "never fully rendered, so it is never culled, and the zoom factor does not matter"


def never_whole(results: zoom.Results) -> bool:
    """Whether NEVER_WHOLE applies to the primitive: nothing was tested then."""
    return any(a.steps for a in results.approaches) and not any(a.seen_whole for a in results.approaches)


WRONG_PIXELS = "wrong pixels of this primitive"
SUMMARY = ("factor", "re-examined", "wrong pixels", "most", "at the end", terms.CULLED, terms.DYNAMIC_ONLY)


def summary(approach: Approach) -> tuple[str, ...]:
    """What came of one factor, a cell for each heading of SUMMARY."""
    anew, wrong = approach.examined_anew, approach.wrong_steps
    due = max(1, sum(step.due for step in approach.steps))
    culled, alone = (sum(getattr(step, name) for step in approach.steps) / due for name in ("culled", "dynamic_only"))
    return (
        f"{approach.factor:g}",
        f"step {', '.join(map(str, anew))}" if anew else "never",
        f"step {wrong[0]} to {wrong[-1]}" if wrong else "none",
        f"{approach.most_wrong:,}",
        f"{approach.steps[-1].wrong_of_primitive:,}" if approach.steps else "",
        f"{culled:.1%}",
        f"{alone:.1%}",
    )


# --- tables for files -------------------------------------------------------------------------------


def table_of(results: experiment.Results | LampResults | zoom.Results) -> tuple[list[str], list[Sequence[object]]]:
    """Return the headings and the rows of results, parts of 1 and seconds as they are.

    Of a zoom test that is a row for each step of each factor."""
    if isinstance(results, experiment.Results):
        return [f.name for f in fields(Row)], [astuple(row) for row in experiment.table(results)]
    if isinstance(results, LampResults):
        return [f.name for f in fields(LampRow)], [astuple(row) for row in lamp_experiment.table(results)]
    plain = [f.name for f in fields(Step) if f.name not in ("camera", "shadows", "changes")]
    lights = max((len(step.shadows) for approach in results.approaches for step in approach.steps), default=0)
    rows: list[Sequence[object]] = []
    for approach in results.approaches:
        for step in approach.steps:
            values = [getattr(step, name) for name in plain]
            changes = "; ".join(changes_in_words(step.changes))
            rows.append([approach.factor, *values, *(mode or "" for mode in step.shadows), changes])
    return ["factor", *plain, *(f"shadow_{light}" for light in range(lights)), "changes"], rows
