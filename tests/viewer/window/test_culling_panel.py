"""The figures beside a method are that method's."""

from __future__ import annotations

from types import SimpleNamespace

from tests.viewer.fakes import make_frame
from tracer.frame import Settings
from viewer.state.draw_options import DrawOptions
from viewer.state.views import View
from viewer.window.panels.culling import trust, wrong_answers
from viewer.window.widgets import ERROR


def test_wrong_answers_are_those_of_the_method_that_is_shown():
    settings = Settings(16, 8, method="paper", verify=True)
    c = SimpleNamespace(
        frame=make_frame(settings), scheduler=SimpleNamespace(settings=settings), runs=SimpleNamespace(current=None),
        session=SimpleNamespace(settings=settings, draw=DrawOptions(View.DIFFERENCE)),
    )  # fmt: skip
    text, color = wrong_answers(c)
    assert text.startswith("3 wrong answers (") and color == ERROR
    c.session.settings = Settings(16, 8, method="paper")
    assert wrong_answers(c)[0] == f"{text} (verified for the view Difference)", "the box Verify is not ticked"
    c.runs.current = SimpleNamespace(name="zoom test")
    text, color = wrong_answers(c)
    assert text == "wrong answers of the zoom test are in its own panel" and color != ERROR
    c.runs.current, c.scheduler.settings = None, Settings(16, 8, method="auto", verify=True)
    assert wrong_answers(c) is None


def test_below_a_method_stands_what_it_trusts_whether_it_is_exact_and_what_it_does_now():
    settings = Settings(16, 8, method="paper+cache")
    c = SimpleNamespace(
        frame=make_frame(settings), runs=SimpleNamespace(current=None), session=SimpleNamespace(settings=settings)
    )
    first, second = trust(c).split(" cache: ")
    assert first.startswith("paper: Trusts ") and "Wrong now and then." in first and second.endswith("as the method.")
    c.session.settings = Settings(16, 8, method="auto")
    c.frame.statistics.decision = "Every shadow ray is traced."
    assert trust(c).endswith(" Exact."), "the picture is another method's"
    c.frame = make_frame(c.session.settings)
    c.frame.statistics.decision = "Every shadow ray is traced."
    assert trust(c).endswith(" Exact. Every shadow ray is traced.")
