"""A sweep: which of a study's frames are still missing, tracing them by the processes of a cluster, and keeping each as
soon as it is traced."""

from __future__ import annotations

import os
import platform
import sys
import time as clocks
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np

from tracer.experiments.cluster import Cluster
from tracer.experiments.experiment import FIGURES, figures_of
from tracer.experiments.remote_jobs import Emit, Job, do, prepare, world_of
from tracer.experiments.study import ASPECTS, Study, Task, differences
from tracer.experiments.sweep_store import Key, Store, keys_of
from tracer.frame import Frame
from tracer.method import Method
from tracer.renderer import Renderer
from tracer.scene import fingerprint
from tracer.scene.model import Scene
from tracer.util.version import program_version, tracer_code

FORMAT = 1
Row = dict[str, Any]
"""A frame that was measured, by the names of the columns in `tracer.experiments.sweep_store`."""
SAME = (*(name for name in FIGURES if name != "frame_seconds"), "picture")
"""What a frame that is traced again must have in common with what was kept of it."""


@dataclass
class Plan:
    """The tasks of a study, the scenes that they need, and which frames are kept already.

    `changes` say in words how the study differs from the one that was kept last."""

    study: Study
    scenes: Mapping[str, Scene]
    tasks: list[Task]
    kept: set[Key]
    changes: list[str] = field(default_factory=list)

    @property
    def missing(self) -> list[Task]:
        """Tasks of which a frame is not kept."""
        return [task for task in self.tasks if not self.kept.issuperset(frames_of(task))]

    @property
    def frames(self) -> int:
        """How many frames the study has."""
        return sum(len(task.frames) for task in self.tasks)

    @property
    def done(self) -> int:
        """How many of them are kept."""
        return sum(key in self.kept for task in self.tasks for key in frames_of(task))


@dataclass
class Report:
    """What came of a sweep: frames that were traced, those that were traced again for the sake of later ones, tasks
    that failed, with why, and frames that were not the same when they were traced again."""

    traced: int = 0
    again: int = 0
    failures: list[tuple[Task, str]] = field(default_factory=list)
    unequal: list[tuple[Task, int, str]] = field(default_factory=list)


def frames_of(task: Task) -> list[Key]:
    """What its results are kept by."""
    return [(task.key, number) for number, _ in task.frames]


def identity(study: Study, scenes: Mapping[str, Scene]) -> dict[str, Any]:
    """What results are of: the program, the contents of the scenes, and the study."""
    return {
        "format": FORMAT,
        "version": program_version(),
        "tracer": tracer_code(),
        "scenes": {name: fingerprint.of_scene(scene) for name, scene in scenes.items()},
        "study": study.to_json(),
    }


def check_same(kept: dict[str, Any], now: dict[str, Any], store: Store) -> list[str]:
    """How the study has changed since, where what is kept can stay.

    Raises ValueError, in one line, where it cannot: results of another program or other scenes are not mixed."""
    found = [f"{key}: {kept.get(key)} → {now[key]}" for key in ("format", "version") if kept.get(key) != now[key]]
    if not found and kept.get("tracer") != now["tracer"]:
        found.append("the tracer's sources have changed")
    for name, parts in now["scenes"].items():
        before = kept.get("scenes", {}).get(name)
        other = [part for part, code in parts.items() if before is not None and before.get(part) != code]
        if other:
            found.append(f"scene {name}: other {', '.join(other)}")
    if found:
        raise ValueError(
            f"{store.folder}: its results are of something else: {'; '.join(found)}; give another --output, or --anew "
            "to trace all of it again"
        )
    return differences(kept.get("study", {}), now["study"])


def planned(study: Study, scenes: Mapping[str, Scene], store: Store) -> Plan:
    """What is to be done for a study, whose results go to a store.  Raises ValueError and OSError, in one line."""
    kept, now = store.study(), identity(study, scenes)
    changes = [] if kept is None else check_same(kept, now, store)
    tasks = [task for name, scene in scenes.items() for task in study.tasks(name, scene, fingerprint.code_of(scene))]
    return Plan(study, scenes, tasks, set(keys_of(store.read())), changes)


def sweep(
    plan: Plan,
    store: Store,
    cluster: Cluster,
    cancelled: Callable[[], bool] = lambda: False,
    on_progress: Callable[[int], None] = lambda done: None,
) -> Report:
    """Trace what is missing; `on_progress` is told how many of the study's frames are kept.

    A path whose modes need their history is traced from its beginning: frames of it that are kept already are traced
    again for the others, held against what was kept, and kept as they were.  Raises Cancelled, with all that is done
    kept, and OSError, in one line."""
    missing, report = plan.missing, Report()
    kept, counted, done = set(plan.kept), _Kept(store), plan.done

    def progress() -> None:
        on_progress(done)

    jobs = [Job(task.scene, task) for task in missing]
    for outcome in do(cluster, trace, plan.scenes, jobs, cancelled, progress, fetch=False):
        new: dict[Key, Row] = {}
        for number, row in outcome.parts:
            key: Key = (row["task"], row["frame"])
            if key in kept:
                report.again += 1
                other = counted.difference(key, row) if missing[number].repeats else ""
                if other:
                    report.unequal.append((missing[number], row["frame"], other))
            else:
                kept.add(key)
                new[key] = row
        if new:
            store.add(list(new.values()))
            counted.add(new)
            report.traced += len(new)
            done += len(new)
        report.failures += [(missing[number], why) for number, why in outcome.failures]
        progress()
    failed = {task.key for task, _ in report.failures}
    for task in missing:
        if task.key not in failed and not kept.issuperset(frames_of(task)):
            report.failures.append((task, "its results did not arrive; the same command traces it again"))
    return report


class _Kept:
    """What is known of frames that are kept: those of before are read only once somebody asks."""

    def __init__(self, store: Store) -> None:
        self._store, self._known = store, dict[Key, tuple[Any, ...]]()
        self._read = False

    def add(self, rows: Mapping[Key, Row]) -> None:
        self._known.update({key: tuple(row[name] for name in SAME) for key, row in rows.items()})

    def difference(self, key: Key, row: Row) -> str:
        """In what a frame differs from what is kept of it, in words; empty where it is the same."""
        if key not in self._known and not self._read:
            table, self._read = self._store.read(), True
            columns = [table[name].to_pylist() for name in SAME]
            self._known.update(zip(keys_of(table), zip(*columns)))
        before = self._known.get(key, ())
        return ", ".join(name for name, old in zip(SAME, before) if row[name] != old)


def in_words(failures: Sequence[tuple[Task, str]]) -> str:
    """Which tasks failed, in one line."""
    task, why = failures[0]
    line = f"{task.in_words()}: {why}"
    return line if len(failures) == 1 else f"{len(failures)} tasks failed, the first of them {line}"


# --- in the processes of the cluster ------------------------------------------------------------------

_last: Renderer | None = None


def trace(task: Task, scene: Scene, emit: Emit, cancelled: Callable[[], bool]) -> None:
    """In a process of the cluster: trace a task's frames, and send each row off at once."""
    for row in rows_of(task, scene, cancelled):
        emit(row)


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
