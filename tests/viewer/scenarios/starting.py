"""A first start: kernels are compiled, which is made to last as long as the scenario wants."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

from tests.viewer.driver import Driver
from tracer.compiling.compilation import can_draw, compiled_before, warm_up
from tracer.scene.model import Progress
from viewer.services import scene_loader

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


def starting(d: Driver) -> None:
    """How far it is stands where the picture will be; then the picture of the scene comes, which was read meanwhile."""
    d.expect("Compiling the tracer (first start only): 25 %")
    assert d.c.frame is None and d.c.session.scene is None and d.c.loader.warm_up_job is not None
    _compiled.set()
    d.settle()
    assert d.c.frame is not None and d.has("//Picture/picture")
