"""A first start: kernels are compiled, which is made to last as long as the scenario wants."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

import numpy as np
from imgui_bundle import imgui

from tests.viewer.driver import Driver
from tests.viewer.previews import colors_of
from tracer.compilation import can_draw, compiled_before, warm_up
from tracer.scene.model import Progress
from viewer.services import scene_loader

KEY = imgui.Key
_compiled = threading.Event()


@contextmanager
def first_start() -> Iterator[None]:
    """As if no kernel were compiled until the scenario says so."""
    _compiled.clear()

    def slowly(progress: Progress, *arguments, **options) -> None:
        while not _compiled.is_set():
            progress("nearest hits; about 30 s left", 0.25)
            time.sleep(0.02)
        warm_up(progress, *arguments, **options)

    def after(known):
        return lambda *arguments, **options: _compiled.is_set() and known(*arguments, **options)

    with mock.patch.object(scene_loader, "warm_up", slowly):
        scene_loader.can_draw, scene_loader.compiled_before = after(can_draw), after(compiled_before)
        try:
            yield
        finally:
            scene_loader.can_draw, scene_loader.compiled_before = can_draw, compiled_before


def previewing(d: Driver) -> None:
    """The scene is there, and can be flown through; then the traced picture takes its place, from there."""
    d.wait(lambda: d.ui.graphics.preview is not None, "the preview", 30.0)
    assert d.c.frame is None and d.c.session.scene is None and d.c.loader.warm_up_job is not None
    d.frames(3)
    first = _read(d)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 100, "a shaded sphere"
    home = d.c.session.camera
    window = imgui.internal.find_window_by_name("Picture")
    d.drag((window.pos.x + 0.5 * window.size.x, window.pos.y + 0.5 * window.size.y), (60.0, 10.0))
    assert d.c.session.camera != home, "the pointer has not turned the camera"
    d.hold(KEY.d, 0.1)
    flown = d.c.session.camera
    d.wait(lambda: not d.c.motion.under_way, "rest", 10.0)
    d.frames(2)
    assert np.abs(_read(d).astype(int) - first).max() > 50, "another picture"
    _compiled.set()
    d.settle()
    assert d.ui.graphics.preview is None and d.c.preview.geometry is None and d.c.session.previewed is None
    assert d.c.frame is not None and d.c.frame.camera == flown == d.c.session.camera
    assert d.has("//Picture/picture") and not d.has("//Picture/preview")


def _read(d: Driver) -> np.ndarray:
    return d.inside(lambda: colors_of(d.ui.graphics.preview))
