"""States as JSON and back, and what is said of those that are damaged."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from tracer.editing.edits import Edits
from tracer.scene.camera import Camera
from viewer.output.capture import carried_from_json
from viewer.state import codec
from viewer.state.draw_options import Curve, DrawOptions, Slice, Tone
from viewer.state.view_state import ViewState, Warmup, WarmupFrame
from viewer.state.views import View

CAMERA = Camera((0.0, 1.0, 3.0), (0.0, 0.0, -1.0), angle=40.0)
FULL = ViewState(
    scene="/scenes/hall.aff",
    time=2.5,
    camera=CAMERA,
    edits=Edits(frozenset({3, 1}), ((2, (1.0, 2.0, 3.0)),), hidden=frozenset({"chair"}), static=(("cube", 0.5),)),
    draw=DrawOptions(
        view=View.DEPTH, light=2, tone=Tone(1.5, 2.0, Curve.FILMIC), outlines=True, spans=((View.DEPTH, (1.0, 9.0)),),
        slice=Slice(0, 0.5), legend=True, legend_at=(0.25, 0.75),
    ),
    warmup=Warmup((WarmupFrame(0.5), WarmupFrame(1.0, CAMERA)), repeats=2),
).with_settings(method="paper+cache", lamp_radius=0.25, depth=3)  # fmt: skip


def test_a_state_survives_json() -> None:
    stored = json.loads(json.dumps(codec.state_to_json(FULL)))
    assert codec.state_from_json(stored) == FULL
    of_picture = codec.state_to_json(FULL.with_settings(accelerator="kdtree", width=80, height=60), of_picture=True)
    found = codec.state_from_json(of_picture)
    assert (found.settings.accelerator, found.settings.width, found.draw) == ("kdtree", 80, FULL.draw)


def test_what_belongs_to_the_machine_is_not_stored_and_not_taken() -> None:
    stored = codec.state_to_json(FULL.with_settings(threads=3, width=80, record_lights=True))
    assert not {"threads", "width", "record_lights"} & stored["settings"].keys()
    stored["settings"]["record_lights"] = True
    assert not codec.state_from_json(stored).settings.record_lights


def test_a_part_of_a_state_changes_only_what_it_says() -> None:
    part = {"settings": {"depth": 5}, "draw": {"tone": {"exposure": -1.0}}, "of a newer version": 1}
    found = codec.state_from_json(part, FULL)
    tone = replace(FULL.draw.tone, exposure=-1.0)
    assert found == FULL.with_settings(depth=5).with_draw(tone=tone)


def test_states_of_version_0_2_are_read() -> None:
    old = {
        "scene": "/scenes/hall.aff", "time": 2.0, "camera": CAMERA.to_json(), "follow": True,
        "settings": {"method": "certified", "depth": 4}, "view": "saved", "light": 1, "wipe": 0.25,
        "tone": {"exposure": 1.0, "white": 1.0, "curve": "srgb"}, "span": [0.0, 8.0],
        "meshes": {"studio": True, "up": "z", "crease": None}, "edits": {"lights_off": [1]}, "slice": [2, 0.5],
    }  # fmt: skip
    picture = {
        "accelerator": "kdtree", "threads": 0, "warmup": 3, "repeats": 1, "history": "", "by_gpu": False,
        "style": {"shares": False, "marked": False, "outlines": True, "legend": [0.5, 1.0], "annotations": [{}]},
        "before": [[0.5, None], [1.0, CAMERA.to_json()]],
    }  # fmt: skip
    found = carried_from_json({"format": 1, "state": old, "picture": picture, "size": [64, 48]}).view_state()
    assert (found.scene, found.time, found.camera) == ("/scenes/hall.aff", 2.0, None)
    assert found.settings.method == "certified" and found.settings.accelerator == "kdtree"
    assert (found.settings.width, found.settings.height) == (64, 48)
    draw = found.draw
    assert (draw.view, draw.light, draw.wipe, draw.span) == (View.SAVED, 1, 0.25, (0.0, 8.0))
    assert draw.tone == Tone(1.0, 1.0, Curve.SRGB) and draw.slice == Slice(2, 0.5)
    assert draw.outlines and not draw.mark_wrong and draw.legend and draw.legend_at == (0.5, 1.0)
    assert found.meshes.studio and found.meshes.up == "z" and found.edits.lights_off == {1}
    assert found.warmup == Warmup((WarmupFrame(0.5), WarmupFrame(1.0, CAMERA)), of_path=3, repeats=1)
    assert codec.state_from_json(old | {"follow": False}).camera == CAMERA


@pytest.mark.parametrize(
    ("damaged", "said"),
    [
        (3, "no saved state in it"),
        ({"view": "color"}, "its saved state lacks 'camera'"),
        ({"draw": {"outlines": 3}}, "its saved state is damaged: draw.outlines: expected true or false, got"),
        ({"draw": {"legend_at": [1, 2]}}, "the legend lies outside the picture"),
        ({"draw": {"view": "none such"}}, "its saved state is damaged: draw.view: there is no 'none such'"),
        ({"draw": {"spans": [["depth", [2, 1]]]}}, "the range of a view is empty"),
        ({"draw": {"slice": [5, 0.5]}}, "the slice lies nowhere"),
        ({"draw": {"tone": {"exposure": 99}}}, "exposure is a number from -16 to 16, not 99"),
        ({"settings": {"depth": -3}}, "depth is a whole number from 0 to 100, not -3"),
        ({"settings": {"depth": 10**400}}, "depth is a whole number from 0 to 100, not so large a number"),
        ({"settings": {"zoom_factor": 10**400}}, "its saved state is damaged: "),
        ({"time": float("nan")}, "the time is not a finite number"),
        ({"edits": []}, "its saved state is damaged: edits: expected a table, got a list"),
        ({"edits": {"moved_lights": [[0, [1e300, 0, 0]]]}}, "the edits of the scene are out of range"),
        ({"edits": {"lights_off": [-1]}}, "the edits of the scene are out of range"),
        ({"camera": {"position": [1, 2, 3], "direction": [0, 0, 0]}}, "a camera's angle lies between 0 and 180"),
        ({"warmup": {"repeats": 10**9}}, "a picture has 0 to 100,000 frames before it"),
    ],
)  # fmt: skip
def test_damage_is_said_in_one_line(damaged: object, said: str) -> None:
    with pytest.raises(ValueError) as error:
        codec.state_from_json(damaged)
    assert str(error.value).startswith(said) and "\n" not in str(error.value)
