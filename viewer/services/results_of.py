"""Of which scene results are that a panel shows: they stay when another is opened, and look alike."""

from __future__ import annotations

from datetime import date

from tracer.scene.model import Scene
from viewer.services.runs import Experiment, ZoomTest
from viewer.util.numbers import several


def results_of(run: Experiment | ZoomTest, scene: Scene | None) -> tuple[str, bool]:
    """Scene, size, what was done, and when it began, of a run's results; and whether they are of another scene than the
    one that is open, or of what that was before: this is said first."""
    name, elsewhere = run.scene_path.name, not run.is_of(scene)
    if elsewhere and scene is not None:
        same = scene.path == run.scene_path
        name += " before it was edited, or read again" if same else f" (not {scene.path.name}, which is open)"
    when = f"{run.began:%H:%M}" if run.began.date() == date.today() else f"{run.began:%Y-%m-%d %H:%M}"
    return f"{name}, {run.settings.width} x {run.settings.height}, {_what(run)}, begun {when}", elsewhere


def _what(run: Experiment | ZoomTest) -> str:
    if isinstance(run, ZoomTest):
        return f"towards primitive {run.start.primitive}"
    done, of = run.done_of
    frames = several(of, "frame") if done == of else f"{done} of {several(of, 'frame')}"
    return f"{frames}, {run.settings.accelerator}"
