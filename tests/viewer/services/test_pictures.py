"""A copied command makes the picture of the window, to the bit; a saved picture carries the modes that it went by."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import ROOM, run, shell_words
from tests.marbles import write_marbles
from tests.sweeps import crossed
from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.fakes import TINY_SCENE
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.settings import Settings
from viewer.output import capture
from viewer.output.commands import needs_history
from viewer.services import stills
from viewer.state.draw_options import Curve, DrawOptions, Tone
from viewer.state.view_state import ViewState
from viewer.state.views import View, can_draw

ODD = 'it\'s "odd"; $HOME & -c\tüñ.aff'


@pytest.fixture
def odd(desk_at: Callable[[Path], Desk], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """A desk with a scene of an odd name in a folder of another, which is the current one."""
    folder = tmp_path / "a folder's"
    folder.mkdir()
    (folder / ODD).write_text(TINY_SCENE)
    monkeypatch.chdir(tmp_path)
    return desk_at(folder / ODD)


def fresh(desk: Desk) -> None:
    """What is known is forgotten, and learnt again from what is seen now."""
    desk.c.reset_modes()
    desk.rest()


def shown(desk: Desk) -> np.ndarray:
    """The picture as the window's state draws the frame that is there."""
    state = desk.c.pictures.state_of(desk.c.frame, desk.c.session.draw.view)
    return stills.draw(desk.c.frame, desk.c.session.scene, state)[0]


def made(desk: Desk, capfd: pytest.CaptureFixture[str]) -> np.ndarray:
    """The picture that the copied command makes, started as a shell would."""
    words = shell_words(desk.c.pictures.command() or "")
    assert words[0] == "shadowcull"
    code, _, errors = run(capfd, *words[1:])
    assert code == 0, errors
    with Image.open(words[words.index("-o") + 1]) as image:
        return np.asarray(image)


Changes = dict[str, object]
ONE_AFTER_THE_OTHER: tuple[tuple[Changes, Changes, Changes], ...] = (  # of settings, of how it is drawn, of the state
    ({}, {}, {}),
    ({"method": "certified"}, {}, {}),  # whose pictures depend on no frames before them
    ({}, {"outlines": True}, {"time": 1.2345678901234567}),
    ({"samples": 3, "depth": 2}, {}, {"camera": ELSEWHERE}),
    ({"lamp_radius": 0.7, "lamp_samples": 4, "samples": 1}, {"view": View.PENUMBRA, "light": 1}, {}),
    ({}, {"tone": Tone(-1.25, 0.7, Curve.FILMIC), "clipping": True}, {}),
    ({}, {"view": View.DEPTH, "spans": ((View.DEPTH, (1e-7, 9.5)),)}, {}),  # tone and stripes are for other views
    *(
        ({"method": "paper", "symmetric": True, "zoom_factor": 2.5},
         {"view": view, "wipe": 0.3, "legend_at": (0.25, 1.0), "shading": 0.7, "shares": True}, {})
        for view in (View.SHADOW, View.OCCLUSION, View.WIPE, View.DIFFERENCE, View.SAVED)
    ),
)  # fmt: skip


def test_a_copied_command_makes_the_same_picture(odd: Desk, capfd: pytest.CaptureFixture[str]) -> None:
    session = odd.c.session
    for settings, draw, state in ONE_AFTER_THE_OTHER:
        session.change(**state)
        session.set_settings(**settings)
        session.set_draw(**draw)
        odd.c.preferences.legend_in_pictures = session.draw.view is View.SHADOW
        if session.settings.method == "paper":
            odd.rest()
            fresh(odd)
        odd.rest()
        assert np.array_equal(made(odd, capfd), shown(odd)), odd.c.pictures.command()
        assert odd.said.startswith("copied: shadowcull render "), odd.said


def test_what_cannot_be_brought_back_is_said(odd: Desk) -> None:
    odd.c.session.set_draw(view=View.OCCLUSION)
    odd.c.motion.step(5)
    odd.rest()
    assert odd.c.pictures.command() is not None
    assert "may differ" in odd.said and "other frames" in odd.said and "Backspace" in odd.said
    fresh(odd)
    assert odd.c.pictures.command() is not None and odd.said.startswith("copied: ")
    odd.c.session.change(settings=replace(odd.c.session.settings, method="certified"))
    odd.c.session.set_draw(view=View.CERTIFICATE)
    odd.rest()
    fresh(odd)
    assert odd.c.pictures.command() is not None
    assert "may differ" in odd.said and "time" in odd.said


def test_scenes_of_the_program_are_named(figure4: Desk) -> None:
    assert (figure4.c.pictures.command() or "").startswith("shadowcull render figure4 -o figure4-color-0000.png")


