"""The tour says what holds."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.experiments.zoom import Approach, Change, Results, Step
from tracer.frame import Settings
from viewer.services.tour import STEPS, Tour, zoom_test_in_words

CULLING = next(step for step in STEPS if step.title == "Turn culling off and on")


KEYS = {"Shadow culling": "Q", "Trace again": "T"}


def test_the_way_to_see_culling_can_be_gone_in_order_from_every_method():
    """With `auto`, which may cull nothing, `paper` comes first, whether there is a picture already or not."""
    for frame in (None, make_frame(Settings(16, 8, method="auto"))):
        c = SimpleNamespace(frame=frame, session=SimpleNamespace(settings=Settings(16, 8, method="auto")))
        c.active, c.scheduler = False, SimpleNamespace(awaits=False)
        text = CULLING.text(c, KEYS.__getitem__)
        assert text.index("Choose paper") < text.index("press Q twice")
        for method, said in (("paper", "Press Q twice."), ("none", "Press Q once more")):
            c.session.settings = Settings(16, 8, method=method)
            assert CULLING.text(c, KEYS.__getitem__).startswith(said)
    shadow = c.frame.statistics.shadow
    shadow.culled = shadow.candidates_only = shadow.dynamic_only = shadow.cache_hits = 0
    c.session.settings = Settings(16, 8, method="paper")
    for c.active, c.scheduler.awaits in ((True, False), (False, True)):
        assert "is on its way" in CULLING.text(c, KEYS.__getitem__)
    c.scheduler.awaits = False
    assert "has culled nothing here yet. Press T" in CULLING.text(c, KEYS.__getitem__)


def test_while_a_step_is_shown_nobody_is_told_to_do_it():
    c = SimpleNamespace(frame=make_frame(), session=SimpleNamespace(settings=Settings(16, 8, method="auto")))
    tour = Tour(c, lambda panel: None, KEYS.__getitem__)
    tour.at = STEPS.index(CULLING)
    assert "Choose paper" in tour.text(CULLING)
    tour.show()
    assert tour.text(CULLING) == CULLING.shown and "Press" not in CULLING.shown


def test_the_readme_takes_the_same_way():
    """Its steps are the tour's, and it presses the key at once: the method at the start culls, as the tour knows."""
    readme = " ".join((Path(__file__).parents[3] / "README.md").read_text(encoding="utf-8").split())
    for number, step in enumerate(STEPS, 1):
        assert f"{number}. **{step.title}.**" in readme
    c = SimpleNamespace(frame=None, session=SimpleNamespace(settings=Settings(16, 8)))
    said = CULLING.text(c, {"Shadow culling": "C"}.__getitem__)
    assert "Press `C` twice." in readme and said.startswith("Press C twice.")


def test_a_zoom_test_is_told_as_it_went():
    grown = Approach(4.0, [step(0, 0), step(1, 3, examined_anew=True), step(2, 1)])
    results = Results("s", (8, 8), 1, 0.0, (0.0, 0.0, 0.0), 0.9, approaches=[grown, Approach(16.0, [step(0, 0)])])
    assert zoom_test_in_words(results) == (
        "Zoom test, factor 4: examined anew at step 1, at most 3 pixels wrong; factor 16: never examined anew, no "
        "pixel wrong."
    )


def step(number: int, wrong: int, examined_anew: bool = False) -> Step:
    changes = [Change(None, "FULLY_RENDERED", "INIT")] if examined_anew else []
    return Step(number, 1.0, make_frame().camera, 9, 9, "INIT", [], changes, wrong, wrong, 9, 0, 0)
