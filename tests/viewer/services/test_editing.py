"""Edits brought about on the render thread, compared with what was before, undone, and made again by a command."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import run
from tests.viewer.desk import Desk
from tests.viewer.fakes import TINY_SCENE
from tracer.editing.edits import NO_EDITS, Edits
from tracer.renderer import Renderer
from tracer.scene.things import things
from tracer.settings import Settings

CARS = """x ball { s 0 0.8 0 0.8 }
x car { s 1.6 0.4 0.5 0.4 }
k car { transl 4 0 0 0 0 0 0 0  1 0 0 0 0 0 0  2 1 0 0 0 0 0  3 1 0 0 0 0 0 }"""
SCENE = TINY_SCENE.replace("s 0 0.8 0 0.8", CARS)


@pytest.fixture
def desk(desk_at: Callable[[Path], Desk], tmp_path: Path) -> Desk:
    path = tmp_path / "parts.aff"
    path.write_text(SCENE)
    return desk_at(path)


def fresh(desk: Desk) -> np.ndarray:
    """The picture of what is shown, by a renderer that knows nothing."""
    c = desk.c
    renderer = Renderer(c.session.scene, Settings(c.frame.width, c.frame.height, method="none"))
    return renderer.render(c.session.time, c.session.camera).color


def test_edits_of_all_kinds_are_shown_and_undone(desk: Desk):
    c = desk.c
    assert [thing.name for thing in things(c.session.original)] == ["parts", "ball", "car"]
    c.settings.change(method="certified")
    desk.rest()
    before, original = c.frame.color.copy(), c.session.scene
    steps = {
        "light 1 off": ("with_light", 1, False),
        "light 0 moved": ("with_light_at", 0, (-1.0, 6.0, 2.0)),
        "ball hidden": ("with_thing", "ball", False),
        "car static": ("with_static", "car", c.session.time),
        "parts moving": ("with_moving", "parts", True),
        "primitive 0 hidden": ("with_primitive", 0, False),
    }
    pictures = []
    for name, (change, *values) in steps.items():
        pictures.append(c.frame.color.copy())
        desk.edit(getattr(c.editing.now, change)(*values))
        assert c.undo.undoes == name
        assert np.array_equal(c.frame.color, fresh(desk)), name
    assert [len(c.session.scene.objects), len(c.session.scene.lights)] == [2, 1]
    for picture in reversed(pictures):
        c.undo.undo()
        desk.rest()
        assert np.array_equal(c.frame.color, picture)
    assert c.session.scene is original and np.array_equal(c.frame.color, before) and not c.session.edits
    assert c.undo.undoes == "method Certified", "edits make no steps but their own"


def test_the_modes_of_all_edited_scenes_are_forgotten(desk: Desk, monkeypatch: pytest.MonkeyPatch):
    c, original, resets = desk.c, desk.c.renderer._renderer, []
    monkeypatch.setattr(original, "reset_modes", lambda: resets.append(c.session.edits))
    desk.edit(c.editing.now.with_thing("ball", False))
    hidden = c.renderer._renderer
    c.reset_modes()
    desk.rest()
    assert hidden is not original and not resets
    desk.edit(c.editing.now.with_thing("ball", True))
    assert c.renderer._renderer is original and len(resets) == 1
    desk.edit(c.editing.now.with_thing("ball", False))
    assert c.renderer._renderer is not hidden and len(resets) == 1


def test_no_picture_of_an_edited_scene_comes_before_the_session_has_it(desk: Desk):
    c = desk.c
    c.editing.change(c.editing.now.with_light_at(0, (1.0, 5.0, 4.0)))
    c.session.go_to_frame(5)  # so that there is something to ask for
    desk.tick()
    while c.renderer.busy:
        time.sleep(0.001)
    assert c.renderer.take() is None and c.session.scene is c.session.original
    # A light that is dragged is seen on its way.
    for n in range(4):
        came = len(desk.came)

        def drag(came: int = came) -> bool:
            x, y, z = c.session.edits.light_place(0)
            c.editing.change(c.editing.now.with_light_at(0, (x + 1e-4, y, z)))
            return len(desk.came) > came

        c.editing.change(c.editing.now.with_light_at(0, (n % 4 - 2.0, 5.0, 4.0)))
        desk.until(drag)
    desk.rest()
    assert np.array_equal(c.frame.color, fresh(desk))


def test_no_run_begins_while_the_scene_is_being_edited(desk: Desk):
    c, said = desk.c, "the scene is being edited; start again when the picture shows it"
    c.editing.change(Edits(hidden=frozenset({"ball"})))
    desk.tick()
    c.editing.clear()  # it is being hidden nevertheless
    for start in (c.runs.start_experiment, c.runs.start_hunt, c.films.start, c.runs.start_zoom_test):
        c.notices.message = None
        start()
        assert desk.said == said and c.runs.current is None
    assert c.runs.experiment is None and c.runs.hunt is None and c.films.film is None
    desk.rest()
    c.runs.start_experiment()
    run = c.runs.current
    desk.run_to_its_end()
    assert run.whole


def test_edits_stay_when_the_scene_is_read_again_as_far_as_it_has_their_targets(desk: Desk):
    c = desk.c
    desk.edit(c.editing.now.with_thing("ball", False))
    desk.edit(c.editing.now.with_light(1, False))
    path = Path(c.session.scene.path)
    path.write_text(SCENE.replace("x ball", "x globe"))
    c.loader.reload()
    desk.rest()
    assert c.session.edits == Edits(lights_off=frozenset({1}))
    assert np.array_equal(c.frame.color, fresh(desk))


def test_the_command_makes_the_edited_picture_again(
    desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    c = desk.c
    c.settings.change(method="certified")
    desk.edit(c.editing.now.with_light(0, False))
    desk.edit(c.editing.now.with_light_at(1, (-1.1, 4.7, 1e-6)))
    desk.edit(c.editing.now.with_static("car", c.session.time))
    desk.edit(c.editing.now.with_primitive(0, False))
    desk.edit(c.editing.now.with_moving("ball", True))
    words = shlex.split(c.pictures.command())
    assert words[0] == "shadowcull" and "--without-light=0" in words
    monkeypatch.chdir(tmp_path)
    assert run(capfd, *words[1:], "--threads", 1)[0] == 0
    made = Path(words[words.index("-o") + 1])
    assert np.array_equal(np.asarray(Image.open(made)), c.frame.pixels)
    # The picture remembers its edits.
    assert run(capfd, "check", made)[0] == 0
    here = c.session.edits
    desk.edit(NO_EDITS)
    c.loader.open(made.absolute())
    desk.rest()
    assert c.session.edits == here and np.array_equal(np.asarray(Image.open(made)), c.frame.pixels)
