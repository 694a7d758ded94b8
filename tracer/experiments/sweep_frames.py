"""What a process of a sweep does with a task: trace its frames, and say in a row what was measured of each.

A process keeps the worlds of the last scenes, as building trees takes longer than many a frame.
"""

from __future__ import annotations

import os
import platform
import sys
import time as clocks
from collections import OrderedDict
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from filelock import FileLock

from tracer import fingerprint
from tracer.compilation import compiled_before, make_ready, ready_for, warm_up
from tracer.experiments.experiment import figures_of
from tracer.experiments.study import ASPECTS, Task
from tracer.frame import Frame
from tracer.geometry.world import World
from tracer.kernel_cache import cache_root
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene.model import Scene
from tracer.version import program_version, tracer_code

Row = dict[str, Any]
"""A frame that was measured, by the names of the columns in `tracer.experiments.sweep_store`."""
KEPT_WORLDS = 2
_worlds: OrderedDict[tuple[str, str, float], World] = OrderedDict()
_last: Renderer | None = None


def rows_of(task: Task, scene: Scene, cancelled: Callable[[], bool] = lambda: False) -> Iterator[Row]:
    """Trace a task's frames; yields a row for each as soon as it is traced.  Raises Cancelled."""
    settings = task.settings
    prepare(len(scene.lights), settings.accelerator, settings.method)
    renderer = _renderer(task, scene)
    renderer.settings = replace(settings, verify=False)  # of frames that only teach
    for _, time in task.before:
        renderer.render(time, task.camera(scene, time), cancelled)
    renderer.settings = settings
    for number, time in task.frames:
        start = clocks.process_time()  # of a process that does nothing else
        frame = renderer.render(time, task.camera(scene, time), cancelled)
        yield _row(task, number, time, frame, clocks.process_time() - start)


def _renderer(task: Task, scene: Scene) -> Renderer:
    """A renderer that knows nothing of earlier frames; the last one again where its method learns nothing, as what a
    renderer makes for its first frame is no part of the others' time."""
    global _last
    settings, world = task.settings, world_of(scene, task.code, task.settings.accelerator, task.start)
    if _last is None or _last.world is not world or _last.settings != settings or Method.parse(settings.method).learns:
        _last = Renderer(scene, settings, world=world)
    return _last


def _row(task: Task, number: int, time: float, frame: Frame, processor_seconds: float) -> Row:
    settings = task.settings
    replays = Method.parse(settings.method).kind.measures  # what it records first is none of its time
    return {
        "task": task.key,
        "scene": task.scene,
        "scene_code": task.code,
        "method": settings.method,
        "width": settings.width,
        "height": settings.height,
        **{name: getattr(settings, name) for name in ASPECTS},
        "seed": task.seed,
        "shake": task.shake,
        "warmup": task.warmup,
        "frame": number,
        "path_frames": task.path_frames,
        "time": time,
        **figures_of(frame.statistics),
        "processor_seconds": None if replays else processor_seconds,
        "picture": fingerprint.of_pixels(frame.color),
        "repeats": task.repeats,
        "version": program_version(),
        "tracer": tracer_code(),
        **machine(),
        "finished": datetime.now(UTC),
    }


def world_of(scene: Scene, code: str, accelerator: str, start: float) -> World:
    """The geometry of a scene of this code, as it is kept or built at `start`; for one renderer at a time."""
    key = (code, accelerator, start)
    if key not in _worlds:
        while len(_worlds) >= KEPT_WORLDS:
            _worlds.popitem(last=False)
        _worlds[key] = World(scene, start, accelerator)
    _worlds.move_to_end(key)
    return _worlds[key]


def prepare(lights: int, accelerator: str, method: str) -> None:
    """Make ready the kernels; of the processes that share a cache, one compiles and the others wait for it."""
    certificates = Method.parse(method).has_certificates
    if compiled_before(lights, accelerator, certificates) and ready_for(method, lights, accelerator):
        warm_up(None, lights, accelerator, certificates)
        return
    with FileLock(cache_root() / "sweep.lock"):
        warm_up(None, lights, accelerator, certificates)
        make_ready(method, lights, accelerator)


def check_program(version: str, tracer: str) -> None:
    """Raise ValueError, in one line, where this process runs another program than the one that asks."""
    if (version, tracer) != (program_version(), tracer_code()):
        raise ValueError(
            f"{platform.node()} has Shadowcull {program_version()} ({tracer_code()}), not {version} ({tracer}); "
            "install the same there"
        )


@cache
def machine() -> Row:
    """What traces: processor, cores, and the versions of what compiles."""
    return {
        "host": platform.node(),
        "process": os.getpid(),
        "processor": _processor(),
        "cores": os.cpu_count() or 1,
        "system": f"{platform.system()} {platform.release()}",
        "python": ".".join(str(part) for part in sys.version_info[:3]),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def _processor() -> str:
    """The name that the system gives the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
