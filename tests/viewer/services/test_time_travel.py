"""Back to a frame that was traced: the same picture, and if asked for, the same modes; and who taught a mode."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.viewer.desk import ELSEWHERE, Desk
from tracer.culling import modes
from tracer.frame import Frame
from tracer.mode_origins import NEVER
from tracer.scene.edits import NO_EDITS, Edits
from viewer.state.views import View


def flown(desk: Desk, method: str) -> dict[int, Frame]:
    """Frames by their numbers: of the path, from elsewhere, and in another view, traced with a method."""
    c = desk.c
    c.settings.change(method=method, depth=3)
    desk.rest()
    c.tracing.reset_modes()
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
    c.settings.set_view(View.DEPTH)
    here()
    c.session.go_to_frame(15)
    c.motion.follow_path(True)
    here()
    return {number: frame for number, frame in seen.items() if frame is not None}


@pytest.mark.parametrize("method", ["none", "certified"])
def test_an_exact_picture_comes_back_bit_for_bit(desk: Desk, method: str) -> None:
    seen, c = flown(desk, method), desk.c
    for number, frame in seen.items():
        moment = c.record.moments.get(number)
        assert moment is not None and (moment.time, moment.camera) == (frame.time, frame.camera)
        c.travel.go(number)
        of_path = c.session.frame_at(frame.time)
        assert desk.said == f"picture {number}, frame {of_path} of the path, again: the same picture, bit for bit"
        desk.rest()
        assert (c.session.time, c.session.camera) == (frame.time, frame.camera)
        assert (c.session.settings.method, c.session.settings.depth) == (method, frame.settings.depth)
        assert np.array_equal(c.frame.color.view(np.uint32), frame.color.view(np.uint32))
    assert {c.record.moments.get(number).view for number in seen} == {View.COLOR, View.DEPTH}


def test_frames_of_an_experiment_are_told_from_those_of_the_path(desk: Desk) -> None:
    c, scene = desk.c, desk.c.session.scene
    every = [scene.frame_time(number) for number in range(scene.frames)]
    runs = [SimpleNamespace(times=times, shown="paper", is_of=lambda scene: True) for times in (every, every[::5])]
    assert c.travel.named_of_experiment(runs[0], 2) == "frame 2 of the path, by paper"
    assert c.travel.named_of_experiment(runs[1], 2) == "frame 2 of the experiment, by paper, frame 10 of the path"


def test_going_back_can_be_undone_with_its_time(desk: Desk) -> None:
    seen, c = flown(desk, "paper"), desk.c
    here = c.session.snapshot()
    number = list(seen)[1]
    c.travel.go(number)
    assert "with the modes of now" in desk.said
    desk.rest()
    assert c.session.time == seen[number].time != here.time and c.session.view is View.COLOR
    assert c.undo.undoes == f"going to picture {number}"
    c.undo.undo()
    desk.rest()
    assert c.session.snapshot() == here
    c.undo.redo()
    desk.rest()
    assert c.session.time == seen[number].time and c.session.settings.depth == 3


def test_the_modes_of_then_come_back_with_the_picture(desk: Desk) -> None:
    """Traced again after the frames that had taught them, a picture and all modes are those of then, bit for bit."""
    c = desk.c
    seen = flown(desk, "paper")
    first, *_, number = list(seen)[:4]
    before = [n for n in c.record.learnt_from or [] if n < number]
    c.travel.go(number, modes=True, point=(0.5, 0.6))
    assert c.runs.current is not None, desk.said
    desk.run_to_its_end()
    assert_the_same(c.frame, seen[number])
    assert c.selection.picked is not None and (c.selection.picked.x, c.selection.picked.y) == (32, 28)
    assert len(c.record.learnt_from or []) == len(before) + 1, "another frame has followed"

    # The frames that were traced again have numbers of their own, and can be gone back to as well.
    again = (c.record.learnt_from or [])[before.index(first)]
    c.travel.go(again, modes=True)
    desk.run_to_its_end()
    assert_the_same(c.frame, seen[first])
    c.motion.move(ELSEWHERE)
    desk.rest()
    assert len(c.record.learnt_from or []) > before.index(first) + 2, "no frame follows any more"


def assert_the_same(frame: Frame | None, then: Frame) -> None:
    assert frame is not None and (frame.time, frame.camera) == (then.time, then.camera)
    assert np.array_equal(frame.color.view(np.uint32), then.color.view(np.uint32))
    assert np.array_equal(frame.modes, then.modes) and np.array_equal(frame.highest_count, then.highest_count)


def test_what_was_forgotten_cannot_be_learnt_again(desk: Desk) -> None:
    seen, c = flown(desk, "paper"), desk.c
    c.tracing.reset_modes()
    desk.rest()
    c.travel.go(next(iter(seen)), modes=True)
    assert "were forgotten since" in desk.said and c.runs.current is None
    c.travel.go(99_999)
    assert "no longer kept" in desk.said


def test_a_mode_names_the_frame_and_the_pixels_that_taught_it(desk: Desk) -> None:
    """Against the modes as each frame left them, and what its pixels met without culling."""
    c, words = desk.c, {}
    c.settings.change(method="paper", depth=2)
    desk.rest()
    c.tracing.reset_modes()
    desk.rest()
    for number in (0, 4, 9):
        c.session.go_to_frame(number)
        desk.until(lambda number=number: c.frame is not None and c.frame.time == c.session.time)
        desk.rest()
    c.motion.move(ELSEWHERE)
    desk.rest()
    learnt = c.record.learnt_from
    assert learnt is not None and len(learnt) >= 5
    words = {n: c.record.moments.get(n) for n in learnt}
    assert all(words.values())
    c.selection.select((0.5, 0.75))
    picked = c.selection.picked
    assert picked is not None and picked.primitive >= 0
    taught = c.record.origins(picked)
    assert taught is not None
    desk.until(lambda: all(c.origins.of(n, 0, True) is not None for one in taught.lights for n in one if n != NEVER))
    import tracer

    met = 0
    world = tracer.World(c.session.scene)
    again = tracer.Renderer(c.session.scene, replace(words[learnt[0]].settings, verify=False), world=world)
    first: dict[tuple[int, bool], int] = {}
    for n in learnt:
        moment = words[n]
        again.settings = moment.settings
        word = again.render(moment.time, moment.camera).modes[picked.unit]
        for light in range(2):
            for lit, bit in ((False, modes.FULL_SHADOW), (True, modes.NON_SHADOW)):
                if int(modes.shadow_mode(word, light)) & bit:
                    first.setdefault((light, lit), n)
    for light, lesson in enumerate(taught.lights):
        for lit, n in ((False, lesson.blocked), (True, lesson.lit)):
            assert first.get((light, lit), NEVER) == n
            if n == NEVER:
                continue
            found, moment = c.origins.of(n, light, lit), words[n]
            assert found is not None
            exact = replace(moment.settings, method="none", record_lights=True, verify=False)
            frame = tracer.Renderer(c.session.scene, exact, world=world).render(moment.time, moment.camera)
            here = (frame.primitive == picked.primitive) & (frame.asked[..., light] > 0)
            here &= (frame.reached[..., light] > 0) == lit
            if found.pixel is not None:
                x, y = found.pixel
                assert here[y, x] and found.count == np.count_nonzero(here)
                met += 1
    assert met >= 2, "no pixel was named: this shows nothing"


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
        c.travel.go(to, point=(0.5, 0.45))
        desk.until(lambda: not c.editing.under_way)
        desk.rest()
        assert np.array_equal(c.frame.color, picture) and c.session.edits == edits
        here = c.selection.at((0.5, 0.45))
        picked = c.selection.picked
        assert (picked is None) == (here.primitive < 0) == bool(edits)
        assert picked is None or (picked.primitive == here.primitive and picked.seen)
    c.travel.go(number, modes=True)
    assert "cannot be learnt again" in desk.said


def test_a_replay_that_never_began_has_forgotten_nothing(desk: Desk) -> None:
    seen, c = flown(desk, "paper"), desk.c
    numbers = list(c.record.learnt_from or [])
    c.travel.go(list(seen)[2], modes=True)
    assert c.record.learnt_from == numbers, "nothing has been forgotten yet"
    desk.until(lambda: c.runs.current is None)
    desk.rest()
    assert c.record.learnt_from != numbers and c.travel.replay.whole
