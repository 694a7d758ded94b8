"""The zoom test: where it goes, what it records, and that it shows the paper's Figure 4."""

from __future__ import annotations

import json
import math
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tracer
from tests.scenes import loaded
from tests.sweeps import crossed
from tests.tracing.worlds import affine, moved, quad, quadrics, scene
from tracer.experiments import zoom
from tracer.experiments.zoom import Change
from tracer.scene.model import SPHERE, Camera

FIGURE_4 = Path(__file__).resolve().parents[2] / "assets" / "scenes" / "figure4.aff"
SETTINGS = tracer.Settings(width=128, height=128, threads=1)
CARD = [[(1.0, 0.5, 0.0), (3.0, 0.5, 0.0), (2.0, 2.5, 0.0)]]
SCREEN = quad((-4, 1.2, 1), (4, 1.2, 1), (4, 4, 1), (-4, 4, 1))


def picture(world: tracer.Scene, **settings) -> tracer.Frame:
    return tracer.Renderer(world, replace(SETTINGS, method="none", **settings)).render()


def run(world: tracer.Scene, primitive: int, settings: tracer.Settings = SETTINGS, **options) -> zoom.Results:
    *_, results = zoom.run(world, settings, zoom.aim(picture(world), primitive), **options)
    return results


@pytest.fixture(scope="module")
def figure4() -> zoom.Results:
    return run(loaded(FIGURE_4), 0, factors=[4.0, 64.0], steps=20)


def test_figure_4_is_mended_by_examining_anew(figure4: zoom.Results):
    """The shadow is missing until the primitive has grown past the factor, and is there from the next frame on."""
    four, sixty_four = figure4.approaches
    (anew,) = four.examined_anew
    before, at = four.steps[anew - 1], four.steps[anew]
    assert before.highest == four.steps[0].pixels
    assert before.pixels <= 4 * before.highest < at.pixels == at.highest
    assert four.wrong_steps, "nothing was wrong: this shows nothing"
    assert max(four.wrong_steps) == anew
    assert Change(0, "NON_SHADOW", "PARTIAL_SHADOW") in four.steps[anew + 1].changes
    assert all(step.wrong == 0 for step in four.steps[anew + 1 :])

    assert sixty_four.examined_anew == []
    assert sixty_four.wrong_steps == list(range(min(four.wrong_steps), len(sixty_four.steps)))
    assert {step.shadows[0] for step in sixty_four.steps} == {"NON_SHADOW"}
    assert four.most_wrong < sixty_four.most_wrong


def test_a_step_records_what_the_frame_says(figure4: zoom.Results):
    """Against frames traced here, by hand, along the same way."""
    world = loaded(FIGURE_4)
    renderer = tracer.Renderer(world, replace(SETTINGS, verify=True))
    for step in figure4.approaches[0].steps:
        frame = renderer.render(camera=step.camera)
        assert (step.pixels, step.highest) == (frame.pixel_count[0], frame.highest_count[0])
        assert step.pixels == np.count_nonzero(frame.primitive == 0)
        assert step.occlusion == ("INIT", "PARTIALLY_OCCLUDED", "FULLY_RENDERED", "DYNAMIC")[frame.modes[0] & 3]
        counts = frame.statistics.shadow
        assert (step.due, step.culled, step.dynamic_only) == (counts.due, counts.culled, counts.dynamic_only)
        assert step.wrong == np.count_nonzero((frame.color != frame.reference).any(2))
        assert step.wrong == step.wrong_of_primitive


def test_the_camera_comes_nearer_by_the_same_part_and_looks_at_the_target(figure4: zoom.Results):
    steps = figure4.approaches[0].steps
    assert len(steps) == zoom.STILL_FRAMES + 20
    distances = np.array([step.distance for step in steps])
    assert distances[: zoom.STILL_FRAMES] == pytest.approx(20.0, rel=1e-6)
    assert distances[zoom.STILL_FRAMES :] / distances[zoom.STILL_FRAMES - 1 : -1] == pytest.approx(0.94)
    for step in steps:
        at = np.asarray(step.camera.position) + step.distance * step.camera.basis()[2]
        assert at == pytest.approx(np.asarray(figure4.target), abs=1e-9)


def test_first_changes_are_those_from_nothing_known(figure4: zoom.Results):
    assert figure4.approaches[0].steps[0].changes == [
        Change(None, "INIT", "FULLY_RENDERED"),
        Change(0, "INIT", "NON_SHADOW"),
    ]
    assert figure4.approaches[0].steps[1].changes == []


def test_a_camera_turns_to_the_middle_of_what_is_to_be_seen():
    """Of a card whose upper part is behind a screen, that is a point of its lower part."""
    world = scene([*CARD, *SCREEN], lights=[(0, 0, 20)])
    frame = picture(world)
    aim = zoom.aim(frame, 0)
    assert aim.camera.position == frame.camera.position
    ahead = np.asarray(aim.camera.position) + aim.distance * aim.camera.basis()[2]
    assert ahead == pytest.approx(np.asarray(aim.target))
    x, y, z = aim.target
    assert (x, z) == pytest.approx((2.0, 0.0), abs=0.1)
    assert 0.5 < y < 1.2 * 10 / 9
    turned = tracer.Renderer(world, SETTINGS).render(camera=aim.camera)
    assert turned.primitive[64, 64] == 0
    assert turned.depth[64, 64] == pytest.approx(aim.distance, rel=1e-2)


def test_a_camera_that_looks_at_it_goes_straight_on():
    world = scene(quad((-1, -2, 0), (3, -2, 0), (3, 2, 0), (-1, 2, 0)), lights=[(0, 0, 20)])
    frame = picture(world)
    aim = zoom.aim(frame, int(frame.primitive[64, 64]))
    assert aim.camera == frame.camera
    assert aim.target == pytest.approx((0.0, 0.0, 0.0), abs=1e-5)


