"""Back to a frame that was traced; which frames set a mode, against a record kept mode by mode; frames a second."""

from __future__ import annotations

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.fakes import Clock, make_frame, make_scene
from tracer.culling import modes
from tracer.editing.edits import NO_EDITS
from tracer.frame import Frame
from tracer.inspect.mode_origins import NEVER
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
        assert c.history.records[number].state.time == frame.time
        c.navigator.go(number)
        of_path = c.session.frame_at(frame.time)
        assert desk.said == f"picture {number}, frame {of_path} of the path, again: the same picture, bit for bit"
        desk.rest()
        assert (c.session.time, c.session.camera) == (frame.time, frame.camera)
        assert (c.session.settings.method, c.session.settings.depth) == (method, frame.settings.depth)
        assert np.array_equal(c.frame.color.view(np.uint32), frame.color.view(np.uint32))
    assert {c.history.records[number].state.draw.view for number in seen} == {View.COLOR, View.DEPTH}


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


def test_a_mode_names_the_frames_that_taught_it(desk: Desk) -> None:
    """Against the modes as each frame left them."""
    c = desk.c
    c.settings.change(method="paper", depth=2)
    desk.rest()
    before = c.history.frames
    desk.came.clear()
    c.reset_modes()
    desk.rest()
    for number in (0, 4, 9):
        c.session.go_to_frame(number)
        desk.rest()
    c.motion.move(ELSEWHERE)
    desk.rest()
    assert len(desk.came) == c.history.frames - before >= 5
    c.selection.select((0.5, 0.75))
    primitive = c.selection.picked.primitive
    taught = c.history.origins_of(c.frame, primitive, wait=True)
    first: dict[tuple[int, bool], int] = {}
    for number, frame in enumerate(desk.came, before):
        for light in range(2):
            for lit, bit in ((False, modes.FULL_SHADOW), (True, modes.NON_SHADOW)):
                if int(modes.shadow_mode(frame.modes[primitive], light)) & bit:
                    first.setdefault((light, lit), number)
    assert first
    for light, lesson in enumerate(taught.lights):
        for lit, number in ((False, lesson.blocked), (True, lesson.lit)):
            assert first.get((light, lit), NEVER) == number


def test_a_frame_of_other_edits_comes_back_with_them(desk: Desk) -> None:
    """The picture, what is selected in it, and that nobody says who taught modes which an edit has left."""
    c = desk.c
    c.settings.change(method="none", depth=1)
    desk.rest()
    without_ball = NO_EDITS.with_primitive(c.selection.at((0.5, 0.45)).primitive, False)

    whole, number = c.frame.color.copy(), c.history.frames - 1
    desk.edit(without_ball)
    hidden, other = c.frame.color.copy(), c.history.frames - 1
    assert not np.array_equal(whole, hidden)
    for to, picture, edits in ((number, whole, NO_EDITS), (other, hidden, without_ball)):
        record = c.history.records[to]
        c.navigator.go_to(record.state, "a picture", (0.5, 0.45))
        desk.rest()
        assert np.array_equal(c.frame.color, picture) and c.session.edits == edits
        here = c.selection.at((0.5, 0.45))
        picked = c.selection.picked
        assert (picked is None) == (here.primitive < 0) == bool(edits)
        assert picked is None or (picked.primitive == here.primitive and picked.seen)


def took(history: FrameHistory, seconds: float = 0.0, parts: tuple[float, ...] = (1.0,), **shadow: int) -> None:
    """One frame is traced, in parts of its pixels, of which each has so many shadow rays of some fates."""
    frame = make_frame(time=seconds)
    request = RenderRequest(frame.time, frame.camera, frame.settings)
    s, pixels = frame.statistics, frame.primitive.size
    for part in parts:
        s.part, s.primary.traversal_steps, s.certificate_steps = part, 30 * pixels, 2 * pixels
        for name, each in shadow.items():
            setattr(s.shadow, name, round(each * part * pixels))
        history.take([], Traced(request, frame, s), 0.01)


def test_so_many_frames_come_in_a_second_and_each_counts_once(clock: Clock) -> None:
    history = FrameHistory(Session(make_scene()))
    for apart, pause in ((0.04, 0.0), (0.1, 0.0), (4.0, 7.0)):
        for _ in range(40):
            clock.now += apart
            took(history, clock.now, (0.2, 0.5, 1.0))
        assert history.frames_per_second == pytest.approx(1.0 / apart), "what came long before does not count"
        clock.now += pause
    assert history.frames == 120 and history.frames_per_second == pytest.approx(0.25)
    clock.now += 2.0
    assert history.frames_per_second is None, "nothing comes any more"
    history.clear()
    took(history)
    assert history.frames_per_second is None and list(history.records) == [0]


def test_the_newest_frames_are_kept_and_plotted_in_order(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("viewer.services.history.KEPT_FRAMES", 5)
    monkeypatch.setattr("viewer.services.history.PLOTTED_FRAMES", 3)
    history = FrameHistory(Session(make_scene()))
    for number in range(8):
        took(history, float(number), (0.5, 1.0), due=number)
        assert [record.state.time for record in history.records.values()] == list(range(max(number - 4, 0), number + 1))
        due = history.per_pixel("due")
        assert list(due) == list(range(history.first, number + 1)) and len(history) == min(number + 1, 3)
        assert due.flags.c_contiguous and due.dtype == np.float64
    history.clear_plots()
    assert len(history) == 0 and len(history.values("due")) == 0 and len(history.records) == 5
    took(history)
    assert (history.first, history.frames, len(history)) == (8, 9, 1)


def test_a_picture_that_is_shaded_in_part_counts_for_each_pixel_as_a_whole_one() -> None:
    """Primary rays and proofs are of all pixels, all else is of those that are shaded; fates add up to the rays due."""
    history = FrameHistory(Session(make_scene()))
    fates = {"culled": 40, "candidates_only": 25, "dynamic_only": 20, "cache_hits": 10}
    for part in (0.25, 1.0):
        took(history, parts=(part,), due=100, traversal_steps=40, **fates)
    each = {"due": 100, "steps": 72, "shadow_steps": 42, "traced": 5, **fates}
    assert {name: list(history.per_pixel(name)) for name in each} == {name: [n, n] for name, n in each.items()}
    steps, pixels = history.values("shadow_steps"), make_frame().primitive.size
    assert list(steps) == [12 * pixels, 42 * pixels], "the work that was done"
