"""The cut of the pixel that is pointed at: asked for, taken up, and gone where a pixel has none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from tests.viewer.fakes import make_frame
from viewer.services import cut_inspector
from viewer.services.cut_inspector import CutInspector, CutQuestion


@pytest.mark.parametrize("over", [False, True])
def test_a_pixel_without_a_cut_does_not_keep_that_of_the_pixel_before(monkeypatch: pytest.MonkeyPatch, over: bool):
    """`over`: the renderer has begun another frame."""
    frame, asked = make_frame(), []

    def answer(renderer, of, x, y):
        if x == 0:
            return SimpleNamespace(frame=of, x=x, y=y)
        if over:
            raise LookupError("another frame has begun")
        return None

    monkeypatch.setattr(cut_inspector, "light_cut", answer)
    selection = SimpleNamespace(pixel=(0, 0), picked=object(), hovered=None)
    cuts = CutInspector(selection, SimpleNamespace(ask=asked.append))

    def follow() -> CutQuestion:
        cuts.follow(frame, idle=True)
        return asked[-1]

    follow().answer(None)
    follow()
    assert cuts.cut is not None and cuts.cut.x == 0
    selection.pixel = (4, 0)
    question = follow()
    assert not question.over and cuts.cut is None, "what is drawn is never that of another pixel"
    question.answer(None)
    follow()
    assert question.over and cuts.cut is None and len(asked) == 2


def test_a_cut_is_asked_for_once_and_stays_while_samples_come(monkeypatch: pytest.MonkeyPatch):
    frame, asked = make_frame(), []
    monkeypatch.setattr(cut_inspector, "light_cut", lambda renderer, of, x, y: SimpleNamespace(frame=of, x=x, y=y))
    cuts = CutInspector(SimpleNamespace(pixel=(1, 0), picked=object(), hovered=None), SimpleNamespace(ask=asked.append))
    cuts.follow(frame, idle=True)
    sampled = replace(frame, color=frame.color + 0.1)  # comes before the answer about the first
    cuts.follow(sampled, idle=True)
    assert cuts.waits_for == (1, 0)
    asked[-1].answer(None)
    assert cuts.waits_for is None
    for samples in range(3):
        sampled = replace(sampled, color=sampled.color + samples)
        cuts.follow(sampled, idle=True)
        assert cuts.cut is not None and len(asked) == 1
    cuts.follow(replace(frame, primitive=frame.primitive.copy()), idle=True)
    assert cuts.cut is None and len(asked) == 2, "another picture"