def test_a_camera_whose_axis_may_pass_beside_it_turns():
    """The middle pixel shows it, but not those on the axis's other side."""
    world = scene([[(0.01, -2.0, 0.0), (3.0, -2.0, 0.0), (0.01, 2.0, 0.0)]], lights=[(0, 0, 20)])
    frame = picture(world)
    assert frame.primitive[64, 64] == 0
    x, y, _ = zoom.aim(frame, 0).target
    assert 0.5 < x < 1.5 and -1.0 < y < 0.0


SLANTED = {"static": [[(-8, -4, 8), (8, -4, -8), (0, 8, 0)]]}
SPHERE = {"static_quadrics": quadrics([(SPHERE, affine(0.5, (-0.2, 0.1, 0.0)), (1.0, 1.0))])}


@pytest.mark.parametrize(("shape", "size"), crossed([SLANTED, SPHERE], [127, 128]))
def test_a_slanted_surface_is_seen_to_the_end(shape: dict, size: int):
    """So near, the camera would have passed a surface of which it had aimed half a pixel off."""
    world = scene(**shape, lights=[(0, 5, 20)])
    frame = picture(world, width=size, height=size)
    primitive = int(frame.primitive[size // 2, size // 2])
    start = zoom.aim(frame, primitive)
    assert start.camera == frame.camera
    *_, results = zoom.run(world, replace(SETTINGS, width=size, height=size), start, [4.0], steps=110)
    steps = results.approaches[0].steps
    assert len(steps) == zoom.STILL_FRAMES + 110
    assert min(step.pixels for step in steps) == steps[0].pixels


@pytest.mark.parametrize("primitive", [-1, 1])
def test_a_primitive_that_is_not_there_is_refused(primitive: int):
    world = scene(CARD, lights=[(0, 0, 20)])
    start = replace(zoom.aim(picture(world), 0), primitive=primitive)
    with pytest.raises(ValueError, match=f"there is no primitive {primitive}; the scene's are 0 to 0"):
        next(zoom.run(world, SETTINGS, start))


def test_what_is_not_to_be_seen_is_refused():
    behind = scene([*CARD, *quad((-9, -9, 5), (9, -9, 5), (9, 9, 5), (-9, 9, 5))])
    for primitive in (0, 99, -1):
        with pytest.raises(ValueError, match=f"primitive {primitive} is not to be seen"):
            zoom.aim(picture(behind), primitive)


def test_pixels_name_primitives():
    frame = picture(scene(CARD))
    rows, columns = np.nonzero(frame.primitive == 0)
    assert zoom.primitive_at(frame, int(columns[0]), int(rows[0])) == 0
    with pytest.raises(ValueError, match="pixel 0,0 shows no primitive"):
        zoom.primitive_at(frame, 0, 0)
    for x, y in ((128, 0), (0, 128), (-1, 0)):
        with pytest.raises(ValueError, match="128 × 128 pixels"):
            zoom.primitive_at(frame, x, y)


def test_what_moves_is_refused():
    world = scene(dynamic=(moved("kite", CARD, np.eye(4)),), lights=[(0, 0, 20)])
    with pytest.raises(ValueError, match="moves"):
        run(world, 0)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"ratio": 1.0}, "between 0 and 1"),
        ({"ratio": 0.0}, "between 0 and 1"),
        ({"steps": 0}, "at least one step"),
        ({"ratio": 0.5, "steps": 20}, "go fewer"),
        ({"factors": [0.5]}, "zoom_factor"),
    ],
)
def test_numbers_out_of_range_are_refused(options: dict, said: str):
    with pytest.raises(ValueError, match=said):
        run(scene(CARD), 0, **options)


def test_stopping_keeps_whole_steps_and_frames_are_shown():
    world, stop, shown = scene(CARD, lights=[(0, 0, 20)]), threading.Event(), []
    options = {"factors": [4.0, 9.0], "steps": 4, "cancel": stop.is_set}
    start = zoom.aim(picture(world), 0)
    for results in zoom.run(world, SETTINGS, start, on_frame=lambda f, n, frame: shown.append((f, n)), **options):
        if len(results.approaches) == 2 and len(results.approaches[1].steps) == 2:
            stop.set()
    assert [len(approach.steps) for approach in results.approaches] == [7, 2]
    assert shown == [(4.0, n) for n in range(7)] + [(9.0, 0), (9.0, 1)]


def test_modes_start_afresh_for_each_factor():
    results = run(loaded(FIGURE_4), 0, factors=[4.0, 4.0], steps=18)
    assert results.approaches[0].steps == results.approaches[1].steps


def test_a_world_may_be_shared_with_lights_beyond_those_culled():
    world = scene(CARD, lights=[(math.cos(i), math.sin(i), 20) for i in range(33)])
    start = zoom.aim(picture(world), 0)
    *_, results = zoom.run(world, SETTINGS, start, [4.0], steps=1, world=tracer.World(world))
    assert results.approaches[0].steps[0].shadows[31:] == [None, None]
    assert results.approaches[0].steps[0].shadows[0] == "NON_SHADOW"


def test_results_are_plain_json(figure4: zoom.Results):
    again = json.loads(json.dumps(figure4.to_dict()))
    lamps = {"lamp_radius", "lamp_samples"}
    assert set(again) == {"scene", "size", "primitive", "time", "target", "ratio", "still_frames", "approaches"} | lamps
    step = again["approaches"][0]["steps"][0]
    assert step["changes"][0] == {"light": None, "before": "INIT", "after": "FULLY_RENDERED"}
    assert Camera.from_json(step["camera"]).position == pytest.approx((0, 0, 20))
