"""Pictures of a film by several processes, in any order: each is traced alone, by one thread, as if in its turn.

That holds where no earlier frame shows in a picture.  How a picture is traced and drawn is passed in as a function.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from tracer import fingerprint
from tracer.experiments.cluster import Cluster
from tracer.experiments.remote_jobs import Emit, Job, do, prepare, world_of
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.settings import Settings

Draw = Callable[[Renderer, Any, Callable[[], bool]], tuple[bytes, str]]
"""Traces and draws what it is given: the picture's file, and a remark or nothing.  It lies in a module that processes
can import, and the last argument says whether to stop."""
_SCENE = "film"


def pictures(
    cluster: Cluster,
    scene: Scene,
    draw: Draw,
    wanted: Sequence[tuple[Settings, Any]],
    cancelled: Callable[[], bool] = lambda: False,
    on_wait: Callable[[], None] = lambda: None,
) -> Iterator[tuple[int, bytes, str]]:
    """Draw what is wanted, each with its settings; yields numbers, files and remarks as they come.

    Raises Cancelled, and RuntimeError, in one line, where a picture could not be traced."""
    code = fingerprint.code_of(scene)
    jobs = [Job(_SCENE, (draw, settings, given, code)) for settings, given in wanted]
    for outcome in do(cluster, _picture, {_SCENE: scene}, jobs, cancelled, on_wait):
        for number, (data, remark) in outcome.results:
            yield number, data, remark
        for number, why in outcome.failures:
            raise RuntimeError(f"picture {number + 1} of {len(jobs)}: {why}")


def _picture(
    job: tuple[Draw, Settings, Any, str], scene: Scene, emit: Emit, cancelled: Callable[[], bool]
) -> tuple[bytes, str]:
    draw, settings, given, code = job
    prepare(len(scene.lights), settings.accelerator, settings.method)
    world = world_of(scene, code, settings.accelerator, scene.time_range[0])
    return draw(Renderer(scene, settings, world=world), given, cancelled)
