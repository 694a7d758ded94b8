"""The preview before the first picture: which scenes get one, and how fast the camera moves in it."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import trimesh

from tests.viewer.fakes import make_scene
from tracer.scene.load import load_scene
from tracer.scene.mesh_options import AS_IN_FILE, IN_STUDIO, MeshOptions
from tracer.scene.model import Scene
from viewer.services import preview, scene_files
from viewer.services.motion import Motion
from viewer.services.preview import Preview
from viewer.state.notices import Notices
from viewer.state.preferences import Preferences
from viewer.state.session import Session


class FirstStart:
    """A session in which a scene waits for kernels."""

    def __init__(self, scene: Scene) -> None:
        self.session, notices = Session(), Notices()
        self.motion = Motion(self.session, Preferences(), notices, lambda: False)
        loader = SimpleNamespace(waiting=(scene, None, None))
        self.preview = Preview(self.session, loader, self.motion, notices, lambda: None)
        end = time.monotonic() + 20.0
        self.preview.update(traced=False)
        while self.preview._job is not None:
            assert time.monotonic() < end, "in vain"
            time.sleep(0.002)
            self.preview.update(traced=False)
        assert notices.current is None, notices.current


@pytest.mark.parametrize("meshes", [IN_STUDIO, AS_IN_FILE])
def test_the_camera_is_as_fast_in_the_preview_as_in_the_traced_scene(tmp_path: Path, meshes: MeshOptions):
    path = tmp_path / "box.ply"
    trimesh.creation.box((1, 2, 3)).export(path)
    scene = load_scene(path, meshes=meshes)
    first = FirstStart(scene)
    assert first.preview.geometry is not None
    before = first.motion.pace
    opened = scene_files.open_scene(lambda: scene, first.session.settings, lambda: True, lambda what, fraction: None)
    first.motion.enter(opened.info["bounds"])
    assert before == pytest.approx(first.motion.pace, rel=1e-6) and before != 1.0


def test_the_box_is_found_beside_the_window(monkeypatch: pytest.MonkeyPatch):
    known, threads = preview.bounds, []
    monkeypatch.setattr(preview, "bounds", lambda *of: threads.append(threading.current_thread()) or known(*of))
    FirstStart(make_scene())
    assert len(threads) == 1 and threads[0] is not threading.current_thread()


def test_spheres_and_cones_count_where_a_scene_is_too_large_for_a_preview(monkeypatch: pytest.MonkeyPatch):
    scene = make_scene()
    for most, there in ((scene.primitive_count, True), (scene.triangle_count, False)):
        monkeypatch.setattr(preview, "MOST_READ", most)
        first = FirstStart(scene)
        assert (first.preview.geometry is not None) == (first.session.previewed is not None) == there
