"""The command that is copied makes the picture of the window, to the bit."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.commands import run
from tests.viewer.desk import ELSEWHERE, Desk
from tests.viewer.fakes import TINY_SCENE
from viewer.output.commands import BUILT
from viewer.services import stills
from viewer.state.tone import Curve, Tone
from viewer.state.views import View

ODD = 'it\'s "odd"; $HOME & -c\tüñ.aff'


@pytest.fixture
def odd(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    """A desk with a scene of an odd name in a folder of another, which is the current one."""
    folder = tmp_path / "a folder's"
    folder.mkdir()
    (folder / ODD).write_text(TINY_SCENE)
    monkeypatch.chdir(tmp_path)
    desk = Desk(folder / ODD, tmp_path / "pictures")
    yield desk
    assert desk.c.close()


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
    words = shlex.split(desk.c.pictures.command() or "")
    assert words[0] == "shadowcull"
    code, _, errors = run(capfd, *words[1:])
    assert code == 0, errors
    with Image.open(words[words.index("-o") + 1]) as image:
        return np.asarray(image)


def exactly(desk: Desk) -> None:
    """By a method whose pictures depend on no frames before them."""
    desk.c.settings.change(method="certified")


def later(desk: Desk) -> None:
    desk.c.session.change(time=1.2345678901234567)
    desk.c.session.set_draw(outlines=True)


def elsewhere(desk: Desk) -> None:
    desk.c.motion.move(ELSEWHERE)
    desk.c.session.change(settings=replace(desk.c.session.settings, samples=3, depth=2))


def soft(desk: Desk) -> None:
    desk.c.session.change(settings=replace(desk.c.session.settings, lamp_radius=0.7, lamp_samples=4, samples=1))
    desk.c.session.set_draw(view=View.PENUMBRA)
    desk.c.settings.set_light(1)


def toned(desk: Desk) -> None:
    desk.c.session.set_draw(tone=Tone(-1.25, 0.7, Curve.FILMIC), clipping=True)


def ranged(desk: Desk) -> None:
    """By a range of its own; tone and stripes are for other views."""
    desk.c.session.change(draw=desk.c.session.draw.with_span((1e-7, 9.5), View.DEPTH))
    desk.c.session.set_draw(view=View.DEPTH)


def by_modes(view: View) -> Callable[[Desk], None]:
    def change(desk: Desk) -> None:
        desk.c.session.change(
            settings=replace(desk.c.session.settings, method="paper", symmetric=True, zoom_factor=2.5)
        )
        desk.c.session.set_draw(view=view)
        desk.c.session.set_draw(wipe=0.3)
        desk.c.preferences.legend_in_pictures = view is View.SHADOW
        desk.c.session.set_draw(legend_at=(0.25, 1.0), shading=0.7, shares=True)
        desk.rest()
        fresh(desk)

    return change


def test_a_copied_command_makes_the_same_picture(odd: Desk, capfd: pytest.CaptureFixture[str]) -> None:
    modes = [by_modes(view) for view in (View.SHADOW, View.OCCLUSION, View.WIPE, View.DIFFERENCE, View.SAVED)]
    for change in (lambda _: None, exactly, later, elsewhere, soft, toned, ranged, *modes):
        change(odd)
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
        assert (
            first.text["shadowcull"].partition('"statistics"')[0]
            == second.text["shadowcull"].partition('"statistics"')[0]
        )


def test_a_tree_that_rays_have_had_built_cannot_be_brought_back(odd: Desk) -> None:
    odd.c.settings.change(accelerator="kdtree-lazy")
    odd.c.session.set_draw(view=View.TREE)
    odd.rest()
    assert odd.c.pictures.command() is not None and f"may differ: {BUILT}" in odd.said
    assert odd.c.pictures.save()
    assert odd.runs.current.state.warmup.unknown == BUILT
    odd.run_to_its_end()
    odd.c.films.plan = replace(odd.c.films.plan, first=0, last=1, size=(32, 24), video=False)
    odd.c.films.start()
    assert odd.c.films.film.script.state.warmup.unknown == BUILT
    odd.run_to_its_end()
    odd.c.navigator.go(odd.c.history.frames - 1)
    assert odd.said.endswith(f"again, though {BUILT}"), odd.said
