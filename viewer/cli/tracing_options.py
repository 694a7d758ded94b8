"""What the commands that trace have in common: settings, the moment, and kernels that are ready."""

from __future__ import annotations

import math
from argparse import Namespace

from tracer.compilation import compiled_before, make_ready, warm_up
from tracer.frame import Settings
from tracer.kernel_cache import outlives_process
from tracer.method import Method
from tracer.scene.model import Scene
from viewer.cli.console import Work

MOST_PIXELS = 1 << 26  # 8192 × 8192; a frame's buffers then take some 4 GB


def prepare_kernels(work: Work, lights: int, accelerator: str, *methods: str) -> None:
    """Compile or load every kernel that these methods need for so many lights.

    The first time takes a while and says so."""
    certificates = any(Method.parse(name).has_certificates for name in methods)
    if not compiled_before(lights, accelerator, certificates):
        always = "at every start, as the cache folder cannot be written to"
        often = "once for this version" if outlives_process() else always
        work.note(f"compiling the kernels, {often}; this takes a minute or less")
    warm_up(work.progress, lights, accelerator, certificates)
    for name in methods:
        make_ready(name, lights, accelerator, work.progress)


def tracing_settings(options: Namespace) -> Settings:
    """Settings that commands have in common, of one ray a pixel; raises ValueError in one line."""
    width, height = options.size
    if width * height > MOST_PIXELS:
        raise ValueError(f"--size {width}x{height}: more than {MOST_PIXELS:,} pixels")
    return Settings(
        width=width,
        height=height,
        depth=options.depth,
        symmetric=options.symmetric,
        zoom_factor=options.zoom_factor,
        lamp_radius=options.lamp_radius,
        lamp_samples=options.lamp_samples,
        verify=options.verify,
        threads=options.threads,
        accelerator=options.accelerator,
    ).validated()


def moment(scene: Scene, frame: int | None, time: float | None) -> float:
    """The time of `--frame` or `--time`, of the first frame where neither is given; raises ValueError in one line."""
    start, end = scene.time_range
    if time is not None:
        if not (math.isfinite(time) and start <= time <= end):
            raise ValueError(f"--time {time:g}: the scene's time runs from {start:g} to {end:g} seconds")
        return time
    number = 0 if frame is None else frame
    if not 0 <= number < scene.frames:
        only = "is 0" if scene.frames == 1 else f"are 0 to {scene.frames - 1}"
        raise ValueError(f"--frame {number}: the scene's frame numbers {only}")
    return scene.frame_time(number)
