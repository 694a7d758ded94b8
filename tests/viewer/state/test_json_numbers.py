"""Numbers of JSON that are too large, or none, are one line, wherever a saved state has them."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.viewer.fakes import make_scene
from tracer.experiments import warmup_frames
from tracer.scene.model import Camera
from viewer.output import recipe
from viewer.services import comparison
from viewer.state.choices import Choices
from viewer.state.preferences import Preferences, checked
from viewer.state.session import Session, Snapshot
from viewer.util.json_numbers import finite, number, whole

LARGE = 10**400
INFINITE = float("inf")


def state() -> dict[str, Any]:
    session = Session()
    session.open(make_scene(lights=2))
    data: dict[str, Any] = json.loads(json.dumps(session.snapshot().to_json()))
    return data


@pytest.mark.parametrize("wrong", [LARGE, -LARGE, "1", True, None, [1]])
def test_what_is_no_number_is_refused(wrong: Any) -> None:
    for kind in (number, finite):
        with pytest.raises(ValueError, match="a number in it is"):
            kind(wrong)


def test_numbers_of_numpy_are_numbers() -> None:
    assert finite(np.float32(0.5)) == 0.5 and number(7) == 7.0 and type(number(7)) is float
    assert type(whole(np.int64(3))) is int and np.isnan(number(float("nan")))
    for wrong in (1.0, True, INFINITE):
        with pytest.raises(ValueError, match="a whole number"):
            whole(wrong)
    with pytest.raises(ValueError, match="finite"):
        finite(INFINITE)


@pytest.mark.parametrize(
    "wrong",
    [
        {"time": LARGE},
        {"time": INFINITE},
        {"wipe": LARGE},
        {"light": INFINITE},
        {"span": [0, LARGE]},
        {"meshes": {"crease": LARGE}},
        {"tone": {"exposure": LARGE}},
        {"tone": {"white": -LARGE}},
        {"settings": {"zoom_factor": LARGE}},
        {"settings": {"lamp_radius": LARGE}},
        {"settings": {"certificate_memory": LARGE}},
        {"camera": {"position": [LARGE, 0, 0], "direction": [0, 0, 1]}},
        {"camera": {"position": [0, 0, 0], "direction": [0, 0, 1], "angle": LARGE}},
        {"edits": {"moved_lights": [[0, [LARGE, 0, 0]]]}},
        {"edits": {"static": [["train", LARGE]]}},
    ],
)
def test_a_state_with_a_number_beyond_all_bounds_is_one_line(wrong: dict[str, Any]) -> None:
    data = json.loads(json.dumps(state() | wrong))
    with pytest.raises(ValueError) as told:
        Snapshot.from_json(data)
    assert "\n" not in str(told.value) and len(str(told.value)) < 200


@pytest.mark.parametrize(
    "read",
    [
        lambda: Choices.from_json({"wipe": LARGE}),
        lambda: Choices.from_json({"light": INFINITE}),
        lambda: warmup_frames.from_json([[LARGE, None]]),
        lambda: Camera.from_json({"position": (0, 0, 0), "direction": (0, 0, LARGE)}),
        lambda: recipe.from_json(Snapshot.from_json(state()), None, {"style": {"shading": LARGE}}),
        lambda: recipe.from_json(Snapshot.from_json(state()), None, {"style": {"magnified": INFINITE}}),
        lambda: recipe.from_json(Snapshot.from_json(state()), None, {"style": {"legend": []}}),
        lambda: comparison.from_json(Snapshot.from_json(state()), None, {"crops": [[0, 0, INFINITE, 1]]}),
    ],
)
def test_so_is_whatever_else_is_saved(read: Callable[[], object]) -> None:
    with pytest.raises(ValueError) as told:
        read()
    assert "\n" not in str(told.value) and len(str(told.value)) < 200


@pytest.mark.parametrize(("name", "wrong"), [("tree", 1), ("speed", LARGE), ("font", LARGE), ("depth", INFINITE)])
def test_preferences_keep_their_defaults(name: str, wrong: Any) -> None:
    for default in (1.5, 2):
        assert checked(name, wrong, default) == (default if wrong != 1 else 1)
    assert checked("speed", 2, Preferences().speed) == 2.0
