"""Compiling, or loading from the cache, every kernel that frames need, before a scene needs it.

Where none have been compiled before, processes of their own compile them first, a part each, into the cache
(`tracer.compiling.processes`).  One that fails costs time only, as what the cache lacks is compiled when it is needed.
What a first picture needs comes first; what other methods need comes last, and only where somebody wants it.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from numba.core.registry import cpu_target

from tracer.compiling.processes import compile_in_processes
from tracer.compiling.steps import (
    FIRST,
    FOR_A_PICTURE,
    PARTS,
    SHARES,
    WARM,
    kinds_of,
    method_steps,
    picture_steps,
    render_tiny,
)
from tracer.culling.modes import MAX_CULLED_LIGHTS, word_type
from tracer.method import Method, title_of
from tracer.runtime.kernel_cache import anything_kept, version_folder
from tracer.scene.model import Progress

_lock = threading.Lock()
_ready: set[str] = set()
_draws: set[str] = set()  # of which what a first picture needs is ready
_methods: set[str] = set()  # with kernels of their own, which are ready


def warm_up(
    progress: Progress | None = None, lights: int = 1, accelerator: str = "bvh8", picture_only: bool = False
) -> None:
    """Make the kernels ready for scenes with so many lights, of all `WARM` methods or only those of a first picture; at
    once where that has been done before.

    `progress` is given what is being compiled; what it raises (Cancelled) passes through.
    """
    report, name = progress or (lambda what, fraction: None), _variant(lights, accelerator)
    if name in _ready or (name in _draws and picture_only):
        return
    with _alone(report):
        if name in _ready or (name in _draws and picture_only):
            return
        done: set[str] = set()
        kept = compiled_before(lights, accelerator, picture_only)
        picture_kept = compiled_before(lights, accelerator, picture_only=True)
        parts = [part for part in PARTS if not (picture_kept and part in FOR_A_PICTURE)]
        if picture_only:
            parts = [part for part in parts if part in FOR_A_PICTURE]

        def load(steps: Iterator[str]) -> None:
            for step in steps:
                doing = "loading" if kept or step in done else "compiling"
                report(f"{doing} {step}", min(1.0, sum(SHARES[s] for s in done)))
                done.add(step)

        def load_picture() -> None:
            load(picture_steps(lights, accelerator))
            _draws.add(name)
            _mark_kept(name, picture_only=True)

        if not kept:
            with suppress(OSError):
                compile_in_processes(report, lights, accelerator, done, load_picture, parts)
        if name not in _draws:
            load_picture()
        if not picture_only:
            load(method_steps(lights, accelerator))
            _ready.add(name)
            _mark_kept(name, picture_only=False)
        report("ready", 1.0)


@contextmanager
def _alone(report: Progress) -> Iterator[None]:
    """Compile one thing at a time; whoever waits can be cancelled."""
    while not _lock.acquire(timeout=0.1):
        report("waiting for other kernels", 0.0)
    try:
        yield
    finally:
        _lock.release()


def ready_for(method: str, lights: int = 1, accelerator: str = "bvh8") -> bool:
    """Whether the kernels of a method have been made ready (`make_ready`), or are among those that `warm_up` makes."""
    return _variant(lights, accelerator, method) in _methods or set(Method.parse(method).kinds) <= kinds_of(*WARM)


def make_ready(method: str, lights: int = 1, accelerator: str = "bvh8", progress: Progress | None = None) -> None:
    """Compile or load what a method has of its own, besides what all pictures need."""
    if not ready_for(method, lights, accelerator):
        if progress is not None:
            progress(f"compiling the kernels of {title_of(method)}", 0.0)
        render_tiny(method, lights, accelerator)
        _methods.add(_variant(lights, accelerator, method))


def make_all_ready(methods: Iterable[str], lights: int, accelerator: str, progress: Progress | None = None) -> None:
    """Compile or load every kernel that these methods need for so many lights."""
    names = list(methods)
    warm_up(progress, lights, accelerator, picture_only=all(map(is_first, names)))
    for name in names:
        make_ready(name, lights, accelerator, progress)


def is_first(method: str) -> bool:
    """Whether a method needs no more than a first picture does."""
    return set(Method.parse(method).kinds) <= kinds_of(*FIRST)


def can_draw(lights: int = 1, accelerator: str = "bvh8") -> bool:
    """Whether pictures can be traced by the `FIRST` methods; others may not be ready yet."""
    return _variant(lights, accelerator) in _draws


def compiled_before(lights: int = 1, accelerator: str = "bvh8", picture_only: bool = False) -> bool:
    """Whether all kernels, or those of a first picture, were compiled once already, for this processor and from these
    sources: they are loaded only."""
    name = _variant(lights, accelerator)
    return _mark(name, False).exists() or (picture_only and _mark(name, True).exists())


def _variant(lights: int, accelerator: str, method: str = "") -> str:
    many = "-many" if method and lights > MAX_CULLED_LIGHTS else ""
    return f"{accelerator}-{word_type(lights).__name__}{many}{method}"


def _mark(variant: str, picture_only: bool) -> Path:
    """The file that says that all kernels of a variant, or those of a first picture, are in the cache."""
    whole = "drawable" if picture_only else "ready"
    return version_folder() / f"{variant}-{sys.implementation.cache_tag}-{_processor()}.{whole}"


def _processor() -> str:
    return str(cpu_target.target_context.codegen().magic_tuple()[1])


def _mark_kept(variant: str, picture_only: bool) -> None:
    with suppress(OSError):
        if anything_kept():  # else nothing could be kept
            _mark(variant, picture_only).touch()
