"""What a state says of the frames before its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.commands import ROOM
from tracer.renderer import Renderer
from tracer.scene.load import load_scene
from tracer.settings import Settings
from viewer.output.commands import by_one_thread, cannot_come_back, needs_history
from viewer.services import stills
from viewer.state.draw_options import DrawOptions
from viewer.state.readings import can_draw
from viewer.state.view_state import ViewState
from viewer.state.views import View


@pytest.mark.parametrize("method", ("none", "certified", "voxels", "lie-exact", "certified+cache"))
@pytest.mark.parametrize("view", View)
def test_without_frames_before_it_a_picture_is_the_same_unless_the_recipe_says_otherwise(
    tmp_path: Path, method: str, view: View
) -> None:
    (tmp_path / "room.aff").write_text(ROOM)
    scene = load_scene(tmp_path / "room.aff")
    recipe = ViewState(
        time=scene.frame_time(3), settings=Settings(24, 18, method=method, threads=1), draw=DrawOptions(view)
    )
    if needs_history(recipe):
        return
    alone, later = Renderer(scene, recipe.settings), Renderer(scene, recipe.settings)
    for number in range(3):
        later.render(scene.frame_time(number))
    one, other = (stills.trace(renderer, recipe) for renderer in (alone, later))
    if can_draw(one, view):
        drawn = (stills.draw(frame, scene, recipe)[0] for frame in (one, other))
        np.testing.assert_array_equal(*drawn)


@pytest.mark.parametrize("view", [View.FATE, View.MOVING_SHADOW])
def test_what_becomes_of_rays_depends_on_what_an_exact_method_has_learnt(view: View) -> None:
    """As work does: such a picture is filmed after those before it, and by chance where that is by chance."""
    for method in ("certified", "auto", "voxels", "none+cache", "certified+cache"):
        for threads in (1, 2):
            one, work = (
                ViewState(settings=Settings(method=method, threads=threads), draw=DrawOptions(shown))
                for shown in (view, View.SAVED)
            )
            assert needs_history(one)
            assert by_one_thread(one) == by_one_thread(work)
            assert cannot_come_back(one.settings, one.draw) == cannot_come_back(work.settings, work.draw)
    assert not needs_history(ViewState(settings=Settings(method="none"), draw=DrawOptions(view)))
