"""A picture that is saved after others carries the modes that it went by, and is true to the bit when checked."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import run
from tests.viewer.desk import Desk
from tests.viewer.marbles import write_marbles
from viewer.output import capture, kept_modes, png
from viewer.services import stills
from viewer.state.view_state import ViewState, Warmup
from viewer.state.views import View


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    desk = Desk(write_marbles(tmp_path), tmp_path / "pictures")
    yield desk
    assert desk.c.close()


def saved(desk: Desk, view: View, name: str) -> Path:
    """What the window would save of the picture that it shows, after it has shown others."""
    desk.c.settings.change(method="paper", samples=2)
    desk.c.session.set_draw(view=view)
    for _ in range(4):
        desk.c.motion.step(1)
        desk.rest()
    c = desk.c
    c.preferences.screenshot_template = name
    state = c.pictures.state_of(c.frame, view)
    assert state is not None and state.warmup.unknown, "its modes come from other frames"
    pixels, _ = stills.draw(c.frame, c.session.scene, state)
    c.captures.capture(c.frame, pixels, None, state)
    job = c.captures.saving.pop()
    assert job.join(10.0)
    return job.result


def check(capfd: pytest.CaptureFixture[str], path: Path) -> tuple[int, str]:
    code, out, errors = run(capfd, "check", path)
    assert errors == ""
    return code, out.strip()


def changed(path: Path, name: str, **warmup: object) -> Path:
    """A copy of a picture whose state says something else."""
    data = capture.read_data(path)
    data["state"]["warmup"] |= warmup
    with Image.open(path) as image:
        png.write(path.with_name(name), np.asarray(image.convert("RGB")), json.dumps(data))
    return path.with_name(name)


@pytest.mark.parametrize("view", [View.COLOR, View.DIFFERENCE, View.SAVED])
def test_a_picture_after_others_is_made_again_to_the_bit(
    desk: Desk, view: View, capfd: pytest.CaptureFixture[str]
) -> None:
    path = saved(desk, view, f"{view.value}.png")
    code, said = check(capfd, path)
    assert code == 0 and "true: 64 × 48, bit for bit" in said, said


def test_a_picture_after_others_in_motion_of_which_some_pixels_taught_is_made_again_to_the_bit(
    desk: Desk, capfd: pytest.CaptureFixture[str]
) -> None:
    c = desk.c
    c.session.set_pace(progressive=True, target_fps=5000.0)
    c.settings.change(method="paper")
    c.session.playing = True
    desk.came.clear()
    desk.until(lambda: len(desk.came) > 20 and any(frame.statistics.part < 1.0 for frame in desk.came))
    c.session.playing = False
    desk.rest()
    code, said = check(capfd, saved(desk, View.SAVED, "after-motion.png"))
    assert code == 0 and "bit for bit" in said, said


def test_without_its_modes_a_picture_is_held_against_that_with_every_ray_traced(
    desk: Desk, capfd: pytest.CaptureFixture[str]
) -> None:
    path = saved(desk, View.COLOR, "color.png")
    frame = desk.c.frame
    code, said = check(capfd, changed(path, "older.png", modes=""))
    with Image.open(path) as image:
        kept = np.asarray(image.convert("RGB"))
    renderer = stills.Renderer(desk.c.session.scene, replace(frame.settings, method="none", verify=False))
    differ = int((renderer.render(frame.time, frame.camera).pixels != kept).any(axis=-1).sum())
    if differ:
        assert code == 1 and f"but for {differ:,} of 3,072 pixels" in said and "Backspace" in said, said
    else:
        assert code == 0 and "nothing of its culling shows" in said, said
    with Image.open(path) as image:
        darker = np.asarray(image.convert("RGB")) // 2
    png.write(path.with_name("dark.png"), darker, json.dumps(capture.read_data(changed(path, "again.png", modes=""))))
    code, said = check(capfd, path.with_name("dark.png"))
    assert code == 1 and "unknown: but for" in said


def test_modes_that_are_damaged_or_of_another_scene_are_said_to_be(
    desk: Desk, capfd: pytest.CaptureFixture[str]
) -> None:
    path = saved(desk, View.SAVED, "saved.png")
    for name, modes, why in (
        ("letters", "no base64!", "damaged"),
        ("bytes", "aGVsbG8=", "damaged"),
        ("short", capture.read_data(path)["state"]["warmup"]["modes"][:-8], "damaged"),
        ("empty", "eJwDAAAAAAE=", "not those of"),
    ):
        code, said = check(capfd, changed(path, f"{name}.png", modes=modes))
        assert code == 1 and why in said and len(said.splitlines()) == 1, (name, said)


def test_views_of_modes_say_how_to_save_what_can_be_made_again(desk: Desk, capfd: pytest.CaptureFixture[str]) -> None:
    path = saved(desk, View.OCCLUSION, "modes.png")
    assert not capture.read_data(path)["state"]["warmup"]["modes"], "such a picture shows what comes of more than these"
    code, said = check(capfd, path)
    assert code == 1 and "cannot be made again" in said and "Backspace" in said


def test_modes_come_back_as_they_were(desk: Desk) -> None:
    frame = desk.c.frame
    state = ViewState(settings=replace(frame.settings, method="paper"), warmup=Warmup(unknown="why"))
    text = kept_modes.packed(frame, state)
    words = kept_modes.unpacked(text, len(frame.modes_before), frame.modes_before.dtype)
    assert text and np.array_equal(words, frame.modes_before) and words.dtype == frame.modes_before.dtype
    for other in (
        replace(state, warmup=Warmup()),
        replace(state, settings=replace(frame.settings, method="certified")),
    ):
        assert kept_modes.packed(frame, other) == ""
