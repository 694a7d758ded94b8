"""The tour says what holds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from viewer.services.tour import STEPS, Tour

CULLING = next(step for step in STEPS if step.title == "Turn culling off and on")
KEYS = {"Shadow culling": "Q", "Trace again": "T"}


def tour_of(method: str, frame=None) -> tuple[SimpleNamespace, Tour]:
    c = SimpleNamespace(frame=frame, session=SimpleNamespace(settings=Settings(16, 8, method=method)), active=False)
    return c, Tour(c, KEYS.__getitem__)


def test_the_way_to_see_culling_can_be_gone_in_order_from_every_method():
    """With `auto`, which may cull nothing, `paper` comes first, whether there is a picture already or not."""
    for frame in (None, make_frame(Settings(16, 8, method="auto"))):
        c, tour = tour_of("auto", frame)
        text = tour.text(CULLING)
        assert text.index("Choose paper") < text.index("press Q twice")
        for method, said in (("paper", "Press Q twice."), ("none", "Press Q once more")):
            c.session.settings = Settings(16, 8, method=method)
            assert tour.text(CULLING).startswith(said)
    shadow = c.frame.statistics.shadow
    shadow.culled = shadow.candidates_only = shadow.dynamic_only = shadow.cache_hits = 0
    c.session.settings = Settings(16, 8, method="paper")
    assert "has culled nothing here yet. Press T" in tour.text(CULLING)


def test_the_readme_takes_the_same_way():
    """Its steps are the tour's, and it presses the key at once: the method at the start culls, as the tour knows."""
    readme = " ".join((Path(__file__).parents[3] / "README.md").read_text(encoding="utf-8").split())
    assert all(f"{number}. **{step.title}.**" in readme for number, step in enumerate(STEPS, 1))
    _, tour = tour_of(Settings().method)
    assert "Press `C` twice." in readme and tour.text(CULLING).startswith("Press Q twice.")
