"""Pictures that are shaded in parts: what is shown before they are whole, and that they become what `render` makes."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

import tracer
from tests.sweeps import ACCELERATORS, cases
from tests.tracing.random_worlds import Walk, quickly, walks
from tests.tracing.worlds import quad, quadrics, scene
from tracer.geometry.accelerators import BVH8
from tracer.methods.adaptive_policy import AdaptivePolicy
from tracer.progressive import BEYOND, HALVES, LEVELS, Parts, after
from tracer.scene.model import SPHERE, Camera, Cancelled, Material, Texture
from tracer.shading.blocks import BAYER, EDGE, TURNS, all_blocks, lanes_of, make_planes, pixels_of
from tracer.shading.filling import nearest

SETTINGS = tracer.Settings(width=75, height=50, threads=2, verify=True, record_lights=True, record_work=True)
PIXELS = ("color", "depth", "primitive", "normal", "due", "lit", "reference", "wrong")
SAVED = ("saved", "cost")
ABOVE = Camera((0.0, 0.0, 30.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 40.0)


def assert_whole(frame: tracer.Frame, expected: tracer.Frame, where: str) -> None:
    """All is the same; but what reflected rays want to be certified is noted of some vectors of them, which are others
    where pixels are shaded in parts, and so certificates of later frames may be others, and what they save."""
    certified = frame.settings.method == "certified"
    for name in PIXELS + SAVED * (not certified):
        assert getattr(frame, name).tobytes() == getattr(expected, name).tobytes(), f"{name} {where}"
    assert frame.statistics.part == 1.0
    for name in ("modes", "pixel_count", "highest_count"):
        assert np.array_equal(getattr(frame, name), getattr(expected, name)), f"{name} {where}"
    shadow, other = frame.statistics.shadow, expected.statistics.shadow
    for name in ("due", "wrong", *(("culled", "dynamic_only") * (not certified))):
        assert getattr(shadow, name) == getattr(other, name), f"{name} {where}"


@pytest.mark.parametrize("accelerator", cases((BVH8,), ACCELERATORS))
@given(walk=walks())
@quickly(3)
def test_what_becomes_whole_is_what_is_rendered_at_once(accelerator: str, walk: Walk):
    """Bit for bit, all that a frame holds and learns, frame after frame, whichever parts come first."""
    for number, method in enumerate(("paper", "cells", "certified")):
        settings = replace(SETTINGS, method=method, modes=True, accelerator=accelerator)
        at_once, in_parts = tracer.Renderer(walk.scene, settings), tracer.Renderer(walk.scene, settings)
        for k, (time, camera) in enumerate(walk.frames[:3]):
            expected = at_once.render(time, camera)
            parts = ((4, 16), (1, 4, 8, 16), (16,), (0.5, 3, 16))[(number + k) % 4]
            frames = list(in_parts.refine(time, camera, parts=parts, focus=(0.7, 0.2)))
            for frame, part in zip(frames, parts, strict=True):
                most = min((2 if part == LEVELS[0] else 1 + BEYOND) * part / TURNS, 1.0)  # with what is untaught
                assert (1 - BEYOND) * part / TURNS - 0.01 < frame.statistics.part < most + 0.01
            assert_whole(frames[-1], expected, f"of {method}, frame {k}, in {parts}")
            for frame in frames[:-1]:
                for name in ("depth", "primitive", "normal"):
                    assert np.array_equal(getattr(frame, name), getattr(expected, name)), "surfaces are there at once"


@given(walk=walks())
@quickly(3)
def test_what_is_shaded_is_shown_as_it_is(walk: Walk):
    """Pixels of a part that have been shaded have their final colours; more of them in each part."""
    time, camera = walk.frames[0]
    *parts, whole = tracer.Renderer(walk.scene, replace(SETTINGS, method="none")).refine(time, camera)
    for frame in parts:
        same = (frame.color == whole.color).all(axis=-1)
        assert same.mean() >= frame.statistics.part - 0.02  # a picture's edge cuts blocks in two
        assert np.isfinite(frame.color).all()
        missed = frame.primitive < 0
        assert (frame.color[missed] == whole.color[missed]).all()


def test_a_picture_that_is_left_teaches_what_its_last_frame_shows():
    """However it is left: closed, or cancelled while the next part is shaded.  One that has shown nothing teaches
    nothing."""
    rng = np.random.default_rng(3)
    corners = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)) + list(rng.uniform(1, 5, (20, 3, 3)) - (3, 3, 0))
    world = scene(corners, lights=[(3, 4, 20), (-5, 2, 12)], camera=ABOVE)
    closed, cancelled = (tracer.Renderer(world, replace(SETTINGS, method="paper")) for _ in range(2))
    left, cancel = [], []
    for renderer, cancels in ((closed, False), (cancelled, True)):
        refining = renderer.refine(parts=(1, 8, 16), cancel=lambda: bool(cancel))
        next(refining)
        left.append(next(refining))
        if cancels:
            cancel.append("now")
            for refining_on in (refining, renderer.refine(parts=(4, 16), cancel=lambda: True)):
                with pytest.raises(Cancelled):
                    next(refining_on)
        else:
            refining.close()
        after = renderer.render()
        assert np.array_equal(after.modes_before, left[-1].modes)
        left.append(after)
    assert left[0].modes.any() and np.array_equal(left[0].modes, left[2].modes)
    assert_whole(left[1], left[3], "after both")
    assert left[1].statistics.shadow.culled > 0


def test_pictures_that_are_never_whole_teach_by_and_by_what_a_whole_one_does():
    """A still view of which each picture shades other pixels: after as many as shade them all, what was seen whole is
    FULLY_RENDERED, and culled as after one whole picture."""
    rng = np.random.default_rng(3)
    corners = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)) + list(rng.uniform(1, 5, (20, 3, 3)) - (3, 3, 0))
    world = scene(corners, lights=[(3, 4, 20), (-5, 2, 12)], camera=ABOVE)
    whole, left = (tracer.Renderer(world, replace(SETTINGS, method="paper")) for _ in range(2))
    expected = whole.render()
    for number in range(TURNS // 4):
        refining = left.refine(parts=(4, 16))
        frame = next(refining)
        refining.close()
        learnt_all = np.array_equal(frame.modes, expected.modes)
        assert learnt_all == (number == TURNS // 4 - 1)
    assert np.array_equal(frame.highest_count, expected.highest_count)


def test_consecutive_pictures_shade_other_pixels_first():
    world = scene(quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), lights=[(3, 4, 20)], camera=ABOVE)
    renderer = tracer.Renderer(world, replace(SETTINGS, method="none"))
    shaded = np.zeros((50, 75), int)
    for _ in range(TURNS // 4):
        refining = renderer.refine(parts=(4, 16))
        shaded += next(refining).due[..., 0]
        refining.close()
    seen = renderer.render().due[..., 0]
    assert (shaded[seen] == 1).all(), "each pixel once in four pictures"


def test_samples_follow_and_are_those_of_a_picture_with_so_many():
    ball = quadrics([(SPHERE, np.hstack([np.eye(3), [[0], [0], [2]]]), (1, 1))])
    world = scene(quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), ball, lights=[(3, 4, 20)], camera=ABOVE)
    for method in ("none", "paper"):
        settings = replace(SETTINGS, method=method)
        refined, rendered = tracer.Renderer(world, settings), tracer.Renderer(world, settings)
        for _ in range(2):
            frames = list(refined.refine(parts=(4, 16), samples=5))
            rendered.settings = replace(settings, samples=5)
            expected = rendered.render()
            assert [frame.settings.samples for frame in frames] == [1, 1, 2, 3, 4, 5]
            assert_whole(frames[-1], expected, f"of {method} with 5 samples")
            assert frames[1].color.tobytes() != frames[2].color.tobytes()


def test_light_is_filled_in_from_the_same_surface_alone():
    """Two squares side by side, one lit and one turned away from the light: their border stays sharp, and the textures
    of neither matter, as all of either is known from one of its pixels."""
    lit, dark = quad((-9, -9, 0), (0, -9, 0), (0, 9, 0), (-9, 9, 0)), quad((0, -9, 0), (9, -9, 0), (9, 9, 0), (0, 9, 0))
    roof = quad((0, -9, 1), (9, -9, 1), (9, 9, 1), (0, 9, 1))  # over the second, seen from below by the light alone
    materials = (Material("white", diffuse=(1.0, 1.0, 1.0)), Material("red", diffuse=(1.0, 0.1, 0.1)))
    world = scene(lit + dark + roof, lights=[(-4, 0, 30)], camera=ABOVE, materials=materials)
    world.objects[0].triangles.material[4:] = 1
    renderer = tracer.Renderer(world, replace(SETTINGS, method="none", width=128, height=128))
    first, whole = renderer.refine(parts=(1, 16))
    assert np.abs(first.color - whole.color)[whole.primitive >= 0].max() < 1e-4


def test_turns_lie_evenly():
    assert sorted(BAYER.reshape(-1)) == list(range(TURNS))
    for count in (1, 2, 4, 8):
        for first in range(0, TURNS, count):
            ys, xs = np.nonzero(pixels_of(all_blocks(16, 16, lanes_of(first, count)), 16, 16))
            apart = min(max(abs(a - c), abs(b - d)) for a, b in zip(ys, xs) for c, d in zip(ys, xs) if (a, b) != (c, d))
            assert apart == {1: 4, 2: 2, 4: 2, 8: 1}[count]


@pytest.mark.parametrize("level", LEVELS)
def test_each_pixel_comes_first_as_often_as_the_others(level: float):
    width, height, turn, seen = 24, 16, 5, np.zeros((16, 24), int)
    rounds = HALVES // int(2 * level)
    for _ in range(rounds):
        turn = after(turn, level)
        lanes = next(Parts(width, height, make_planes(width, height), 0.01, turn).left_up_to(level, lambda: None))
        seen += pixels_of(lanes, width, height)
    assert (seen == 1).all()


def test_what_is_left_over_goes_where_it_is_in_doubt():
    """A shadow's border is shaded whole before what is lit or dark all around; in the end nothing is left."""
    post = quad((-1, -1, 4), (1, -1, 4), (1, 1, 4), (-1, 1, 4))
    floor = quad((-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0))
    world = scene(floor + post, lights=[(12, 3, 20)], camera=ABOVE)
    renderer = tracer.Renderer(world, replace(SETTINGS, method="none", width=128, height=128))
    refining = renderer.refine(parts=(5, 16))
    shaded = next(refining).due[..., 0].copy()
    whole = next(refining)
    lit = whole.lit[..., 0] & (whole.primitive >= 0)
    border = np.zeros_like(lit)
    border[1:-1, 1:-1] = (lit[1:-1, 1:-1] != lit[:-2, 1:-1]) | (lit[1:-1, 1:-1] != lit[1:-1, :-2])
    border &= (whole.primitive < 2) & (whole.primitive >= 0)
    assert shaded[border].mean() > 0.9 > 0.35 > shaded[whole.primitive >= 0].mean()


