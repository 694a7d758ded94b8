"""Settings, view and looks as one value."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from tests.viewer.fakes import make_scene
from viewer.state.choices import LOOKS, Choices, differences
from viewer.state.preferences import Preferences
from viewer.state.session import Session
from viewer.state.tone import Curve, Tone
from viewer.state.views import View
from viewer.state.zooming import Zoom


@pytest.fixture
def session() -> Session:
    session = Session(settings=Preferences().settings())
    session.open(make_scene(lights=3))
    return session


def test_choices_are_put_back_as_they_were_and_through_json(session: Session):
    p = Preferences()
    before = Choices.of(session, p)
    session.change(settings=replace(session.settings, method="paper+rest", depth=3, lamp_radius=0.5))
    session.draw.view, session.draw.light, p.outlines, p.shading = View.DEPTH, 2, True, 0.7
    session.draw.tone, session.draw.clipping = Tone(-1.5, 3.0, Curve.FILMIC), False
    after = Choices.of(session, p)
    before.put_into(session, p)
    assert Choices.of(session, p) == before and p.depth == before.settings["depth"] and not p.outlines
    again = Choices.from_json(json.loads(json.dumps(after.to_json())))
    session.draw.tone, session.draw.zoom, session.draw.clipping = Tone(2.0), Zoom(8.0), True
    again.put_into(session, p)
    assert again == replace(after, spans=None, zoom=None, comparison=None, cut=None), "these belong to what is shown"
    assert Choices.of(session, p) == replace(after, zoom=Zoom(8.0)) and p.method == "paper+rest" and p.view == "depth"


def test_differences_are_in_words(session: Session):
    p = Preferences()
    before = Choices.of(session, p)
    session.change(settings=replace(session.settings, method="certified", symmetric=True, lamp_radius=0.25))
    session.draw.view, session.draw.light, p.legend = View.SHADOW, 1, False
    said = set(differences(before, Choices.of(session, p)).values())
    assert said == {"method certified", "symmetric occlusion test on", "lamp radius 0.25", "view Shadow mode",
                    "light 1", "legend off"}  # fmt: skip
    back = differences(Choices.of(session, p), before).values()
    assert "lamp radius of the scene" in back
    assert differences(before, before) == {}


@pytest.mark.parametrize(
    "data",
    [None, [], {"view": "x"}, {"settings": {"depth": "deep"}}, {"looks": 3}, {"light": None}, {"tone": {"curve": "x"}}],
)
def test_damaged_ones_are_one_line(data: object):
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        Choices.from_json(data)


def test_what_is_out_of_range_keeps_its_default(session: Session):
    choices = Choices.from_json({"looks": {"shading": 9.0, "outlines": "yes", "bookmarks": {}}, "light": 99})
    assert choices.looks == {"shading": Preferences().shading, "outlines": False}
    choices.put_into(session, Preferences())
    assert session.draw.light == 2
    assert all(hasattr(Preferences(), name) for name in LOOKS)
