"""Back to a frame that was traced; which frames set a mode, against a record kept mode by mode; frames a second."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tracer
from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.fakes import make_frame, make_scene
from tracer.culling import modes
from tracer.culling.modes import FULLY_RENDERED
from tracer.experiments import warmup_frames
from tracer.experiments.warmup_frames import WarmupFrame
from tracer.frame import Frame
from tracer.mode_origins import NEVER, ModeOrigins
from tracer.scene.edits import NO_EDITS, Edits
from tracer.scene.model import Camera
from viewer.services.history import FrameHistory
from viewer.services.render_request import RenderRequest, Traced
from viewer.state.session import Session
from viewer.state.views import View


def flown(desk: Desk, method: str) -> dict[int, Frame]:
    """Frames by their numbers: of the path, from elsewhere, and in another view, traced with a method."""
    c = desk.c
    c.settings.change(method=method, depth=3)
    desk.rest()
    c.reset_modes()
    desk.rest()
    seen = {c.history.frames - 1: c.frame}

    def here() -> None:
        desk.rest()
        seen[c.history.frames - 1] = c.frame

    for number in (2, 5, 11):
        c.session.go_to_frame(number)
        here()
    c.motion.move(ELSEWHERE)
    here()
    c.settings.change(depth=1)
    c.session.set_draw(view=View.DEPTH)
    here()
    c.session.go_to_frame(15)
    c.motion.follow_path(True)
    here()
    return {number: frame for number, frame in seen.items() if frame is not None}


@pytest.mark.parametrize("method", ["none", "certified"])
def test_an_exact_picture_comes_back_bit_for_bit(desk: Desk, method: str) -> None:
    seen, c = flown(desk, method), desk.c
    for number, frame in seen.items():
        moment = c.history.records.get(number)
        assert moment is not None and (moment.state.time, moment.camera) == (frame.time, frame.camera)
        c.navigator.go(number)
        of_path = c.session.frame_at(frame.time)
        assert desk.said == f"picture {number}, frame {of_path} of the path, again: the same picture, bit for bit"
        desk.rest()
        assert (c.session.time, c.session.camera) == (frame.time, frame.camera)
        assert (c.session.settings.method, c.session.settings.depth) == (method, frame.settings.depth)
        assert np.array_equal(c.frame.color.view(np.uint32), frame.color.view(np.uint32))
    assert {c.history.records.get(number).state.draw.view for number in seen} == {View.COLOR, View.DEPTH}


def test_the_modes_of_a_frame_that_depends_on_them_are_learnt_anew(desk: Desk) -> None:
    """Nothing that later frames have taught is in its picture."""
    seen, c = flown(desk, "paper"), desk.c
    number = list(seen)[1]
    c.navigator.go(number)
    assert desk.said.endswith("modes are learnt anew")
    desk.rest()
    learnt = {n for row in next(iter(c.history._origins.values()))._table[:, 1:].tolist() for n in row if n != NEVER}
    assert learnt and min(learnt) > max(seen)
    c.navigator.go(99_999)
    assert "no longer kept" in desk.said


def test_a_frozen_picture_knows_what_its_warmup_frames_teach_and_no_more(desk: Desk) -> None:
    """As a find of a hunt is looked at: with the modes of these frames, bit for bit, until something moves."""
    c = desk.c
    c.settings.change(method="paper", samples=4)
    desk.rest()
    scene, settings = c.session.scene, c.session.settings
    warmup = tuple((scene.frame_time(n), scene.camera_at(scene.frame_time(n))) for n in range(3))
    snapshot = replace(c.session.state, time=scene.frame_time(3))
    c.navigator.go_to(snapshot, "a find", (32, 24), warmup=warmup)
    desk.rest()
    own = tracer.Renderer(scene, replace(c.frame.settings, samples=1))
    for then, camera in (*warmup, (c.session.time, c.session.camera)):
        alone = own.render(then, camera)
    assert np.array_equal(c.frame.color.view(np.uint32), alone.color.view(np.uint32))
    assert np.array_equal(c.frame.modes, alone.modes) and settings.samples == 4 and c.frame.settings.samples == 1
    c.motion.move(ELSEWHERE)
    desk.rest()
    assert c.frame.settings.samples == 4, "having moved, it gets its samples"


def test_a_mode_names_the_frames_that_taught_it(desk: Desk) -> None:
    """Against the modes as each frame left them."""
    c, words = desk.c, {}
    c.settings.change(method="paper", depth=2)
    desk.rest()
    before = c.history.frames
    c.reset_modes()
    desk.rest()
    for number in (0, 4, 9):
        c.session.go_to_frame(number)
        desk.until(lambda number=number: c.frame is not None and c.frame.time == c.session.time)
        desk.rest()
    c.motion.move(ELSEWHERE)
    desk.rest()
    learnt = range(before, c.history.frames)
    assert len(learnt) >= 5
    words = {n: c.history.records.get(n) for n in learnt}
    assert all(words.values())
    c.selection.select((0.5, 0.75))
    picked = c.selection.picked
    assert picked is not None and picked.primitive >= 0
    taught = c.history.origins_of(c.frame, picked.primitive)
    assert taught is not None
    world = tracer.World(c.session.scene)
    again = tracer.Renderer(c.session.scene, replace(words[learnt[0]].settings, verify=False), world=world)
    first: dict[tuple[int, bool], int] = {}
    for n in learnt:
        moment = words[n]
        again.settings = moment.settings
        word = again.render(moment.state.time, moment.camera).modes[picked.primitive]
        for light in range(2):
            for lit, bit in ((False, modes.FULL_SHADOW), (True, modes.NON_SHADOW)):
                if int(modes.shadow_mode(word, light)) & bit:
                    first.setdefault((light, lit), n)
    assert first
    for light, lesson in enumerate(taught.lights):
        for lit, n in ((False, lesson.blocked), (True, lesson.lit)):
            assert first.get((light, lit), NEVER) == n


def test_a_frame_of_other_edits_comes_back_with_them(desk: Desk) -> None:
    """The picture, what is selected in it, and that nobody says who taught modes which an edit has left."""
    c = desk.c
    c.settings.change(method="none", depth=1)
    desk.rest()
    without_ball = NO_EDITS.with_primitive(c.selection.at((0.5, 0.45)).primitive, False)

    def edit(edits: Edits) -> None:
        c.editing.change(edits)
        desk.until(lambda: not c.editing.under_way)
        desk.rest()

    whole, number = c.frame.color.copy(), c.history.frames - 1
    edit(without_ball)
    hidden, other = c.frame.color.copy(), c.history.frames - 1
    assert not np.array_equal(whole, hidden)
    for to, picture, edits in ((number, whole, NO_EDITS), (other, hidden, without_ball)):
        record = c.history.records.get(to)
        c.navigator.go_to(record.state, "a picture", record.size, (0.5, 0.45))
        desk.until(lambda: not c.editing.under_way)
        desk.rest()
        assert np.array_equal(c.frame.color, picture) and c.session.edits == edits
        here = c.selection.at((0.5, 0.45))
        picked = c.selection.picked
        assert (picked is None) == (here.primitive < 0) == bool(edits)
        assert picked is None or (picked.primitive == here.primitive and picked.seen)


UNITS = 600


@pytest.mark.parametrize(("lights", "word"), [(3, np.uint32), (20, np.uint64)])
def test_the_first_frame_of_each_answer_is_known(lights: int, word: type) -> None:
    """Words drawn by lot, which gain and lose modes; and lights that move, so that what they had was forgotten."""
    lots, origins = np.random.default_rng(3), ModeOrigins(lights)
    first: dict[tuple[int, int], int] = {}  # by unit and bit
    whole: dict[int, int] = {}
    words = np.zeros(UNITS, word)
    for number in range(12):
        moved = lots.random(lights) < 0.2
        gained = lots.integers(0, 1 << 62, UNITS).astype(word) & lots.integers(0, 1 << 62, UNITS).astype(word)
        lost = np.where(lots.random(UNITS) < 0.1, lots.integers(0, 1 << 62, UNITS), 0).astype(word)
        gained &= word(4 ** (lights + 1) - 1)
        before, words = words, (words | np.where(lots.random(UNITS) < 0.3, gained, word(0))) & ~lost
        origins.add(number, words, moved)
        for unit in range(UNITS):
            for bit in range(2, 2 + 2 * lights):
                has, had = int(words[unit]) >> bit & 1, int(before[unit]) >> bit & 1 and not moved[(bit - 2) // 2]
                if has and not had:
                    first[unit, bit] = number
                elif not has:
                    first.pop((unit, bit), None)
            is_whole = int(words[unit]) & 3 == FULLY_RENDERED
            if is_whole and (int(before[unit]) & 3 != FULLY_RENDERED or moved.any()):
                whole[unit] = number
            elif not is_whole:
                whole.pop(unit, None)
    assert len(first) > UNITS and whole
    for unit in range(UNITS):
        known = origins.of(unit)
        for light in range(lights):
            expected = tuple(first.get((unit, 2 + 2 * light + bit), NEVER) for bit in (0, 1))
            assert expected == (NEVER, NEVER) if known is None else known.lights[light] == expected
        assert (NEVER if known is None else known.whole) == whole.get(unit, NEVER)


def test_memory_is_bounded() -> None:
    origins = ModeOrigins(3, most_bytes=100 * 4 * 7)
    origins.add(0, np.full(UNITS, 4, np.uint32))
    assert origins.full and origins.of(99) is not None and origins.of(100) is None
    origins.add(1, np.full(UNITS, 4 | 8, np.uint32))
    assert origins.of(7).lights[0] == (0, 1) and origins.of(-1) is None and origins.of(UNITS) is None


def test_frames_before_a_picture_are_json() -> None:
    frames = (WarmupFrame(0.1), WarmupFrame(1 / 3, Camera((1, 2, 3), (0, 0, -1), angle=33.0)))
    data = warmup_frames.to_json(frames)
    assert warmup_frames.from_json(data) == frames == warmup_frames.from_json({"before": data})
    for wrong in ("x", {}, [[1]], [["a", None]], [[float("nan"), None]], [[0.0, {"position": 1}]]):
        with pytest.raises(ValueError) as raised:
            warmup_frames.from_json(wrong)
        assert "\n" not in str(raised.value)


def took(history: FrameHistory, seconds: float = 0.0, parts: int = 1) -> None:
    """One frame is traced, in parts."""
    frame = make_frame(time=seconds)
    request = RenderRequest(frame.time, frame.camera, frame.settings)
    for _ in range(parts):
        history.take([], Traced(request, frame, frame.statistics), 0.01)


def test_so_many_frames_come_in_a_second_and_each_counts_once() -> None:
    now = 5.0
    history = FrameHistory(Session(make_scene()), clock=lambda: now)
    for apart, pause in ((0.04, 0.0), (0.1, 0.0), (4.0, 7.0)):
        for _ in range(40):
            now += apart
            took(history, now, parts=3)
        assert history.frames_per_second == pytest.approx(1.0 / apart), "what came long before does not count"
        now += pause
    assert history.frames == 120 and history.frames_per_second == pytest.approx(0.25)
    now += 2.0
    assert history.frames_per_second is None, "nothing comes any more"
    assert [history.records[number].number for number in (0, 119)] == [0, 119]
    history.clear()
    took(history)
    assert history.frames_per_second is None and list(history.records) == [0]


def test_the_oldest_records_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("viewer.services.history.MOST_RECORDS", 5)
    history = FrameHistory(Session(make_scene()))
    for number in range(8):
        took(history, float(number), parts=2)
    assert [(number, record.state.time) for number, record in history.records.items()] == [
        (number, float(number)) for number in range(3, 8)
    ]