def test_what_is_recorded_stretches_to_the_nearest():
    for height, width in ((9, 10), (8, 12), (5, 4)):
        numbers = np.arange(height * width).reshape(height, width)
        found = numbers[np.ix_(nearest(height, 0), nearest(width, 0))]
        assert ((found // width % 4 == 0) & (found % width % 4 == 0)).all(), "all are of pixels that are known"
        assert found[0, 0] == 0 and found[4, 3] == 4 * width
        assert nearest(height, 3).tolist() == [min(i // 4 * 4 + 3, (height - 4) // 4 * 4 + 3) for i in range(height)]
        parts = Parts(width, height, make_planes(width, height), 0.01)
        for part in (1, TURNS):
            for _ in parts.left_up_to(part, lambda: None):
                assert (parts.sources() == (found if part == 1 else numbers)).all()
    assert parts.share == 1.0 and (parts.shaded[EDGE:-EDGE, EDGE:-EDGE] == 0xFFFF).all()


@pytest.mark.parametrize("first", [0, 1, 7, 30])
def test_of_a_half_of_the_blocks_what_is_recorded_reaches_the_others(first: int):
    parts = Parts(37, 22, make_planes(37, 22), 0.01, first)
    lanes = next(parts.left_up_to(0.5, lambda: None))
    known = pixels_of(lanes, 37, 22)
    assert 0.02 < known.mean() < 0.045
    assert known.reshape(-1)[parts.sources()[:20, :36]].all(), "of whole blocks"


def test_a_part_between_two_levels_has_as_many_pixels_as_it_says():
    for part in (0.75, 1.5, 3.0, 9.0):
        parts = Parts(80, 64, make_planes(80, 64), 0.01)
        for _ in parts.left_up_to(part, lambda: None):
            pass
        assert parts.share == pytest.approx(part / TURNS, abs=0.003)


def test_what_is_black_says_nothing_of_the_light_around_it():
    """A checkered floor in deep shadow: black texels would call themselves lit, as none of their light is missing."""
    floor = quad((-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0))
    roof = quad((-40, -40, 9), (40, -40, 9), (40, 40, 9), (-40, 40, 9))
    pixels = np.zeros((64, 64, 3), np.uint8)
    pixels[(np.indices((64, 64)).sum(axis=0) // 2) % 2 == 0] = 255
    camera = Camera((0.0, 0.0, 8.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0), 60.0)
    white = Material("white", ambient=(0.1, 0.1, 0.1), diffuse=(1.0, 1.0, 1.0))
    world = scene(
        floor + roof, lights=[(4, 3, 30)], camera=camera, materials=(white,), textures=(Texture("checks", pixels),)
    )
    world.objects[0].triangles.texture[:2] = 0
    world.objects[0].triangles.uvs[:2] = world.objects[0].triangles.corners[:2, :, :2] / 8.0
    first, whole = tracer.Renderer(world, replace(SETTINGS, method="none", width=96, height=96)).refine(parts=(1, 16))
    assert whole.color.max() > 0.05 and np.abs(first.color - whole.color).max() < 1e-3


@pytest.mark.parametrize("parts", [(), (0, 16), (0.4, 16), (4, 4, 16), (4, 8), (16, 4)])
def test_parts_must_increase_to_the_whole(parts: tuple[int, ...]):
    renderer = tracer.Renderer(scene(quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), camera=ABOVE), SETTINGS)
    with pytest.raises(ValueError, match="parts increase"):
        next(renderer.refine(parts=parts))


def test_what_is_cancelled_in_a_further_sample_teaches_nothing():
    rng = np.random.default_rng(3)
    corners = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)) + list(rng.uniform(1, 5, (20, 3, 3)) - (3, 3, 0))
    world = scene(corners, lights=[(3, 4, 20), (-5, 2, 12)], camera=ABOVE)
    settings = replace(SETTINGS, method="paper", threads=1)
    straight, left = tracer.Renderer(world, settings), tracer.Renderer(world, settings)
    for stop in (3, 4):
        asked = Counter()  # how often it was asked whether to go on, in further samples

        def cancel(asked: Counter = asked, stop: int = stop) -> bool:
            asked["now"] += asked["sampling"]
            return asked["now"] > stop

        refining = left.refine(cancel=cancel, parts=(16,), samples=9)
        assert_whole(next(refining), straight.render(), "before")
        asked["sampling"] = 1
        with pytest.raises(Cancelled):
            list(refining)
        near = replace(ABOVE, position=(0.0, 1.0, 20.0))
        assert_whole(list(left.refine(0.0, near))[-1], straight.render(0.0, near), "after a sample was cut short")


def test_what_decides_about_certificates_hears_of_each_picture_once(monkeypatch):
    world = scene(quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)), lights=[(3, 4, 20)], camera=ABOVE)
    renderer = tracer.Renderer(world, replace(SETTINGS, method="auto", verify=False, record_work=False))
    told: list[float] = []
    monkeypatch.setattr(AdaptivePolicy, "finish", lambda self, seconds, *rest, **more: told.append(seconds))
    list(renderer.refine(parts=(4, 16), samples=3))
    assert len(told) == 1
    left = renderer.refine(parts=(4, 16))
    next(left)
    left.close()
    assert len(told) == 2
