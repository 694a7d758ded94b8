"""The tour says what holds."""

from __future__ import annotations

from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from viewer.services.tour import STEPS

CULLING = next(step for step in STEPS if step.title == "Turn culling off and on")


def test_nothing_is_said_of_what_culling_does_before_there_is_a_picture():
    for method in ("auto", "paper", "none"):
        settings = Settings(16, 8, method=method)
        c = SimpleNamespace(frame=None, session=SimpleNamespace(settings=settings))
        assert CULLING.text(c).startswith("Press C twice.")
    c.session.settings, c.frame = Settings(16, 8, method="auto"), make_frame(Settings(16, 8, method="auto"))
    shadow = c.frame.statistics.shadow
    shadow.culled = shadow.candidates_only = shadow.dynamic_only = shadow.cache_hits = 0
    assert "only where it has measured" in CULLING.text(c) and "Choose paper" in CULLING.text(c)
