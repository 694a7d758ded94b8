"""The figures beside a method are that method's."""

from __future__ import annotations

from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from viewer.state.views import View
from viewer.window.panels.culling import wrong_answers
from viewer.window.widgets import ERROR


def test_wrong_answers_are_those_of_the_method_that_is_shown():
    settings = Settings(16, 8, method="paper", verify=True)
    c = SimpleNamespace(
        frame=make_frame(settings), tracing=SimpleNamespace(settings=settings), runs=SimpleNamespace(current=None),
        session=SimpleNamespace(settings=settings, view=View.DIFFERENCE),
    )  # fmt: skip
    text, color = wrong_answers(c)
    assert text.startswith("3 wrong answers (") and color == ERROR
    c.session.settings = Settings(16, 8, method="paper")
    assert wrong_answers(c)[0] == f"{text} (verified for the view Difference)", "the box Verify is not ticked"
    c.runs.current = SimpleNamespace(name="zoom test")
    text, color = wrong_answers(c)
    assert text == "wrong answers of the zoom test are in its own panel" and color != ERROR
    c.runs.current, c.tracing.settings = None, Settings(16, 8, method="auto", verify=True)
    assert wrong_answers(c) is None
