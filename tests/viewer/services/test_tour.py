"""The tour says what holds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from viewer.services.tour import STEPS, Tour

CULLING = STEPS[0]
KEYS = {"Shadow culling": "Q", "Trace again": "T"}


def tour_of(method: str, frame=None) -> Tour:
    c = SimpleNamespace(frame=frame, session=SimpleNamespace(settings=Settings(16, 8, method=method)), active=False)
    return Tour(c, KEYS.__getitem__)


def test_culling_that_saves_nothing_yet_is_not_to_be_switched_off():
    frame = make_frame(Settings(16, 8, method="paper"))
    shadow = frame.statistics.shadow
    shadow.culled = shadow.candidates_only = shadow.dynamic_only = shadow.cache_hits = 0
    assert "has culled nothing here yet. Press T" in tour_of("paper", frame).text(CULLING)


def test_the_readme_takes_the_same_way():
    """Its steps are the tour's, and it presses the key at once: the method at the start culls, as the tour knows."""
    readme = " ".join((Path(__file__).parents[3] / "README.md").read_text(encoding="utf-8").split())
    assert all(f"{number}. **{step.title}.**" in readme for number, step in enumerate(STEPS[:-1], 1))
    assert "Press `C` twice." in readme and tour_of(Settings().method).text(CULLING).startswith("Press Q twice.")
