"""What results of experiments, zoom tests and hunts are called, and what happens in them, for figures and tables."""

from __future__ import annotations

from pathlib import Path

from tracer.experiments import experiment, hunt, zoom
from tracer.experiments.zoom import Approach, Step
from tracer.method import title_of
from tracer.util.text import printable


def frames_in_words(results: experiment.Results) -> str:
    """Return which frames of which path there are, e.g. "frames 0 to 69 of 100, stopped"."""
    first, last = results.frames[0], results.frames[-1]
    which = f"frames {first} to {last}" if last > first else f"frame {first}"
    return f"{which} of {results.path_frames}{', stopped' * results.stopped}"


def title(results: experiment.Results | zoom.Results | hunt.Results) -> str:
    """Return what was measured, in one line."""
    if isinstance(results, experiment.Results):
        what = frames_in_words(results)
    elif isinstance(results, zoom.Results):
        what = f"{results.time:.3f} s, towards primitive {results.primitive}"
    else:
        what = f"method {title_of(results.method)}"
    width, height = results.size
    return f"{printable(Path(results.scene).name)}, {width} × {height}, {what}"


# --- zoom tests ------------------------------------------------------------------------------------

WRONG_PIXELS = "wrong pixels of this primitive"
NEVER_WHOLE = "never fully rendered, so it is never culled, and the zoom factor does not matter"


def never_whole(results: zoom.Results) -> bool:
    """Return whether NEVER_WHOLE applies to the primitive: nothing was tested then."""
    return any(a.steps for a in results.approaches) and not any(a.seen_whole for a in results.approaches)


FactorStep = tuple[float, Step]
"""A step, behind the zoom factor that it was made with."""


def happenings(results: zoom.Results) -> list[FactorStep]:
    """Return the steps where a mode changes, or the primitive's wrong pixels become more or fewer."""
    found = []
    for approach in results.approaches:
        wrong_before = [0, *(step.wrong_of_primitive for step in approach.steps)]
        for step, wrong in zip(approach.steps, wrong_before):
            if step.changes or step.wrong_of_primitive != wrong:
                found.append((approach.factor, step))
    return found


def verdict(approach: Approach) -> str:
    """Return when the primitive was examined anew, and how long it was wrong, in a sentence: "factor 4: examined anew
    after step 14 (185 > 4 x 46); wrong at steps 7 to 14"."""
    factor, steps, wrong = f"{approach.factor:g}", approach.steps, approach.wrong_steps
    anew = " and ".join(
        f"{number} ({steps[number].pixels:,} > {factor} × {steps[number - 1].highest:,})"
        for number in approach.examined_anew
    )
    said = f"examined anew after step {anew}" if anew else "never examined anew"
    where = f"steps {wrong[0]} to {wrong[-1]}" if len(wrong) > 1 else f"step {wrong[0]}" if wrong else ""
    return f"factor {factor}: {said}; {f'wrong at {where}' if wrong else 'never wrong'}"