def test_a_command_is_printed_for_a_saved_picture(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("room.aff").write_text(TINY_SCENE)
    options = ("--frame", 4, "--warmup", 3, "--method", "paper", "--view", "shadow:1", "--size", "80x60", "--legend")
    more = ("--legend-at", "1,0", "--caption", "{scene} {{{frame}}}", "--accelerator", "kdtree")
    assert run(capfd, "render", "room.aff", "-o", "first.png", *options, *more)[0] == 0
    code, printed, _ = run(capfd, "render", "first.png", "-o", "second.png", "--print-command")
    assert code == 0 and not Path("second.png").exists()
    words = shlex.split(printed)
    assert "--frame" in words and "--caption=room {{4}}" in words
    assert run(capfd, *words[1:])[0] == 0
    with Image.open("first.png") as first, Image.open("second.png") as second:
        assert first.height > 60, "there is a caption"
        assert np.array_equal(np.asarray(first), np.asarray(second))
        state, again = (image.text["shadowcull"].partition('"statistics"')[0] for image in (first, second))
        assert state == again


@pytest.fixture
def desk(desk_at: Callable[[Path], Desk], tmp_path: Path) -> Desk:
    return desk_at(write_marbles(tmp_path))


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
    c.captures.capture(c.frame, shown(desk), None, state)
    (job,) = c.captures.saving
    desk.rest()
    return job.result


def check(capfd: pytest.CaptureFixture[str], path: Path) -> tuple[int, str]:
    """The exit code and the line of `check`."""
    code, out, errors = run(capfd, "check", path)
    assert errors == "" and len(out.splitlines()) == 1
    return code, out.strip()


def changed(path: Path, name: str, **warmup: object) -> Path:
    """A copy of a picture whose state says something else."""
    carried = capture.read_carried(path)
    carried.state["warmup"] |= warmup
    with Image.open(path) as image:
        capture.write(path.with_name(name), np.asarray(image.convert("RGB")), carried.text())
    return path.with_name(name)


@pytest.mark.parametrize(
    ("view", "in_motion"), [(View.COLOR, False), (View.DIFFERENCE, False), (View.SAVED, False), (View.SAVED, True)]
)
def test_a_picture_after_others_is_made_again_to_the_bit(
    desk: Desk, capfd: pytest.CaptureFixture[str], view: View, in_motion: bool
) -> None:
    """Also after some in motion, of which some pixels have taught."""
    if in_motion:
        desk.c.session.set_pace(progressive=True, target_fps=5000.0)
        desk.c.settings.change(method="paper")
        desk.c.session.playing = True
        desk.came.clear()
        desk.until(lambda: len(desk.came) > 20 and any(frame.statistics.part < 1.0 for frame in desk.came))
        desk.c.session.playing = False
        desk.rest()
    code, said = check(capfd, saved(desk, view, f"{view.value}.png"))
    assert code == 0 and "true: 64 × 48, bit for bit" in said, said


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
        assert code == 1 and "Backspace" in said, said
    else:
        assert code == 0 and "true: 64 × 48, bit for bit" in said, said


def test_modes_that_are_damaged_or_of_another_scene_are_said_to_be(
    desk: Desk, capfd: pytest.CaptureFixture[str]
) -> None:
    path = saved(desk, View.SAVED, "saved.png")
    for name, modes, why in (
        ("letters", "no base64!", "damaged"),
        ("bytes", "aGVsbG8=", "damaged"),
        ("short", capture.read_carried(path).state["warmup"]["modes"][:-8], "damaged"),
        ("empty", "eJwDAAAAAAE=", "not those of"),
    ):
        code, said = check(capfd, changed(path, f"{name}.png", modes=modes))
        assert code == 1 and why in said, (name, said)


def test_views_of_modes_say_how_to_save_what_can_be_made_again(desk: Desk, capfd: pytest.CaptureFixture[str]) -> None:
    path = saved(desk, View.OCCLUSION, "modes.png")
    assert not capture.read_carried(path).state["warmup"]["modes"], "such a picture shows what comes of more than these"
    code, said = check(capfd, path)
    assert code == 1 and "cannot be made again" in said and "Backspace" in said


@pytest.mark.parametrize(
    ("method", "view"),
    [
        *crossed(("none", "certified", "voxels", "lie-exact", "certified+cache"), list(View)),
        ("certified", View.CERTIFICATE), ("voxels", View.VOXELS), ("lie-exact", View.CELL_LIGHTS),
    ],
)  # fmt: skip
def test_without_frames_before_it_a_picture_is_the_same_unless_its_state_says_otherwise(
    tmp_path: Path, method: str, view: View
) -> None:
    (tmp_path / "room.aff").write_text(ROOM)
    scene = load_scene(tmp_path / "room.aff")
    settings = Settings(24, 18, method=method, threads=1)
    state = ViewState(time=scene.frame_time(3), settings=settings, draw=DrawOptions(view))
    if needs_history(state):
        return
    alone, later = Renderer(scene, state.settings), Renderer(scene, state.settings)
    for number in range(3):
        later.render(scene.frame_time(number))
    one, other = (stills.trace(renderer, state) for renderer in (alone, later))
    if can_draw(one, view):
        drawn = (stills.draw(frame, scene, state)[0] for frame in (one, other))
        np.testing.assert_array_equal(*drawn)
